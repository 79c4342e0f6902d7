"""How long planning for 64 beliefs takes, beside one unified-planning call a belief.

Run as `python3 -m mirror_explainer.experiments.planning.speed --pucrs DIR`; without
DIR, for the warehouse alone. Prints Markdown tables.
"""

import argparse
import statistics
import sys
import time
import warnings
from collections.abc import Iterator, Sequence
from pathlib import Path
from random import Random

from unified_planning.shortcuts import OneshotPlanner, get_environment

from mirror_explainer import pddl
from mirror_explainer.commands.command_line import command_parser
from mirror_explainer.commands.extras import MissingExtras, require_extras
from mirror_explainer.commands.options import number, whole
from mirror_explainer.commands.terminal import tell_error
from mirror_explainer.errors import InputError, PlanningError
from mirror_explainer.experiments.benchmark.dataset import listed_locations
from mirror_explainer.experiments.planning.cases import (
    Instance,
    every_belief,
    pucrs_instance,
    running_planner,
    timed,
    uncertain_case,
    warehouse,
)
from mirror_explainer.experiments.planning.speed_tables import (
    HardRow,
    Row,
    domains_table,
    draw,
    hard_table,
    table,
)
from mirror_explainer.planning import Belief, BeliefPlans, BeliefSpace, Planner, Status

_FACTS, _MANY_FACTS = 4, 8


def measure(instance: Instance, sample: int) -> Row:
    """Measure one instance; raises AssertionError if a cost differs from the naive way's."""
    random = Random(instance.name)
    with Planner() as helper:
        case = uncertain_case(helper, instance, _FACTS, random)
        many = uncertain_case(helper, instance, _MANY_FACTS, Random(instance.name))
    with running_planner() as planner:
        cold, report = timed(planner, case.space)
        step, stepped = timed(planner, case.stepped)
    with running_planner() as planner:
        many_seconds, _ = timed(planner, many.space)
    seconds = []
    for space, found in ((case.space, report), (case.stepped, stepped)):
        beliefs = every_belief(space)
        costs = dict(zip(beliefs, map(_cost, found.results), strict=True))
        asked = random.sample(beliefs, min(sample, len(beliefs)))
        for belief, (took, cost) in zip(asked, naive(space, asked), strict=True):
            assert costs[belief] == cost, (instance.name, belief, costs[belief], cost)
            seconds.append(took)
    return Row(
        instance.domain_name,
        instance.name,
        len(report.results),
        statistics.mean(seconds) * len(report.results),
        cold,
        step,
        report.planner_calls,
        report.searching,
        many_seconds,
        len(seconds),
    )


def measure_hard(instance: Instance, deadline: float) -> HardRow:
    """Measure what the deadline, in seconds, leaves of one instance."""
    # Its first plan is there soon.
    with Planner('fast-downward', planning_timeout=60.0) as helper:
        case = uncertain_case(helper, instance, _FACTS, Random(instance.name))
    with running_planner() as planner:
        seconds, report = timed(planner, case.space, deadline=deadline)
    states = [result.status for result in report.results]
    return HardRow(
        instance.name,
        len(states),
        seconds,
        states.count(Status.SOLVED),
        states.count(Status.UNSOLVABLE),
        states.count(Status.UNKNOWN),
    )


def naive(
    space: BeliefSpace, beliefs: Sequence[Belief], timeout: float | None = None
) -> Iterator[tuple[float, float | None]]:
    """Yield the seconds of one unified-planning call for each belief, and the cost found.

    A call is ended after `timeout` seconds.
    """
    model = pddl.read_task(space.domain, space.problem).model
    get_environment().credits_stream = None
    warnings.simplefilter('ignore')
    for belief in beliefs:
        began = time.perf_counter()
        problem = model.clone()
        for fact in space.uncertain_facts:
            expression = pddl.fluent_expression(problem, fact)
            problem.set_initial_value(expression, fact in belief.true_facts)
        problem.clear_goals()
        problem.add_goal(pddl.goal_expression(problem, space.goals[belief.goal]))
        with OneshotPlanner(name='fast-downward-opt') as engine:
            plan = engine.solve(problem, timeout=timeout).plan
        seconds = time.perf_counter() - began
        # The data set has no action costs, the demo neither: the cost is the length.
        yield seconds, None if plan is None else float(len(plan.actions))


def start_seconds() -> float:
    """Return how long a new planner takes for its first belief, its process's start included."""
    began = time.perf_counter()
    with running_planner():
        return time.perf_counter() - began


def _cost(result: BeliefPlans) -> float | None:
    return result.plans[0].cost if result.status is Status.SOLVED else None


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure and print; return 0, or 2 for bad input, told on stderr."""
    options = _parser().parse_args(arguments)
    try:
        if options.figure:
            require_extras('experiments')
        _measure_all(options)
    except (InputError, PlanningError, MissingExtras, OSError) as error:
        tell_error('planning_speed', error)
        return 2
    except KeyboardInterrupt:
        return 130
    return 0


def _measure_all(options: argparse.Namespace) -> None:
    rows = [measure(i, options.sample) for i in _instances(options, hard=False)]
    if rows:
        print(
            'The time of one call a belief is extrapolated from those made to compare costs. '
            'Cold: the problem is new, the process is up; to start that and plan for one belief '
            f'takes {start_seconds():.2f} s.\n'
        )
        print(f'{table(rows)}\n\nMedians:\n\n{domains_table(rows)}')
        if options.figure:
            draw(rows, options.figure)
    hard = _instances(options, hard=True)
    if hard:
        print(f'\nWith a deadline of {options.deadline:g} s:\n')
        print(hard_table([measure_hard(i, options.deadline) for i in hard]))


def _instances(options: argparse.Namespace, *, hard: bool) -> list[Instance]:
    """Return the instances asked for: the hard ones, or the others, the warehouse first."""
    found = [] if hard else [warehouse()]
    if options.pucrs:
        where = listed_locations(options.pucrs, hard=hard)
        found += [pucrs_instance(location, options.pucrs) for location in where]
    return [instance for instance in found if options.only in instance.name]


def _parser() -> argparse.ArgumentParser:
    command = 'python3 -m mirror_explainer.experiments.planning.speed'
    parser = command_parser(
        'planning_speed',
        'Measure planning for 64 beliefs, beside one unified-planning call a belief.',
        command,
        f'{command} --only warehouse --figure speed',
    )
    parser.add_argument('--pucrs', type=Path, help='folder of the PUCRS instances')
    parser.add_argument('--only', default='', help='only instances whose name contains this')
    parser.add_argument('--sample', type=whole(1), default=4, help='naive calls for each state')
    parser.add_argument(
        '--deadline', type=number(0), default=30.0, help='for the hard ones, seconds'
    )
    parser.add_argument('--figure', type=Path, help='draw FIGURE.png and FIGURE.svg')
    return parser


if __name__ == '__main__':
    sys.exit(main())
