"""What saying each sentence of a plan would tell a listener: the input of Algorithm 1."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

# Of the facts, less than this counts as not known at all (method, section 2).
LEAST_FACTS = 0.01
_SURPRISE = 0.5 + 1e-9
# Which share of the hypotheses a column of Evidence.weight holds.
ALL, GOAL, FORESEEN, BELIEF = range(4)


@dataclass(frozen=True)
class Doubt:
    """D of the method, section 2: what a listener does not know, in nats.

    Of *what* the robot is up to, and, weighed by `facts` (λ_f) and `way` (λ_w), of the facts
    and of its way. With `whole` it is the cross-entropy H of Eq. 1.
    """

    facts: float = 0.0
    way: float = 0.0
    whole: bool = False

    def of(self, masses: Floats, robot: float) -> Floats:
        """D where hypotheses of these masses are left, shape (..., 4); `robot` is that of π_R."""
        if self.whole:
            doubt: Floats = np.log(masses[..., ALL] / robot)
            return np.maximum(doubt, 0.0)
        doubt = np.log(masses[..., ALL] / masses[..., GOAL])
        if self.facts:
            known = np.maximum(masses[..., BELIEF] / masses[..., FORESEEN], LEAST_FACTS)
            doubt = doubt - self.facts * np.log(known)
        if self.way:
            doubt = doubt + self.way * np.log(masses[..., BELIEF] / robot)
        return np.maximum(doubt, 0.0)


@dataclass(frozen=True)
class Evidence:
    """T different sentences of π_R that may be said, to K kinds of hypotheses.

    `ratio`, shape (K, T): how much better each sentence fits a kind of hypotheses than π_R,
    P(s|π_k) / P(s|π_R) for the paper's listener. `weight`, shape (K, 4): how much of a kind's
    mass counts as any hypothesis, as one with the robot's goal, as a foreseen one with the
    robot's goal, and as one with the robot's belief; each a part of the one before, and given
    what was said already. `robot` is the mass of (π_R, b_R), for which every ratio is 1.
    `places` are the plan positions of each sentence, ascending; it stands for the last, and
    sentences are in the order of these. `means` are the columns of those that are no end of
    the robot's goal or another. What tells no more than `min_gain` nats is not worth a
    sentence; None: exactly as many are said as asked for.
    """

    ratio: Floats
    weight: Floats
    robot: float
    places: tuple[tuple[int, ...], ...]
    doubt: Doubt
    means: frozenset[int] = frozenset()
    min_gain: float | None = None

    @property
    def positions(self) -> tuple[int, ...]:
        """The plan position that each sentence stands for, ascending."""
        return tuple(places[-1] for places in self.places)

    @property
    def doubt_before(self) -> float:
        """D before any of the sentences is said."""
        return float(self.doubt.of(self.weight.sum(axis=0), self.robot))

    def doubt_after(self, columns: Sequence[int]) -> float:
        """D once the sentences of these columns are said."""
        fit = self.ratio[:, list(columns)].prod(axis=1)
        return float(self.doubt.of(fit @ self.weight, self.robot))

    @property
    def has_surprises(self) -> bool:
        """Whether a means may tell something worth knowing.

        That is of the facts, where those that are true are no more likely than not to who
        foresees the robot's ways; or of the way, for whoever asks for that.
        """
        masses = self.weight.sum(axis=0)
        return bool(self.doubt.way > 0 or masses[BELIEF] <= _SURPRISE * masses[FORESEEN])

    def leaves_an_end(self, columns: Sequence[int]) -> bool:
        """Whether there is an end besides these columns that would tell more of the goal."""
        others = set(range(len(self.places))) - self.means - set(columns)
        fit = self.ratio[:, list(columns)].prod(axis=1)
        masses = (self.ratio[:, sorted(others)] * fit[:, None]).T @ self.weight
        before = Doubt().of(fit @ self.weight, self.robot)
        return bool((before - Doubt().of(masses, self.robot) > (self.min_gain or 0.0)).any())

    def of_ends(self) -> 'Evidence':
        """The evidence of the ends alone; its columns are theirs, in order."""
        if not self.means:
            return self
        ends = [column for column in range(len(self.places)) if column not in self.means]
        places = tuple(self.places[column] for column in ends)
        return replace(self, ratio=self.ratio[:, ends], places=places, means=frozenset())
