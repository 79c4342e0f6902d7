"""The fast way: Fast Downward in a worker that grounds once (`worker_program.py`).

For the engine fast-downward-opt only. It finds the same optimal costs as the
general way, with less work.
"""

import contextlib
import logging
import time
from collections.abc import Callable, Sequence
from pathlib import Path

from mirror_explainer.errors import PlanningError
from mirror_explainer.planning.beliefs import Belief, BeliefSpace
from mirror_explainer.planning.limits import TICK, Limits, Resources
from mirror_explainer.planning.messages import (
    Ask,
    Attempt,
    Done,
    EndSearches,
    Refusal,
    Unfitting,
    unknown,
)
from mirror_explainer.planning.processes.worker import Worker

_PROGRAM = Path(__file__).with_name('worker_program.py')
_TRIES = 2

# The problem may take this long to be grounded, or the planning timeout if that is longer.
_GROUNDING_SECONDS = 10.0

# How long a worker may take to come to a stop before it is ended, in seconds.
_GRACE = 0.05
_LONG_GRACE = 1.0

_Found = Sequence[tuple[Belief, Attempt]]

_log = logging.getLogger(__name__)


class DownwardWay:
    """A worker process that grounds and runs searches, within these resources.

    `downward` is the path of the search program, `kstar` of the one for further plans, '' if there
    is none. The worker starts at once, so that it is there when it is needed.
    """

    def __init__(self, downward: str, kstar: str, resources: Resources) -> None:
        self._programs = downward, kstar
        self._resources = resources
        self._worker: Worker | None = Worker(_PROGRAM)

    def plan(
        self,
        space: BeliefSpace,
        beliefs: Sequence[Belief],
        plans_per_belief: int,
        limits: Limits,
        record: Callable[[Belief, Attempt], None],
    ) -> Done | Unfitting:
        """Plan for each belief and record the results as they come, until the limits.

        Returns what it took, or why this way cannot be gone. Raises Cancelled, and
        PlanningError when the worker dies more than once, or lacks memory.
        """
        left = dict.fromkeys(beliefs)
        for _ in range(_TRIES):
            if self._worker is None or not self._worker.alive:
                self.close()
                self._worker = Worker(_PROGRAM)
            worker = self._worker
            seconds = limits.end - time.monotonic()
            asked = space, tuple(left), plans_per_belief
            worker.send(Ask(*asked, *self._programs, self._resources, seconds))
            try:
                return self._hear(worker, left, limits, record)
            except EOFError:
                words = worker.last_words()
                _log.debug('the planning worker died: %s', words)
                self.close()
            except BaseException:
                if worker is self._worker:
                    self._stop(worker)
                raise
        raise PlanningError(
            f'the planning process died more than once: {words or "it was killed"}',
            cure='See whether the machine ran out of memory (dmesg); if not, please report it.',
        )

    def _hear(
        self,
        worker: Worker,
        left: dict[Belief, None],
        limits: Limits,
        record: Callable[[Belief, Attempt], None],
    ) -> Done | Unfitting:
        def take_in(found: _Found) -> None:
            for belief, attempt in found:
                left.pop(belief, None)
                record(belief, attempt)

        grounded = False
        grounding_end = time.monotonic() + max(
            self._resources.planning_timeout, _GROUNDING_SECONDS
        )
        while True:
            limits.check()
            if limits.expired and not worker.connection.poll(_GRACE):
                if not self._stop(worker, _LONG_GRACE, take_in) and grounded:
                    for belief in left:
                        record(belief, unknown('the planning process hangs', crashed=True))
                return Done(0, 0.0, 'the deadline passed')
            if not grounded and time.monotonic() > grounding_end:
                self._stop(worker)
                for belief in left:
                    record(belief, unknown('the problem is too large to be grounded in time'))
                return Done(0, 0.0, 'not grounded in time')
            if worker.connection.poll(TICK):
                message = worker.receive()
                grounded = True
                if isinstance(message, Done | Unfitting):
                    return message
                if isinstance(message, Refusal):
                    raise message.error()
                take_in(message)

    def _stop(
        self,
        worker: Worker,
        grace: float = _GRACE,
        take_in: Callable[[_Found], None] = lambda found: None,
    ) -> bool:
        """Bring the worker to a stop, and take in what it had found.

        It is ended, and False returned, if it takes long.
        """
        worker.send(EndSearches())
        end = time.monotonic() + grace
        try:
            while worker.connection.poll(max(0.0, end - time.monotonic())):
                message = worker.receive()
                if isinstance(message, Done | Unfitting | Refusal):
                    return True
                take_in(message)
        except EOFError:
            pass
        self.close()
        with contextlib.suppress(PlanningError):  # the next question will say so
            self._worker = Worker(_PROGRAM)
        return False

    def close(self) -> None:
        """End the worker and its searches at once."""
        if self._worker is not None:
            self._worker.kill()
            self._worker = None
