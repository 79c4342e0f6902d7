"""Drafted user models beside those by hand, with each two of a robot's other goals as seen.

    python test/benchmarks/drafted_models.py FOLDER …

A folder has `domain.pddl`, `problem.pddl`, `plan.txt`, and a `user.yaml` by hand, such as those in
test/commands/drafted_robots. Prints for each robot, over all pairs: how many drafts take all
goals by hand; how many facts and groups of facts are found and proposed, at worst; and of the
answers with at most 1, 2 and 3 sentences how many name the same ends, how many name the same ends
or ones that the model by hand finds exactly as telling (within 1e-9 nats), how many tell the
listener by hand as much, but for what that one takes for a filler (its `min_gain`, 0.02 nats if
the model says nothing else), and how many nats less the others tell, in the mean and at most.
With -v each pair that differs.
"""

import contextlib
import io
import sys
import tempfile
from collections.abc import Callable
from itertools import combinations
from pathlib import Path
from statistics import mean

import pandas as pd

sys.path.insert(0, str(Path(__file__).parents[1] / 'helpers'))

from drafted import TIE, Drafted, Robot

from mirror_explainer.experiments.markdown import markdown_table
from mirror_explainer.planning import Planner


def main(folders: list[str], verbose: bool) -> None:
    """Print a table with a row for each robot."""
    rows = []
    with Planner(planning_timeout=10.0) as planner:
        for folder in folders:
            robot = Robot(Path(folder), planner)
            pairs = list(combinations(robot.others, 2))
            drafts = []
            for pair in pairs:
                with (
                    tempfile.TemporaryDirectory() as place,
                    contextlib.redirect_stdout(io.StringIO()),
                ):
                    drafts.append(robot.drafted(pair, Path(place)))
                if verbose:
                    tell(robot, [goal.name for goal in pair], drafts[-1])
            rows.append(row(robot, drafts))
    headers = ['robot', 'pairs', 'all goals', 'facts found', 'proposed']
    headers += ['same ends', 'same or a tie', 'but a filler', 'nats less, mean', 'at most']
    print(markdown_table(pd.DataFrame(rows, columns=headers)))


def row(robot: Robot, drafts: list[Drafted]) -> list[object]:
    """Return the table's row of a robot."""
    criteria = (
        robot.same_ends,
        robot.same_or_tied,
        lambda told, best: robot.loss(told, best) <= filler(robot),
    )
    by_hand = drafts[0].by_hand
    return [
        robot.folder.name,
        len(drafts),
        sum(not draft.missing for draft in drafts),
        f'{min(draft.found for draft in drafts)} of {by_hand}',
        max(draft.proposed for draft in drafts),
        *(counts(robot, drafts, criterion) for criterion in criteria),
        *(losses(robot, drafts, summary) for summary in (mean, max)),
    ]


def counts(
    robot: Robot,
    drafts: list[Drafted],
    criterion: Callable[[frozenset[int], frozenset[int]], bool],
) -> str:
    """Return how many drafts' answers fulfil a criterion, with 1, 2 and 3 sentences."""
    judged = zip(*(map(criterion, draft.answers, robot.answers) for draft in drafts), strict=True)
    return ', '.join(str(sum(answers)) for answers in judged)


def losses(robot: Robot, drafts: list[Drafted], summary: Callable[[list[float]], float]) -> str:
    """Return what the answers lose with 1, 2 and 3 sentences, of those that lose a filler more."""
    lost = zip(*(map(robot.loss, draft.answers, robot.answers) for draft in drafts), strict=True)
    more = [[nats for nats in number if nats > filler(robot)] for number in lost]
    return ', '.join(f'{summary(nats):.2f}' if nats else '–' for nats in more)


def filler(robot: Robot) -> float:
    """Return the nats that are not worth a sentence."""
    return robot.model.listener.min_gain or 0.0


def tell(robot: Robot, seen: list[str], draft: Drafted) -> None:
    """Print where a draft differs."""
    if draft.missing:
        print(f'{seen}: lacks {draft.missing}')
    for n, (told, best) in enumerate(zip(draft.answers, robot.answers, strict=True), start=1):
        ours, theirs = (sorted(map(str, robot.ends(answer))) for answer in (told, best))
        if ours != theirs:
            loss = robot.loss(told, best)
            less = 'a tie' if abs(loss) <= TIE else f'{loss:.3f} nats less'
            print(f'{seen}: with {n} {ours}, by hand {theirs}, {less}')


if __name__ == '__main__':
    main([word for word in sys.argv[1:] if word != '-v'], '-v' in sys.argv)
