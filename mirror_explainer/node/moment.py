"""Points in time, told by two clocks: one that never jumps, and one that people read."""

import time
from dataclasses import dataclass, field
from datetime import datetime


@dataclass(frozen=True)
class Moment:
    """A point in time: seconds of time.monotonic(), and the local time with its offset."""

    steady: float = field(default_factory=time.monotonic)
    wall: datetime = field(default_factory=lambda: datetime.now().astimezone())

    def seconds_since(self, earlier: 'Moment') -> float:
        """Return how many seconds passed, whatever was done to the clock on the wall."""
        return self.steady - earlier.steady

    def __str__(self) -> str:
        return self.wall.isoformat(timespec='seconds')
