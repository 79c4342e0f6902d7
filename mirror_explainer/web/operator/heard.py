"""What the operator's page has heard of an explainer: values only, no ROS and no HTTP."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, replace

from pydantic import TypeAdapter, ValidationError

from mirror_explainer.errors import InputError


@dataclass(frozen=True)
class Goal:
    """A candidate goal, and how likely the listener finds it before and after the answer.

    `name` is None for all that lacks a part of every candidate.
    """

    name: str | None
    prior: float
    posterior: float


@dataclass(frozen=True)
class Fact:
    """An uncertain fact, likewise, and whether it holds."""

    fact: str
    prior: float
    posterior: float
    true: bool


@dataclass(frozen=True)
class Step:
    """An action of the plan; `information_gain` is what it would tell alone, in nats.

    `status` says whether it is `done`, `skipped`, `running` or `ahead`; `tenses` is its sentence
    in each.
    """

    position: int
    action: str
    sentence: str
    information_gain: float
    status: str = 'ahead'
    tenses: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Baseline:
    """What the first or the last steps, as many as are said, would have told instead."""

    strategy: str
    understanding: float


@dataclass(frozen=True)
class Episode:
    """Which of the robot's tasks an answer is about, and why it began."""

    number: int
    reason: str = ''


@dataclass(frozen=True)
class Answer:
    """An answer, as `~/explanation` has it; docs/answer.md says what the names mean."""

    strategy: str
    spoken: str
    sentences: tuple[str, ...]
    positions: tuple[int, ...]
    cross_entropy_before: float
    cross_entropy_after: float
    understanding_before: float
    understanding: float
    true_goal: str
    optimal: bool
    complete: bool
    goals: tuple[Goal, ...]
    plan: tuple[Step, ...]
    inputs: str
    planned: float = 1.0
    unmentioned: tuple[str, ...] = ()
    in_words: Mapping[str, str] = field(default_factory=dict)
    facts: tuple[Fact, ...] = ()
    baselines: tuple[Baseline, ...] = ()
    episode: Episode | None = None

    def called(self, goal: str) -> str:
        """Return what a goal, or a part of one, is called."""
        return self.in_words.get(goal, goal)

    def comparable(self, other: 'Answer') -> bool:
        """Whether both are about the same plan, for a listener who knew as much before."""
        return (self.inputs, self.cross_entropy_before) == (
            other.inputs,
            other.cross_entropy_before,
        )


_ANSWER = TypeAdapter(Answer)


def read_answer(text: str, source: str) -> Answer:
    """Return the answer from its JSON. Raises InputError, with `source`, for anything else."""
    try:
        return _ANSWER.validate_json(text)
    except ValidationError as error:
        first = error.errors()[0]
        place = '.'.join(map(str, first['loc']))
        reason = f'this is no explanation ({place}: {first["msg"]})'
        raise InputError(source, reason) from error


@dataclass(frozen=True)
class Status:
    """The newest of the explainer's diagnostics; `level` is that of a DiagnosticStatus.

    `state` and `inputs` are the values of these keys, and `cure` that of `what to do`, ''
    where there are none. `episode` is the number of the task that the robot has now, 0 for an
    explainer that tells none, or has not answered yet: its numbers are not those of an answer
    that was heard. Of the task's plan `done` steps are done, and `running` go on.
    """

    level: int
    message: str
    state: str = ''
    inputs: str = ''
    cure: str = ''
    episode: int = 0
    done: int = 0
    running: int = 0

    @classmethod
    def of(cls, level: int, message: str, values: Mapping[str, str]) -> 'Status':
        """Return the status that a message with these values tells."""
        cure = values.get('what to do', 'nothing')
        answers = values.get('calls answered', '0') != '0'
        return cls(
            level,
            message,
            values.get('state', ''),
            values.get('inputs', ''),
            '' if cure == 'nothing' else cure,
            _number(r'\d+', values.get('episode')) if answers else 0,
            _number(r'\d+(?= done)', values.get('progress')),
            _number(r'\d+(?= running)', values.get('progress')),
        )

    def task(self) -> str:
        """Return what stands for the robot's present task: the episode, or else the inputs."""
        return str(self.episode) if self.episode else self.inputs


def _number(pattern: str, text: str | None) -> int:
    """Return the first number of a text that is like this, 0 where there is none."""
    found = re.search(pattern, text or '')
    return int(found[0]) if found else 0


@dataclass(frozen=True)
class Settings:
    """Those of the explainer's parameters that the page shows, by their names."""

    n: int
    strategy: str
    threshold: float
    remember: bool
    answer_timeout: float

    @classmethod
    def of(cls, values: Sequence[object]) -> 'Settings | None':
        """Return the settings with these values, in this order; None where one is no such."""
        try:
            return _SETTINGS.validate_python(dict(zip(SETTINGS, values, strict=True)))
        except (ValidationError, ValueError):
            return None


SETTINGS = tuple(field.name for field in fields(Settings))
_SETTINGS = TypeAdapter(Settings)


@dataclass(frozen=True)
class Failure:
    """Why there was no answer, the clock's time, and the explainer's state at that time."""

    reason: str
    at: str
    state: str


@dataclass(frozen=True)
class Heard:
    """All that was heard of the explainer, None where nothing was yet.

    `tried` has the answers to compare: about the newest plan, one for each strategy
    and number of sentences. Times are the clock's, in words; `silent` says that the
    status is no news any more, and `restarts` that the robot is one that can begin again.
    """

    explainer: str
    answer: Answer | None = None
    answered_at: str = ''
    tried: tuple[Answer, ...] = ()
    status: Status | None = None
    status_at: str = ''
    silent: bool = False
    settings: Settings | None = None
    failure: Failure | None = None
    restarts: bool = False

    @property
    def state(self) -> str:
        """The explainer's state, as far as it is known."""
        return 'silent' if self.status is None or self.silent else self.status.state

    @property
    def is_current(self) -> bool:
        """Whether the answer is about the task that the robot has now, as far as is known.

        A step that is done changes the inputs, but not the task.
        """
        if self.answer is None or self.status is None:
            return False
        if self.status.episode and self.answer.episode:
            return self.status.episode == self.answer.episode.number
        return self.status.inputs == self.answer.inputs

    def with_answer(self, answer: Answer, at: str) -> 'Heard':
        """Return what was heard, and now this answer."""
        others = (
            other
            for other in self.tried
            if other.comparable(answer)
            and (other.strategy, len(other.positions)) != (answer.strategy, len(answer.positions))
        )
        tried = sorted((*others, answer), key=lambda a: (a.strategy, len(a.positions)))
        return replace(self, answer=answer, answered_at=at, tried=tuple(tried), failure=None)

    def with_failure(self, reason: str, at: str) -> 'Heard':
        """Return what was heard, and now why there is no answer."""
        return replace(self, failure=Failure(reason, at, self.state))
