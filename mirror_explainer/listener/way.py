"""The robot's own way: its plan, what is said of it, and what it is seen to be for."""

from dataclasses import dataclass

from mirror_explainer.listener.ends import Aim
from mirror_explainer.planning import Plan


@dataclass(frozen=True)
class Way:
    """π_R and what it does: its sentence at each plan position, and the aims it is seen by.

    `aims` are for each candidate goal its own first, then those that lack one of its parts.
    """

    plan: Plan
    sentences: tuple[str, ...]
    aims: tuple[tuple[Aim, ...], ...]
