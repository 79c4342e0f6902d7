"""Which actions to say (Section 'Informative Communication' of the paper): Algorithm 1.

FIND-MOST-INFORMATIVE enumerates the C(|π_R|, N) combinations of actions and
takes the one with the largest information gain (Eq. 3). `most_informative`
returns the same one without enumerating: minimising
F(o) = Σ_k w_k ∏_{i∈o} r_k(s_i), a branch and bound in `branch_and_bound`.

Sets whose gains differ by less than 1e-9 are tied. Then the larger sum of the
single-sentence gains wins, then the lexicographically smallest positions.
"""

import math
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from mirror_explainer.listener.mirror_model import Evidence
from mirror_explainer.selection.branch_and_bound import Search
from mirror_explainer.selection.columns import ROUNDING, TIE, Columns, Ints, exp, log_sum
from mirror_explainer.selection.scores import Scores


@dataclass(frozen=True)
class Selection:
    """Positions of the robot's plan to say, in plan order, and what saying them brings.

    `information_gain` is in nats (Eq. 3). `gap`, in nats, bounds what a better
    selection of the same size could add: 0 when there is none.
    """

    positions: tuple[int, ...]
    information_gain: float
    gap: float

    @property
    def optimal(self) -> bool:
        """Whether no other selection of this size is known to be possibly better."""
        return self.gap == 0.0


@dataclass(frozen=True)
class Step:
    """One step of the informative order: the position said, and the nats it adds."""

    position: int
    information_gain: float


def most_informative(evidence: Evidence, n: int, budget: float | None = None) -> Selection:
    """FIND-MOST-INFORMATIVE of Algorithm 1: the best `n` positions, ties broken as above.

    With a `budget` in seconds, the best found by then and its proven `gap`. A
    gap of 0 means that no gain is larger by more than 1e-9, in any case; only
    if time ran out between that proof and the end of the tie-break may an
    equally informative selection with more telling single sentences exist.
    """
    deadline = _deadline(budget)
    n = min(max(n, 0), len(evidence.positions))
    return _select(evidence, _greedy(evidence.columns, n), deadline)


def curve(evidence: Evidence, budget: float | None = None) -> tuple[Selection, ...]:
    """The most informative selections of 0, 1, ... and all positions.

    The `budget` in seconds is for all together; every size gets an equal part
    of what the smaller ones left over.
    """
    return tuple(_select_all(evidence, len(evidence.positions), budget))


def smallest_sufficient(
    evidence: Evidence,
    required_gain: float,
    at_most: int,
    budget: float | None = None,
) -> Selection:
    """The smallest selection that says enough: the threshold θ of the paper's Fig. 1.

    Enough is a gain above `required_gain` = H(P_R, P_R^H) − θ, so that the
    cross-entropy falls below θ; or the gain of saying everything, within
    1e-9, should that be less. Without such a selection of `at_most`
    positions, it is the most informative one of that size. The `gap` also
    covers smaller sizes of which the time did not tell whether they suffice.
    """
    everything = -evidence.columns.log_value(evidence.columns.copies)
    best, doubt = Selection((), 0.0, 0.0), 0.0
    for best in _select_all(evidence, min(at_most, len(evidence.positions)), budget):
        if is_enough(best.information_gain, required_gain, everything):
            break
        if is_enough(best.information_gain + best.gap, required_gain, everything):
            doubt = max(doubt, best.gap)
    return replace(best, gap=max(best.gap, doubt))


def is_enough(gain: float, required_gain: float, everything: float) -> bool:
    """Whether a gain is above the required one, or that of saying everything, within 1e-9."""
    return gain > required_gain or gain >= everything - TIE


def increasing(evidence: Evidence, n: int) -> Selection:
    """The paper's baseline: the first `n` positions in plan order."""
    return _baseline(evidence, range(len(evidence.positions))[: max(n, 0)])


def decreasing(evidence: Evidence, n: int) -> Selection:
    """The paper's baseline: the last `n` positions of the plan."""
    return _baseline(evidence, range(len(evidence.positions))[::-1][: max(n, 0)])


def informative_order(evidence: Evidence) -> tuple[Step, ...]:
    """All positions one at a time, each the best given those before it (Table 1)."""
    unused = [list(of_sentence) for of_sentence in evidence.columns.places]
    steps = []
    gain = 0.0
    for sentence, gain_with in _greedy(evidence.columns, len(evidence.positions)):
        position = int(evidence.positions[unused[sentence].pop(0)])
        steps.append(Step(position, gain_with - gain))
        gain = gain_with
    return tuple(steps)


def _deadline(budget: float | None) -> float:
    """When to stop: a little before the end, as the step that is under way goes on."""
    return math.inf if budget is None else time.monotonic() + 0.9 * budget


def _selection(evidence: Evidence, counts: Ints, gap: float) -> Selection:
    """The lowest positions that say every sentence as often as `counts` (T,) has it."""
    said = sorted(
        column
        for of_sentence, count in zip(evidence.columns.places, counts, strict=True)
        for column in of_sentence[:count]
    )
    positions = tuple(int(evidence.positions[column]) for column in said)
    return Selection(positions, 0.0 - evidence.columns.log_value(counts), gap)


def _baseline(evidence: Evidence, said: range) -> Selection:
    """Say the columns `said`; the gap is to a bound that needs no search."""
    columns = evidence.columns
    counts = np.array([len(set(c) & set(said)) for c in columns.places], dtype=np.int64)
    log_value = columns.log_value(counts)
    gap = max(0.0, log_value - columns.log_floor(len(said)))
    positions = tuple(int(evidence.positions[column]) for column in sorted(said))
    return Selection(positions, 0.0 - log_value, gap if gap > TIE else 0.0)


def _greedy(columns: Columns, n: int) -> list[tuple[int, float]]:
    """Add n sentences one at a time, the best next: each with the gain of all up to it.

    Sentences are sorted by single gain, so the first of those tied for the
    step and for the single gain that has the lowest position left is it.
    """
    ratio = np.exp(columns.log_ratio)
    log_weight = columns.log_weight
    used = np.zeros_like(columns.copies)
    order = []
    for _ in range(n):
        reference = float(log_sum(log_weight))
        with np.errstate(divide='ignore'):
            gain = 0.0 - (reference + np.log(np.exp(log_weight - reference) @ ratio))
        left = used < columns.copies
        tied = left & (gain >= gain[left].max() - TIE)
        tied &= columns.single_gain >= columns.single_gain[tied].max() - TIE
        best = min(np.flatnonzero(tied), key=lambda t: columns.places[t][used[t]])
        used[best] += 1
        log_weight = log_weight + columns.log_ratio[:, best]
        order.append((int(best), float(gain[best])))
    return order


def _swapped(columns: Columns, counts: Ints, limit: float | None = None) -> Ints:
    """Exchange one sentence for another, the best exchange first, as long as it helps.

    It helps if it makes F smaller; or, with a `limit` on F relative to that of
    `counts`, if it makes the sum of single gains larger.
    """
    ratio = np.exp(columns.log_ratio)
    gain = columns.single_gain
    log_value = columns.log_value(counts)
    while True:
        said = np.flatnonzero(counts)
        without = counts - np.eye(len(counts), dtype=np.int64)[said]
        value = exp(columns.log_products(without) - log_value) @ ratio  # (said, T)
        value[:, counts >= columns.copies] = np.inf
        if limit is None:
            improvement = 1 - value
        else:
            improvement = np.where(value <= limit, gain - gain[said, None], -np.inf)
        out, new = np.unravel_index(improvement.argmax(), improvement.shape)
        if improvement[out, new] <= ROUNDING:
            return counts
        counts = without[out]
        counts[new] += 1
        if limit is None:
            log_value = columns.log_value(counts)


def _select(evidence: Evidence, greedy: list[tuple[int, float]], deadline: float) -> Selection:
    """Find the optimum as large as the greedy start, then settle the ties."""
    columns = evidence.columns
    counts = np.bincount([sentence for sentence, _ in greedy], minlength=len(columns.copies))
    if 0 < len(greedy) < len(evidence.positions):
        counts, gap = _optimum(columns, _swapped(columns, counts), deadline)
        if gap == 0:
            counts = _settled(columns, counts, deadline)
    else:
        gap = 0.0
    return _selection(evidence, counts, gap)


def _select_all(evidence: Evidence, largest: int, budget: float | None) -> Iterator[Selection]:
    """The selections of 0, 1, ... `largest` positions, with equal parts of what time is left."""
    deadline = _deadline(budget)
    greedy = _greedy(evidence.columns, largest)
    for n in range(largest + 1):
        part = (deadline - time.monotonic()) / (largest + 1 - n)
        yield _select(evidence, greedy[:n], time.monotonic() + part)


def _optimum(columns: Columns, start: Ints, deadline: float) -> tuple[Ints, float]:
    """The counts with the smallest F, no worse than `start`, and the proven gap in nats."""
    best, value = start, 1.0
    search = Search(columns, start, 1 - ROUNDING, deadline)
    for found in search.completions():
        best, value = found.counts, found.value
        search.limit = value * (1 - ROUNDING)
    gap = math.log(value) - math.log(search.lower) if search.lower < value else 0.0
    return best, gap if gap > TIE else 0.0


def _settled(columns: Columns, optimum: Ints, deadline: float) -> Ints:
    """Of all sets as good as `optimum`: the largest single gains, then the lowest positions."""
    limit = math.exp(TIE)  # of F, relative to that of the optimum
    n = int(optimum.sum())
    best = _swapped(columns, optimum, limit)
    most = float(best @ columns.single_gain)
    scores = Scores.of(columns, optimum, limit, most)
    between = scores.counts_between(columns, n, most - TIE)
    search = Search(
        columns, optimum, limit, deadline, scores, most - TIE, *between, other_than=best
    )
    alone = True
    for found in search.completions():
        alone = found.gain > most + TIE and not found.tied
        if found.gain > most + ROUNDING * n:
            best, most = found.counts, found.gain
        search.least_gain = most + ROUNDING * n
    if alone:
        return best

    least = most - TIE
    scores = Scores.of(columns, optimum, limit, least)
    at_least, at_most = scores.counts_between(columns, n, least)

    def other(fewest: Ints) -> Ints | None:
        """Another set with the same gains, if there is one, with at least these counts."""
        search = Search(
            columns, optimum, limit, deadline, scores, least, fewest, at_most, other_than=best
        )
        return next((found.counts for found in search.completions()), None)

    if (at_least == at_most).all() or other(at_least) is None:
        return best
    fixed = np.zeros_like(best)
    for sentence in columns.sentence_of.values():
        if fixed[sentence] == at_most[sentence]:
            continue
        fixed[sentence] += 1
        if best[sentence] < fixed[sentence]:
            lower = other(np.maximum(fixed, at_least))
            if lower is None:
                fixed[sentence] -= 1
                at_most[sentence] = fixed[sentence]
            else:
                best = lower
    return best
