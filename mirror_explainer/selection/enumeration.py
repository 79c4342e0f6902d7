"""FIND-MOST-INFORMATIVE of Algorithm 1: the best of all sets of a size, by matrix products.

A set is left out as soon as the kinds of hypotheses that weigh most leave it more doubt than
a set that is known has in all; the rest can only add to that.
"""

import itertools
import math
import time
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from mirror_explainer.selection.evidence import ALL, GOAL, Evidence, Floats

TIE = 1e-9  # nats; gains that differ by less are equal
# Where there are more kinds of hypotheses than this, those of the robot's goal and this many
# of the heaviest are looked at first.
_HEAVIEST = 512
# What is added of the rest in single precision is off by far less than this, in nats.
_ROUNDING = 1e-4
_AT_A_TIME = 4096  # kinds, so that what is multiplied stays in a processor's cache
# Before this share of the sets is looked at it is not foreseen how long the rest takes.
_FORESEEN_FROM = 1 / 16
# Rough costs on one core: of a product, and of one multiplication and addition in it.
_SECONDS_A_PRODUCT = 4e-5
_SECONDS_AN_OPERATION = 1e-10


class OutOfTime(Exception):
    """The time is up before all sets are looked at; `best` are the columns of the best so far."""

    def __init__(self, best: Sequence[int]) -> None:
        super().__init__()
        self.best = best


class _Pace:
    """How many of all sets were looked at, and whether the time is enough for the rest."""

    def __init__(self, total: int, end: float) -> None:
        self._began, self._end = time.monotonic(), end
        self._looked_at, self._total = 0, total

    def goes_on(self, sets: int) -> bool:
        """Say whether so many more may be looked at."""
        taken = time.monotonic() - self._began
        share = max(self._looked_at / self._total, _FORESEEN_FROM)
        self._looked_at += sets
        return self._began + taken / share <= self._end


def least_seconds(evidence: Evidence, size: int) -> float:
    """Return roughly how long it takes at least to look at all sets of a size."""
    kinds, sentences = evidence.ratio.shape
    kinds = min(kinds, int(np.count_nonzero(evidence.weight[:, GOAL])) + _HEAVIEST)
    prefixes = math.comb(sentences, max(size - 2, 0))
    pairs = (sentences / max(size - 1, 1)) ** 2
    return float(prefixes * (_SECONDS_A_PRODUCT + _SECONDS_AN_OPERATION * kinds * pairs))


def best_of_all(
    evidence: Evidence, size: int, known: Sequence[int], end: float
) -> tuple[int, ...]:
    """Return the columns of the set of `size` ≥ 1 sentences that leaves the least doubt.

    Of those within 1e-9 nats of it, the one with the latest last position, then the latest
    last but one, and so on. `known` are the columns of a good one. Raises OutOfTime at `end`
    (of time.monotonic()), or once it is foreseen.
    """
    if size == 1:
        doubts = evidence.doubt.of(evidence.ratio.T @ evidence.weight, evidence.robot)
        return (int(np.flatnonzero(doubts <= doubts.min() + TIE)[-1]),)
    first, rest = _heaviest_first(evidence)
    least = evidence.doubt_after(known)
    best = [(least, tuple(sorted(known)))]
    sentences = evidence.ratio.shape[1]
    progress = _Pace(math.comb(sentences, size), end)
    for prefix in itertools.combinations(range(sentences - 2), size - 2):
        start = prefix[-1] + 1 if prefix else 0
        if not progress.goes_on(math.comb(sentences - start, 2)):
            raise OutOfTime(_latest_of(best, least))
        masses = _masses_of_pairs(first, prefix, start)
        doubts = _doubts_of_pairs(evidence, masses)
        if len(rest.ratio):
            near = np.flatnonzero((doubts <= least + TIE).any(axis=1))
            if not len(near):
                continue
            some = near[0]
            start += some
            masses = masses[some:, some:] + _masses_of_pairs(rest, prefix, start)
            doubts = _doubts_of_pairs(evidence, masses)
            for pair in np.argwhere(doubts <= least + _ROUNDING).tolist():
                doubts[tuple(pair)] = evidence.doubt_after([*prefix, *(start + c for c in pair)])
        least = min(least, float(doubts.min()))
        tied = np.argwhere(doubts <= least + TIE)
        if len(tied):
            last = tied[np.lexsort(tied.T)[-1]]  # by the last column, then the one before
            best.append((float(doubts[tuple(last)]), prefix + tuple((start + last).tolist())))
    return _latest_of(best, least)


def _latest_of(found: Sequence[tuple[float, tuple[int, ...]]], least: float) -> tuple[int, ...]:
    """Of the sets that leave the least doubt, the one with the latest last column, and so on."""
    best = (columns for doubt, columns in found if doubt <= least + TIE)
    return max(best, key=lambda columns: columns[::-1])


def _heaviest_first(evidence: Evidence) -> tuple[Evidence, Evidence]:
    """Divide the kinds: of the robot's goal or heavy; and, in single precision, the rest."""
    among_first = evidence.weight[:, GOAL] > 0
    among_first[np.argsort(evidence.weight[:, ALL])[-_HEAVIEST:]] = True
    first, rest = (
        (np.compress(kinds, evidence.ratio.T, axis=1).T, evidence.weight[kinds])
        for kinds in (among_first, ~among_first)
    )
    return (
        replace(evidence, ratio=first[0], weight=first[1]),
        replace(evidence, ratio=rest[0].astype(np.float32), weight=rest[1].astype(np.float32)),
    )


def _masses_of_pairs(evidence: Evidence, prefix: Sequence[int], start: int) -> Floats:
    """What is left of each weight after a prefix and two of T columns from a start, (T, T, 4)."""
    ratio = evidence.ratio.T[start:]
    shares = evidence.weight.T * evidence.ratio[:, list(prefix)].prod(axis=1)
    masses = np.zeros((len(ratio), len(ratio), len(shares)))
    for place, share in enumerate(shares[:1] if evidence.doubt.whole else shares):
        root = np.sqrt(share)
        for begin in range(0, len(root) if share.any() else 0, _AT_A_TIME):
            kinds = slice(begin, begin + _AT_A_TIME)
            some = ratio[:, kinds] * root[kinds]
            masses[..., place] += some @ some.T
    return masses


def _doubts_of_pairs(evidence: Evidence, masses: Floats) -> Floats:
    """The doubt that is left, infinity where the two columns do not ascend."""
    doubts = evidence.doubt.of(masses, evidence.robot)
    doubts[np.tril_indices(len(doubts))] = np.inf
    return doubts
