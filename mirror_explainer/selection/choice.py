"""Which sentences to say (method, section 3): the fewest that tell nearly all that so many can.

Sets are of different sentences. Small ones are all looked at, as Algorithm 1 has it; where
there are too many for the time, a search finds a good one, and the gap says how good.
"""

import math
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from mirror_explainer.selection.baselines import ORDERS
from mirror_explainer.selection.enumeration import (
    TIE,
    OutOfTime,
    best_of_all,
    least_seconds,
)
from mirror_explainer.selection.evidence import Evidence
from mirror_explainer.selection.search import greedy, improved, least_doubt

# Of the time for sets of any sentences, where those of ends alone may have to be looked at, too.
_SHARE_OF_ANY = 0.8


@dataclass(frozen=True)
class Selection:
    """Positions of the robot's plan to say, in plan order, and what saying them brings.

    `information_gain` is in nats (Eq. 2 for the paper's listener). `gap`, in nats, bounds how
    much larger the largest gain of so many sentences, or fewer, could be (of a baseline: of
    so many): 0 if it was found.
    """

    positions: tuple[int, ...]
    information_gain: float
    gap: float = 0.0

    @property
    def optimal(self) -> bool:
        """Whether none of this size or less that may be said tells more."""
        return self.gap == 0.0


@dataclass(frozen=True)
class Addition:
    """One sentence of the informative order: its position, and the nats it adds."""

    position: int
    information_gain: float


def most_informative(
    evidence: Evidence,
    n: int,
    budget: float | None = None,
    *,
    first: bool = True,
) -> Selection:
    """The selection of at most `n` sentences with the largest gain, without fillers.

    That is the smallest whose gain comes within the evidence's `min_gain` nats of the largest;
    with None it has exactly `n`. Unless this is the `first` answer, it is empty where even the
    largest gain is at most `min_gain`. With a `budget` in seconds, the best found by then.
    """
    n = min(n, len(evidence.positions))
    sizes = range(1 if evidence.min_gain is not None else n, n + 1) if n else range(0)
    best = [*best_of_each(evidence, sizes, budget)]
    largest = max((selection.information_gain for selection in best), default=0.0)
    if not first and largest <= max(evidence.min_gain or 0.0, TIE):
        return Selection((), 0.0)
    chosen = _without_fillers(best, evidence.min_gain)
    if first and n and not chosen.positions:  # a robot whose steps bring nothing about
        return selection_of(evidence, *_best_of_any(evidence, 1, _end(budget)))
    return chosen


def _without_fillers(best: Sequence[Selection], min_gain: float | None) -> Selection:
    """Return of the best selections of some sizes, ascending, the smallest that tells enough."""
    if not best:
        return Selection((), 0.0)
    largest = max(selection.information_gain for selection in best)
    enough = largest - (min_gain or 0.0) - TIE
    chosen = next(selection for selection in best if selection.information_gain >= enough)
    gap = max(selection.information_gain + selection.gap for selection in best) - largest
    return replace(chosen, gap=gap if gap > TIE else 0.0)


def smallest_sufficient(
    evidence: Evidence, threshold: float, at_most: int, budget: float | None = None
) -> Selection:
    """The smallest selection that leaves less doubt than `threshold` (θ of the paper's Fig. 1).

    If none of `at_most` sentences does, the smallest with the least. The `gap` covers smaller
    ones, too, of which the time did not tell whether they suffice.
    """
    sizes = range(1, min(at_most, len(evidence.positions)) + 1)
    best, gap = Selection((), 0.0), 0.0
    for found in best_of_each(evidence, sizes, budget):
        gap = max(gap, found.information_gain + found.gap - best.information_gain)
        if not best.positions or found.information_gain > best.information_gain + TIE:
            best, gap = found, found.gap
        if evidence.doubt_before - found.information_gain < threshold:
            break
    return Selection(best.positions, best.information_gain, gap if gap > TIE else 0.0)


def curve(evidence: Evidence, budget: float | None = None) -> list[Selection]:
    """The most informative selections of at most 1, 2, ... and all sentences, as above."""
    sizes = range(1, len(evidence.positions) + 1)
    best = [*best_of_each(evidence, sizes, budget)]
    if evidence.min_gain is None:
        return best
    return [_without_fillers(best[:n], evidence.min_gain) for n in sizes]


def baseline(evidence: Evidence, strategy: str, n: int, threshold: float = 0.0) -> Selection:
    """The first `n` different sentences of a strategy's order, each at the place where it is met.

    With a `threshold` above 0 only as many as bring the doubt below it.
    """
    columns = ORDERS[strategy](evidence)[:n]
    if threshold > 0:
        sizes = range(1, len(columns))
        enough = (k for k in sizes if evidence.doubt_after(columns[:k]) < threshold)
        columns = columns[: next(enough, len(columns))]
    met = 0 if strategy == 'increasing' else -1
    return Selection(
        tuple(sorted(evidence.places[column][met] for column in columns)),
        evidence.doubt_before - evidence.doubt_after(columns),
        _gap(evidence, columns),
    )


def informative_order(evidence: Evidence) -> tuple[Addition, ...]:
    """All sentences one at a time, each the best given those before it (Table 1)."""
    steps = []
    before = evidence.doubt_before
    said: list[int] = []
    for column in greedy(evidence, len(evidence.positions), math.inf):
        said.append(column)
        after = evidence.doubt_after(said)
        steps.append(Addition(evidence.positions[column], before - after))
        before = after
    return tuple(steps)


def selection_of(evidence: Evidence, columns: Sequence[int], gap: float = 0.0) -> Selection:
    """Return the selection of these columns of the evidence."""
    positions = tuple(sorted(evidence.positions[column] for column in columns))
    return Selection(positions, evidence.doubt_before - evidence.doubt_after(columns), gap)


def best_of_each(
    evidence: Evidence, sizes: range, budget: float | None = None
) -> Iterator[Selection]:
    """Yield the best selection of exactly each size, with an equal part of the time left."""
    end = _end(budget)
    for done, size in enumerate(sizes):
        now = time.monotonic()
        yield _best(evidence, size, now + (end - now) / (len(sizes) - done))


def _best(evidence: Evidence, size: int, end: float) -> Selection:
    """The best selection of exactly `size` sentences, or a good one and its gap.

    A means is said when nothing is left to say of the goal, and only for a surprise: otherwise
    the best of ends alone is taken.
    """
    if evidence.has_surprises:
        now = time.monotonic()
        columns, gap = _best_of_any(evidence, size, now + _SHARE_OF_ANY * (end - now))
        if evidence.means.isdisjoint(columns) or not evidence.leaves_an_end(columns):
            return selection_of(evidence, columns, gap)
    ends = evidence.of_ends()
    return selection_of(ends, *_best_of_any(ends, min(size, len(ends.places)), end))


def _best_of_any(evidence: Evidence, size: int, end: float) -> tuple[Sequence[int], float]:
    """The columns of the best `size` sentences of any kind, or of good ones, and their gap."""
    if size == len(evidence.places):
        return range(size), 0.0
    starts = [greedy(evidence, size, end), *(order(evidence)[:size] for order in ORDERS.values())]
    start: Sequence[int] = min(starts, key=evidence.doubt_after)
    if least_seconds(evidence, size) < end - time.monotonic():
        try:
            return best_of_all(evidence, size, start, end), 0.0
        except OutOfTime as stopped:
            start = stopped.best
    found = improved(evidence, start, end)
    return found, _gap(evidence, found)


def _gap(evidence: Evidence, columns: Sequence[int]) -> float:
    """How much less doubt than these columns leave others may leave, as far as is known."""
    gap = evidence.doubt_after(columns) - least_doubt(evidence, len(columns))
    return gap if gap > TIE else 0.0


def _end(budget: float | None) -> float:
    """When to stop: a little before the end, as the step that is under way goes on."""
    return math.inf if budget is None else time.monotonic() + 0.9 * budget
