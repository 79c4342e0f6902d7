"""What `Planner` and its worker processes say to one another, besides beliefs."""

from dataclasses import dataclass

from mirror_explainer.errors import InputError, PlanningError
from mirror_explainer.planning.beliefs import BeliefPlans, BeliefSpace, Status


@dataclass(frozen=True)
class Setup:
    """To an engine's worker: read this space. It answers None, or a Refusal."""

    engine: str
    space: BeliefSpace
    memory_limit: int


@dataclass(frozen=True)
class Refusal:
    """From a worker: why the space cannot be planned for.

    `sentence` says it in full. `place` is the (source, reason, line) of an
    InputError, None when the input is not to blame.
    """

    sentence: str
    place: tuple[str, str, int | None] | None = None

    def error(self) -> InputError | PlanningError:
        """Return the error to raise in the calling process."""
        return InputError(*self.place) if self.place else PlanningError(self.sentence)


@dataclass(frozen=True)
class Attempt:
    """From a worker: the result for one belief, and whether the engine failed at it."""

    result: BeliefPlans
    crashed: bool = False


def unknown(reason: str, crashed: bool = False) -> Attempt:
    """Return the attempt that leaves a belief unknown."""
    return Attempt(BeliefPlans(Status.UNKNOWN, reason=reason), crashed)
