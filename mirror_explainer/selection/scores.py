"""How large the sum of single gains can be among the most informative sets.

The tie-break maximises Σ_i gain_i over sets with F(o) ≤ F*. What F* demands of
a set makes the bound on that sum sharp, so that few sets are looked at.
"""

from dataclasses import dataclass

import numpy as np

from mirror_explainer.selection.columns import ROUNDING, Columns, Floats, Ints, exp

MULTIPLIER_ROUNDS = 50


@dataclass(frozen=True)
class Scores:
    """What a set must do besides having large single gains, and what that is worth.

    No single hypothesis may keep F above the limit: a set has to hit it, or
    has to bring the cost that makes it small enough. Each copy does a share of
    that, and the shares of a set must add up to 1. Each condition has a
    multiplier λ ≥ 0 (Lagrange), so that for all sets that meet them
    Σ_i gain_i ≤ Σ_i (gain_i + Σ_k λ_k share_ki) − Σ_k λ_k.
    """

    gain: Floats  # (P,) the single gain of each copy
    share: Floats  # (C, P) of C conditions
    multiplier: Floats  # (C,)

    @classmethod
    def of(cls, columns: Columns, start: Ints, limit: float, target: float) -> 'Scores':
        """Find multipliers that bound the gains of sets as large as `start` near `target`.

        `limit` is that of F, relative to `start`.
        """
        n = int(start.sum())
        log_weight = columns.log_weight - columns.log_value(start)
        unhit = exp(log_weight + columns.least[:, n])
        floor = np.where(columns.hits.any(axis=1), 0.0, unhit)
        slack = np.maximum(limit - (floor.sum() - floor), 0.0) + ROUNDING
        needed = log_weight + n * columns.largest - np.log(slack)  # (K,) cost
        share = np.minimum(columns.cost / np.maximum(needed, ROUNDING)[:, None], 1.0)
        share[unhit > slack] = 0.0
        share = np.where(columns.hits > 0, 1.0, share)[needed > 0]

        gain = columns.single_gain[columns.sentence]
        multiplier = np.zeros(len(share))
        best, lowest, reach = multiplier, np.inf, 1.0
        for _ in range(MULTIPLIER_ROUNDS):
            score = gain + multiplier @ share
            top = np.argpartition(-score, n - 1)[:n]
            highest = float(score[top].sum() - multiplier.sum())
            if highest < lowest:
                best, lowest = multiplier, highest
            else:
                reach *= 0.9
            excess = share[:, top].sum(axis=1) - 1.0
            excess[(multiplier == 0) & (excess > 0)] = 0.0
            if highest <= target or not excess.any():
                break
            step = reach * (highest - target) / (excess @ excess)
            multiplier = np.maximum(multiplier - step * excess, 0.0)
        return cls(gain, share[best > 0], best[best > 0])

    def counts_between(
        self,
        columns: Columns,
        n: int,
        least_gain: float,
    ) -> tuple[Ints, Ints]:
        """The fewest and the most copies (T,) in any set that reaches `least_gain`."""
        score = self.gain + self.multiplier @ self.share
        order = np.argsort(-score, kind='stable')
        score = score[order]
        spare = score[:n].sum() - self.multiplier.sum() - least_gain + ROUNDING * n
        needed = np.zeros(len(order), dtype=np.int64)
        possible = np.zeros(len(order), dtype=np.int64)
        needed[order[:n]] = score[:n] - score[n] > spare
        possible[order[:n]] = 1
        possible[order[n:]] = score[n - 1] - score[n:] <= spare
        first = columns.first_copy
        return np.add.reduceat(needed, first), np.add.reduceat(possible, first)
