"""What searches are run for: tasks, whether grounded all at once or one by one."""

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

from mirror_explainer.planning.beliefs import Belief


@dataclass(frozen=True)
class Finding:
    """A plan, or None where there is provably none; `optimal` says that none is cheaper."""

    plan: tuple[str, ...] | None
    optimal: bool = True


class Subject(Protocol):
    """One task, and the beliefs that are this task.

    `hopeless` says that an optimal search is known to take too long.
    """

    members: list[Belief]
    hopeless: bool


class Subjects(Protocol):
    """The tasks to plan for. Those in `ready` may be planned for now, in this order."""

    ready: deque[Any]

    def known(self, subject: Any) -> Finding | None:
        """Return what is known of a ready subject without a search, None if nothing."""

    def stand_in(self, subject: Any) -> tuple[str, ...] | None:
        """Return the cheapest known plan that works, None if none is known."""

    def search_input(self, subject: Any) -> tuple[bytes, tuple[str, ...]]:
        """Return the input of the search, and configurations that are optimal, to try in order."""

    def checked(self, subject: Any, actions: Sequence[str]) -> tuple[str, ...] | None:
        """Return the plan in a search's actions, None if it does not reach the goal."""

    def cost(self, subject: Any, plan: Sequence[str]) -> float:
        """Return a plan's cost, in the problem's metric."""

    def settle(self, subject: Any, finding: Finding | None) -> None:
        """Take in all that will be known of a subject, None if that is nothing."""
