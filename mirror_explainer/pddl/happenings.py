"""The steps of a plan, ground, and what happens when: their starts and ends in order.

What an action with a duration needs and does at its start, all the while, and at
its end is as in PDDL 2.1. An action without one starts and ends at once.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import unified_planning.model as up

from mirror_explainer.pddl.atoms import conjuncts
from mirror_explainer.pddl.plan_text import Step
from mirror_explainer.pddl.states import Binding, Evaluator, State


@dataclass(frozen=True)
class Happening:
    """A step, by its position in the plan, starts or ends, or does both at once.

    What has the same `moment` happens at the same time.
    """

    step: int
    starts: bool = True
    ends: bool = True
    moment: int = field(default=0, compare=False)


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


def ground(evaluator: Evaluator, steps: Sequence[Step]) -> tuple[GroundStep, ...]:
    """Return what the steps of a plan need and do."""
    return tuple(GroundStep(evaluator.model, step) for step in steps)


def orders(
    steps: Sequence[Step], given: Sequence[GroundStep]
) -> tuple[tuple[Happening, ...], ...]:
    """Return what happens as the steps' times say, if they have any, and one after the other."""
    happenings = [h for position, step in enumerate(given) for h in _happenings(position, step)]
    in_turn = tuple(replace(h, moment=number) for number, h in enumerate(happenings))
    in_time = _in_time(steps, given)
    return (in_turn,) if in_time in ((), in_turn) else (in_time, in_turn)


def _happenings(position: int, step: GroundStep) -> list[Happening]:
    """Return the happenings of a step that is carried out alone."""
    if not step.lasts:
        return [Happening(position)]
    return [Happening(position, ends=False), Happening(position, starts=False)]


def _in_time(steps: Sequence[Step], given: Sequence[GroundStep]) -> tuple[Happening, ...]:
    """Return what happens by the steps' times, nothing where some are not given.

    At one moment what ends comes before what starts.
    """
    timed: list[tuple[float, bool, int, Happening]] = []
    for position, (step, own) in enumerate(zip(steps, given, strict=True)):
        for happening in _happenings(position, own):
            time = step.start if happening.starts else step.end
            if time is None or step.start is None:
                return ()
            late = happening.starts or round(time, 6) == round(step.start, 6)
            timed.append((round(time, 6), late, position, happening))
    timed.sort(key=lambda entry: entry[:3])
    moments = {time: number for number, time in enumerate(sorted({time for time, *_ in timed}))}
    return tuple(replace(happening, moment=moments[time]) for time, *_, happening in timed)
