"""The mirror model."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Evidence:
    """What saying each position of the robot's plan would tell: the input of Algorithm 1.

    `prior`, shape (K,): weights w_k of the K distinct hypotheses, given what
    was said before; they sum to 1. `ratio`, shape (K, P): the likelihood
    ratios r_k(s_i) = P(s_i|π_k) / P(s_i|π_R) of the P positions that may be
    said. `positions`, shape (P,): their places in the plan, ascending, from 0.
    The robot's own hypothesis has ratio 1 everywhere.
    """

    prior: np.ndarray
    ratio: np.ndarray
    positions: np.ndarray

    def information_gain(self, columns: Sequence[int]) -> float:
        """IG(o) = −log Σ_k w_k ∏_{i∈o} r_k(s_i), in nats (Eq. 3), o given as column indices."""
        return float(-np.log(self.prior @ self.ratio[:, list(columns)].prod(axis=1)))
