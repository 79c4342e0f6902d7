"""Python's log records on a ROS logger: at their own level, and repeated ones counted.

rclpy's throttle goes by the place of a call in the code: it would drop a different
message from the same place, and say nothing of what it dropped.
"""

import logging
import time
from collections import defaultdict
from typing import Any

from mirror_explainer.node.answers import printable

# Repetitions are told once in so many seconds; of different lines of a level so many are logged.
PERIOD = 60.0
MOST_LINES = 20

_OTHERS = 'others'


class RosLog(logging.Handler):
    """Hands log records on to an rclpy logger, whose level decides.

    From INFO up, a line that keeps coming is logged once, and then counted; so are lines
    beyond MOST_LINES. The counts are told each PERIOD.
    """

    def __init__(self, logger: Any) -> None:
        super().__init__()
        self._logger = logger
        # Of each level, how often each line came again since that was told last.
        self._repeated: defaultdict[int, dict[str, int]] = defaultdict(dict)
        self._told = time.monotonic()

    def emit(self, record: logging.LogRecord) -> None:
        """Log a record, unless it only repeats what was logged."""
        level, line = record.levelno, printable(self.format(record))
        repeated = self._repeated[level]
        if level < logging.INFO:
            self._log(level, line)
        elif line not in repeated and len(repeated) < MOST_LINES:
            repeated[line] = 0
            self._log(level, line)
        else:
            key = line if line in repeated else _OTHERS
            repeated[key] = repeated.get(key, 0) + 1

    def tell_counts(self) -> None:
        """Log how often lines came again, where that is due; to be called each second."""
        self.acquire()
        try:
            if time.monotonic() < self._told + PERIOD:
                return
            self._told = time.monotonic()
            for level, repeated in self._repeated.items():
                for line, count in repeated.items():
                    if count:
                        self._log(level, f'in the last {PERIOD:.0f} s {count} more: {line}')
                # What keeps coming is counted on; what was silent is news when it comes again.
                going_on = [line for line, count in repeated.items() if count and line != _OTHERS]
                self._repeated[level] = dict.fromkeys(going_on, 0)
        finally:
            self.release()

    def _log(self, level: int, line: str) -> None:
        # rclpy wants each place of a call to keep to one severity.
        if level >= logging.ERROR:
            self._logger.error(line)
        elif level >= logging.WARNING:
            self._logger.warning(line)
        elif level >= logging.INFO:
            self._logger.info(line)
        else:
            self._logger.debug(line)
