"""What `Planner` and its worker processes say to one another, besides beliefs."""

from dataclasses import dataclass

from mirror_explainer.errors import InputError, PlanningError
from mirror_explainer.planning.beliefs import Belief, BeliefPlans, BeliefSpace, Status
from mirror_explainer.planning.limits import Resources


@dataclass(frozen=True)
class Setup:
    """To an engine's worker: read this space. It answers None, or a Refusal.

    The resources are for each belief of the space, sent later, and the worker itself.
    """

    engine: str
    space: BeliefSpace
    resources: Resources


@dataclass(frozen=True)
class Refusal:
    """From a worker: why the space cannot be planned for.

    `sentence` says it in full, `cure` what to do about it. `place` is the (source,
    reason, line) of an InputError, None when the input is not to blame.
    """

    sentence: str
    cure: str
    place: tuple[str, str, int | None] | None = None

    def error(self) -> InputError | PlanningError:
        """Return the error to raise in the calling process."""
        if self.place:
            return InputError(*self.place, cure=self.cure)
        return PlanningError(self.sentence, cure=self.cure)


@dataclass(frozen=True)
class Attempt:
    """From a worker: the result for one belief, and whether the engine failed at it.

    `lasting` is False for what more time until the deadline might have bettered.
    """

    result: BeliefPlans
    crashed: bool = False
    lasting: bool = True


def unknown(reason: str, crashed: bool = False) -> Attempt:
    """Return the attempt that leaves a belief unknown."""
    return Attempt(BeliefPlans(Status.UNKNOWN, reason=reason), crashed)


@dataclass(frozen=True)
class Ask:
    """To the worker of the fast way: plan for these beliefs.

    It answers with an empty list once the beliefs are grounded, then with lists of
    (belief, attempt) pairs, and at last with Done; or with Unfitting. The program `downward`
    searches, and for further plans `kstar`, '' if that is not here; all for `seconds` at most.
    The resources are for each search, and the worker itself.
    """

    space: BeliefSpace
    beliefs: tuple[Belief, ...]
    plans_per_belief: int
    downward: str
    kstar: str
    resources: Resources
    seconds: float


@dataclass(frozen=True)
class EndSearches:
    """To the worker of the fast way: end the searches, and answer Done."""


@dataclass(frozen=True)
class Done:
    """From the worker of the fast way: the call is over.

    `searching` is how many seconds were spent on starting searches and waiting for them,
    `worked` how much processor time these took.
    """

    calls: int
    searching: float
    way: str
    worked: float = 0.0


@dataclass(frozen=True)
class Unfitting:
    """From the worker of the fast way: it cannot take these texts, for this reason.

    `unexpected` says that this is not how the translator refuses a text: there is a
    fault in this program, or the translator is not the one it was written for.
    """

    reason: str
    unexpected: bool = False
