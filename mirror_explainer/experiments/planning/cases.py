"""The cases that planning is measured on: goals, uncertain facts, and a step of the robot.

They are drawn from the problems of the PUCRS data set, and from the demo's warehouse.
"""

import itertools
import re
import time
from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path
from random import Random

from mirror_explainer.errors import PlanningError
from mirror_explainer.experiments.benchmark.dataset import Location, read_instance
from mirror_explainer.experiments.benchmark.ground_actions import ground_action, needed_facts
from mirror_explainer.experiments.warehouse_files import read_warehouse
from mirror_explainer.pddl import Task, read_task
from mirror_explainer.pddl.text.sections import section
from mirror_explainer.planning import Belief, BeliefSpace, Planner, PlanningReport, Status

_GOALS = 4


@dataclass(frozen=True)
class Instance:
    """A goal recognition problem: the candidate goals as PDDL, the robot's own goal first."""

    domain_name: str
    name: str
    domain: str
    problem: str
    goals: tuple[str, ...]


@dataclass(frozen=True)
class Case:
    """A belief space, and the same after the first action of the robot's plan."""

    space: BeliefSpace
    stepped: BeliefSpace


def pucrs_instance(location: Location, dataset: Path) -> Instance:
    """Read an instance of the PUCRS data set. Raises InputError.

    Its problem asks for nothing: a goal there would break ties among plans another
    way, and other facts be drawn.
    """
    found = read_instance(location, dataset)
    own = found.true_goal
    others = (goal for goal in found.goals if goal != own)
    return Instance(
        location.domain, location.name, found.domain, found.problem('(and )'), (own, *others)
    )


def warehouse() -> Instance:
    """Return the demo's warehouse: which door the robot leaves by, with what in hand."""
    task, _ = read_warehouse()
    items = ('red_circle', 'blue_cube', 'red_triangle', 'blue_circle')
    doors = ('bottom_door', 'top_left_door', 'top_right_door', 'bottom_door')
    goals = tuple(
        f'(and (holding {item}) (outside {door}))' for item, door in zip(items, doors, strict=True)
    )
    return Instance('warehouse', 'warehouse', task.domain, task.problem, goals)


def uncertain_case(planner: Planner, instance: Instance, facts: int, random: Random) -> Case:
    """Return four goals, and uncertain facts as in Section 6 of the paper.

    They are drawn from the preconditions of the robot's plan that hold initially;
    where these are too few, from its other preconditions.
    """
    others = instance.goals[1:]
    goals = (instance.goals[0], *random.sample(others, min(_GOALS - 1, len(others))))
    space = BeliefSpace(instance.domain, instance.problem, goals)
    [robot] = planner.plan(space, [Belief(0)], deadline=60.0).results
    if robot.status is not Status.SOLVED:
        why = robot.reason or 'it cannot be reached'
        raise PlanningError(f"{instance.name} has no plan for the robot's goal: {why}")
    plan = robot.plans[0].actions
    task = read_task(instance.domain, instance.problem)
    needed, initial = needed_facts(task, plan), task.initial_facts
    holding = sorted(needed & initial)
    random.shuffle(holding)
    more = sorted(needed - initial)
    random.shuffle(more)
    space = replace(space, uncertain_facts=tuple((holding + more)[:facts]))
    return Case(space, _after(task, space, plan[0]))


def after_step(space: BeliefSpace, belief: Belief, action: str) -> BeliefSpace:
    """Return the space after an action of a robot in a belief's state."""
    return _after(read_task(space.domain, problem_of(space, belief)), space, action)


def _after(task: Task, space: BeliefSpace, action: str) -> BeliefSpace:
    done = ground_action(task, action)
    facts = (task.initial_facts - done.deleted) | done.added
    return replace(space, problem=_with_facts(space.problem, facts))


def _with_facts(problem: str, facts: Iterable[str]) -> str:
    """Return the problem with other initial facts; its costs stay."""
    init = section(problem, ':init')
    assert init is not None
    costs = re.findall(r'\(=\s+\([^)]*\)\s+[\d.]+\s*\)', problem[init.start : init.end])
    changed = f'(:init {" ".join([*sorted(facts), *costs])})'
    return problem[: init.start] + changed + problem[init.end :]


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


def every_belief(space: BeliefSpace) -> list[Belief]:
    """Return the beliefs of all goals and all subsets of the uncertain facts."""
    facts = space.uncertain_facts
    return [
        Belief(goal, frozenset(true))
        for goal in range(len(space.goals))
        for size in range(len(facts) + 1)
        for true in itertools.combinations(facts, size)
    ]


def running_planner() -> Planner:
    """Return a planner whose process is up, as a node's is, and that knows another problem."""
    planner = Planner()
    other = warehouse()
    planner.plan(BeliefSpace(other.domain, other.problem, other.goals), [Belief(0)])
    return planner


def timed(
    planner: Planner,
    space: BeliefSpace,
    *,
    plans_per_belief: int = 1,
    deadline: float | None = None,
) -> tuple[float, PlanningReport]:
    """Plan for every belief of the space; return the seconds that took, and what was found."""
    beliefs = every_belief(space)
    began = time.perf_counter()
    report = planner.plan(space, beliefs, plans_per_belief=plans_per_belief, deadline=deadline)
    return time.perf_counter() - began, report
