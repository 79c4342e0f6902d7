"""Drafted user models beside those by hand, with each two of a robot's other goals as seen.

    python test/benchmarks/drafted_models.py FOLDER …

A folder has `domain.pddl`, `problem.pddl`, `plan.txt`, and a `user.yaml` by hand, such as those in
test/commands/drafted_robots. Prints for each robot, over all pairs: how many drafts take all
goals by hand; how many facts and groups of facts are found and proposed, at worst; and of the
answers with at most 1, 2 and 3 sentences how many name the same ends; how many do, or are as good:
they tell the listener by hand as much, but for what that one takes for a filler (its `min_gain`,
0.02 nats if the model says nothing else); how many are as good or a tie, where the draft's own
listener would find the answer by hand as good; and how many nats less those tell that are not as
good, in the mean and at most.
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

from drafted import NUMBERS, Drafted, Robot, is_as_good, loss

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
    headers += ['same ends', 'or as good', 'or a tie', 'nats less, mean', 'at most']
    print(markdown_table(pd.DataFrame(rows, columns=headers)))


def row(robot: Robot, drafts: list[Drafted]) -> list[object]:
    """Return the table's row of a robot."""

    def is_same(draft: Drafted, number: int) -> bool:
        return robot.ends(draft.answers[number]) == robot.ends(robot.answers[number])

    def is_good(draft: Drafted, number: int) -> bool:
        asked = (robot.model, draft.answers[number], robot.answers[number])
        return is_same(draft, number) or is_as_good(*asked)

    def counted(judge: Callable[[Drafted, int], bool]) -> str:
        numbers = range(len(NUMBERS))
        return ', '.join(str(sum(judge(draft, number) for draft in drafts)) for number in numbers)

    def less(summary: Callable[[list[float]], float]) -> str:
        told = []
        for number, best in enumerate(robot.answers):
            worse = [d.answers[number] for d in drafts if not is_good(d, number)]
            lost = [loss(robot.model, answer, best) for answer in worse]
            told.append(f'{summary(lost):.2f}' if lost else '–')
        return ', '.join(told)

    by_hand = drafts[0].by_hand
    return [
        robot.folder.name,
        len(drafts),
        sum(not draft.missing for draft in drafts),
        f'{min(draft.found for draft in drafts)} of {by_hand}',
        max(draft.proposed for draft in drafts),
        counted(is_same),
        counted(is_good),
        counted(lambda draft, number: is_good(draft, number) or draft.tied[number]),
        less(mean),
        less(max),
    ]


def tell(robot: Robot, seen: list[str], draft: Drafted) -> None:
    """Print where a draft differs."""
    if draft.missing:
        print(f'{seen}: lacks {draft.missing}')
    for n, (told, best) in enumerate(zip(draft.answers, robot.answers, strict=True), start=1):
        ours, theirs = (sorted(map(str, robot.ends(answer))) for answer in (told, best))
        if ours != theirs:
            less = f'{loss(robot.model, told, best):.3f} nats less'
            tie = ', a tie to the draft' if draft.tied[n - 1] else ''
            print(f'{seen}: with {n} {ours}, by hand {theirs}, {less}{tie}')


if __name__ == '__main__':
    main([word for word in sys.argv[1:] if word != '-v'], '-v' in sys.argv)
