"""What an explanation is made from, and where its making stands."""

import hashlib
from dataclasses import dataclass, field
from enum import Enum
from functools import cached_property

from mirror_explainer.explainer import Preparation
from mirror_explainer.input_limits import InputLimits
from mirror_explainer.node.moment import Moment
from mirror_explainer.settings import PlanningSettings


@dataclass(frozen=True)
class Text:
    """A text from outside, the file or topic that it came from, and when."""

    text: str
    source: str
    heard: Moment = field(default_factory=Moment, compare=False, repr=False)


@dataclass(frozen=True)
class Inputs:
    """The newest of everything that an explanation is made from, None where nothing came yet.

    `domain_file` stands in for a domain that was not heard; `files_revision` is
    another one after each change of the files that are read.
    """

    domain: Text | None = None
    domain_file: str = ''
    problem: Text | None = None
    plan: Text | None = None
    user_model_file: str = ''
    files_revision: object = None
    max_beliefs: int = PlanningSettings.max_beliefs
    plans_per_belief: int = PlanningSettings.plans_per_belief
    deadline: float | None = None
    limits: InputLimits = field(default_factory=InputLimits)

    @property
    def missing(self) -> tuple[str, ...]:
        """What has to come before there is anything to explain."""
        present = {
            'domain (topic, or parameter domain_file)': self.domain or self.domain_file,
            'problem (topic)': self.problem,
            'plan (topic)': self.plan,
            'user model (parameter user_model_file)': self.user_model_file,
        }
        return tuple(name for name, value in present.items() if not value)

    @cached_property
    def digest(self) -> str:
        """A short text that is the same for equal inputs, also in another process."""
        return hashlib.blake2b(repr(self).encode(), digest_size=8).hexdigest()


class Phase(Enum):
    """What the updates are doing."""

    WAITING = 'waiting'
    WORKING = 'planning'
    READY = 'ready'
    ERROR = 'error'


@dataclass(frozen=True)
class State:
    """Where things stand: `message` says it in words, `preparation` is there when READY.

    `inputs` are those that it is about, the `number`-th that were submitted; `cure` says
    what a person can do about it. `since` is when it came to be so. `blamed` is the file or
    topic of a wrong input; `may_pass` says that the inputs are not to blame, so that another
    attempt may go better.
    """

    phase: Phase
    message: str
    preparation: Preparation | None = None
    inputs: Inputs = field(default_factory=Inputs)
    cure: str = ''
    since: Moment = field(default_factory=Moment)
    blamed: str = ''
    may_pass: bool = False
    number: int = 0

    @property
    def blames_plan(self) -> bool:
        """Whether the plan is wrong, by itself or for the problem that came with it."""
        return self.inputs.plan is not None and self.blamed == self.inputs.plan.source
