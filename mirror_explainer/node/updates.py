"""Keeps an explanation ready: the newest inputs win, work goes on in a thread of its own.

When to work, and for whom, is decided here; what the work is, in `maker.py`.
"""

import logging
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

from mirror_explainer.errors import Cancelled
from mirror_explainer.node.inputs import Inputs, Text
from mirror_explainer.node.maker import Maker
from mirror_explainer.node.readiness import Phase, Readiness
from mirror_explainer.node.retries import Retries
from mirror_explainer.node.stop_request import StopRequest

# A robot publishes its problem and its plan one after the other: what comes within so many seconds
# is taken together.
SETTLING_SECONDS = 0.1
# They may come further apart, behind many calls: that a plan does not fit is believed once it has
# not for so long.
DOUBTFUL_SECONDS = 0.5
# A file may be written piece by piece: it is read when it has been left alone for so long, but not
# later than that.
FILE_SETTLING_SECONDS = 0.5
LONGEST_FILE_SETTLING_SECONDS = 5.0

_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class _Work:
    """Inputs to work on, the `number`-th that were submitted, and what asks to stop."""

    inputs: Inputs
    number: int
    stop: StopRequest


class Updates:
    """Makes the newest inputs ready to answer from, in a thread of its own.

    Once the texts are read there is something to answer from, and planning refines it. Newer
    inputs stop the work on older ones: at once, but if the work before it was stopped, too,
    its texts are read and planning goes on for half as long as calls wait. So inputs that never
    rest are planned for, and calls about newer ones need not wait for longer than they do. What
    comes of it goes to the calls that came before the newer inputs.

    `on_done` is called from the thread when an update is done. What failed for
    another reason than its inputs is tried again (`retries.py`); until that is done,
    the readiness stays what it is. `close` stops the work at once, closes the maker and
    frees everyone who waits.
    """

    def __init__(self, maker: Maker, on_done: Callable[[Readiness], None]) -> None:
        self._maker = maker
        self._on_done = on_done
        self._changed = threading.Condition()
        self._current = Readiness(Phase.WAITING, 'waiting for inputs')
        self._known = self._current
        self._newest: Inputs | None = None
        self._number = 0
        self._pending = False
        self._was_stopped = False
        self._working_on = 0
        self._patience = 0.0
        self._doubt: tuple[Text | None, float] = (None, 0.0)
        self._retrying = False
        self._retries = Retries()
        self._settled_at = 0.0
        self._looking = threading.Lock()
        self._stop = StopRequest()
        self._closed = False
        # A daemon, for unified-planning's reader can't be interrupted in a huge text.
        self._thread = threading.Thread(target=self._run, name='updates', daemon=True)
        self._thread.start()

    @property
    def readiness(self) -> Readiness:
        """Where the newest inputs stand."""
        with self._changed:
            return self._current

    def submit(self, inputs: Inputs, patience: float) -> None:
        """Work on these inputs; `patience` is how many seconds calls wait for an answer."""
        with self._changed:
            self._patience = patience
            if self._newest is not None:
                inputs = replace(inputs, files_revision=self._newest.files_revision)
            if inputs != self._newest:
                self._begin(inputs, 0.0 if self._pending else SETTLING_SECONDS)

    def look_at_files(self, timeout: float = -1.0) -> bool:
        """Work again if a file that was read has changed since; return whether one has.

        Where somebody else is looking, wait for them, up to `timeout` seconds if it is
        not negative.
        """
        # Until the work has begun, for whoever looks next sees no change.
        if not self._looking.acquire(timeout=timeout):
            return False
        try:
            files = self._maker.files
            if not files.changed():
                return False
            with self._changed:
                if files is self._maker.files and self._newest is not None:
                    newest = replace(self._newest, files_revision=files.revision)
                    self._begin(newest, FILE_SETTLING_SECONDS)
            return True
        finally:
            self._looking.release()

    def _begin(self, inputs: Inputs, settling: float) -> None:
        self._settled_at = max(self._settled_at, time.monotonic() + settling)
        self._newest = inputs
        self._number += 1
        self._pending = True
        self._make_way()
        self._current = Readiness(Phase.PLANNING, 'reading the newest inputs', inputs=inputs)
        self._changed.notify_all()

    def _make_way(self) -> None:
        """Stop the work under way for newer inputs, now or later."""
        if not self._was_stopped:
            self._stop.after(0.0)
        elif self._known.number == self._working_on:  # its texts are read
            self._stop.after(self._patience / 2)

    def wait(self, timeout: float) -> Readiness:
        """Return what came of the inputs that are the newest now, or of newer ones.

        What failed is tried again, unless that was done just now. After `timeout`
        seconds return what is known until then, or where things stand if that is nothing.
        """
        end = time.monotonic() + timeout
        self.look_at_files(timeout)
        with self._changed:
            newest = self._number
            if self._current.phase is Phase.ERROR and self._retries.due_for_a_call():
                self._retrying = True
                self._changed.notify_all()
            self._changed.wait_for(
                lambda: self._closed or self._is_done(newest), end - time.monotonic()
            )
            is_known = self._known.number >= newest and not self._closed
            return self._known if is_known else self._current

    def _is_done(self, number: int) -> bool:
        """Whether work on this submission, or a later one, is done, and no error tried again."""
        may_turn_good = self._retrying and self._current.phase is Phase.ERROR
        is_done = self._known.number >= number and self._known.phase is not Phase.PLANNING
        return is_done and not may_turn_good

    def close(self, timeout: float = 1.0) -> None:
        """Stop at once; wait up to `timeout` seconds for the thread to end."""
        with self._changed:
            if self._closed:
                return
            self._closed = True
            self._stop.after(0.0)
            self._changed.notify_all()
        self._maker.close()
        self._thread.join(timeout)

    def _run(self) -> None:
        self._maker.warm_up()
        while (work := self._next_work()) is not None:
            began = time.monotonic()
            try:
                outcome = self._maker.make(work.inputs, work.stop, partial(self._tell, work))
            except Cancelled:
                with self._changed:
                    self._was_stopped = True
                continue
            took = time.monotonic() - began
            outcome = replace(outcome, number=work.number)
            if self._conclude(work, outcome, took):
                try:
                    self._on_done(outcome)
                except Exception:  # whatever listens must not end this thread
                    _log.exception('what listens to updates failed')

    def _next_work(self) -> _Work | None:
        """Wait for inputs, or for the time to try again; return None when closed."""
        with self._changed:
            self._changed.wait_for(
                lambda: self._closed or self._pending or self._retrying,
                self._retries.seconds_left(),
            )
            self._retrying = not self._pending
        if not self._retrying:  # otherwise with the files that the last answer rests on
            self._let_settle()
        with self._changed:
            if self._closed or self._newest is None:
                return None
            self._retrying &= not self._pending
            if not self._retrying:
                self._maker.forget_files()
            self._pending = False
            self._stop = StopRequest()
            self._working_on = self._number
            return _Work(self._newest, self._number, self._stop)

    def _let_settle(self) -> None:
        """Wait until the inputs are together and the files left alone, but not for ever."""
        latest = time.monotonic() + LONGEST_FILE_SETTLING_SECONDS
        is_restless = True
        while is_restless and not self._closed and time.monotonic() < latest:
            with self._changed:
                while (wait := min(self._settled_at, latest) - time.monotonic()) > 0.0:
                    if self._closed:
                        return
                    self._changed.wait(wait)
            is_restless = self.look_at_files()

    def _tell(self, work: _Work, meanwhile: Readiness) -> None:
        """Say how far the planning is, and let calls be answered from what is known so far."""
        if meanwhile.preparation is not self._known.preparation:
            self.look_at_files()  # nothing that was half-written when read is answered from
        with self._changed:
            is_retry = self._known.number == work.number and (
                self._known.phase is not Phase.PLANNING
            )
            if is_retry or not self._same_files(work):
                return
            self._known = replace(meanwhile, number=work.number)
            if self._pending:
                self._make_way()
            else:
                self._current = self._known

    def _same_files(self, work: _Work) -> bool:
        """Whether no file was edited since the work began."""
        newest = self._newest
        return newest is not None and newest.files_revision == work.inputs.files_revision

    def _conclude(self, work: _Work, outcome: Readiness, took: float) -> bool:
        """Make known what came of work that took so many seconds; say whether it is news."""
        believed = self._is_believed(outcome)
        self.look_at_files()
        with self._changed:
            self._was_stopped = not (believed and self._same_files(work))
            if self._closed or self._was_stopped:
                return False
            is_news = self._pending or not outcome.is_no_better_than(self._current)
            if not is_news:
                outcome = self._current
            elif not self._pending:
                self._current = outcome
            self._known = outcome
            self._retries = self._retries.after_failure(took) if outcome.may_pass else Retries()
            self._retrying = False
            self._changed.notify_all()
            return is_news

    def _is_believed(self, outcome: Readiness) -> bool:
        """Say whether the plan is not to blame, or for long enough; wait while nothing comes."""
        plan = outcome.inputs.plan if outcome.blames_plan else None
        with self._changed:
            if self._doubt[0] != plan:
                self._doubt = plan, time.monotonic()
            if plan is None:
                return True
            believed_at = self._doubt[1] + DOUBTFUL_SECONDS
            self._changed.wait_for(
                lambda: self._closed or self._pending, believed_at - time.monotonic()
            )
            return time.monotonic() >= believed_at
