"""How ready the explainer is to answer."""

from dataclasses import dataclass, field, replace
from enum import Enum

from mirror_explainer.listener.preparation import Preparation
from mirror_explainer.node.inputs import Inputs
from mirror_explainer.node.moment import Moment

_REPORT = 'Report it with the log and the inputs; the next input is tried all the same.'


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

    def at(self, newer: 'Readiness') -> 'Readiness':
        """Return what it is for newer inputs, which are progress in the same task."""
        preparation = self.preparation
        if preparation is not None and newer.preparation is not None:
            preparation = preparation.at(newer.preparation)
        return replace(self, preparation=preparation, inputs=newer.inputs, number=newer.number)

    def is_no_better_than(self, now: 'Readiness') -> bool:
        """Whether another attempt changed nothing: the same error, or as many beliefs failed."""
        if now.phase is Phase.PLANNING:  # this is the first attempt
            return False
        if self.phase is Phase.PLANNING:  # another one takes no answer away while it goes on
            return True
        if self.phase is Phase.ERROR:
            return self.message == now.message if now.phase is Phase.ERROR else self.may_pass
        if self.preparation is None or now.phase is not Phase.READY or now.preparation is None:
            return False
        return self.preparation.failed_beliefs >= now.preparation.failed_beliefs


def planning(preparation: Preparation, done: int) -> Readiness:
    """Return the readiness while `done` beliefs are planned for, and others are not."""
    beliefs = len(preparation.prior.beliefs)
    return Readiness(Phase.PLANNING, f'planning {done} of {beliefs}', preparation)


def internal_error(error: Exception) -> Readiness:
    """Return the readiness after a fault of this package."""
    message = f'internal error, please report it: {error!r}'
    return Readiness(Phase.ERROR, message, cure=_REPORT, may_pass=True)
