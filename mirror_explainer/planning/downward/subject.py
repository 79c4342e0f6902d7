"""What searches are run for: tasks, whether grounded all at once or one by one."""

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

from mirror_explainer.planning.beliefs import Belief, BeliefPlans
from mirror_explainer.planning.downward.ground_task import Actions
from mirror_explainer.planning.downward.portfolio import Try


@dataclass(frozen=True)
class Finding:
    """Optimal plans, none where there is provably none; `all` says that these are all of them."""

    plans: tuple[Actions, ...]
    all: bool = False


@dataclass(frozen=True)
class SearchInput:
    """What a search reads, which searches to try on it, and what suits it in all likelihood."""

    text: bytes
    members: Sequence[str]
    lesson: Try | None = None


@dataclass(eq=False, kw_only=True)
class Subject:
    """One task, and the beliefs that are this task.

    `hopeless` says that a search is known to take too long; `lesson` is what suited it. `parents`
    are tasks like it that are planned for before.
    """

    members: list[Belief] = field(default_factory=list)
    parents: list[Any] = field(default_factory=list)
    hopeless: bool = False
    lesson: Try | None = None


class Subjects(Protocol):
    """The tasks to plan for. Those in `ready` may be planned for now, in this order.

    `provisional` says that their plans will be joined by others.
    """

    ready: deque[Any]
    provisional: bool

    def known(self, subject: Any) -> Finding | None:
        """Return what is known of a ready subject without a search, None if nothing."""

    def search_input(self, subject: Any) -> SearchInput:
        """Return what is to be searched for a subject of which nothing is known."""

    def checked(self, subject: Any, plans: Sequence[Actions]) -> Finding | None:
        """Return what the plans that a search gives come to, None if they are wrong."""

    def settle(self, subject: Any, finding: Finding | None) -> BeliefPlans | None:
        """Take in all that will be known of a subject; return what it says of the beliefs."""
