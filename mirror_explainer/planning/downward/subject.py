"""What searches are run for: tasks, whether grounded all at once or one by one."""

from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

from mirror_explainer.planning.beliefs import Belief, BeliefPlans, Plan, Status


@dataclass(frozen=True)
class Finding:
    """A plan, or None where there is provably none; `optimal` says that none is cheaper."""

    plan: tuple[str, ...] | None
    optimal: bool = True

    def result(self, cost: Callable[[tuple[str, ...]], float], reason: str) -> BeliefPlans:
        """Return the finding as a belief's result; `reason` says why a plan is not optimal."""
        if self.plan is None:
            return BeliefPlans(Status.UNSOLVABLE)
        plan = Plan(self.plan, cost(self.plan), self.optimal)
        return BeliefPlans(Status.SOLVED, (plan,), reason)


class Subject(Protocol):
    """One task, and the beliefs that are this task.

    `hopeless` says that an optimal search is known to take too long.
    """

    members: list[Belief]
    hopeless: bool


class Subjects(Protocol):
    """The tasks to plan for. Those in `ready` may be planned for now, in this order.

    `required` says that beliefs depend on these for any result at all;
    `provisional` that their optimal plans will be joined by others. `first_try` is
    how many seconds an optimal search may take when there is another left to try.
    """

    ready: deque[Any]
    required: bool
    provisional: bool
    first_try: float

    def known(self, subject: Any) -> Finding | None:
        """Return what is known of a ready subject without a search, None if nothing."""

    def stand_in(self, subject: Any) -> tuple[str, ...] | None:
        """Return the cheapest known plan that works, None if none is known."""

    def search_input(self, subject: Any) -> tuple[bytes, tuple[str, ...]]:
        """Return the input of the search, and configurations that are optimal, to try in order."""

    def checked(self, subject: Any, actions: Sequence[str]) -> tuple[str, ...] | None:
        """Return the plan in a search's actions, None if it does not reach the goal."""

    def result(self, subject: Any, finding: Finding, reason: str) -> BeliefPlans | None:
        """Return the beliefs' result after `settle`, None if there is none yet."""

    def settle(self, subject: Any, finding: Finding | None) -> None:
        """Take in all that will be known of a subject, None if that is nothing."""
