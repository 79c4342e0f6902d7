"""A wish that work should stop, now or a little later."""

import math
import time

from mirror_explainer.errors import Cancelled


class StopRequest:
    """Like a threading.Event that sets itself at a time; work looks at it now and then."""

    def __init__(self) -> None:
        self._at = math.inf

    def after(self, seconds: float) -> None:
        """Ask to stop once so many seconds have passed, unless it is asked for sooner already."""
        self._at = min(self._at, time.monotonic() + seconds)

    def is_set(self) -> bool:
        """Say whether it is time to stop."""
        return time.monotonic() >= self._at

    def check(self) -> None:
        """Raise Cancelled if it is time to stop."""
        if self.is_set():
            raise Cancelled
