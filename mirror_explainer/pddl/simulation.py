"""A plan carried out in time: its steps' starts and ends, one after the other.

What an action with a duration needs and does at its start, all the while, and at
its end is as in PDDL 2.1. An action without one starts and ends at once.
"""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

import unified_planning.model as up
from unified_planning.model.metrics import (
    MaximizeExpressionOnFinalState,
    MinimizeActionCosts,
    MinimizeExpressionOnFinalState,
)

from mirror_explainer.pddl.atoms import conjuncts
from mirror_explainer.pddl.plan_text import Step
from mirror_explainer.pddl.states import Binding, ConflictError, Evaluator, State
from mirror_explainer.pddl.task import Task


@dataclass(frozen=True)
class Happening:
    """A step, by its position in the plan, starts or ends, or does both at once."""

    step: int
    starts: bool = True
    ends: bool = True


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


class GroundStep:
    """A step of a plan: what it needs and does, when, and with which objects."""

    def __init__(self, model: up.Problem, step: Step) -> None:
        self.action = model.action(step.words[0])
        self.objects = step.words[1:]
        self.binding: Binding = dict(
            zip((p.name for p in self.action.parameters), self.objects, strict=True)
        )
        self.lasts = isinstance(self.action, up.DurativeAction)

    def conditions(self, happening: Happening) -> list[up.FNode]:
        """Return what must hold when the step starts, or ends."""
        if not self.lasts:
            return list(self.action.preconditions)
        return self._conditions(up.StartTiming() if happening.starts else up.EndTiming())

    @property
    def invariants(self) -> list[up.FNode]:
        """What must hold between start and end."""
        if not self.lasts:
            return []
        return [
            condition
            for interval, conditions in self.action.conditions.items()
            if interval.lower != interval.upper
            for condition in conditions
        ]

    def effects(self, happening: Happening) -> list[up.Effect]:
        """Return what the step does when it starts, or ends."""
        if not self.lasts:
            return list(self.action.effects)
        timing = up.StartTiming() if happening.starts else up.EndTiming()
        return list(self.action.effects.get(timing, ()))

    def lacking(
        self, conditions: Sequence[up.FNode], state: State, evaluator: Evaluator
    ) -> tuple[up.FNode, ...]:
        """Return the ground conditions, each without "and", that do not hold in the state."""
        return tuple(
            part.substitute(
                {
                    p: self.action.environment.expression_manager.auto_promote(
                        evaluator.model.object(self.binding[p.name])
                    )[0]
                    for p in self.action.parameters
                }
            )
            for condition in conditions
            for part in conjuncts(condition)
            if not evaluator.holds(part, state, self.binding)
        )

    def _conditions(self, timing: up.Timing) -> list[up.FNode]:
        return [
            condition
            for interval, conditions in self.action.conditions.items()
            if interval.lower == interval.upper == timing
            for condition in conditions
        ]


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
    given = [GroundStep(evaluator.model, step) for step in steps]
    start = evaluator.first_state() if state is None else state
    in_turn = [[h] for position, step in enumerate(given) for h in _happenings(position, step)]
    run = _carried_out(task, given, _in_time(steps, given) or in_turn, start, evaluator)
    if run.failure is None:
        return run
    alone = _carried_out(task, given, in_turn, start, evaluator)
    return run if alone.failure else alone


def _happenings(position: int, step: GroundStep) -> list[Happening]:
    """Return the happenings of a step that is carried out alone."""
    if not step.lasts:
        return [Happening(position)]
    return [Happening(position, ends=False), Happening(position, starts=False)]


def _in_time(steps: Sequence[Step], given: Sequence[GroundStep]) -> list[list[Happening]]:
    """Return what happens at each moment, in order, [] where some times are not given.

    At one moment what ends comes before what starts.
    """
    timed: list[tuple[float, bool, int, Happening]] = []
    for position, (step, ground) in enumerate(zip(steps, given, strict=True)):
        for happening in _happenings(position, ground):
            time = step.start if happening.starts else step.end
            if time is None or step.start is None:
                return []
            late = happening.starts or round(time, 6) == round(step.start, 6)
            timed.append((round(time, 6), late, position, happening))
    timed.sort(key=lambda entry: entry[:3])
    return [
        [happening for *_, happening in moment]
        for _, moment in itertools.groupby(timed, key=lambda entry: entry[0])
    ]


def _carried_out(
    task: Task,
    steps: Sequence[GroundStep],
    moments: Sequence[Sequence[Happening]],
    state: State,
    evaluator: Evaluator,
) -> Run:
    """Let happen what happens at each moment, up to what fails."""
    happenings: list[Happening] = []
    passed, states = [state], [state]
    going: dict[int, dict[str, bool | Fraction]] = {}  # what each step has changed so far
    positions: list[int] = []
    cost = _Cost(task, evaluator)

    def failure() -> Failure | None:
        for moment in moments:
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
                    going[happening.step] = {}
                going[happening.step] |= changes
                happenings.append(happening)
                passed.append(state.after(changes))
                if happening.ends:
                    states.append(states[-1].after(going.pop(happening.step)))
                    positions.append(happening.step)
            for position in going:
                step = steps[position]
                lacking = step.lacking(step.invariants, passed[-1], evaluator)
                if lacking:
                    return Failure(position, ' while it goes on', lacking)
        return None

    failed = failure()
    return Run(
        tuple(happenings),
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
    return [[evaluator.holds(condition, state) for state in states] for condition in conditions]


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
