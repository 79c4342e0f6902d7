"""FIND-MOST-INFORMATIVE of Algorithm 1 to the letter: all sets of a size, by matrix products."""

import itertools
import math
import time
from collections.abc import Iterator

import numpy as np

from mirror_explainer.selection.evidence import Evidence, Floats

TIE = 1e-9  # nats; gains that differ by less are equal
# Rough costs on one core: of a product, and of one multiplication and addition in it.
_SECONDS_A_PRODUCT = 4e-5
_SECONDS_AN_OPERATION = 1.5e-10


class OutOfTime(Exception):
    """The time was up before all sets were looked at."""


def seconds_to_enumerate(evidence: Evidence, size: int) -> float:
    """Return roughly how long it takes to look at all sets of a size."""
    kinds, sentences = evidence.ratio.shape
    prefixes = math.comb(sentences, max(size - 2, 0))
    pairs = (sentences / max(size - 1, 1)) ** 2
    return float(prefixes * (_SECONDS_A_PRODUCT + _SECONDS_AN_OPERATION * kinds * pairs))


def best_of_all(evidence: Evidence, size: int, end: float) -> tuple[int, ...]:
    """Return the columns of the set of `size` ≥ 1 sentences that leaves the least doubt.

    Of those within 1e-9 nats of it, the one with the latest last position, then the latest
    last but one, and so on. Raises OutOfTime at `end` (of time.monotonic()).
    """
    best: list[tuple[float, tuple[int, ...]]] = []
    for prefix, doubts in _by_prefix(evidence, size, end):
        least = min([float(doubts.min()), *(doubt for doubt, _ in best)])
        best = [(doubt, columns) for doubt, columns in best if doubt <= least + TIE]
        tied = np.argwhere(doubts <= least + TIE)
        if len(tied):
            last = tied[np.lexsort(tied.T)[-1]]  # by the last column, then the one before
            best.append((float(doubts[tuple(last)]), prefix + tuple(last.tolist())))
    return max((columns for _, columns in best), key=lambda columns: columns[::-1])


def _by_prefix(
    evidence: Evidence, size: int, end: float
) -> Iterator[tuple[tuple[int, ...], Floats]]:
    """Yield the doubts that sets leave, for each choice of all but their last two columns.

    They have shape (T,) for sets of one, else (T, T), with infinity where the columns do not
    ascend.
    """
    sentences = evidence.ratio.shape[1]
    if size == 1:
        yield (), evidence.doubt.of(evidence.ratio.T @ evidence.weight, evidence.robot)
        return
    descending = np.tril(np.ones((sentences, sentences), dtype=bool))
    for prefix in itertools.combinations(range(sentences - 2), size - 2):
        if time.monotonic() > end:
            raise OutOfTime
        first = prefix[-1] + 1 if prefix else 0
        fit = evidence.ratio[:, list(prefix)].prod(axis=1)
        left = fit > 0
        ratio, weight = evidence.ratio[left, first:], evidence.weight[left]
        weight = weight * fit[left, None]
        masses = np.stack([_pairs(ratio, share) for share in weight.T], axis=-1)
        doubts = np.full((sentences, sentences), np.inf)
        doubts[first:, first:] = evidence.doubt.of(masses, evidence.robot)
        doubts[descending] = np.inf
        yield prefix, doubts


def _pairs(ratio: Floats, share: Floats) -> Floats:
    """Σ_k share_k r_ki r_kj for each pair of columns, shape (T, T)."""
    counted = share > 0
    if not counted.all():
        ratio, share = ratio[counted], share[counted]
    return (ratio * share[:, None]).T @ ratio
