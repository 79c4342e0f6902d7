"""What the operator's page has heard of an explainer: values only, no ROS and no HTTP."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace

from pydantic import TypeAdapter, ValidationError

from mirror_explainer.errors import InputError


@dataclass(frozen=True)
class Goal:
    """A candidate goal, and how likely the listener finds it before and after the answer."""

    name: str
    prior: float
    posterior: float


@dataclass(frozen=True)
class Step:
    """An action of the plan; `information_gain` is what it would tell alone, in nats."""

    position: int
    action: str
    sentence: str
    information_gain: float


@dataclass(frozen=True)
class Answer:
    """An answer, as `~/explanation` has it; the README says what the names mean."""

    strategy: str
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

    `state` and `inputs` are the values of these keys, and `cure` that of `what to do`,
    '' where there are none.
    """

    level: int
    message: str
    state: str = ''
    inputs: str = ''
    cure: str = ''

    @classmethod
    def of(cls, level: int, message: str, values: Mapping[str, str]) -> 'Status':
        """Return the status that a message with these values tells."""
        cure = values.get('what to do', 'nothing')
        return cls(
            level,
            message,
            values.get('state', ''),
            values.get('inputs', ''),
            '' if cure == 'nothing' else cure,
        )


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
    status is no news any more.
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

    @property
    def state(self) -> str:
        """The explainer's state, as far as it is known."""
        return 'silent' if self.status is None or self.silent else self.status.state

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
