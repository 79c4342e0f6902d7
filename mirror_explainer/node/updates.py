"""Keeps an explanation ready: the newest inputs win, work goes on in threads of its own.

When inputs are read, and who gets what comes of them, is decided here; how they are read is in
`input_reader.py`, and which task is planned for in `planning_thread.py`.
"""

import logging
import threading
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Protocol

from mirror_explainer.errors import Cancelled
from mirror_explainer.node.inputs import Inputs, Text
from mirror_explainer.node.planning_thread import PlannedTask, PlanningThread, Refines
from mirror_explainer.node.readiness import Phase, Readiness
from mirror_explainer.node.retries import Retries
from mirror_explainer.node.stop_request import StopRequest
from mirror_explainer.text_files import TextFiles

# A robot publishes its problem and its plan one after the other: what comes within so many seconds
# is taken together.
SETTLING_SECONDS = 0.1
# They may come further apart, behind many calls: that a plan does not fit is believed so long
# after the last of the two came, or the longer time where a robot tells ever newer states.
DOUBTFUL_SECONDS = 0.5
LONGEST_DOUBTFUL_SECONDS = 2.0
# A file may be written piece by piece: it is read when it has been left alone for so long, but not
# later than that.
FILE_SETTLING_SECONDS = 0.5
LONGEST_FILE_SETTLING_SECONDS = 5.0

_NOTHING_YET = Readiness(Phase.WAITING, 'waiting for inputs')

_log = logging.getLogger(__name__)


class Reads(Protocol):
    """How inputs are read, such as by an `InputReader`."""

    @property
    def files(self) -> TextFiles:
        """The files that were read."""

    def forget_files(self) -> None:
        """Take what is read from now on for what the files are like."""

    def read(self, inputs: Inputs, stop: StopRequest) -> Readiness:
        """Return what there is to answer from, or why there is nothing; raises Cancelled."""


@dataclass(frozen=True)
class _Submission:
    """The newest inputs, the `number`-th that came, None before the first.

    They are together, and the files left alone, at `settled_at` (of time.monotonic()). Calls
    wait for `patience` seconds. `unread` is how ready the explainer is until they are read.
    `is_plan_newer` says whether the plan came after the progress since the texts are these.
    """

    inputs: Inputs | None = None
    number: int = 0
    settled_at: float = 0.0
    patience: float = 0.0
    unread: Readiness = _NOTHING_YET
    is_plan_newer: bool = False


@dataclass(frozen=True)
class _Reading:
    """The reading of inputs, the `number`-th that came.

    It is done `again` where work on the same inputs failed; newer ones stop it unless it is
    `patient`.
    """

    inputs: Inputs = field(default_factory=Inputs)
    number: int = 0
    again: bool = False
    patient: bool = False
    stop: StopRequest = field(default_factory=StopRequest)


@dataclass(frozen=True)
class _Suspect:
    """The plan that was found to be wrong last, if one was, and since when."""

    plan: Text | None = None
    since: float = 0.0


class Updates:
    """Makes the newest inputs ready to answer from, in threads of its own.

    Once the texts are read there is something to answer from, and planning refines it in another
    thread. Newer inputs stop the reading of older ones, but not if the reading before was
    stopped, too. They stop the planning only if they turn out to be about another task. What
    comes of it all goes to the calls that came before newer inputs did.

    `on_done` is called from the thread that reads when an update is done. What failed for
    another reason than its inputs is tried again (`retries.py`); until that is done, the
    readiness stays what it is. `close` stops the work at once and frees everyone who waits.
    """

    def __init__(
        self, reader: Reads, refiner: Refines, on_done: Callable[[Readiness], None]
    ) -> None:
        self._reader = reader
        self._on_done = on_done
        self._looking = threading.Lock()  # whoever has it looks at the files
        self._changed = threading.Condition()  # of all that follows
        self._newest = _Submission()
        self._edited = 0  # the number of the submission that the last edit of a file was
        self._reading = _Reading()  # the last that was begun
        self._suspect = _Suspect()
        self._known = _NOTHING_YET  # of the newest inputs that are read
        self._done = _NOTHING_YET  # of the newest inputs that nothing is left to do for
        self._untold: deque[Readiness] = deque()  # what updates came to, in order
        self._retries = Retries()
        self._closed = False
        self._planning = PlanningThread(refiner, self._changed, self._take)
        # A daemon, for unified-planning's reader can't be interrupted in a huge text.
        self._thread = threading.Thread(target=self._run, name='updates', daemon=True)
        self._thread.start()

    @property
    def readiness(self) -> Readiness:
        """Where the newest inputs stand."""
        with self._changed:
            is_read = self._known.number == self._newest.number
            return self._known if is_read else self._newest.unread

    def submit(self, inputs: Inputs, patience: float) -> None:
        """Work on these inputs; `patience` is how many seconds calls wait for an answer."""
        with self._changed:
            before = self._newest = replace(self._newest, patience=patience)
            if before.inputs is not None:
                inputs = replace(inputs, files_revision=before.inputs.files_revision)
            known = before.inputs
            is_same = inputs == known and inputs.begins_anew == known.begins_anew
            is_plan_newer = inputs.is_plan_newer or (is_same and before.is_plan_newer)
            if not is_same or is_plan_newer != before.is_plan_newer:
                self._begin(inputs, 0.0 if self._is_pending else SETTLING_SECONDS)
            # The same may have been heard again.
            self._newest = replace(self._newest, inputs=inputs, is_plan_newer=is_plan_newer)

    def look_at_files(self, timeout: float = -1.0) -> bool:
        """Work again if a file that was read has changed since; return whether one has.

        Where somebody else is looking, wait for them, up to `timeout` seconds if it is
        not negative.
        """
        # Until the work has begun, for whoever looks next sees no change.
        if not self._looking.acquire(timeout=timeout):
            return False
        try:
            files = self._reader.files
            if not files.changed():
                return False
            with self._changed:
                inputs = self._newest.inputs
                if files is self._reader.files and inputs is not None:
                    inputs = replace(inputs, files_revision=files.revision)
                    self._begin(inputs, FILE_SETTLING_SECONDS)
                    self._edited = self._newest.number
            return True
        finally:
            self._looking.release()

    def wait(self, timeout: float) -> Readiness:
        """Return what came of the inputs that are the newest now, or of newer ones.

        What failed is tried again, unless that was done just now. After `timeout`
        seconds return what is known until then, or where things stand if that is nothing.
        """
        end = time.monotonic() + timeout
        self.look_at_files(timeout)
        with self._changed:
            newest = self._newest.number
            if self.readiness.phase is Phase.ERROR:
                self._retries = self._retries.asked_for()
                self._changed.notify_all()
            self._changed.wait_for(
                lambda: self._closed or self._is_done(newest), end - time.monotonic()
            )
            if not self._closed:
                for found in (self._done, self._known):
                    if found.number >= newest:
                        return found
            return self.readiness

    def close(self, timeout: float = 1.0) -> None:
        """Stop at once; wait up to `timeout` seconds for each thread to end."""
        with self._changed:
            if self._closed:
                return
            self._closed = True
            self._reading.stop.after(0.0)
            self._planning.close()
            self._changed.notify_all()
        self._planning.join(timeout)
        self._thread.join(timeout)

    @property
    def _is_pending(self) -> bool:
        """Whether there are inputs of which the reading has not begun."""
        return self._newest.number > self._reading.number

    def _begin(self, inputs: Inputs, settling: float) -> None:
        before = self._newest
        self._newest = replace(
            before,
            inputs=inputs,
            number=before.number + 1,
            settled_at=max(before.settled_at, time.monotonic() + settling),
            unread=Readiness(Phase.PLANNING, 'reading the newest inputs', inputs=inputs),
        )
        if not self._reading.patient:
            self._reading.stop.after(0.0)
        self._changed.notify_all()

    def _is_done(self, number: int) -> bool:
        """Whether work on this submission, or a later one, is done, and no error tried again."""
        may_turn_good = self._done.phase is Phase.ERROR and self._retries.may_mend
        return self._done.number >= number and not may_turn_good

    def _run(self) -> None:
        patient = False
        while self._wait_for_work():
            self._tell()
            reading = self._next_reading(patient)
            if reading is not None:
                patient = not self._read(reading)

    def _wait_for_work(self) -> bool:
        """Wait until there is something to tell or to read; return False when closed."""
        with self._changed:
            while not (self._closed or self._untold or self._is_pending or self._retries.is_due):
                self._changed.wait(self._retries.seconds_left())
            return not self._closed

    def _tell(self) -> None:
        """Tell how updates ended."""
        while self._untold:
            try:
                self._on_done(self._untold.popleft())
            except Exception:  # whatever listens must not end this thread
                _log.exception('what listens to updates failed')

    def _next_reading(self, patient: bool) -> _Reading | None:
        """Return the newest inputs, if they are to be read, or to be read again."""
        if self._is_pending:
            self._let_settle()
        with self._changed:
            inputs, again = self._newest.inputs, not self._is_pending
            if self._closed or inputs is None or (again and not self._retries.is_due):
                return None
            if again:  # with the files that the last answer rests on
                self._retries = self._retries.begun()
            else:
                self._reader.forget_files()
            self._reading = _Reading(inputs, self._newest.number, again, patient)
            return self._reading

    def _let_settle(self) -> None:
        """Wait until the inputs are together and the files left alone, but not for ever."""
        latest = time.monotonic() + LONGEST_FILE_SETTLING_SECONDS
        is_restless = True
        while is_restless and not self._closed and time.monotonic() < latest:
            with self._changed:
                while (wait := min(self._newest.settled_at, latest) - time.monotonic()) > 0.0:
                    if self._closed:
                        return
                    self._changed.wait(wait)
            is_restless = self.look_at_files()

    def _read(self, reading: _Reading) -> bool:
        """Read inputs, and have them planned for; return whether that was not in vain."""
        started = time.monotonic()
        try:
            read = self._reader.read(reading.inputs, reading.stop)
        except Cancelled:
            return False
        read = replace(read, number=reading.number)
        believed = self._is_believed(read)
        self.look_at_files()  # nothing that was half-written when read is answered from
        with self._changed:
            if self._closed or not believed or reading.number < self._edited:
                return False
            took = time.monotonic() - started
            known, is_news = read, True
            if read.preparation is None:
                self._planning.stop()
            else:
                known = self._planning.turn_to(read, self._newest.patience, reading.again)
                is_news = not (reading.again and known.is_no_better_than(self._done))
            self._known = known
            if self._planning.is_wanted:
                self._retries = self._retries.begun()
            elif not (known.may_pass and self._retries.is_scheduled and known is not read):
                self._retries = self._retries.after(known, took)
            if known.phase is not Phase.PLANNING:
                self._conclude(known, is_news)
            return True

    def _take(self, task: PlannedTask, told: Readiness, took: float | None) -> None:
        """Take what planning for a task says, which is done if it took so many seconds."""
        if took is not None:
            self.look_at_files()
        with self._changed:
            is_news = self._planning.take(task, told)
            known = task.known
            if self._closed or known.number < self._edited:
                return
            is_newest = known.number == self._known.number
            if is_newest:
                self._known = known
            if took is not None:
                if is_newest:
                    self._retries = self._retries.after(known, took)
                self._conclude(known, is_news)

    def _conclude(self, outcome: Readiness, is_news: bool = True) -> None:
        """Make known what came of an update that is done."""
        if outcome.number >= self._done.number:
            self._done = outcome
            if is_news:
                self._untold.append(outcome)
        self._changed.notify_all()

    def _is_believed(self, read: Readiness) -> bool:
        """Say whether the plan is not to blame, or for long enough; wait while nothing comes."""
        plan = read.inputs.plan if read.blames_plan else None
        with self._changed:
            if self._suspect.plan != plan:
                self._suspect = _Suspect(plan, time.monotonic())
            if plan is None:
                return True
            texts = (text for text in (plan, read.inputs.problem) if text is not None)
            believed_at = min(
                max(text.heard.steady for text in texts) + DOUBTFUL_SECONDS,
                self._suspect.since + LONGEST_DOUBTFUL_SECONDS,
            )
            self._changed.wait_for(
                lambda: self._closed or self._is_pending, believed_at - time.monotonic()
            )
            return time.monotonic() >= believed_at
