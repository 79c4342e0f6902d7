"""When work that failed is tried again although its inputs are the same: later and later."""

import time
from dataclasses import dataclass

FIRST_SECONDS = 5.0
LONGEST_SECONDS = 300.0
# An attempt that takes long is made less often, so that it has no more than this share of time.
_SHARE = 0.1

# Somebody who asks may have mended the fault: then it is tried sooner.
CALL_SECONDS = 1.0


@dataclass(frozen=True)
class Retries:
    """Attempts that failed in a row: `count` of them.

    The last one `took` so many seconds, until `ended` (of time.monotonic()).
    """

    count: int = 0
    took: float = 0.0
    ended: float = 0.0

    def after_failure(self, took: float) -> 'Retries':
        """Return what it is after one more attempt that failed just now."""
        return Retries(self.count + 1, took, time.monotonic())

    def seconds_left(self) -> float | None:
        """Return how long to wait until the next attempt, None if there need be none."""
        if not self.count:
            return None
        pause = min(LONGEST_SECONDS, FIRST_SECONDS * 2.0 ** min(self.count - 1, 10))
        return max(0.0, self.ended + max(pause, self.took / _SHARE) - time.monotonic())

    def due_for_a_call(self) -> bool:
        """Say whether a call may have the next attempt made now."""
        pause = max(CALL_SECONDS, self.took)
        return self.count > 0 and time.monotonic() >= self.ended + pause
