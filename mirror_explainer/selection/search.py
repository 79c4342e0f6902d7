"""The best choice where there are too many sets to look at: a search, and how far it may be off.

From several starts, sentences are exchanged as long as that leaves less doubt. No set of a
size can leave less than a bound in which every kind of hypotheses meets its own worst or best
sentences; the difference is the gap.
"""

import math
import time
from collections.abc import Sequence

import numpy as np

from mirror_explainer.selection.enumeration import TIE
from mirror_explainer.selection.evidence import (
    ALL,
    BELIEF,
    FORESEEN,
    GOAL,
    LEAST_FACTS,
    Evidence,
    Floats,
)

_ROUNDING = 1e-12  # nats; less than this is no improvement


def greedy(evidence: Evidence, size: int, end: float) -> list[int]:
    """Return `size` columns in the order in which each leaves the least doubt after those before.

    Of those within 1e-9 nats of it, the latest. From `end` (of time.monotonic()) on the
    rest are the first that are left.
    """
    chosen: list[int] = []
    fit = np.ones(len(evidence.ratio))
    left = list(range(evidence.ratio.shape[1]))
    while len(chosen) < size:
        if time.monotonic() > end:
            return chosen + left[: size - len(chosen)]
        doubts = _doubts_with_one_more(evidence, fit)[left]
        best = left[int(np.flatnonzero(doubts <= doubts.min() + TIE)[-1])]
        chosen.append(best)
        left.remove(best)
        fit = fit * evidence.ratio[:, best]
    return chosen


def improved(evidence: Evidence, start: Sequence[int], end: float) -> tuple[int, ...]:
    """Exchange columns one for one, the best exchange first, until none helps or at `end`."""
    chosen = sorted(start)
    doubt = evidence.doubt_after(chosen)
    while time.monotonic() <= end:
        best, exchange = doubt - _ROUNDING, (0, 0)
        for place in range(len(chosen)):
            others = chosen[:place] + chosen[place + 1 :]
            doubts = _doubts_with_one_more(evidence, evidence.ratio[:, others].prod(axis=1))
            doubts[chosen] = np.inf
            column = int(doubts.argmin())
            if doubts[column] < best:
                best, exchange = float(doubts[column]), (place, column)
        if best >= doubt - _ROUNDING:
            break
        chosen[exchange[0]] = exchange[1]
        chosen.sort()
        doubt = best
    return tuple(chosen)


def least_doubt(evidence: Evidence, size: int) -> float:
    """Return a bound: no set of `size` sentences leaves less doubt."""
    if evidence.doubt.whole:
        worst = _products(evidence.ratio, size)[:, size]
        everything = max(float(worst @ evidence.weight[:, ALL]), evidence.robot)
        return math.log(everything / evidence.robot)
    # A sentence that some foreseen way to the robot's goal lacks may tell of the facts; how
    # many of these a set has bounds what is left to tell of the goal.
    besides = evidence.weight[:, FORESEEN] - evidence.weight[:, BELIEF]
    lost = besides @ np.maximum(1.0 - evidence.ratio, 0.0)  # at most, by each sentence
    telling, rest = np.flatnonzero(lost > 0), np.flatnonzero(lost <= 0)
    largest = np.sort(lost)[::-1]
    own = evidence.weight[:, GOAL] > 0
    others = evidence.weight[:, ALL] - evidence.weight[:, GOAL]
    groups = (telling, rest)
    lowest = [_products(evidence.ratio[:, group], size) for group in groups]
    highest = [
        _products(evidence.ratio[np.ix_(own, group)], size, largest=True) for group in groups
    ]
    bounds = []
    for count in range(max(0, size - len(rest)), min(size, len(telling)) + 1):
        worst, best = (of[0][:, count] * of[1][:, size - count] for of in (lowest, highest))
        goal, belief = best @ evidence.weight[own][:, [GOAL, BELIEF]]
        left = max(float(besides.sum() - largest[:count].sum()), float(worst @ besides))
        known = max(float(belief / (belief + left)), LEAST_FACTS)
        doubt = math.log(1.0 + worst @ others / goal) - evidence.doubt.facts * math.log(known)
        bounds.append(doubt)
    return max(0.0, min(bounds))


def _products(ratio: Floats, most: int, *, largest: bool = False) -> Floats:
    """The products of each row's 0, 1, ... and `most` smallest, or largest, ratios."""
    most = min(most, ratio.shape[1])
    sign = -1.0 if largest else 1.0
    some = np.partition(sign * ratio, np.arange(most), axis=1)[:, :most]
    return np.concatenate([np.ones((len(ratio), 1)), sign * some], axis=1).cumprod(axis=1)


def _doubts_with_one_more(evidence: Evidence, fit: Floats) -> Floats:
    """The doubt that each column leaves besides what hypotheses already fit, shape (T,)."""
    weight = evidence.weight * fit[:, None]
    return evidence.doubt.of(evidence.ratio.T @ weight, evidence.robot)
