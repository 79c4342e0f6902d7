"""What planning may use, and when a call of `Planner.plan` must end."""

import time
from dataclasses import dataclass
from typing import Protocol

from mirror_explainer.errors import Cancelled

# How often a waiting planner looks up, in seconds.
TICK = 0.02


@dataclass(frozen=True)
class Resources:
    """So many processes plan at a time, for so many seconds a belief, in so many MiB each."""

    workers: int
    planning_timeout: float
    memory_limit: int


class Stop(Protocol):
    """What asks work to stop, such as a threading.Event."""

    def is_set(self) -> bool:
        """Say whether to stop."""


@dataclass(frozen=True)
class Limits:
    """The end of one call: a point in monotonic time, and what cancels it."""

    end: float
    events: tuple[Stop, ...]

    @property
    def expired(self) -> bool:
        """Whether the deadline has passed."""
        return time.monotonic() >= self.end

    def check(self) -> None:
        """Raise Cancelled if one of the events is set."""
        if any(event.is_set() for event in self.events):
            raise Cancelled('planning was cancelled')
