"""How ready the explainer is to answer."""

from dataclasses import dataclass, field
from enum import Enum

from mirror_explainer.listener.preparation import Preparation
from mirror_explainer.node.inputs import Inputs
from mirror_explainer.node.moment import Moment


class Phase(Enum):
    """What an update is doing, or how it ended."""

    WAITING = 'waiting'
    PLANNING = 'planning'
    READY = 'ready'
    ERROR = 'error'


@dataclass(frozen=True)
class Readiness:
    """Where an update stands: `message` says it in words, `preparation` is what to answer from.

    That is there once the texts are read, and is refined while planning goes on.

    `inputs` are those that it is about, the `number`-th that were submitted; `cure` says
    what a person can do about it. `since` is when it came to be so. `blamed` is the file or
    topic of a wrong input; `may_pass` says that the inputs are not to blame, so that another
    attempt may go better. `spoken` is what a person hears of it instead of the message.
    """

    phase: Phase
    message: str
    preparation: Preparation | None = None
    inputs: Inputs = field(default_factory=Inputs)
    cure: str = ''
    since: Moment = field(default_factory=Moment)
    blamed: str = ''
    may_pass: bool = False
    spoken: str = ''
    number: int = 0

    @property
    def blames_plan(self) -> bool:
        """Whether the plan is wrong, by itself or for the problem that came with it."""
        return self.inputs.plan is not None and self.blamed == self.inputs.plan.source

    def is_no_better_than(self, now: 'Readiness') -> bool:
        """Whether another attempt changed nothing: the same error, or as many beliefs failed."""
        if now.phase is Phase.PLANNING:  # this is the first attempt
            return False
        if now.preparation is None:
            return self.phase is Phase.ERROR and self.message == now.message
        if self.preparation is None:
            return self.may_pass
        return self.preparation.failed_beliefs >= now.preparation.failed_beliefs
