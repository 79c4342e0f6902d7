"""One instance of the PUCRS benchmark (Section 5 of the paper): draw, plan, say, measure.

P_R has a goal drawn from the pool. P_R^H has it and three others, equally
likely; four facts that the robot's plan needs and that hold initially are
uncertain, with p = 0.5. Everything drawn depends on the seed and the instance's
name alone.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from hashlib import sha256
from itertools import combinations
from random import Random

import numpy as np

from mirror_explainer.errors import InputError, PlanningError
from mirror_explainer.experiments.benchmark.dataset import Location, RecognitionProblem
from mirror_explainer.experiments.benchmark.ground_actions import (
    distances_to_goal,
    ground_action,
    hearing_ground_actions,
    needed_facts,
)
from mirror_explainer.explainer import robot_plan
from mirror_explainer.listener.listeners import PLANNER
from mirror_explainer.listener.mirror_model import MirrorModel
from mirror_explainer.listener.preparation import prepare, refine
from mirror_explainer.pddl import Task, atom_text, conjuncts, goal_expression, read_task
from mirror_explainer.planning import Belief, BeliefPlans, BeliefSpace, Plan, Planner, Status
from mirror_explainer.selection.baselines import ORDERS
from mirror_explainer.selection.choice import Selection, baseline, curve
from mirror_explainer.selection.enumeration import TIE
from mirror_explainer.selection.evidence import Evidence
from mirror_explainer.settings import PlanningSettings

GOALS, UNCERTAIN_FACTS, FACT_PROBABILITY = 4, 4, 0.5
# Selections of N among which the equally informative ones are counted; beyond, nobody counts.
_COUNTED = 2000


@dataclass(frozen=True)
class Settings:
    """What an instance's result depends on, besides its files; times in seconds."""

    seed: int = 0
    planner: str = 'fast-downward-opt'
    planning_timeout: float = 30.0
    deadline: float = 60.0
    selection_budget: float = 30.0
    plans_per_belief: int = 1


@dataclass(frozen=True)
class Row:
    """What one strategy achieves with N sentences.

    H and IG in nats, G_inf = H of this strategy − H of the informative one.
    D_G is the mean distance to the goal over the N actions said. `gap` bounds
    how far from the optimum the informative selection may be.

    `ties` selections of N are as informative as the best, `D_G_ties` is the
    mean of their D_G and `D_G_nearest` the least: what another way to choose
    among them would come to. None for the other strategies, and for an N with
    too many selections to look at.
    """

    strategy: str
    N: int
    H: float
    IG: float
    G_inf: float
    D_G: float
    understanding: float
    gap: float
    ties: int | None
    D_G_ties: float | None
    D_G_nearest: float | None
    positions: tuple[int, ...]


@dataclass(frozen=True)
class Measures:
    """The instance's line in the paper's table of domains; `initial` is |I|.

    `optimal` is the length of an optimal plan for the true goal, `observed`
    that of the recorded one: None where they are not known.
    """

    predicates: int
    actions: int
    initial: int
    goals: int
    robot_plan: int
    optimal: int | None
    observed: int | None


@dataclass(frozen=True)
class Result:
    """All that was drawn and measured on one instance.

    Instances of the same `problem`, a digest of domain and template, share the world that
    their robots are in. `last_shared` of the other goals have, like the robot's, the goal
    predicates that the plan's last action brings about.
    """

    problem: str
    goals: tuple[str, ...]
    uncertain_facts: tuple[str, ...]
    plan: tuple[str, ...]
    unsolvable: tuple[str, ...]
    unsolvable_mass: float
    last_shared: int
    measures: Measures
    rows: tuple[Row, ...]


@dataclass(frozen=True)
class Draw:
    """The goals, the robot's own first, with π_R and an optimal plan for the true goal."""

    goals: tuple[str, ...]
    plan: Plan
    unsolvable: tuple[str, ...]
    true_plan: Plan | None


def run_instance(location: Location, problem: RecognitionProblem, settings: Settings) -> Result:
    """Run the protocol on one instance.

    Raises InputError for an instance that it does not fit, PlanningError where
    planning could not settle every belief.
    """
    random = Random(f'{settings.seed}/{location.domain}/{location.name}')
    source = str(location.path)
    with Planner(
        settings.planner, workers=1, planning_timeout=settings.planning_timeout
    ) as planner:
        draw = draw_goals(problem, planner, settings.deadline, random, source)
        task = read_task(problem.domain, problem.problem(draw.goals[0]), source, source)
        facts = draw_facts(task, draw.plan, random, source)
        user_model = hearing_ground_actions(
            task, draw.goals, dict.fromkeys(facts, FACT_PROBABILITY)
        )
        planning = PlanningSettings(
            plans_per_belief=settings.plans_per_belief, deadline=settings.deadline
        )
        own = robot_plan(task, '\n'.join(draw.plan.actions), source)
        preparation = refine(prepare(task, own, user_model, planning), planner)
    model = preparation.model_for(PLANNER)
    require_settled(model)
    true_plan = draw.true_plan
    return Result(
        problem=sha256(f'{problem.domain}{problem.template}'.encode()).hexdigest()[:12],
        goals=draw.goals,
        uncertain_facts=facts,
        plan=draw.plan.actions,
        unsolvable=draw.unsolvable,
        unsolvable_mass=model.unsolvable,
        last_shared=goals_sharing_last(task, draw),
        measures=Measures(
            predicates=len(task.model.fluents),
            actions=len(task.model.actions),
            initial=len(task.initial_facts),
            goals=len(problem.goals),
            robot_plan=len(draw.plan.actions),
            optimal=len(true_plan.actions) if true_plan and true_plan.optimal else None,
            observed=problem.observed,
        ),
        rows=tuple(
            measured(
                model,
                distances_to_goal(task, draw.plan.actions),
                settings.selection_budget,
            )
        ),
    )


def draw_goals(
    problem: RecognitionProblem, planner: Planner, deadline: float, random: Random, source: str
) -> Draw:
    """Draw four goals of the pool that can be reached; the first takes more than no action.

    A goal proved unreachable is left out, and the next one drawn.
    """
    if len(problem.goals) < GOALS:
        raise InputError(
            source, f'the pool has {len(problem.goals)} goals; the protocol draws {GOALS}'
        )
    task = read_task(problem.domain, problem.problem(problem.goals[0]), source, source)
    for goal in (*problem.goals, problem.true_goal):
        goal_expression(task.model, goal, source)
    pool = random.sample(problem.goals, len(problem.goals))
    space = BeliefSpace(task.domain, task.problem, (*pool, problem.true_goal))
    found: list[tuple[str, Plan]] = []
    unsolvable: list[str] = []
    for index, goal in enumerate(pool):
        [result] = planner.plan(space, [Belief(index)], deadline=deadline).results
        if result.status is Status.UNSOLVABLE:
            unsolvable.append(goal)
        elif found or _settled(result, goal).actions:
            found.append((goal, _settled(result, goal)))
        if len(found) == GOALS:
            break
    else:
        raise InputError(
            source, f'only {len(found)} goals of the pool can be reached; {GOALS} are needed'
        )
    [true] = planner.plan(space, [Belief(len(pool))], deadline=deadline).results
    return Draw(
        goals=tuple(goal for goal, _ in found),
        plan=found[0][1],
        unsolvable=tuple(unsolvable),
        true_plan=true.plans[0] if true.plans else None,
    )


def draw_facts(task: Task, plan: Plan, random: Random, source: str) -> tuple[str, ...]:
    """Draw four facts that hold initially and that the plan's actions need, or all there are."""
    holding = sorted(needed_facts(task, plan.actions) & task.initial_facts)
    if not holding:
        raise InputError(source, "no precondition of the robot's plan holds initially")
    return tuple(random.sample(holding, min(UNCERTAIN_FACTS, len(holding))))


def goals_sharing_last(task: Task, draw: Draw) -> int:
    """Count the other goals that have all that π_R's last action does for the robot's goal."""
    own, *others = (
        {atom_text(atom) for atom in conjuncts(goal_expression(task.model, goal))}
        for goal in draw.goals
    )
    reached = ground_action(task, draw.plan.actions[-1]).added & own
    return sum(reached <= other for other in others)


def require_settled(model: MirrorModel) -> None:
    """Raise PlanningError unless every belief has an optimal plan, or is known to have none."""
    if model.planned < 1.0 - 1e-9:
        raise PlanningError(
            f'no plan was found in time for {1.0 - model.planned:.0%} of what the listener '
            'may believe'
        )
    unproved = sum(not h.plan.optimal for h in model.hypotheses if h.plan)
    if unproved:
        raise PlanningError(
            f'{unproved} of {len(model.hypotheses)} plans were not proved optimal in time'
        )


def measured(model: MirrorModel, distance: Sequence[float], budget: float) -> Iterator[Row]:
    """Yield the quantities of every strategy at every N up to all different actions of π_R."""
    evidence = model.evidence()
    for n, best in enumerate(curve(evidence, budget), start=1):
        selections: dict[str, Selection] = {'informative': best}
        selections |= {name: baseline(evidence, name, n) for name in reversed(ORDERS)}
        lowest = model.cross_entropy(best.positions)
        for strategy, selection in selections.items():
            positions = selection.positions
            tied = _tied(evidence, distance, selection) if selection is best else None
            entropy = model.cross_entropy(positions)
            yield Row(
                strategy=strategy,
                N=n,
                H=entropy,
                IG=selection.information_gain,
                G_inf=entropy - lowest,
                D_G=sum(distance[position] for position in positions) / n,
                understanding=model.understanding(positions),
                gap=best.gap,
                ties=len(tied) if tied else None,
                D_G_ties=sum(tied) / len(tied) if tied else None,
                D_G_nearest=min(tied) if tied else None,
                positions=positions,
            )


def _tied(evidence: Evidence, distance: Sequence[float], best: Selection) -> list[float]:
    """Return D_G of every selection that is as informative as the best, if they can be counted."""
    n, size = len(best.positions), len(evidence.positions)
    if math.comb(size, n) > _COUNTED:
        return []
    sets = np.array(list(combinations(range(size), n)))  # shape (selections, N)
    fit = evidence.ratio[:, sets].prod(axis=2).T
    doubts = evidence.doubt.of(fit @ evidence.weight, evidence.robot)
    tied = sets[evidence.doubt_before - doubts >= best.information_gain - TIE]
    nearest = np.asarray(distance)[list(evidence.positions)]
    return [float(mean) for mean in nearest[tied].mean(axis=1)]


def _settled(result: BeliefPlans, goal: str) -> Plan:
    """Return a goal's plan, or raise PlanningError if it is not known to be the best."""
    if result.status is not Status.SOLVED:
        raise PlanningError(f'no plan was found for the goal {goal} ({result.reason})')
    if not result.plans[0].optimal:
        raise PlanningError(f'no plan for the goal {goal} was proved optimal in time')
    return result.plans[0]
