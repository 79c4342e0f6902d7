"""FIND-MOST-INFORMATIVE of Algorithm 1 to the letter: all sets of a size, by matrix products."""

import itertools
import math
import time
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mirror_explainer.selection.evidence import Evidence, Floats

TIE = 1e-9  # nats; gains that differ by less are equal
# Of so many kinds of hypotheses on, sums of single precision tell first which sets are near the
# best: within this many nats, which is far more than they may be off.
_MANY_KINDS = 4096
_ROUNDING = 1e-4
_MOST_NEAR = 50
_AT_A_TIME = 2048  # kinds, so that what is multiplied stays in a processor's cache
# Rough costs on one core: of a product, and of one multiplication and addition in it.
_SECONDS_A_PRODUCT = 4e-5
_SECONDS_AN_OPERATION = 2.4e-10


class OutOfTime(Exception):
    """The time was up before all sets were looked at."""


def seconds_to_enumerate(evidence: Evidence, size: int) -> float:
    """Return roughly how long it takes to look at all sets of a size."""
    kinds, sentences = evidence.ratio.shape
    fitting = float((evidence.ratio[:: 1 + kinds // 256] > 0).mean()) if size > 2 else 1.0
    prefixes = math.comb(sentences, max(size - 2, 0))
    pairs = (sentences / max(size - 1, 1)) ** 2
    operations = kinds * fitting * pairs
    return float(prefixes * (_SECONDS_A_PRODUCT + _SECONDS_AN_OPERATION * operations))


def best_of_all(evidence: Evidence, size: int, end: float) -> tuple[int, ...]:
    """Return the columns of the set of `size` ≥ 1 sentences that leaves the least doubt.

    Of those within 1e-9 nats of it, the one with the latest last position, then the latest
    last but one, and so on. Raises OutOfTime at `end` (of time.monotonic()).
    """
    if len(evidence.ratio) >= _MANY_KINDS:
        near = _near_the_best(evidence, size, end)
        if near:
            return _latest([(evidence.doubt_after(columns), columns) for columns in near])
    best: list[tuple[float, tuple[int, ...]]] = []
    for prefix, doubts in _by_prefix(evidence, evidence.ratio, size, end):
        least = min([float(doubts.min()), *(doubt for doubt, _ in best)])
        best = [(doubt, columns) for doubt, columns in best if doubt <= least + TIE]
        tied = np.argwhere(doubts <= least + TIE)
        if len(tied):
            last = tied[np.lexsort(tied.T)[-1]]  # by the last column, then the one before
            best.append((float(doubts[tuple(last)]), prefix + tuple(last.tolist())))
    return _latest(best)


def _latest(found: list[tuple[float, tuple[int, ...]]]) -> tuple[int, ...]:
    """Return of the sets that leave the least doubt the latest."""
    least = min(doubt for doubt, _ in found)
    tied = (columns for doubt, columns in found if doubt <= least + TIE)
    return max(tied, key=lambda columns: columns[::-1])


def _near_the_best(evidence: Evidence, size: int, end: float) -> list[tuple[int, ...]]:
    """Return the sets that may be the best by sums of single precision; none if there are many."""
    near: list[tuple[float, tuple[int, ...]]] = []
    least = math.inf
    for prefix, doubts in _by_prefix(evidence, evidence.ratio.astype(np.float32), size, end):
        least = min(least, float(doubts.min()))
        near = [(doubt, columns) for doubt, columns in near if doubt <= least + _ROUNDING]
        found = np.argwhere(doubts <= least + _ROUNDING)
        if len(near) + len(found) > _MOST_NEAR:
            return []
        near += [(float(doubts[tuple(c)]), prefix + tuple(c)) for c in found.tolist()]
    return [columns for _, columns in near]


def _by_prefix(
    evidence: Evidence, ratio: NDArray[Any], size: int, end: float
) -> Iterator[tuple[tuple[int, ...], Floats]]:
    """Yield the doubts that sets leave, for each choice of all but their last two columns.

    `ratio` is the evidence's, in any precision. The doubts have shape (T,) for sets of one,
    else (T, T), with infinity where the columns do not ascend.
    """
    weight = evidence.weight.astype(ratio.dtype)
    if size == 1:
        yield (), evidence.doubt.of(ratio.T @ weight, evidence.robot)
        return
    sentences = ratio.shape[1]
    descending = np.tril(np.ones((sentences, sentences), dtype=bool))
    for prefix in itertools.combinations(range(sentences - 2), size - 2):
        if time.monotonic() > end:
            raise OutOfTime
        first = prefix[-1] + 1 if prefix else 0
        fit = ratio[:, list(prefix)].prod(axis=1)
        masses = _masses_of_pairs(ratio[:, first:], weight * fit[:, None])
        doubts = np.full((sentences, sentences), np.inf)
        doubts[first:, first:] = evidence.doubt.of(masses, evidence.robot)
        doubts[descending] = np.inf
        yield prefix, doubts


def _masses_of_pairs(ratio: NDArray[Any], weight: NDArray[Any]) -> Floats:
    """Σ_k w_k r_ki r_kj for each pair of T columns and each of the four weights, (T, T, 4)."""
    masses = np.zeros((ratio.shape[1], ratio.shape[1], weight.shape[1]))
    for place, share in enumerate(weight.T):
        left = np.flatnonzero(share)
        for start in range(0, len(left), _AT_A_TIME):
            rows = left[start : start + _AT_A_TIME]
            some = ratio[rows]
            masses[..., place] += (some * share[rows, None]).T @ some
    return masses
