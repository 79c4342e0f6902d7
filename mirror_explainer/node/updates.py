"""Keeps an explanation ready: newest input wins, work in one thread of its own.

This is the node's engine room, without ROS: inputs go in, a state comes out,
and whoever needs an answer waits here for the work to end.
"""

import contextlib
import logging
import threading
import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial

from mirror_explainer.errors import Cancelled, InputError, NoPlanError, PlanningError
from mirror_explainer.explainer import Preparation, prepare, robot_plan
from mirror_explainer.input_limits import InputLimits
from mirror_explainer.node.retries import Retries
from mirror_explainer.node.state import Inputs, Phase, State, Text
from mirror_explainer.pddl import Task, forget_expressions, read_task, require_definition
from mirror_explainer.plan_text import read_plan
from mirror_explainer.planning import Planner
from mirror_explainer.text_files import TextFiles
from mirror_explainer.user_model import read_user_model

# A robot publishes its problem and its plan one after the other: judge them together.
SETTLING_SECONDS = 0.1
LONGEST_SETTLING_SECONDS = 0.5
# Inputs that always change faster than they can be worked on would stop all work for ever: once
# work was cut off, the next gets so long to finish in spite of newer inputs, and then twice that.
SECONDS_TO_FINISH = 1.0
# A file may be written piece by piece: read it when it has been left alone for so long.
FILE_SETTLING_SECONDS = 0.5

_log = logging.getLogger(__name__)

_START = (
    "Start what publishes these topics in the node's namespace, or remap them; set the parameters."
)
_CORRECT = 'Correct it there: a new message, or the changed file, is taken up by itself.'
_REPORT = 'Report it with the log and the inputs; the next input is tried all the same.'


class Updates:
    """Turns the newest inputs into a Preparation, in a thread of its own.

    `make_planner` is called once it is needed, and again after planning failed;
    `on_state` is called from the thread when an update is done. What failed for
    another reason than its inputs is tried again (`retries.py`); until that is done,
    the state stays what it is. `close` stops the work at once, ends the planner and
    frees everyone who waits.
    """

    def __init__(
        self, make_planner: Callable[[], Planner], on_state: Callable[[State], None]
    ) -> None:
        self._make_planner = make_planner
        self._planner: Planner | None = None
        self._on_state = on_state
        self._changed = threading.Condition()
        self._state = State(Phase.WAITING, 'waiting for inputs')
        self._newest: Inputs | None = None
        self._submits = 0
        self._finished = (0, self._state)
        self._pending = False
        self._cut_off = 0
        self._retrying = False
        self._retries = Retries()
        self._settled_at = 0.0
        self._files = TextFiles()
        self._looking = threading.Lock()
        self._cancelled = threading.Event()
        self._closed = False
        self._task: tuple[Text, Text, Task] | None = None
        # A daemon, for unified-planning's reader can't be interrupted in a huge text.
        self._thread = threading.Thread(target=self._run, name='updates', daemon=True)
        self._thread.start()

    @property
    def state(self) -> State:
        """The current state."""
        with self._changed:
            return self._state

    def submit(self, inputs: Inputs) -> None:
        """Work on these inputs, and drop what is being worked on."""
        with self._changed:
            if self._newest is not None:
                inputs = replace(inputs, files_revision=self._newest.files_revision)
            if inputs != self._newest:
                self._begin(inputs, SETTLING_SECONDS)

    def look_at_files(self) -> None:
        """Work again if a file that was read has changed since."""
        with self._looking:  # until the work has begun, for whoever looks next sees no change
            files = self._files
            if files.changed():
                with self._changed:
                    if files is self._files and self._newest is not None:
                        revised = replace(self._newest, files_revision=files.revision)
                        self._begin(revised, FILE_SETTLING_SECONDS)

    def _begin(self, inputs: Inputs, settling: float) -> None:
        self._newest = inputs
        self._submits += 1
        if not self._cut_off:
            self._cancelled.set()
        elif not self._pending:
            seconds = SECONDS_TO_FINISH * 2 ** (self._cut_off - 1)
            stop = threading.Thread(
                target=_set_after, args=(seconds, self._cancelled), daemon=True
            )
            stop.start()
        self._pending = True
        self._settled_at = max(self._settled_at, time.monotonic() + settling)
        self._state = State(Phase.WORKING, 'reading the newest inputs', inputs=inputs)
        self._changed.notify_all()

    def wait(self, timeout: float) -> State:
        """Return what came of the inputs that are the newest now, or of newer ones.

        What failed is tried again, unless that was done just now. After `timeout`
        seconds return the current state.
        """
        self.look_at_files()
        with self._changed:
            newest = self._submits
            if self._state.phase is Phase.ERROR and self._retries.due_for_a_call():
                self._retrying = True
                self._changed.notify_all()
            if (
                self._changed.wait_for(
                    lambda: (
                        self._closed or (self._finished[0] >= newest and not self._may_turn_good)
                    ),
                    timeout,
                )
                and not self._closed
            ):
                return self._finished[1]
            return self._state

    @property
    def _may_turn_good(self) -> bool:
        """Whether an error is being tried again."""
        return self._retrying and self._state.phase is Phase.ERROR

    def close(self, timeout: float = 1.0) -> None:
        """Stop at once; wait up to `timeout` seconds for the thread to end."""
        with self._changed:
            self._closed = True
            self._cancelled.set()
            self._changed.notify_all()
            planner = self._planner
        if planner:
            planner.close()
        self._thread.join(timeout)

    def _run(self) -> None:
        with contextlib.suppress(Cancelled, PlanningError):
            self._ready_planner()  # early, so that its processes are up when they are needed
        while (work := self._next_work()) is not None:
            inputs, number, cancelled = work
            began = time.monotonic()
            try:
                state = self._state_for(inputs, cancelled)
            except Cancelled:
                self._cut_off += 1
                continue
            finally:
                cancelled.set()  # whoever would stop the work need not wait any more
            self.look_at_files()  # nothing that was half-written when read is answered from
            took = time.monotonic() - began
            state = replace(state, inputs=self._as_read(inputs))
            with self._changed:
                told = state.phase is Phase.ERROR and (
                    state.message == self._state.message  # it has been so since then
                    or (state.may_pass and self._state.phase is Phase.READY)  # another attempt
                )
                if told:
                    state = self._state
            if not self._finish(state, inputs, number):
                continue
            with self._changed:
                self._retries = self._retries.after_failure(took) if state.may_pass else Retries()
                self._retrying = False
                self._changed.notify_all()
            if told:
                continue
            try:
                self._on_state(state)
            except Exception as error:  # whatever listens must not end this thread
                self._finish(replace(_internal_error(error), inputs=inputs), inputs, number)

    def _finish(self, state: State, inputs: Inputs, number: int) -> bool:
        """Make it known what came of these inputs, the submission of this number; say if it was.

        What newer inputs have overtaken is of no use any more. But when that happened to the
        work before it too, an answer goes to the calls that came before the newer inputs.
        """
        with self._changed:
            if self._closed or self._newest is None:
                return False
            if self._pending:
                answer = state.preparation is not None  # an error may be of inputs half changed
                same_files = self._newest.files_revision == inputs.files_revision
                if not (answer and same_files and self._cut_off):
                    self._cut_off += answer
                    return False
            else:
                self._state = state
            self._cut_off = 0
            self._finished = (number, state)
            self._changed.notify_all()
            return True

    def _next_work(self) -> tuple[Inputs, int, threading.Event] | None:
        """Wait for inputs, or for the time to try again; return None when closed."""
        with self._changed:
            self._changed.wait_for(
                lambda: self._closed or self._pending or self._retrying,
                self._retries.seconds_left(),
            )
            self._retrying = not self._pending
            if self._pending:
                self._settle()
                self._files = TextFiles()  # another attempt keeps what the last answer rests on
            if self._closed or self._newest is None:
                return None
            self._pending = False
            self._cancelled = threading.Event()
            return self._newest, self._submits, self._cancelled

    def _settle(self) -> None:
        """Wait until inputs stop coming for a moment, but not for ever."""
        latest = time.monotonic() + LONGEST_SETTLING_SECONDS
        while not self._closed:
            remaining = min(self._settled_at, latest) - time.monotonic()
            if remaining <= 0:
                return
            self._changed.wait(remaining)

    def _state_for(self, inputs: Inputs, cancelled: threading.Event) -> State:
        """Do the work, and put what goes wrong in words."""
        try:
            if inputs.missing:
                _check_alone(inputs, partial(self._files.read, limits=inputs.limits))
                return State(
                    Phase.WAITING, f'waiting for {", ".join(inputs.missing)}', cure=_START
                )
            preparation = self._prepare(inputs, cancelled)
            failed = preparation.failed_beliefs > 0
            return State(Phase.READY, 'ready', preparation, may_pass=failed)
        except NoPlanError as error:
            return State(Phase.WAITING, str(error), cure=error.cure)
        except InputError as error:
            return State(Phase.ERROR, str(error), cure=error.cure or _CORRECT)
        except Cancelled:
            raise
        except PlanningError as error:
            self._drop_planner()
            return State(Phase.ERROR, str(error), cure=error.cure, may_pass=True)
        except Exception as error:  # the node must outlive a fault of ours
            self._drop_planner()
            return _internal_error(error)

    def _prepare(self, inputs: Inputs, cancelled: threading.Event) -> Preparation:
        assert inputs.problem and inputs.plan  # nothing is missing
        started = time.perf_counter()
        limits = inputs.limits
        read_file = partial(self._files.read, limits=limits)
        domain = inputs.domain or Text(read_file(inputs.domain_file), inputs.domain_file)
        task = self._read(domain, inputs.problem, limits)
        _stop_if(cancelled)
        plan = robot_plan(task, inputs.plan.text, inputs.plan.source, limits)
        _stop_if(cancelled)
        user_model = read_user_model(inputs.user_model_file, task, read_file, limits)
        read = time.perf_counter() - started
        preparation = prepare(
            task,
            plan,
            user_model,
            self._ready_planner(),
            max_beliefs=inputs.max_beliefs,
            plans_per_belief=inputs.plans_per_belief,
            deadline=inputs.deadline,
            cancelled=cancelled,
            progress=self._progress,
        )
        seconds = replace(preparation.seconds, read=read)
        return replace(preparation, seconds=seconds, inputs=self._as_read(inputs).digest)

    def _as_read(self, inputs: Inputs) -> Inputs:
        """Return the inputs with the revision of the files that were read for them."""
        return replace(inputs, files_revision=self._files.revision)

    def _ready_planner(self) -> Planner:
        """Return the planner, which is made once. Raises PlanningError if it can't be."""
        if self._planner is None:
            planner = self._make_planner()
            with self._changed:
                self._planner = planner
                closed = self._closed
            if closed:  # too late for `close` to see it
                planner.close()
                raise Cancelled
        return self._planner

    def _drop_planner(self) -> None:
        """End a planner that failed: the next one is made of what is installed then."""
        with self._changed:
            planner, self._planner = self._planner, None
        if planner:
            planner.close()

    def _read(self, domain: Text, problem: Text, limits: InputLimits) -> Task:
        """Return the task, read again only when its texts changed."""
        if self._task is None or self._task[:2] != (domain, problem):
            self._task = None
            forget_expressions()
            task = read_task(domain.text, problem.text, domain.source, problem.source, limits)
            self._task = (domain, problem, task)
        return self._task[2]

    def _progress(self, done: int, beliefs: int) -> None:
        with self._changed:
            if not self._pending and self._state.phase is Phase.WORKING:
                message = f'planning {done} of {beliefs}'
                self._state = replace(self._state, message=message)


def _stop_if(cancelled: threading.Event) -> None:
    if cancelled.is_set():
        raise Cancelled


def _set_after(seconds: float, event: threading.Event) -> None:
    event.wait(seconds)
    event.set()


def _internal_error(error: Exception) -> State:
    _log.error('where the internal error came from', exc_info=error)
    return State(
        Phase.ERROR, f'internal error, please report it: {error!r}', cure=_REPORT, may_pass=True
    )


def _check_alone(inputs: Inputs, read: Callable[[str], str]) -> None:
    """Raise InputError for what is wrong already, whatever is still missing."""
    for text, kind in ((inputs.domain, 'domain'), (inputs.problem, 'problem')):
        if text:
            require_definition(text.text, kind, text.source, inputs.limits)
    if inputs.plan:
        read_plan(inputs.plan.text, inputs.plan.source, inputs.limits)
    if inputs.user_model_file:
        read_user_model(inputs.user_model_file, read=read, limits=inputs.limits)
