"""The explainer while a robot lives: inputs and calls come as they like, answers go out.

It knows nothing of ROS, so that a test, or another middleware, can drive it.
"""

import logging
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, replace

from mirror_explainer.node.answers import Answers, printable
from mirror_explainer.node.diagnostics import Diagnosis, diagnose
from mirror_explainer.node.history import History, news
from mirror_explainer.node.input_reader import InputReader
from mirror_explainer.node.inputs import Configuration, Inputs, Text
from mirror_explainer.node.readiness import Phase, Readiness
from mirror_explainer.node.refiner import Refiner
from mirror_explainer.node.surroundings import Others, look_around
from mirror_explainer.node.updates import Updates
from mirror_explainer.planning import Planner

# Each call that waits holds a thread of whoever calls. More than these are answered at once.
MOST_WAITING_CALLS = 56

_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Reply:
    """What a call gets: an answer, or with `success` false why there is none."""

    success: bool
    message: str


class LiveExplainer:
    """Hears what the robot publishes, and says what it is up to when asked.

    All methods may be called from any thread, and none but `ask` takes long. `publish` is
    called with the text and the JSON of each answer (see `Answers`), `on_update` whenever
    an update is done. `close` ends its threads and its planner's processes.

    Example::

        settings = Configuration(NodeSettings(user_model_file='user_model.yaml'))
        explainer = LiveExplainer(settings, publish=lambda text, report: print(text))
        explainer.hear('domain', Text(domain, '/domain'))  # 'problem' and 'plan' likewise
        explainer.ask().message
        explainer.close()
    """

    def __init__(
        self,
        configuration: Configuration,
        publish: Callable[[str, str], None],
        on_update: Callable[[], None] = lambda: None,
    ) -> None:
        self._on_update = on_update
        self._lock = threading.Lock()  # of the three that follow
        self._configuration = configuration
        self._inputs = Inputs()
        self._history = History()
        self._waiting = threading.Semaphore(MOST_WAITING_CALLS)
        self._answers = Answers(publish)
        self._reader = InputReader(configuration.node.goals_seen_file)
        self._updates = Updates(self._reader, Refiner(self._make_planner), self._on_done)
        self.configure(configuration)

    def configure(self, configuration: Configuration) -> None:
        """Do as one is told from now on."""
        with self._lock:
            self._configuration = configuration
            self._submit(
                replace(
                    self._inputs,
                    domain_file=configuration.node.domain_file,
                    user_model_file=configuration.node.user_model_file,
                    planning=configuration.planning,
                    limits=configuration.limits,
                )
            )

    def hear(self, name: str, text: Text) -> None:
        """Take up a 'domain', 'problem', 'plan' or 'progress', in place of the one before."""
        with self._lock:
            self._submit(self._inputs.hearing(name, text))

    def look_at_files(self) -> None:
        """Notice edits of the files that were read; to be called now and then."""
        self._updates.look_at_files()

    def ask(self) -> Reply:
        """Return the answer to "What are you up to?" for what was heard until now, or later.

        Waits `answer_timeout` at most for planning to be done, and answers from what is known
        then; only where the texts are not read yet there is no answer.
        """
        started = time.perf_counter()
        try:
            reply = self._reply()
        except Exception as error:
            _log.exception('a call failed')
            reply = Reply(False, f'internal error, please report it: {error!r}')
        with self._lock:
            seconds = time.perf_counter() - started
            self._history = self._history.after_call(reply.success, seconds)
        _log.debug('call: %s', reply.message)
        return replace(reply, message=printable(reply.message))

    def forget(self) -> int:
        """Forget what was said; return how many sentences that was."""
        return self._answers.forget()

    def diagnose(self, others: Others) -> Diagnosis:
        """Say how things stand, among other nodes."""
        with self._lock:
            inputs, history = self._inputs, self._history
        surroundings = look_around((inputs.domain_file, inputs.user_model_file), others)
        return diagnose(self._updates.readiness, history, inputs, surroundings, self._answers.last)

    def close(self) -> None:
        """Stop all work, and free the calls that wait; no planner process is left."""
        self._answers.close()
        self._updates.close()

    def _submit(self, inputs: Inputs) -> None:
        """Work on inputs; with the lock, so that none overtakes another."""
        self._inputs = inputs
        self._updates.submit(inputs, self._configuration.node.answer_timeout)

    def _configured(self) -> Configuration:
        with self._lock:
            return self._configuration

    def _make_planner(self) -> Planner:
        return Planner.of(self._configured().planning)

    def _on_done(self, readiness: Readiness) -> None:
        """Tell how an update ended, and make the answer that a call will want."""
        with self._lock:
            before, self._history = self._history.outcome, self._history.after_update(readiness)
            question = self._configuration.question
        for level, line in news(before, readiness):
            _log.log(level, '%s', line)
        if readiness.preparation is not None:
            self._answers.make(readiness.preparation, readiness.number, question)
        elif readiness.phase is Phase.WAITING:  # what was said was about a plan that is over
            self._answers.forget()
        self._on_update()

    def _reply(self) -> Reply:
        configuration = self._configured()
        if self._waiting.acquire(blocking=False):
            try:
                readiness = self._updates.wait(configuration.node.answer_timeout)
            finally:
                self._waiting.release()
        else:
            readiness = self._updates.readiness
        if readiness.preparation is None:
            phrases = self._reader.phrases
            if readiness.phase is Phase.PLANNING:  # the texts are still being read
                return Reply(False, phrases.not_ready)
            wrong = phrases.wrong_input.replace('{reason}', readiness.message)
            return Reply(False, readiness.spoken or wrong)
        text = self._answers.give(
            readiness.preparation,
            readiness.number,
            configuration.question,
            configuration.node.remember,
        )
        if text is None:
            return Reply(False, self._reader.phrases.not_ready)
        return Reply(True, text)
