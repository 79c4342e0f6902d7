"""Keeps an explanation ready: newest input wins, work in one thread of its own.

This is the node's engine room, without ROS: inputs go in, a state comes out, and whoever
needs an answer waits here. When to work, and for whom, is decided here; what the work is,
in `maker.py`.
"""

import logging
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, replace

from mirror_explainer.errors import Cancelled
from mirror_explainer.node.maker import Maker
from mirror_explainer.node.retries import Retries
from mirror_explainer.node.state import Inputs, Phase, State, Text
from mirror_explainer.node.stop_request import StopRequest

# A robot publishes its problem and its plan one after the other: judge them together.
SETTLING_SECONDS = 0.1
LONGEST_SETTLING_SECONDS = 0.5
# One of the two may wait behind many calls: that they do not fit is believed when nothing has come
# for so long.
DOUBTFUL_SECONDS = 0.5
# A file may be written piece by piece: read it when it has been left alone for so long.
FILE_SETTLING_SECONDS = 0.5
LONGEST_FILE_SETTLING_SECONDS = 5.0
# Inputs that always change faster than they can be worked on would stop all work for ever: once
# work came to nothing, the next gets so long to finish in spite of newer inputs, then twice that.
SECONDS_TO_FINISH = 1.0
# Of works that newer inputs overtook, the second in a row is told if it brought an answer, the
# third if it did not. A plan that does not fit may be newer, or older, than the problem that came
# with it: it must have been the same plan three times.
OVERTAKEN_ANSWERS = 2
OVERTAKEN_OTHERS = 3

_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class _Work:
    """Inputs to work on, which submission they are, and what asks to stop."""

    inputs: Inputs
    number: int
    stop: StopRequest


class Updates:
    """Turns the newest inputs into a state, in a thread of its own.

    `on_state` is called from the thread when an update is done. What failed for
    another reason than its inputs is tried again (`retries.py`); until that is done,
    the state stays what it is. `close` stops the work at once, closes the maker and
    frees everyone who waits.
    """

    def __init__(self, maker: Maker, on_state: Callable[[State], None]) -> None:
        self._maker = maker
        self._on_state = on_state
        self._changed = threading.Condition()
        self._state = State(Phase.WAITING, 'waiting for inputs')
        self._newest: Inputs | None = None
        self._submits = 0
        self._patience = 0.0
        self._finished = self._state
        self._pending = False
        self._overtaken = 0
        self._same_plan = 0
        self._overtaken_plan: Text | None = None
        self._retrying = False
        self._retries = Retries()
        self._settled_at = 0.0
        self._files_settled_at = 0.0
        self._looking = threading.Lock()
        self._stop = StopRequest()
        self._closed = False
        # A daemon, for unified-planning's reader can't be interrupted in a huge text.
        self._thread = threading.Thread(target=self._run, name='updates', daemon=True)
        self._thread.start()

    @property
    def state(self) -> State:
        """The current state."""
        with self._changed:
            return self._state

    def submit(self, inputs: Inputs, patience: float) -> None:
        """Work on these inputs, and stop what is being worked on.

        `patience` is how long calls wait for an answer, in seconds: no work goes on
        for longer than that in spite of newer inputs.
        """
        with self._changed:
            self._patience = patience
            if self._newest is not None:
                inputs = replace(inputs, files_revision=self._newest.files_revision)
            if inputs != self._newest:
                self._settled_at = time.monotonic() + SETTLING_SECONDS
                self._begin(inputs)

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
                    self._files_settled_at = time.monotonic() + FILE_SETTLING_SECONDS
                    self._begin(replace(self._newest, files_revision=files.revision))
            return True
        finally:
            self._looking.release()

    def _begin(self, inputs: Inputs) -> None:
        self._newest = inputs
        self._submits += 1
        grace = 0.0
        if self._overtaken:
            longest = max(SECONDS_TO_FINISH, self._patience)
            grace = min(SECONDS_TO_FINISH * 2.0 ** min(self._overtaken - 1, 10), longest)
        self._stop.after(grace)
        self._pending = True
        self._state = State(Phase.WORKING, 'reading the newest inputs', inputs=inputs)
        self._changed.notify_all()

    def wait(self, timeout: float) -> State:
        """Return what came of the inputs that are the newest now, or of newer ones.

        What failed is tried again, unless that was done just now. After `timeout`
        seconds return the current state.
        """
        end = time.monotonic() + timeout
        self.look_at_files(timeout)
        with self._changed:
            newest = self._submits
            if self._state.phase is Phase.ERROR and self._retries.due_for_a_call():
                self._retrying = True
                self._changed.notify_all()
            self._changed.wait_for(
                lambda: self._closed or self._is_finished(newest), end - time.monotonic()
            )
            done = self._is_finished(newest) and not self._closed
            return self._finished if done else self._state

    def _is_finished(self, number: int) -> bool:
        """Whether work on this submission, or a later one, is done, and no error tried again."""
        may_turn_good = self._retrying and self._state.phase is Phase.ERROR
        return self._finished.number >= number and not may_turn_good

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
                state = self._maker.make(work.inputs, work.stop, self._progress)
            except Cancelled:
                with self._changed:
                    self._overtaken += 1
                continue
            if state.blames_plan:
                self._wait_for_the_other_half()
            self.look_at_files()  # nothing that was half-written when read is answered from
            state = replace(state, number=work.number)
            if self._conclude(state, work.inputs, time.monotonic() - began):
                try:
                    self._on_state(state)
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
            if self._retrying:  # with the files that the last answer rests on
                return self._work()
        return self._settled_work()

    def _settled_work(self) -> _Work | None:
        """Wait until inputs and files are left alone for a moment, but not for ever."""
        latest = time.monotonic() + LONGEST_SETTLING_SECONDS
        latest_for_files = time.monotonic() + LONGEST_FILE_SETTLING_SECONDS
        looked_after = 0
        while True:
            with self._changed:
                now = time.monotonic()
                settled_at = max(
                    min(self._settled_at, latest), min(self._files_settled_at, latest_for_files)
                )
                if now < settled_at and not self._closed:
                    self._changed.wait(settled_at - now)
                    continue
                if looked_after == self._submits or now >= latest_for_files or self._closed:
                    self._maker.forget_files()
                    return self._work()
                looked_after = self._submits
            self.look_at_files()

    def _work(self) -> _Work | None:
        if self._closed or self._newest is None:
            return None
        self._pending = False
        self._stop = StopRequest()
        return _Work(self._newest, self._submits, self._stop)

    def _wait_for_the_other_half(self) -> None:
        """Wait for a problem, or a plan, that was published together with the last input."""
        with self._changed:
            believed_at = self._settled_at - SETTLING_SECONDS + DOUBTFUL_SECONDS
            self._changed.wait_for(
                lambda: self._closed or self._pending, believed_at - time.monotonic()
            )

    def _conclude(self, state: State, inputs: Inputs, took: float) -> bool:
        """Make known what came of these inputs after so many seconds; say whether it is news.

        What newer inputs have overtaken is mostly of no use any more. But if it goes on like
        that, it goes to the calls that came before the newer inputs.
        """
        with self._changed:
            if self._closed or self._newest is None:
                return False
            is_news = True
            if self._pending:
                self._overtaken += 1
                self._same_plan = 1 + self._same_plan * (inputs.plan == self._overtaken_plan)
                self._overtaken_plan = inputs.plan
                count = self._same_plan if state.blames_plan else self._overtaken
                enough = OVERTAKEN_OTHERS if state.preparation is None else OVERTAKEN_ANSWERS
                same_files = self._newest.files_revision == inputs.files_revision
                if count < enough or not same_files:
                    return False
            else:
                is_news = not _is_no_better(state, self._state)
                self._state = state = state if is_news else self._state
            self._overtaken = self._same_plan = 0
            self._finished = state
            self._retries = self._retries.after_failure(took) if state.may_pass else Retries()
            self._retrying = False
            self._changed.notify_all()
            return is_news

    def _progress(self, done: int, beliefs: int) -> None:
        with self._changed:
            if not self._pending and self._state.phase is Phase.WORKING:
                message = f'planning {done} of {beliefs}'
                self._state = replace(self._state, message=message)


def _is_no_better(new: State, now: State) -> bool:
    """Whether another attempt changed nothing: the same error, or no fewer beliefs that failed."""
    if now.preparation is None:
        return new.phase is Phase.ERROR and new.message == now.message
    if new.preparation is None:
        return new.may_pass
    return new.preparation.failed_beliefs >= now.preparation.failed_beliefs
