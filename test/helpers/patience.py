"""How tests wait for what comes in its own time: long, and with word of what did not come."""

import time
from collections.abc import Callable
from typing import TypeVar

T = TypeVar('T')

PATIENCE = 120.0  # s: far more than anything takes on a busy machine; only a hang runs into it


def eventually(condition: Callable[[], T], what: str) -> T:
    """Wait until the condition is true, and return its value."""
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        if value := condition():
            return value
        time.sleep(0.01)
    raise AssertionError(f'never came: {what}')
