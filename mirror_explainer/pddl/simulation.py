"""A plan carried out step by step in unified-planning's simulator, derived facts included."""

import warnings
from collections.abc import Sequence
from dataclasses import dataclass

from unified_planning.engines.sequential_simulator import (
    UPSequentialSimulator,
    evaluate_quality_metric,
    evaluate_quality_metric_in_initial_state,
)
from unified_planning.exceptions import UPConflictingEffectsException, UPInvalidActionError
from unified_planning.model import FNode, State
from unified_planning.model.walkers import StateEvaluator
from unified_planning.plans import ActionInstance

from mirror_explainer.pddl.task import Task


@dataclass(frozen=True)
class Run:
    """The states that a plan leads through, the initial one first, and its cost up to the last.

    `positions` are the plan positions (from 0) whose action led from each state to the next;
    they end early where an action is impossible. The cost is in the problem's metric: the
    number of actions where it has none.
    """

    states: tuple[State, ...]
    positions: tuple[int, ...]
    cost: float


def can_simulate(task: Task) -> bool:
    """Say whether the simulator knows all that the task is made of."""
    kind = task.model.kind
    kind.unset_initial_state('UNDEFINED_INITIAL_NUMERIC')  # it matters only if an action needs one
    return bool(UPSequentialSimulator.supports(kind))


def carry_out(task: Task, plan: Sequence[ActionInstance]) -> Run:
    """Carry out the plan from the task's initial state, up to the first impossible action.

    Raises UPException where a number has no value.
    """
    model = task.axioms.open_model() if task.axioms else task.model
    with warnings.catch_warnings():
        warnings.simplefilter('ignore')  # see can_simulate
        simulator = UPSequentialSimulator(model, error_on_failed_checks=False)
    state = task.axioms.first_state() if task.axioms else simulator.get_initial_state()
    metric = next(iter(task.model.quality_metrics), None)
    cost = evaluate_quality_metric_in_initial_state(simulator, metric) if metric else 0
    states = [state]
    for step in plan:
        try:
            lacking, _ = simulator.get_unsatisfied_conditions(state, step)
            if lacking:
                break
            following = simulator.apply_unsafe(state, step)
        except (UPInvalidActionError, UPConflictingEffectsException):
            break
        if metric:
            cost = evaluate_quality_metric(
                simulator, metric, cost, state, step.action, step.actual_parameters, following
            )
        state = following
        states.append(state)
    positions = tuple(range(len(states) - 1))
    return Run(tuple(states), positions, float(cost if metric else len(positions)))


def truths(task: Task, states: Sequence[State], conditions: Sequence[FNode]) -> list[list[bool]]:
    """Return for each condition whether it holds in each state of a run, derived facts included.

    The conditions are ground and free of quantifiers.
    """
    if task.axioms:
        states = task.axioms.with_derived(states, conditions)
    evaluator = StateEvaluator(task.model)
    return [
        [bool(evaluator.evaluate(condition, state).is_true()) for state in states]
        for condition in conditions
    ]
