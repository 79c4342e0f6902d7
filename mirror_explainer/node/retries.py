"""When work that failed is tried again although its inputs are the same: later and later."""

import math
import time
from dataclasses import dataclass, replace

from mirror_explainer.node.readiness import Readiness

FIRST_SECONDS = 5.0
LONGEST_SECONDS = 300.0
# An attempt that takes long is made less often, so that it has no more than this share of time.
_SHARE = 0.1

# Somebody who asks may have mended the fault: then it is tried sooner.
CALL_SECONDS = 1.0


@dataclass(frozen=True)
class Retries:
    """Attempts that failed in a row: `count` of them.

    The last one `took` so many seconds, until `ended`. The next one is `due` at a time (both of
    time.monotonic()): never if none failed, or while an attempt is under way.
    """

    count: int = 0
    took: float = 0.0
    ended: float = 0.0
    due: float = math.inf
    under_way: bool = False

    def after(self, outcome: Readiness, took: float) -> 'Retries':
        """Return what it is after an attempt that ended so just now."""
        if not outcome.may_pass:
            return Retries()
        now = time.monotonic()
        pause = min(LONGEST_SECONDS, FIRST_SECONDS * 2.0 ** min(self.count, 10))
        return Retries(self.count + 1, took, now, now + max(pause, took / _SHARE))

    def begun(self) -> 'Retries':
        """Return what it is while an attempt is under way."""
        return replace(self, due=math.inf, under_way=True)

    def asked_for(self) -> 'Retries':
        """Return what it is after a call, which may have the next attempt made now."""
        is_early = time.monotonic() < self.ended + max(CALL_SECONDS, self.took)
        return self if is_early or not self.is_scheduled else replace(self, due=0.0)

    def seconds_left(self) -> float | None:
        """Return how long to wait until the next attempt, None if there is to be none."""
        return max(0.0, self.due - time.monotonic()) if self.is_scheduled else None

    @property
    def is_scheduled(self) -> bool:
        """Whether there is to be another attempt."""
        return self.due < math.inf

    @property
    def is_due(self) -> bool:
        """Whether it is time for the next attempt."""
        return time.monotonic() >= self.due

    @property
    def may_mend(self) -> bool:
        """Whether what failed is being tried again, or is to be now."""
        return self.count > 0 and (self.under_way or self.is_due)
