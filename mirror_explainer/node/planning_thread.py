"""Which task is planned for, and for how long: a thread of its own, beside that which reads."""

import contextlib
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Protocol

from mirror_explainer.errors import Cancelled
from mirror_explainer.listener.preparation import Preparation
from mirror_explainer.node.readiness import Phase, Readiness
from mirror_explainer.node.refiner import Tell
from mirror_explainer.node.stop_request import StopRequest


@dataclass
class PlannedTask:
    """A task as it was read first, with what is `known` of it by now."""

    unplanned: Preparation
    known: Readiness


class Refines(Protocol):
    """What the work in this thread is, such as a `Refiner`."""

    def warm_up(self) -> None:
        """Get ready."""

    def refine(self, unplanned: Preparation, stop: StopRequest, tell: Tell) -> Readiness:
        """Return what comes of planning, and tell of it meanwhile; raises Cancelled."""

    def close(self) -> None:
        """End the work."""


class PlanningThread:
    """Plans for the task that was read last.

    What is read as progress in a task lets its planning go on. Another task stops it: at once,
    but if the planning before it was stopped, too, it may go on for half as long as calls wait.
    So tasks that never rest are planned for, and calls about newer ones need not wait for longer.

    `changed` is the caller's lock, which guards the tasks, and is held when methods are called.
    `tell` is called without it: with a task, what planning says of it, and when that is done
    how many seconds it took. It is to be taken by `take`.
    """

    def __init__(
        self,
        refiner: Refines,
        changed: threading.Condition,
        tell: Callable[[PlannedTask, Readiness, float | None], None],
    ) -> None:
        self._refiner = refiner
        self._changed = changed
        self._tell = tell
        self._task: PlannedTask | None = None  # that was read last
        self._due: PlannedTask | None = None  # to be planned for next
        self._under_way: PlannedTask | None = None  # being planned for, and not to stop
        self._stop = StopRequest()
        self._was_stopped = False
        self._closed = False
        # A daemon: a planner that hangs must not keep the node from ending.
        self._thread = threading.Thread(target=self._run, name='planning', daemon=True)
        self._thread.start()

    def turn_to(self, read: Readiness, patience: float, again: bool = False) -> Readiness:
        """Have a task planned for that was read, and return what is known of it already.

        What failed is done `again` only if asked for; calls wait for `patience` seconds.
        """
        assert read.preparation is not None
        task = self._task
        if task is not None and task.unplanned.is_of_task_of(read.preparation):
            task.known = task.known.at(read)
        else:
            self.stop(patience / 2 if self._was_stopped else 0.0)
            task = self._task = PlannedTask(read.preparation, read)
        known = task.known
        is_unplanned = known.phase is Phase.PLANNING or (again and known.may_pass)
        if is_unplanned and task is not self._under_way:
            self._due = task
            self._changed.notify_all()
        return known

    @property
    def is_wanted(self) -> bool:
        """Whether something is, or is to be, planned for that is not to stop."""
        return self._due is not None or self._under_way is not None

    def take(self, task: PlannedTask, told: Readiness) -> bool:
        """Take what was told of a task; return whether that is news."""
        if told.phase is not Phase.PLANNING and task is self._under_way:
            self._under_way = None
        if told.is_no_better_than(task.known):
            return False
        task.known = told.at(task.known)
        return True

    def stop(self, seconds: float = 0.0) -> None:
        """Stop what is being planned, now or after some seconds; what is known stays known."""
        self._due = self._under_way = None
        self._stop.after(seconds)

    def close(self) -> None:
        """Stop for good."""
        self._closed = True
        self.stop()
        self._changed.notify_all()

    def join(self, timeout: float) -> None:
        """End the work, and wait up to so many seconds for the thread; without the lock."""
        self._refiner.close()
        self._thread.join(timeout)

    def _run(self) -> None:
        self._refiner.warm_up()
        while (task := self._next()) is not None:
            started, told = time.monotonic(), None
            with contextlib.suppress(Cancelled):
                tell = partial(self._tell_meanwhile, task)
                told = self._refiner.refine(task.unplanned, self._stop, tell)
            with self._changed:
                self._was_stopped = told is None
            if told is not None:
                self._tell(task, told, time.monotonic() - started)

    def _next(self) -> PlannedTask | None:
        """Wait for a task to plan for; return None when closed."""
        with self._changed:
            self._under_way = None
            self._changed.wait_for(lambda: self._closed or self._due is not None)
            if self._closed:
                return None
            self._under_way, self._due = self._due, None
            self._stop = StopRequest()
            return self._under_way

    def _tell_meanwhile(self, task: PlannedTask, told: Readiness) -> None:
        self._tell(task, told, None)
