"""How far a plan is carried out: each of its steps is done, left out, going on, or ahead."""

import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import StrEnum
from functools import cached_property

from mirror_explainer.pddl.happenings import Happening


class StepStatus(StrEnum):
    """How far the robot is with a step of its plan."""

    AHEAD = 'ahead'
    RUNNING = 'running'
    DONE = 'done'
    SKIPPED = 'skipped'

    @property
    def is_over(self) -> bool:
        """Whether nothing of the step is left to do: it is done, or was left out."""
        return self in (StepStatus.DONE, StepStatus.SKIPPED)


@dataclass(frozen=True)
class Progress:
    """What has become of each step of a plan. `failed` are those, by position, that went wrong.

    A step that failed is ahead: it is still to be done, if the robot can. `reasons` are why
    steps failed or were left out, by position, in the robot's words, of those where it says.
    """

    steps: tuple[StepStatus, ...]
    failed: tuple[int, ...] = ()
    reasons: Mapping[int, str] = field(default_factory=dict)

    @classmethod
    def none(cls, length: int) -> 'Progress':
        """Return the progress of a plan that has not begun."""
        return cls((StepStatus.AHEAD,) * length)

    @classmethod
    def each(cls, happenings: Sequence[Happening]) -> Iterator['Progress']:
        """Yield the progress of a plan after none, one, two … of the happenings of its run."""
        steps = [StepStatus.AHEAD] * sum(happening.ends for happening in happenings)
        yield cls(tuple(steps))
        for happening in happenings:
            steps[happening.step] = StepStatus.DONE if happening.ends else StepStatus.RUNNING
            yield cls(tuple(steps))

    @classmethod
    def after(cls, happenings: Sequence[Happening], count: int) -> 'Progress':
        """Return the progress when the first `count` of a run's happenings have happened."""
        return next(itertools.islice(cls.each(happenings), count, None))

    @property
    def finished(self) -> bool:
        """Whether every step is done, or was left out."""
        return all(status.is_over for status in self.steps)

    @cached_property
    def happened(self) -> int:
        """How many starts and ends there have been."""
        return sum(
            2 if own is StepStatus.DONE else own is StepStatus.RUNNING for own in self.steps
        )

    @property
    def without_failures(self) -> 'Progress':
        """The progress of a robot that tries again what failed."""
        reasons = {p: reason for p, reason in self.reasons.items() if p not in self.failed}
        return replace(self, failed=(), reasons=reasons)

    def undone(self, before: 'Progress') -> tuple[int, ...]:
        """Return the positions of the steps that were done before, and are not any more."""
        done = self.positions(StepStatus.DONE)
        return tuple(p for p in before.positions(StepStatus.DONE) if p not in done)

    def positions(self, *statuses: StepStatus) -> tuple[int, ...]:
        """Return the positions, from 0, of the steps of which one of these is true."""
        return tuple(index for index, own in enumerate(self.steps) if own in statuses)
