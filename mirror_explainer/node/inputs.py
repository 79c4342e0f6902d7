"""What an explanation is made from: texts from the robot, files, and what the parameters say."""

import hashlib
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

from mirror_explainer.input_limits import InputLimits
from mirror_explainer.node.moment import Moment
from mirror_explainer.settings import PlanningSettings, Question, setting

# The topics that are heard; a robot need not publish its progress.
TOPICS = ('domain', 'problem', 'plan', 'progress')
# A robot publishes its plan and its progress in this order, but they may come in the other.
TOGETHER_SECONDS = 1.0


@dataclass(frozen=True)
class NodeSettings:
    """What the node may be told beside planning, answering and limits."""

    domain_file: str = setting(
        '', 'PDDL domain; a message on "domain" replaces it', fixed=True, metavar='FILE'
    )
    user_model_file: str = setting('', 'YAML: what the listener may believe', metavar='FILE')
    goals_seen_file: str = setting(
        '', 'YAML: where the goals of the robot are counted, if at all', fixed=True, metavar='FILE'
    )
    remember: bool = setting(False, 'whether each answer conditions the next')
    answer_timeout: float = setting(
        1.0, 's, that a call waits for planning to be done', least=0.0, most=1e6, metavar='S'
    )


@dataclass(frozen=True)
class Configuration:
    """All that a running explainer may be told."""

    node: NodeSettings = field(default_factory=NodeSettings)
    question: Question = field(default_factory=Question)
    planning: PlanningSettings = field(default_factory=PlanningSettings)
    limits: InputLimits = field(default_factory=InputLimits)


@dataclass(frozen=True)
class Text:
    """A text from outside, the file or topic that it came from, and when.

    `earlier` is when the message before it was heard there, whatever its text.
    """

    text: str
    source: str
    heard: Moment = field(default_factory=Moment, compare=False, repr=False)
    earlier: Moment | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True)
class Inputs:
    """The newest of everything that an explanation is made from, None where nothing came yet.

    The `progress` need not come at all. `domain_file` stands in for a domain that was not
    heard; `files_revision` is another one after each change of the files that are read.
    """

    domain: Text | None = None
    domain_file: str = ''
    problem: Text | None = None
    plan: Text | None = None
    progress: Text | None = None
    user_model_file: str = ''
    files_revision: object = None
    planning: PlanningSettings = field(default_factory=PlanningSettings)
    limits: InputLimits = field(default_factory=InputLimits)

    def hearing(self, name: str, text: Text) -> 'Inputs':
        """Return the inputs with a text in place of the one before of that name."""
        before: Text | None = getattr(self, name)
        changed: dict[str, Any] = {name: replace(text, earlier=before.heard if before else None)}
        return replace(self, **changed)

    @property
    def missing(self) -> tuple[str, ...]:
        """What has to come before there is anything to explain."""
        present = {
            'domain (topic, or parameter domain_file)': self.domain or self.domain_file,
            'problem (topic)': self.problem,
            'plan (topic)': self.plan,
        }
        return tuple(name for name, value in present.items() if not value)

    @property
    def newest(self) -> Moment:
        """When the last of problem, plan and progress was heard."""
        texts = filter(None, (self.problem, self.plan, self.progress))
        return max((text.heard for text in texts), key=lambda moment: moment.steady)

    @property
    def is_plan_newer(self) -> bool:
        """Whether the plan came, or came again, after the progress."""
        return self._since_progress(self.plan) > 0.0

    @property
    def is_progress_old(self) -> bool:
        """Whether the progress came long before the plan: so it is about a plan before."""
        return self._since_progress(self.plan) > TOGETHER_SECONDS

    @property
    def begins_anew(self) -> bool:
        """Whether problem and plan both came, or came again, long after the progress."""
        return self.is_progress_old and self._since_progress(self.problem) > TOGETHER_SECONDS

    def _since_progress(self, text: Text | None) -> float:
        """Return how many seconds after the progress a text came, 0 where one is missing."""
        return text.heard.seconds_since(self.progress.heard) if text and self.progress else 0.0

    @cached_property
    def digest(self) -> str:
        """A short text that is the same for equal inputs, also in another process."""
        return hashlib.blake2b(repr(self).encode(), digest_size=8).hexdigest()
