"""When a call of `Planner.plan` must end: its deadline, and requests to stop."""

import threading
import time
from dataclasses import dataclass, field

from mirror_explainer.errors import Cancelled

# How often a waiting planner looks up, in seconds.
TICK = 0.02


@dataclass(frozen=True)
class Limits:
    """The end of one call: a point in monotonic time, and the events that cancel it."""

    end: float = float('inf')
    events: tuple[threading.Event, ...] = field(default=())

    @property
    def expired(self) -> bool:
        """Whether the deadline has passed."""
        return time.monotonic() >= self.end

    def check(self) -> None:
        """Raise Cancelled if one of the events is set."""
        if any(event.is_set() for event in self.events):
            raise Cancelled('planning was cancelled')
