"""How planning grows with the robot: families of tasks in three sizes each, beside other ways.

Run as `python3 -m mirror_explainer.experiments.planning.scale`. Prints a Markdown table.
"""

import select
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from mirror_explainer.commands.options import number, whole
from mirror_explainer.commands.terminal import command_parser, tell_error
from mirror_explainer.errors import PlanningError
from mirror_explainer.experiments.planning.cases import running_planner
from mirror_explainer.experiments.planning.robots import Robot, robots
from mirror_explainer.experiments.planning.speed import naive
from mirror_explainer.pddl.text.sections import section
from mirror_explainer.planning import Belief, BeliefSpace, Status
from mirror_explainer.planning.downward.portfolio import PLAIN
from mirror_explainer.planning.downward.program import Search, find_downward

_LAMA = 'let(h,ff(),lazy_greedy([h],preferred=[h],cost_type=one))'
_GOALS = 4  # that plain searches are made for
_IMPORT = (sys.executable, '-c', 'import unified_planning.shortcuts')


@dataclass(frozen=True)
class Row:
    """What was measured of one robot, in seconds.

    `unit` is how long an import took just before, `first` is when the first belief's plan was
    there, `all` when every belief's was; `calls` searches were made, in `searching` of these
    seconds. Processor time of searches for four goals alone: `alone` for ours, `best` for the best
    single one of each goal, None where none ends, `quick` for the first plan of a satisficing
    one. `naive` is one unified-planning call a belief.
    """

    name: str
    beliefs: int
    unknown: int
    unit: float
    first: float
    all: float
    calls: int
    searching: float
    alone: float
    best: float | None
    quick: float
    naive: float


def measure(robot: Robot, sample: int, limit: float) -> Row:
    """Measure one robot: `sample` beliefs naively, plain searches for `limit` s at most."""
    unit = _seconds(_IMPORT)
    told_at: list[float] = []
    with running_planner() as planner:
        began = time.perf_counter()
        report = planner.plan(
            robot.space,
            robot.beliefs,
            deadline=120.0,
            found=lambda *_: told_at.append(time.perf_counter() - began),
        )
        took = time.perf_counter() - began
    goals = [Belief(goal, robot.beliefs[0].true_facts) for goal in range(_GOALS)]
    with running_planner() as planner:
        alone = planner.plan(robot.space, goals, deadline=120.0).worked
    best, quick = _plain(robot.space, goals, limit)
    asked = robot.beliefs[:: max(1, len(robot.beliefs) // sample)][:sample]
    naive_seconds = statistics.mean(seconds for seconds, _ in naive(robot.space, asked))
    return Row(
        robot.name,
        len(robot.beliefs),
        sum(result.status is Status.UNKNOWN for result in report.results),
        unit,
        told_at[0] if told_at else took,
        took,
        report.planner_calls,
        report.searching,
        alone,
        best,
        quick,
        naive_seconds * len(robot.beliefs),
    )


def _seconds(command: Sequence[str]) -> float:
    began = time.perf_counter()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return time.perf_counter() - began


def _plain(
    space: BeliefSpace, beliefs: Sequence[Belief], limit: float
) -> tuple[float | None, float]:
    """Return the best single search of each belief, summed, and a satisficing search's seconds.

    Each is a plain search for the belief's own problem, as Fast Downward translates it.
    """
    best: float | None = 0.0
    quick = 0.0
    for belief in beliefs:
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            (folder / 'domain.pddl').write_text(space.domain)
            (folder / 'problem.pddl').write_text(problem_of(space, belief))
            translate = [sys.executable, '-m', 'fast_downward.translate', 'domain.pddl']
            subprocess.run(
                [*translate, 'problem.pddl'], cwd=folder, check=True, stdout=subprocess.DEVNULL
            )
            text = (folder / 'output.sas').read_bytes()
        ended = [taken for search in PLAIN if (taken := _searched(text, search, limit))]
        best = best + min(ended) if ended and best is not None else None
        quick += _searched(text, _LAMA, limit) or limit
    return best, quick


def problem_of(space: BeliefSpace, belief: Belief) -> str:
    """Return one belief's problem as PDDL."""
    text = space.problem
    for fact in set(space.uncertain_facts) - belief.true_facts:
        text = text.replace(fact, '')
    missing = ' '.join(fact for fact in belief.true_facts if fact not in text)
    text = text.replace('(:init', f'(:init {missing}', 1)
    goal = section(text, ':goal')
    assert goal is not None, 'every problem of ours has one'
    return f'{text[: goal.start]}(:goal {space.goals[belief.goal]}){text[goal.end :]}'


def _searched(text: bytes, configuration: str, limit: float) -> float | None:
    """Return the processor time of a search, None if it does not end within the limit."""
    program = find_downward('')
    if program is None:
        raise PlanningError("Fast Downward's search is not installed", cure='Install it.')
    search = Search(program, text, configuration, limit)
    while not select.select([search], [], [], 0.02)[0]:
        if search.used() > limit:
            search.kill()
            return None
    outcome = search.outcome()
    return None if outcome.status is Status.UNKNOWN else outcome.seconds


def table(rows: Sequence[Row]) -> str:
    """Return the measurements as Markdown, times in units of one import."""
    lines = [
        '| robot | beliefs | first plan | all first plans | seconds | searches | searching | '
        'searches of 4 goals : best single ones | LAMA for these | one call a belief |',
        '|:--|' + '--:|' * 9,
    ]
    for row in rows:
        compared = f'{row.alone / row.best:.1f}' if row.best else 'none ends'
        unknown = f' ({row.unknown} unknown)' if row.unknown else ''
        lines.append(
            f'| {row.name} | {row.beliefs}{unknown} | {row.first / row.unit:.2f} | '
            f'{row.all / row.unit:.2f} | {row.all:.2f} | {row.calls} | '
            f'{row.searching / row.all:.0%} | {compared} | {row.quick / row.unit:.2f} | '
            f'{row.naive / row.unit:.0f} |'
        )
    ratios = [row.alone / row.best for row in rows if row.best]
    lines.append(
        f'\nTimes in units of one `import unified_planning.shortcuts`, measured before each row '
        f'({min(r.unit for r in rows):.1f} to {max(r.unit for r in rows):.1f} s). The searches '
        f'for four goals took {statistics.median(ratios):.1f} times as long as the best single '
        f'ones in the median, {max(ratios):.1f} at most.'
    )
    return '\n'.join(lines)


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure and print; return 0, or 2 where planning fails, told on stderr."""
    command = 'python3 -m mirror_explainer.experiments.planning.scale'
    parser = command_parser(
        'scale',
        'Measure planning for robots of growing size.',
        command,
        f'{command} --sample 1 --limit 5',
        ends='Exit status: 0, or 2 where planning fails.',
    )
    parser.add_argument('--only', default='', help='only robots whose name contains this')
    parser.add_argument('--sample', type=whole(1), default=2, help='naive calls a robot')
    parser.add_argument('--limit', type=number(0), default=10.0, help='s of a plain search')
    options = parser.parse_args(arguments)
    try:
        rows = []
        for robot in robots():
            if options.only in robot.name:
                rows.append(measure(robot, options.sample, options.limit))
                print(f'{robot.name}: {rows[-1].all:.2f} s', file=sys.stderr)
        print(table(rows))
    except PlanningError as error:
        tell_error('scale', error)
        return 2
    except KeyboardInterrupt:
        return 130
    return 0


if __name__ == '__main__':
    sys.exit(main())
