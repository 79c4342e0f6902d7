"""How long planning for 64 beliefs takes, beside one unified-planning call a belief.

Run as `python3 -m mirror_explainer.experiments.planning_speed --pucrs DIR`; without
DIR, for the warehouse alone. Prints a Markdown table.
"""

import argparse
import itertools
import json
import re
import statistics
import time
import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from random import Random

from unified_planning.shortcuts import OneshotPlanner, get_environment

from mirror_explainer import pddl
from mirror_explainer.experiments.ground_actions import ground_action
from mirror_explainer.experiments.warehouse_files import warehouse_folder
from mirror_explainer.extras import MissingExtras, require_extras
from mirror_explainer.planning import (
    Belief,
    BeliefPlans,
    BeliefSpace,
    Planner,
    PlanningReport,
    Status,
)

_GOALS, _FACTS, _MANY_FACTS = 4, 4, 8


@dataclass(frozen=True)
class Instance:
    """A goal recognition problem: the candidate goals as PDDL, the robot's own goal first."""

    name: str
    domain: str
    problem: str
    goals: tuple[str, ...]
    hard: bool = False


@dataclass(frozen=True)
class Case:
    """A belief space, and the same after the first action of the robot's plan."""

    space: BeliefSpace
    stepped: BeliefSpace


@dataclass(frozen=True)
class Row:
    """What was measured on one instance; all times in seconds."""

    name: str
    beliefs: int
    naive: float
    cold: float
    step: float
    calls: int
    searching: float
    many: float
    compared: int


def read_instance(folder: Path, hard: bool = False) -> Instance:
    """Read an instance of the PUCRS data set: domain.pddl, template.pddl and *hyp*.dat."""
    own = (folder / 'real_hyp.dat').read_text().strip()
    hypotheses = (folder / 'hyps.dat').read_text().strip().splitlines()
    others = [line for line in hypotheses if _atoms(line) != _atoms(own)]
    return Instance(
        folder.name,
        (folder / 'domain.pddl').read_text(),
        (folder / 'template.pddl').read_text().replace('<HYPOTHESIS>', ''),
        tuple(f'(and {" ".join(sorted(_atoms(line)))})' for line in [own, *others]),
        hard,
    )


def _atoms(line: str) -> frozenset[str]:
    return frozenset(atom.strip().lower() for atom in line.split(','))


def warehouse() -> Instance:
    """Return the demo's warehouse: which door the robot leaves by, with what in hand."""
    folder = warehouse_folder()
    items = ('red_circle', 'blue_cube', 'red_triangle', 'blue_circle')
    doors = ('bottom_door', 'top_left_door', 'top_right_door', 'bottom_door')
    return Instance(
        'warehouse',
        (folder / 'domain.pddl').read_text(),
        (folder / 'problem.pddl').read_text(),
        tuple(
            f'(and (holding {item}) (outside {door}))'
            for item, door in zip(items, doors, strict=True)
        ),
    )


def uncertain_case(planner: Planner, instance: Instance, facts: int, random: Random) -> Case:
    """Return four goals, and uncertain facts as in Section 6 of the paper.

    They are drawn from the preconditions of the robot's plan that hold initially;
    where these are too few, from its other preconditions.
    """
    others = instance.goals[1:]
    goals = (instance.goals[0], *random.sample(others, min(_GOALS - 1, len(others))))
    space = BeliefSpace(instance.domain, instance.problem, goals)
    [robot] = planner.plan(space, [Belief(0)], deadline=20.0).results
    task = pddl.read_task(instance.domain, instance.problem)
    needed = frozenset[str]().union(
        *(ground_action(task, action).preconditions for action in robot.plans[0].actions)
    )
    initial = task.initial_facts
    holding = sorted(needed & initial)
    random.shuffle(holding)
    more = sorted(needed - initial)
    random.shuffle(more)
    space = replace(space, uncertain_facts=tuple((holding + more)[:facts]))
    state = _after(task, robot.plans[0].actions[0])
    init = f'(:init {" ".join(sorted(state))}'
    return Case(space, replace(space, problem=_with_facts(instance.problem, init)))


def _after(task: pddl.Task, action: str) -> frozenset[str]:
    done = ground_action(task, action)
    return (task.initial_facts - done.deleted) | done.added


def _with_facts(problem: str, init: str) -> str:
    """Return the problem with other initial facts; its costs stay."""
    begin = re.search(r'\(\s*:init', problem, re.IGNORECASE)
    assert begin is not None
    depth, end = 0, begin.start()
    for end in range(begin.start(), len(problem)):
        depth += {'(': 1, ')': -1}.get(problem[end], 0)
        if not depth:
            break
    numbers = ' '.join(re.findall(r'\(=\s+\([^)]*\)\s+[\d.]+\s*\)', problem[begin.start() : end]))
    return f'{problem[: begin.start()]}{init} {numbers}{problem[end:]}'


def every_belief(space: BeliefSpace) -> list[Belief]:
    """Return the beliefs of all goals and all subsets of the uncertain facts."""
    facts = space.uncertain_facts
    return [
        Belief(goal, frozenset(true))
        for goal in range(len(space.goals))
        for size in range(len(facts) + 1)
        for true in itertools.combinations(facts, size)
    ]


def naive(space: BeliefSpace, beliefs: Sequence[Belief]) -> Iterator[tuple[float, float | None]]:
    """Yield the seconds of one unified-planning call for each belief, and the cost found."""
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
            plan = engine.solve(problem).plan
        seconds = time.perf_counter() - began
        # The data set has no action costs, the demo neither: the cost is the length.
        yield seconds, None if plan is None else float(len(plan.actions))


def _running_planner() -> Planner:
    """Return a planner whose process is up, as a node's is, and that knows another problem."""
    planner = Planner()
    other = warehouse()
    planner.plan(BeliefSpace(other.domain, other.problem, other.goals), [Belief(0)])
    return planner


def _timed(planner: Planner, space: BeliefSpace) -> tuple[float, PlanningReport]:
    beliefs = every_belief(space)
    began = time.perf_counter()
    report = planner.plan(space, beliefs)
    return time.perf_counter() - began, report


def _cost(result: BeliefPlans) -> float | None:
    return result.plans[0].cost if result.status is Status.SOLVED else None


def measure(instance: Instance, sample: int) -> Row:
    """Measure one instance; raises AssertionError if a cost differs from the naive way's."""
    random = Random(instance.name)
    with Planner() as helper:
        case = uncertain_case(helper, instance, _FACTS, random)
        many = uncertain_case(helper, instance, _MANY_FACTS, Random(instance.name))
    with _running_planner() as planner:
        cold, report = _timed(planner, case.space)
        step, stepped = _timed(planner, case.stepped)
    with _running_planner() as planner:
        many_seconds, _ = _timed(planner, many.space)
    seconds = []
    for space, found in ((case.space, report), (case.stepped, stepped)):
        beliefs = every_belief(space)
        costs = dict(zip(beliefs, map(_cost, found.results), strict=True))
        asked = random.sample(beliefs, min(sample, len(beliefs)))
        for belief, (took, cost) in zip(asked, naive(space, asked), strict=True):
            assert costs[belief] == cost, (instance.name, belief, costs[belief], cost)
            seconds.append(took)
    return Row(
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


def table(rows: Sequence[Row]) -> str:
    """Return the measurements as Markdown."""
    lines = [
        '| instance | beliefs | one call a belief, s | cold, s | times faster | searches | '
        'searching, share | after a step, s | 2⁸ states, s | costs compared |',
        '|---|---|---|---|---|---|---|---|---|---|',
    ]
    for row in rows:
        lines.append(
            f'| {row.name} | {row.beliefs} | {row.naive:.1f} | {row.cold:.3f} | '
            f'{row.naive / row.cold:.0f} | {row.calls} | {row.searching / row.cold:.0%} | '
            f'{row.step:.3f} | {row.many:.3f} | {row.compared} |'
        )
    faster = [row.naive / row.cold for row in rows]
    cold = [row.cold for row in rows]
    lines.append(
        f'\n{len(rows)} instances: {statistics.median(faster):.0f} times faster in the median, '
        f'{min(faster):.0f} at least; cold {statistics.median(cold):.3f} s in the median, '
        f'{max(cold):.3f} s at most; after a step '
        f'{statistics.median(row.step for row in rows):.3f} s in the median; 2⁸ initial states '
        f'take {statistics.median(row.many / row.cold for row in rows):.1f} times as long as 2⁴ '
        f'in the median, {max(row.many / row.cold for row in rows):.1f} at most. '
        f'{sum(row.compared for row in rows)} costs compared, none different.'
    )
    return '\n'.join(lines)


def hard_table(instances: Sequence[Instance], deadline: float) -> str:
    """Return what the deadline leaves of the instances that optimal planning cannot finish."""
    lines = [
        '| hard instance | beliefs | seconds | optimal | stand-in | unsolvable | unknown |',
        '|---|---|---|---|---|---|---|',
    ]
    for instance in instances:
        with Planner() as planner:
            case = uncertain_case(planner, instance, _FACTS, Random(instance.name))
            began = time.perf_counter()
            report = planner.plan(case.space, every_belief(case.space), deadline=deadline)
            seconds = time.perf_counter() - began
        plans = [plan for result in report.results for plan in result.plans]
        optimal = sum(plan.optimal for plan in plans)
        states = [result.status for result in report.results]
        lines.append(
            f'| {instance.name} | {len(states)} | {seconds:.1f} | {optimal} | '
            f'{len(plans) - optimal} | {states.count(Status.UNSOLVABLE)} | '
            f'{states.count(Status.UNKNOWN)} |'
        )
    return '\n'.join(lines)


def draw(rows: Sequence[Row], path: Path) -> None:
    """Draw every instance's seconds, one call a belief beside ours, as PNG and SVG."""
    from matplotlib.figure import Figure

    from mirror_explainer.experiments.figures import save

    figure = Figure(figsize=(7.5, 3.6), layout='constrained')
    axes = figure.subplots()
    ordered = sorted(rows, key=lambda row: row.naive)
    places = range(len(ordered))
    for seconds, label, marker, colour in (
        ([row.naive for row in ordered], 'one call a belief (extrapolated)', 's', '#d55e00'),
        ([row.cold for row in ordered], 'here, a new problem', 'o', '#009e73'),
        ([row.step for row in ordered], 'here, after one step of the robot', 'x', '#0072b2'),
    ):
        axes.plot(places, seconds, marker, label=label, color=colour, markersize=5)
    axes.set_yscale('log')
    axes.set_ylabel('seconds for 64 beliefs')
    axes.set_xlabel(f'{len(ordered)} problems, by the time of one call a belief')
    axes.set_xticks([])
    figure.legend(loc='outside upper center', ncols=3, frameon=False)
    save(figure, path)


def start_seconds() -> float:
    """Return how long a new planner takes for its first belief, its process's start included."""
    began = time.perf_counter()
    with _running_planner():
        return time.perf_counter() - began


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--pucrs', type=Path, help='folder of the PUCRS instances')
    parser.add_argument('--only', default='', help='only instances whose name contains this')
    parser.add_argument('--sample', type=int, default=4, help='naive calls for each state')
    parser.add_argument('--deadline', type=float, default=30.0, help='for the hard ones, seconds')
    parser.add_argument('--figure', type=Path, help='draw FIGURE.png and FIGURE.svg')
    arguments = parser.parse_args()
    if arguments.figure:
        try:
            require_extras('experiments')
        except MissingExtras as error:
            parser.error(str(error))
    instances = [warehouse()]
    if arguments.pucrs:
        manifest = json.loads((arguments.pucrs / 'manifest.json').read_text())['instances']
        for entry in manifest:
            folder = arguments.pucrs / entry['domain'] / entry['instance']
            instances.append(read_instance(folder, entry['lmcut_tier'] == 'hard'))
    chosen = [instance for instance in instances if arguments.only in instance.name]
    rows = [measure(i, arguments.sample) for i in chosen if not i.hard]
    if rows:
        print(
            'The time of one call a belief is extrapolated from those made to compare costs. '
            'Cold: the problem is new, the process is up; to start that and plan for one belief '
            f'takes {start_seconds():.2f} s.\n'
        )
        print(table(rows))
        if arguments.figure:
            draw(rows, arguments.figure)
    hard = [instance for instance in chosen if instance.hard]
    if hard:
        print(f'\nWith a deadline of {arguments.deadline:g} s:\n')
        print(hard_table(hard, arguments.deadline))


if __name__ == '__main__':
    main()
