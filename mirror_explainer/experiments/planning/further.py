"""All optimal plans of a belief: our searches beside K*'s unordered top-quality planning.

Run as `python3 -m mirror_explainer.experiments.planning.further [--pucrs DIR]`. Prints a Markdown
table; K* is in it if kstar-planner (PyPI, GPLv3) is installed. Every count that both end with
must be the same.
"""

import importlib.util
import json
import resource
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from mirror_explainer.commands.options import whole
from mirror_explainer.commands.terminal import command_parser, tell_error
from mirror_explainer.errors import InputError, PlanningError
from mirror_explainer.experiments.benchmark.dataset import listed_locations
from mirror_explainer.experiments.markdown import worded_table
from mirror_explainer.experiments.planning.cases import problem_of, pucrs_instance
from mirror_explainer.experiments.planning.robots import robots
from mirror_explainer.planning import Belief, BeliefPlans, BeliefSpace, Planner, Status

_MOST_PLANS = 300
_SECONDS = 20  # of processor time, for either


# In a process of its own, as the licence of its package wants.
_KSTAR = f"""
import json, sys
from pathlib import Path
from kstar_planner.planners import plan_unordered_topq
found = plan_unordered_topq(
    *map(Path, sys.argv[1:]), 1.0, number_of_plans_bound={_MOST_PLANS}, timeout={_SECONDS}
)
print(json.dumps([len(found['plans']), found['timeout_triggered']]))
"""


@dataclass(frozen=True)
class Found:
    """How many plans one way found for some goals, whether it ended, in how many seconds.

    These are of processor time: grounding, searching and putting together, processes' starts.
    """

    plans: tuple[int, ...]
    ended: bool
    seconds: float


def ours(space: BeliefSpace, beliefs: Sequence[Belief]) -> Found:
    """Let our planner find the plans, each belief by itself."""
    before = _processor_seconds()
    results: list[BeliefPlans] = []
    for belief in beliefs:
        with Planner(planning_timeout=_SECONDS) as planner:
            results += planner.plan(space, [belief], plans_per_belief=_MOST_PLANS).results
    ended = all(r.status is not Status.UNKNOWN and r.cut != 'time' for r in results)
    return Found(tuple(len(r.plans) for r in results), ended, _processor_seconds() - before)


def kstar(space: BeliefSpace, beliefs: Sequence[Belief]) -> Found:
    """Let K* find them, called as its package does."""
    before, plans, ended = _processor_seconds(), [], True
    for belief in beliefs:
        with tempfile.TemporaryDirectory() as name:
            domain, problem = Path(name, 'domain.pddl'), Path(name, 'problem.pddl')
            domain.write_text(space.domain)
            problem.write_text(problem_of(space, belief))
            command = [sys.executable, '-c', _KSTAR, str(domain), str(problem)]
            called = subprocess.run(command, check=True, capture_output=True, text=True)
        count, late = json.loads(called.stdout)
        plans.append(count)
        ended &= count > 0 and not late
    return Found(tuple(plans), ended, _processor_seconds() - before)


def _processor_seconds() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


@dataclass(frozen=True)
class Row:
    """What both found for the goals of a task of some kind; K*'s is None if it is not installed.

    Raises AssertionError where the counts differ.
    """

    kind: str
    name: str
    here: Found
    kstar: Found | None

    def __post_init__(self) -> None:
        if self.kstar and self.kstar.ended and self.here.ended:
            assert self.here.plans == self.kstar.plans, self


def table(rows: Sequence[Row]) -> str:
    """Return what was found as Markdown, and what that comes to."""
    both = [(row.here, row.kstar) for row in rows if row.kstar]
    headings = ['task', 'plans, here', 's', *(['plans, K*', 's'] if both else [])]

    def cells(found: Found) -> tuple[str, str]:
        ended = '' if found.ended else ' (not ended)'
        return ', '.join(map(str, found.plans)), f'{found.seconds:.2f}{ended}'

    lines = [
        (row.name, *cells(row.here), *(cells(row.kstar) if row.kstar else ())) for row in rows
    ]
    told = worded_table(headings, lines)
    if not both:
        return f'{told}\n\nLeft out, since not installed: K* (kstar-planner).'
    return f'{told}\n\n{_sums(rows)}'


def _sums(rows: Sequence[Row]) -> str:
    """Return what it comes to for each kind of task, as Markdown; all counts agree."""

    def cells(kind: str) -> list[object]:
        both = [(r.here, r.kstar) for r in rows if r.kstar and kind in (r.kind, 'all')]
        sides = list(zip(*both, strict=True))
        return [
            kind,
            len(both),
            *(sum(not found.ended for found in side) for side in sides),
            sum(here.seconds < other.seconds for here, other in both),
            *(f'{sum(found.seconds for found in side):.0f}' for side in sides),
        ]

    headings = ('tasks', 'how many', 'not ended here', 'not with K*', 'quicker here', 's', 's, K*')
    return worded_table(headings, map(cells, [*dict.fromkeys(r.kind for r in rows), 'all']))


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure and print; return 0, or 2 for bad input, told on stderr."""
    command = 'python3 -m mirror_explainer.experiments.planning.further'
    parser = command_parser(
        'further',
        'Find all optimal plans, beside K*.',
        command,
        f'{command} --only map --goals 1',
    )
    parser.add_argument('--pucrs', type=Path, help='folder of the PUCRS instances')
    parser.add_argument('--only', default='', help='only what has this in its name')
    parser.add_argument('--goals', type=whole(1), default=2, help='goals of each')
    options = parser.parse_args(arguments)
    try:
        spaces = [
            ('robots', r.name, r.space, r.beliefs[0].true_facts)
            for r in robots()
            if options.only in r.name
        ]
        for location in listed_locations(options.pucrs, hard=False) if options.pucrs else ():
            found = pucrs_instance(location, options.pucrs)
            if options.only in found.name:
                space = BeliefSpace(found.domain, found.problem, found.goals)
                spaces.append((found.domain_name, found.name, space, frozenset()))
        installed = importlib.util.find_spec('kstar_planner') is not None
        rows = []
        for kind, name, space, facts in spaces:
            beliefs = [Belief(goal, facts) for goal in range(len(space.goals))][: options.goals]
            other = kstar(space, beliefs) if installed else None
            rows.append(Row(kind, name, ours(space, beliefs), other))
            print(rows[-1], file=sys.stderr)
        print(table(rows))
    except (InputError, PlanningError, subprocess.CalledProcessError, OSError) as error:
        tell_error('further', error)
        return 2
    except KeyboardInterrupt:
        return 130
    return 0


if __name__ == '__main__':
    sys.exit(main())
