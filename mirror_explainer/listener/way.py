"""The robot's own way: its plan, what is said of it, and what it is seen to be for."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

from mirror_explainer.listener.ends import Aim
from mirror_explainer.planning import Plan


@dataclass(frozen=True)
class Way:
    """π_R, how its ground actions are said (any other's, too), and the aims it is seen by.

    `aims` are for each candidate goal its own first, then those that lack one of its parts.
    """

    plan: Plan
    sentence_of: Callable[[str], str]
    aims: tuple[tuple[Aim, ...], ...]

    @cached_property
    def sentences(self) -> tuple[str, ...]:
        """The sentence of each plan position."""
        return tuple(map(self.sentence_of, self.plan.actions))
