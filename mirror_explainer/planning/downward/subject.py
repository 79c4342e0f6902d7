"""What searches are run for: tasks, whether grounded all at once or one by one."""

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

from mirror_explainer.planning.beliefs import Belief, BeliefPlans


@dataclass(frozen=True)
class Finding:
    """An optimal plan, or None where there is provably none."""

    plan: tuple[str, ...] | None


class Subject(Protocol):
    """One task, and the beliefs that are this task.

    `hopeless` says that a search is known to take too long.
    """

    members: list[Belief]
    hopeless: bool


class Subjects(Protocol):
    """The tasks to plan for. Those in `ready` may be planned for now, in this order.

    `required` says that beliefs depend on these for any result at all; `provisional` that
    their plans will be joined by others. `first_try` is how many seconds a search may
    take when there is another left to try.
    """

    ready: deque[Any]
    required: bool
    provisional: bool
    first_try: float

    def known(self, subject: Any) -> Finding | None:
        """Return what is known of a ready subject without a search, None if nothing."""

    def search_input(self, subject: Any) -> tuple[bytes, tuple[str, ...]]:
        """Return the input of the search, and configurations that are optimal, to try in order."""

    def checked(self, subject: Any, actions: Sequence[str]) -> tuple[str, ...] | None:
        """Return the plan in a search's actions, None if it does not reach the goal."""

    def settle(self, subject: Any, finding: Finding | None) -> None:
        """Take in all that will be known of a subject, None if that is nothing."""

    def result(self, subject: Any, finding: Finding | None) -> BeliefPlans | None:
        """Return the beliefs' result after `settle`, None if there is none yet."""
