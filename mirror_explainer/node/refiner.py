"""From something to answer from to a better answer: what an update asks the planner."""

import logging
import threading
from collections.abc import Callable
from dataclasses import replace

from mirror_explainer.errors import Cancelled, InputError, PlanningError
from mirror_explainer.listener.preparation import Preparation, refine
from mirror_explainer.node.readiness import Phase, Readiness, internal_error, planning
from mirror_explainer.node.stop_request import StopRequest
from mirror_explainer.planning import Planner

_log = logging.getLogger(__name__)

Tell = Callable[[Readiness], None]


class Refiner:
    """Plans for one task at a time.

    `make_planner` is called once it is needed, and again after planning failed: the next
    planner is made of what is installed then. `close` may come from any thread.
    """

    def __init__(self, make_planner: Callable[[], Planner]) -> None:
        self._make_planner = make_planner
        self._planner_lock = threading.Lock()  # of the two that follow
        self._planner: Planner | None = None
        self._closed = False

    def warm_up(self) -> None:
        """Start the planner's processes, so that they are up when they are needed."""
        try:
            self._ready_planner()
        except Exception as error:  # the first task will say so
            _log.debug('no planner yet: %s', error)

    def refine(self, unplanned: Preparation, stop: StopRequest, tell: Tell) -> Readiness:
        """Return what comes of planning for what was read. Raises Cancelled when it is to stop.

        `tell` is called meanwhile with what is known so far. Where planning fails, what is
        known without it is left to answer from.
        """
        try:
            refined = self._refine(unplanned, stop, tell)
        except Cancelled:
            raise
        except InputError as error:
            failure = Readiness(Phase.ERROR, str(error), cure=error.cure)
        except PlanningError as error:
            failure = Readiness(Phase.ERROR, str(error), cure=error.cure, may_pass=True)
        except Exception as error:  # the node must outlive a fault of ours
            _log.exception('where the internal error came from')
            failure = internal_error(error)
        else:
            failed = refined.failed_beliefs > 0
            return Readiness(Phase.READY, 'ready', refined, may_pass=failed)
        self._drop_planner()
        return replace(failure, preparation=unplanned.without_planning(failure.message))

    def close(self) -> None:
        """End the planner, and with it what is being planned; no other will be made."""
        with self._planner_lock:
            self._closed = True
        self._drop_planner()

    def _refine(self, unplanned: Preparation, stop: StopRequest, tell: Tell) -> Preparation:
        known = unplanned

        def progress(done: int, beliefs: int) -> None:
            tell(planning(known, done))

        def on_refined(refined: Preparation) -> None:
            nonlocal known
            known = refined

        refined = refine(
            unplanned,
            self._ready_planner(),
            cancelled=stop,
            on_refined=on_refined,
            progress=progress,
        )
        refined.model_for(refined.listener, stop.check)  # made here, where it can be stopped
        return refined

    def _ready_planner(self) -> Planner:
        """Return the planner, which is made once. Raises PlanningError if it can't be."""
        with self._planner_lock:
            if self._closed:
                raise Cancelled
            if self._planner is None:
                self._planner = self._make_planner()
            return self._planner

    def _drop_planner(self) -> None:
        with self._planner_lock:
            planner, self._planner = self._planner, None
        if planner:
            planner.close()
