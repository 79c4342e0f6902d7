"""The answers to calls: each is made once, and what was said is remembered."""

import json
import re
import threading
from collections.abc import Callable
from dataclasses import dataclass

from mirror_explainer.explainer import explain
from mirror_explainer.listener.explanation import Explanation
from mirror_explainer.listener.preparation import Preparation
from mirror_explainer.settings import Question

# How long a call waits for its turn, in seconds: with `remember` each has an answer of its own.
TURN_SECONDS = 5.0

_CONTROL = re.compile(r'[\x00-\x08\x0b-\x1f\x7f-\x9f]')


@dataclass(frozen=True)
class _Made:
    """An answer, as text and as JSON, and the question that it answers after what was said."""

    asked: tuple[Question, tuple[str, ...], int | None]
    explanation: Explanation
    text: str
    report: str


class Answers:
    """Answers from what was prepared.

    `publish` is called with each answer's text and its JSON, one answer at a time,
    so that both are always of the same one, and never with an answer to older inputs
    after one to newer inputs. `last` is the one given last.
    """

    def __init__(self, publish: Callable[[str, str], None]) -> None:
        self.last: Explanation | None = None
        self._publish = publish
        self._published = 0
        self._turn = threading.Lock()
        self._closed = False
        self._newest = 0
        self._goal = ''
        self._said: list[str] = []
        self._last_episode: int | None = None
        self._made_for: Preparation | None = None
        self._made: dict[bool, _Made] = {}

    def make(self, preparation: Preparation, number: int, question: Question) -> None:
        """Make the answer to a question, so that a call finds it made.

        `number` grows with each update.
        """
        with self._turn:
            self._turn_to(preparation, number)
            self._get(preparation, question, ())

    def give(
        self, preparation: Preparation, number: int, question: Question, remember: bool
    ) -> str | None:
        """Publish the answer to a question, and return its text.

        With `remember` it is conditioned on what was said, and counts as said. Sentences
        that are not in the plan are no part of it. Returns None where its turn does not
        come within TURN_SECONDS, or after `close`.
        """
        if not self._turn.acquire(timeout=TURN_SECONDS):
            return None
        try:
            if self._closed:
                return None
            self._turn_to(preparation, number)
            said = [s for s in self._said if remember and s in preparation.model.sentences]
            made = self._get(preparation, question, tuple(said))
            if remember:
                self._said += made.explanation.sentences
            if preparation.situation is not None:
                self._last_episode = preparation.situation.number
            if number >= self._published:
                self._published = number
                self.last = made.explanation
                self._publish(made.text, made.report)
            return made.text
        finally:
            self._turn.release()

    def close(self) -> None:
        """Give no more answers, so that nobody waits for a turn."""
        self._closed = True

    def forget(self) -> int:
        """Forget what was said; return how many sentences that was."""
        with self._turn:
            count = len(self._said)
            self._said.clear()
            self._last_episode = None
            return count

    def _turn_to(self, preparation: Preparation, number: int) -> None:
        """Forget what was said of older plans: steps that are done; all, of another goal."""
        if number > self._newest:
            self._newest = number
            model = preparation.model
            kept = self._said if model.robot_goal.goal == self._goal else []
            self._said = [sentence for sentence in kept if sentence in model.sentences]
            self._goal = model.robot_goal.goal

    def _get(self, preparation: Preparation, question: Question, said: tuple[str, ...]) -> _Made:
        """Return the answer, which is kept; of those after something said the last one is."""
        if self._made_for is not preparation:
            self._made_for, self._made = preparation, {}
        situation, last = preparation.situation, self._last_episode
        if situation is None or last == situation.number:
            last = None  # the same to say as before anything was
        asked = (question, said, last)
        made = self._made.get(bool(said))
        if made is None or made.asked != asked:
            explanation = explain(preparation, question, said, last_episode=last)
            values = {**explanation.as_dict(hypotheses=False), 'inputs': preparation.inputs}
            report = json.dumps(values, ensure_ascii=False)
            made = _Made(asked, explanation, printable(explanation.spoken), printable(report))
            self._made[bool(said)] = made
        return made


def printable(text: str) -> str:
    """Return the text without what a ROS string can't carry, or may upset a terminal.

    That is control characters other than tab and end of line, and lone surrogates.
    """
    return _CONTROL.sub('', text).encode('utf-8', 'replace').decode('utf-8')
