"""A plan carried out in time: the states that its steps' starts and ends lead through."""

import itertools
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from fractions import Fraction

import unified_planning.model as up
from unified_planning.model.metrics import (
    MaximizeExpressionOnFinalState,
    MinimizeActionCosts,
    MinimizeExpressionOnFinalState,
)

from mirror_explainer.pddl.happenings import GroundStep, Happening, ground, orders
from mirror_explainer.pddl.plan_text import Step
from mirror_explainer.pddl.states import ConflictError, Evaluator, State
from mirror_explainer.pddl.task import Task


@dataclass(frozen=True)
class Failure:
    """The step that cannot be carried out as planned, when, and the conditions it lacks.

    There are none where its effects contradict each other. The conditions are ground.
    """

    step: int
    when: str
    lacking: tuple[up.FNode, ...]


@dataclass(frozen=True)
class Run:
    """A plan carried out, up to what fails, if anything does.

    `passed` has the initial state, and the one after each of the `happenings`. `states`
    has the initial state, and the one that each step leaves which ends: what steps that still
    go on have begun to do is not in them. `positions` are these steps' in the plan, from 0.
    `cost` is in the problem's metric: the number of steps where it has none.
    """

    happenings: tuple[Happening, ...]
    passed: tuple[State, ...]
    states: tuple[State, ...]
    positions: tuple[int, ...]
    cost: float
    failure: Failure | None = None


def carry_out(
    task: Task,
    steps: Sequence[Step],
    state: State | None = None,
    evaluator: Evaluator | None = None,
) -> Run:
    """Carry out steps of the task, from its initial state or another, up to what fails.

    Steps whose times let them overlap do so. Where that fails, and without times, each
    begins when the one before it has ended. Raises UnknownNumberError and NotImplementedError
    for what cannot be worked out, InputError for derived facts that take too long.
    """
    evaluator = evaluator or Evaluator(task)
    given = ground(evaluator, steps)
    start = evaluator.first_state() if state is None else state
    runs = (
        happen(task, given, happenings, start, evaluator) for happenings in orders(steps, given)
    )
    first = next(runs)
    return first if first.failure is None else next((r for r in runs if not r.failure), first)


def happen(
    task: Task,
    steps: Sequence[GroundStep],
    happenings: Sequence[Happening],
    state: State,
    evaluator: Evaluator,
    going: Collection[int] = (),
) -> Run:
    """Let things happen from a state in which the steps `going` go on, up to what fails."""
    happened: list[Happening] = []
    passed, states = [state], [state]
    # What each step that goes on has changed so far.
    changed: dict[int, dict[str, bool | Fraction]] = {position: {} for position in going}
    positions: list[int] = []
    cost = _Cost(task, evaluator)

    def failure() -> Failure | None:
        for _, moment in itertools.groupby(happenings, key=lambda happening: happening.moment):
            for happening in moment:
                step, state = steps[happening.step], passed[-1]
                when = '' if happening.starts else ' when it ends'
                lacking = step.lacking(step.conditions(happening), state, evaluator)
                if lacking:
                    return Failure(happening.step, when, lacking)
                try:
                    changes = evaluator.changes(step.effects(happening), state, step.binding)
                except ConflictError:
                    return Failure(happening.step, when, ())
                if happening.starts:
                    cost.add(step, state)
                    changed[happening.step] = {}
                changed[happening.step] |= changes
                happened.append(happening)
                passed.append(state.after(changes))
                if happening.ends:
                    states.append(states[-1].after(changed.pop(happening.step)))
                    positions.append(happening.step)
            for position in changed:
                step = steps[position]
                lacking = step.lacking(step.invariants, passed[-1], evaluator)
                if lacking:
                    return Failure(position, ' while it goes on', lacking)
        return None

    failed = failure()
    return Run(
        tuple(happened),
        tuple(passed),
        tuple(states),
        tuple(positions),
        cost.of(passed[-1]),
        failed,
    )


def truths(
    task: Task, states: Sequence[State], conditions: Sequence[up.FNode]
) -> list[list[bool]]:
    """Return for each ground condition whether it holds in each state, derived facts included."""
    evaluator = Evaluator(task)
    return [_truth(evaluator, condition, states) for condition in conditions]


def _truth(evaluator: Evaluator, condition: up.FNode, states: Sequence[State]) -> list[bool]:
    """Say where a ground condition holds; a literal's atom is spelled out once for all states."""
    if condition.is_not():
        return [not held for held in _truth(evaluator, condition.arg(0), states)]
    if condition.is_fluent_exp():
        atom, fluent = evaluator.atom(condition), condition.fluent()
        return [evaluator.value_of(atom, state, fluent) is True for state in states]
    return [evaluator.holds(condition, state) for state in states]


class _Cost:
    """Adds up what steps cost in the task's metric; without one, each costs 1."""

    def __init__(self, task: Task, evaluator: Evaluator) -> None:
        self._task = task
        self._evaluator = evaluator
        self._metric = next(iter(task.model.quality_metrics), None)
        self._sum = Fraction(0)
        # What durations were made into is known to the model without durations only.
        self._numbers = {
            evaluator.atom(atom): Fraction(value.constant_value())
            for atom, value in task.model.explicit_initial_values.items()
            if task.timed and not value.is_bool_constant()
        }

    def add(self, step: GroundStep, state: State) -> None:
        """Add what a step costs that starts in a state."""
        if not isinstance(self._metric, MinimizeActionCosts):
            self._sum += 1
            return
        cost = self._metric.get_action_cost(self._task.model.action(step.action.name))
        if cost is not None:
            known = State(state.facts, {**self._numbers, **state.numbers})
            value = self._evaluator.value(cost, known, step.binding)
            assert isinstance(value, Fraction)
            self._sum += value

    def of(self, last: State) -> float:
        """Return the sum; where the metric is of the last state, what it comes to there."""
        if isinstance(
            self._metric, MinimizeExpressionOnFinalState | MaximizeExpressionOnFinalState
        ):
            value = self._evaluator.value(self._metric.expression, last)
            return float(value)
        return float(self._sum)
