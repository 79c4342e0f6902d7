"""Python's log records on a ROS logger: at their own level, and repeated ones counted.

rclpy's throttle goes by the place of a call in the code: it would drop a different
message from the same place, and say nothing of what it dropped.
"""

import logging
import time
from collections import defaultdict, deque
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from mirror_explainer.node.answers import printable

# Seconds until repetitions are told; then twice as long each time, up to the longest.
FIRST_INTERVAL = 10.0
LONGEST_INTERVAL = 3600.0
# A line that did not come for so many seconds is news again.
QUIET = 10.0
# Of different lines, so many are logged in so many seconds.
MOST_NEWS = 20
NEWS_PERIOD = 60.0


class RosLog(logging.Handler):
    """Hands log records on to an rclpy logger, whose level decides.

    From INFO up, a line that keeps coming is logged once, and then as a count now
    and then. Of very many different lines only some are logged, the rest is counted.
    """

    def __init__(self, logger: Any) -> None:
        super().__init__()
        self._logger = logger
        self._repetitions: defaultdict[int, Repetitions] = defaultdict(Repetitions)

    def emit(self, record: logging.LogRecord) -> None:
        """Log a record, unless it only repeats what was logged."""
        level, line = record.levelno, printable(self.format(record))
        if level < logging.INFO or self._repetitions[level].is_news(line, time.monotonic()):
            self._log(level, line)

    def log_repetitions(self) -> None:
        """Log the counts that are due; to be called each second."""
        self.acquire()
        try:
            for level, repetitions in self._repetitions.items():
                for line in repetitions.due(time.monotonic()):
                    self._log(level, line)
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


@dataclass
class _Counted:
    """How often a line came since it was last told of. Times are in seconds."""

    line: str
    last: float
    told: float
    interval: float = FIRST_INTERVAL
    count: int = 0


class Repetitions:
    """Tells news from repetitions, and counts these. `now` is in seconds of a steady clock."""

    def __init__(self) -> None:
        self._known: dict[str, _Counted] = {}
        self._others: _Counted | None = None
        self._news: deque[float] = deque(maxlen=MOST_NEWS)

    def is_news(self, line: str, now: float) -> bool:
        """Say whether a line is to be logged; otherwise it is counted."""
        counted = self._known.get(line)
        if counted is None:
            if len(self._news) < MOST_NEWS or now - self._news[0] > NEWS_PERIOD:
                self._news.append(now)
                self._known[line] = _Counted(line, last=now, told=now)
                return True
            self._others = counted = self._others or _Counted(line, last=now, told=now)
        counted.line = line
        counted.last = now
        counted.count += 1
        return False

    def due(self, now: float) -> Iterator[str]:
        """Yield a line for each count that it is time to tell, and forget what is quiet."""
        for key, counted in list(self._known.items()):
            if _is_due(counted, now):
                yield f'{_told(counted, now)} like this: {counted.line}'
            if now - counted.last > QUIET:
                del self._known[key]
        if self._others and _is_due(self._others, now):
            yield f'{_told(self._others, now)} of other kinds, the last one: {self._others.line}'
        if self._others and now - self._others.last > QUIET:
            self._others = None


def _is_due(counted: _Counted, now: float) -> bool:
    waited = now - counted.told >= counted.interval or now - counted.last > QUIET
    return counted.count > 0 and waited


def _told(counted: _Counted, now: float) -> str:
    """Return the count in words, and begin a new one."""
    words = f'in the last {now - counted.told:.0f} s {counted.count} more'
    counted.told, counted.count = now, 0
    counted.interval = min(2 * counted.interval, LONGEST_INTERVAL)
    return words
