"""Exact search for the n sentences that leave the least doubt.

Minimises F(o) = Σ_k w_k ∏_{i∈o} r_k(s_i) over all sets o of n sentences. F is
what the denominator of Eq. 3 becomes once divided by P(o|π_R), so the smallest
F is the largest information gain.

A node of the search is a set A already taken and the sentences still allowed.
It is closed when a lower bound on F(A ∪ B), for every B of the j sentences
still missing, exceeds the best F known. In the logarithm, one hypothesis'
product is exp(−Σ_i cost_i), or 0 as soon as a sentence is not in its plan
(it is *hit*); the tangent of this at any point c bounds it from below:

    ∏_{i∈B} r_i  ≥  height − slope · Σ_{i∈B} cost_i − height · |B ∩ hits|.

The sum of the tangents over all hypotheses is linear in B, so its smallest
value is met by the j sentences with the largest coefficients. Moving the point
c towards them (Frank and Wolfe) and asking again tightens the bound.

Nodes are expanded by the hundred: every step above is a product of matrices.
"""

import time
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Booleans = NDArray[np.bool_]

LARGEST_EXPONENT = 600.0  # exp of more would leave no room for sums
ROUNDING = 1e-12  # relative; sums of differences are not trusted beyond this
TANGENT_ROUNDS = 3
ROOT_ROUNDS = 30
MULTIPLIER_ROUNDS = 100
CELLS_OPEN = 10_000_000  # nodes × hypotheses kept while not going deep
CELLS_AT_ONCE = 2_500_000  # nodes × hypotheses × positions handled in one step


@dataclass(frozen=True)
class Columns:
    """The positions' columns, equal ones made one: K hypotheses, T sentences, P positions.

    Columns are sorted by their single gain, the largest first; the P copies
    repeat every sentence as often as the plan has it, in the same order.
    """

    log_weight: Floats  # (K,) log w_k
    log_ratio: Floats  # (K, T) log r_k(s), −inf where the sentence is not in plan k
    single_gain: Floats  # (T,) information gain of the sentence alone, nats
    columns: tuple[tuple[int, ...], ...]  # T × the columns that say this sentence, ascending
    copies: Ints  # (T,) how many these are
    sentence: Ints  # (P,) the sentence of each copy
    copy: Ints  # (P,) 0 for a sentence's first copy, 1 for its second, ...
    hits: Floats  # (K, P) 1 where a first copy is not in plan k, else 0
    largest: Floats  # (K,) log of the largest ratio
    cost: Floats  # (K, P) largest − log ratio, 0 where the plan lacks the sentence
    least: Floats  # (K, P + 1) log of the product of the j smallest ratios above 0

    @classmethod
    def of(cls, prior: Floats, ratio: Floats) -> 'Columns':
        """Merge equal columns of `ratio` (K, P) and tabulate what the search needs."""
        possible = prior > 0
        weight, ratio = prior[possible] / prior.sum(), ratio[possible]
        distinct, sentence_of = np.unique(ratio, axis=1, return_inverse=True)
        with np.errstate(divide='ignore'):
            log_weight, log_ratio = np.log(weight), np.log(distinct)
        single_gain = -log_sum(log_weight[:, None] + log_ratio)
        columns = [np.flatnonzero(sentence_of == t) for t in range(len(single_gain))]
        order = sorted(range(len(columns)), key=lambda t: (-single_gain[t], columns[t][0]))
        log_ratio, single_gain = log_ratio[:, order], single_gain[order]
        copies = np.array([len(columns[t]) for t in order], dtype=np.int64)

        sentence = np.repeat(np.arange(len(order)), copies)
        copy = np.arange(len(sentence)) - (np.cumsum(copies) - copies)[sentence]
        lacking = np.isneginf(log_ratio)
        largest = np.where(lacking.all(axis=1), 0.0, log_ratio.max(axis=1, initial=-np.inf))
        cost = np.where(lacking, 0.0, largest[:, None] - log_ratio)[:, sentence]
        ascending = np.sort(np.where(lacking, np.inf, log_ratio)[:, sentence], axis=1)
        least = np.cumsum(np.insert(ascending, 0, 0.0, axis=1), axis=1)
        return cls(
            log_weight=log_weight,
            log_ratio=log_ratio,
            single_gain=single_gain,
            columns=tuple(tuple(int(c) for c in columns[t]) for t in order),
            copies=copies,
            sentence=sentence,
            copy=copy,
            hits=(lacking[:, sentence] & (copy == 0)).astype(float),
            largest=largest,
            cost=cost,
            least=np.where(np.isposinf(least), -np.inf, least),
        )

    @property
    def sentence_of(self) -> dict[int, int]:
        """The sentence of every column of the evidence, in plan order."""
        return dict(sorted((c, t) for t, of in enumerate(self.columns) for c in of))

    def log_products(self, counts: Ints) -> Floats:
        """log w_k ∏_{i∈o} r_k(s_i), shape (..., K), of sets given as counts (..., T)."""
        hit = counts @ np.isneginf(self.log_ratio).T > 0
        finite = np.where(np.isneginf(self.log_ratio), 0.0, self.log_ratio)
        return np.where(hit, -np.inf, self.log_weight + counts @ finite.T)

    def log_value(self, counts: Ints) -> float:
        """log F of a set given as counts (T,)."""
        return float(log_sum(self.log_products(counts)))

    def log_floor(self, n: int) -> float:
        """A bound that no set of n sentences can go below: each hypothesis at its smallest."""
        never_hit = ~self.hits.any(axis=1)
        return float(log_sum((self.log_weight + self.least[:, n])[never_hit]))


@dataclass(frozen=True)
class Completion:
    """A set of sentences: how many copies of each (T,), its F, and its sum of single gains."""

    counts: Ints
    value: float
    gain: float


@dataclass(frozen=True)
class Nodes:
    """Sets in the making, B at a time, all with the same number of sentences missing."""

    missing: int
    log_weight: Floats  # (B, K) log w_k ∏_{i∈A} r_k(s_i)
    left: Ints  # (B, T) copies that may still be taken
    taken: Ints  # (B, T) copies in A
    lower: Floats  # (B,) lower bound on F of any completion, relative to the reference

    def __len__(self) -> int:
        return len(self.lower)

    def __getitem__(self, which: 'Booleans | Ints | slice') -> 'Nodes':
        return Nodes(
            self.missing,
            self.log_weight[which],
            self.left[which],
            self.taken[which],
            self.lower[which],
        )


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
        first = np.cumsum(columns.copies) - columns.copies
        return np.add.reduceat(needed, first), np.add.reduceat(possible, first)


class Search:
    """Looks for sets as large as `start` with F ≤ `limit` and single gains ≥ `least_gain`.

    F is relative to that of `start`, a set known to be good. Only sets with
    counts between `at_least` and `at_most` are considered, and not `other_than`. With `scores`,
    sets with larger single gains come first, else those with smaller F.
    Whoever consumes `completions` may lower `limit` or raise `least_gain`
    between two of them, so as to be shown better sets only.
    """

    def __init__(
        self,
        columns: Columns,
        start: Ints,
        limit: float,
        deadline: float,
        scores: Scores | None = None,
        least_gain: float = -np.inf,
        at_least: Ints | None = None,
        at_most: Ints | None = None,
        other_than: Ints | None = None,
    ) -> None:
        taken = np.zeros_like(columns.copies) if at_least is None else at_least
        most = columns.copies if at_most is None else at_most
        self.columns = columns
        self.log_reference = log_reference = columns.log_value(start)
        self.limit = limit
        self.deadline = deadline
        self.scores = scores
        self.least_gain = least_gain
        self._expected = np.maximum(columns.log_products(start) - log_reference, -1e300)  # (K,)
        self._except = np.full_like(start, -1) if other_than is None else other_than
        self._turn = 0
        self._ratio = np.exp(columns.log_ratio)
        self._lacking = np.isneginf(columns.log_ratio)
        self._coefficients = np.vstack([columns.cost, columns.hits])
        self._first_copy = np.cumsum(columns.copies) - columns.copies
        self._at_once = max(1, CELLS_AT_ONCE // max(1, columns.hits.size))
        n = int(start.sum())
        missing = n - int(taken.sum())
        self._open = (
            [
                Nodes(
                    missing=missing,
                    log_weight=columns.log_products(taken)[None] - log_reference,
                    left=(most - taken)[None],
                    taken=taken[None],
                    lower=np.array([exp(columns.log_floor(n) - log_reference)]),
                )
            ]
            if missing >= 0
            else []
        )

    @property
    def lower(self) -> float:
        """A lower bound on F of the sets not yet looked at; infinite when there are none."""
        return min((float(n.lower.min()) for n in self._open if len(n)), default=np.inf)

    def completions(self) -> Iterator[Completion]:
        """Yield sets within the present limits until there are no more, or time is up."""
        while self._open and time.monotonic() < self.deadline:
            nodes = self._open.pop(self._next())
            nodes = nodes[nodes.lower <= self.limit]
            if len(nodes) > self._at_once:
                self._open.append(nodes[self._at_once :])
                nodes = nodes[: self._at_once]
            if not len(nodes):
                continue
            if nodes.missing == 0:
                yield from self._within_limits(nodes.taken)
            elif nodes.missing == 1:
                yield from self._with_last(nodes)
            elif self.scores is None:
                self._expand(nodes[nodes.left.sum(axis=1) >= nodes.missing])
            else:
                nodes, rank, width = self._ranked(nodes, self.scores)
                yield from self._within_limits(self._filled(nodes, rank))
                following = np.minimum(self._first_copy + nodes.taken, rank.shape[1] - 1)
                self._expand(nodes, (np.take_along_axis(rank, following, axis=1), width))

    def _next(self) -> int:
        """Go deep and, by turns while memory allows, to the lowest bound, so that it rises."""
        self._turn += 1
        if self._turn % 2 or sum(nodes.log_weight.size for nodes in self._open) > CELLS_OPEN:
            return -1
        return int(np.argmin([nodes.lower.min(initial=np.inf) for nodes in self._open]))

    def _within_limits(self, counts: Ints) -> Iterator[Completion]:
        """The set with the largest single gains among `counts` (B, T) within the limits."""
        value = exp(self.columns.log_products(counts) - self.log_reference).sum(axis=1)
        gain = counts @ self.columns.single_gain
        good = (value <= self.limit) & (gain >= self.least_gain)
        good &= (counts != self._except).any(axis=1)
        if good.any():
            best = int(np.where(good, gain, -np.inf).argmax())
            yield Completion(counts[best], float(value[best]), float(gain[best]))

    def _ranked(self, nodes: Nodes, scores: Scores) -> tuple[Nodes, Ints, Ints]:
        """Rank the copies (B, P) by score, where the nodes can reach the least gain at all.

        Also the number (B,) of leading copies of which a node needs at least one.
        """
        copy, sentence = self.columns.copy, self.columns.sentence
        taken, left = nodes.taken[:, sentence], nodes.left[:, sentence]
        rest = 1.0 - (copy < taken) @ scores.share.T  # (B, C) of the conditions
        multiplier = np.where(rest > 0, scores.multiplier, 0.0)
        rank, width = leading_copies(
            scores.gain + multiplier @ scores.share,
            (copy >= taken) & (copy < taken + left),
            nodes.missing,
            self.least_gain
            - nodes.taken @ self.columns.single_gain
            + (multiplier * rest).sum(axis=1),
        )
        near = width > 0
        return nodes[near], rank[near], width[near]

    def _filled(self, nodes: Nodes, rank: Ints) -> Ints:
        """Complete every node by its first copies in rank, as counts (B, T)."""
        leading = rank < nodes.missing
        return nodes.taken + np.add.reduceat(leading, self._first_copy, axis=1, dtype=np.int64)

    def _with_last(self, nodes: Nodes) -> Iterator[Completion]:
        """Complete every node by its one missing sentence: all of them at once."""
        value = exp(nodes.log_weight) @ self._ratio  # (B, T)
        gain = (nodes.taken @ self.columns.single_gain)[:, None] + self.columns.single_gain
        good = (nodes.left > 0) & (value <= self.limit) & (gain >= self.least_gain)
        differing = nodes.taken != self._except
        same = (differing.sum(axis=1) == 1)[:, None] & (nodes.taken + 1 == self._except)
        good &= ~same
        if good.any():
            merit = np.where(good, -value if self.scores is None else gain, -np.inf)
            node, last = np.unravel_index(merit.argmax(), merit.shape)
            counts = nodes.taken[node].copy()
            counts[last] += 1
            yield Completion(counts, float(value[node, last]), float(gain[node, last]))

    def _expand(self, nodes: Nodes, by_score: tuple[Ints, Ints] | None = None) -> None:
        """Close the nodes that cannot lead within the limits, and branch on the others.

        A set within the limits needs one of the sentences that lead in marginals
        and, if there are scores, one of those that lead in scores, which come
        as ranks (B, T) and numbers (B,); or else one of those that hit some
        hypothesis, unless that stays unhit. The smallest choice is branched on.
        """
        missing, every = nodes.missing, np.arange(len(nodes))
        unhit = exp(nodes.log_weight + self.columns.least[:, missing])  # (B, K)
        hitters = (nodes.left > 0) @ self._lacking.T.astype(float)  # (B, K)
        floor = np.where(hitters == 0, unhit, 0.0).sum(axis=1)
        allowed = self.columns.copy < nodes.left[:, self.columns.sentence]
        lower, total, marginal = self._bound(nodes, allowed, unhit)
        lower = np.maximum(np.maximum(lower, floor), nodes.lower)

        rank, width = leading_copies(
            marginal, allowed, missing, total * (1 - ROUNDING) - self.limit
        )
        rank = rank[:, self._first_copy]
        if by_score is not None:
            narrower = by_score[1] < width
            rank = np.where(narrower[:, None], by_score[0], rank)
            width = np.where(narrower, by_score[1], width)
        branch = (rank < width[:, None]) & (nodes.left > 0)  # (B, T) the witness sets

        slack = np.maximum(self.limit - floor, ROUNDING)[:, None]
        urgency = np.minimum(1.0, unhit / slack)
        effort = np.divide(
            hitters,
            urgency,
            out=np.full_like(hitters, np.inf),
            where=(hitters > 0) & (urgency > 0),
        )
        hypothesis = effort.argmin(axis=1)
        split = effort[every, hypothesis] < branch.sum(axis=1)
        hitting = self._lacking[hypothesis] & (nodes.left > 0)
        branch = np.where(split[:, None], hitting, branch)

        alive = lower <= self.limit
        spared = split & alive
        if spared.any():
            self._open.append(
                Nodes(
                    missing,
                    nodes.log_weight[spared],
                    np.where(hitting[spared], 0, nodes.left[spared]),
                    nodes.taken[spared],
                    np.maximum(lower, floor + unhit[every, hypothesis])[spared],
                )
            )
        branch &= alive[:, None]
        order = np.argsort(np.where(branch, rank, allowed.shape[1]), axis=1, kind='stable')
        place = np.empty_like(order)
        np.put_along_axis(place, order, np.arange(order.shape[1])[None], axis=1)
        node, nth = np.nonzero(np.arange(order.shape[1]) < branch.sum(axis=1)[:, None])
        chosen = order[node, nth]
        child = np.arange(len(node))
        left = np.where(place[node] < nth[:, None], 0, nodes.left[node])
        taken = nodes.taken[node]
        left[child, chosen] -= 1
        taken[child, chosen] += 1
        self._open.append(
            Nodes(
                missing - 1,
                nodes.log_weight[node] + self.columns.log_ratio.T[chosen],
                left,
                taken,
                lower[node],
            )
        )

    def _bound(
        self,
        nodes: Nodes,
        allowed: Booleans,
        unhit: Floats,
    ) -> tuple[Floats, Floats, Floats]:
        """Bound F below by sums of tangents: total (B,) − Σ_{i∈B} marginal (B, P).

        Returns the bound (B,) with its total and its marginals. The first
        tangents are taken where `start` leaves every hypothesis.
        """
        missing = nodes.missing
        ceiling = exp(nodes.log_weight + missing * self.columns.largest)  # (B, K)
        lower = np.full(len(nodes), -np.inf)
        total, marginal = np.empty(len(nodes)), np.empty(allowed.shape)
        point = np.zeros(allowed.shape)
        cost = nodes.log_weight + missing * self.columns.largest - self._expected  # (B, K)
        spared = np.ones(cost.shape)
        rows = np.arange(len(nodes))
        at_root = not nodes.taken.any()
        for step in range(ROOT_ROUNDS if at_root else TANGENT_ROUNDS):
            if step > 0:
                spared = np.maximum(1.0 - point[rows] @ self.columns.hits.T, 0.0)
                cost = point[rows] @ self.columns.cost.T / np.maximum(spared, ROUNDING)
            height, slope = tangents(ceiling[rows], unhit[rows], cost, spared > ROUNDING)
            gain = np.hstack([slope, height]) @ self._coefficients
            gain[~allowed[rows]] = -1.0
            best = np.argpartition(-gain, missing - 1, axis=1)[:, :missing]
            summed = height.sum(axis=1)
            bound = summed * (1 - ROUNDING) - np.take_along_axis(gain, best, axis=1).sum(axis=1)
            better = bound > lower[rows]
            lower[rows[better]] = bound[better]
            total[rows[better]], marginal[rows[better]] = summed[better], gain[better]
            corner = np.zeros(gain.shape)
            np.put_along_axis(corner, best, 1.0, axis=1)
            point[rows] += (corner - point[rows]) / (step + 1)
            rows = rows[lower[rows] <= self.limit]
        return lower, total, marginal


def tangents(
    ceiling: Floats,
    unhit: Floats,
    cost: Floats,
    spared: Booleans,
) -> tuple[Floats, Floats]:
    """Height and slope of the tangents to `ceiling` · exp(−x) at x = `cost`; all (B, K).

    A flat one at `unhit`, the least value without a hit, where that is
    higher; none at all for hypotheses that are not `spared` from being hit.
    """
    cost = np.clip(cost, 0.0, LARGEST_EXPONENT)
    slope = np.where(spared, ceiling * np.exp(-cost), 0.0)
    flat = spared & (unhit > slope)
    return np.where(flat, unhit, slope * (1.0 + cost)), np.where(flat, 0.0, slope)


def leading_copies(
    score: Floats,
    allowed: Booleans,
    missing: int,
    required: Floats,
) -> tuple[Ints, Ints]:
    """Rank the copies by score, and count the leading ones of which a set must have one.

    `score` has shape (B, P) or (P,), `allowed` (B, P). Sets of `missing` copies without
    any of the leading ones cannot bring the `required` (B,) sum of scores.
    Returns the ranks (B, P) and the numbers of leading copies (B,).
    """
    score = np.broadcast_to(score, allowed.shape)
    order = np.argsort(np.where(allowed, -score, np.inf), axis=1, kind='stable')
    rank = np.empty_like(order)
    np.put_along_axis(rank, order, np.arange(order.shape[1])[None], axis=1)
    sorted_score = np.take_along_axis(np.where(allowed, score, 0.0), order, axis=1)
    running = np.cumsum(np.insert(sorted_score, 0, 0.0, axis=1), axis=1)
    window = running[:, missing:] - running[:, :-missing]  # the best set from each rank on
    full = np.arange(window.shape[1]) <= allowed.sum(axis=1)[:, None] - missing
    return rank, ((window >= required[:, None]) & full).sum(axis=1)


def exp(exponent: 'Floats | float') -> Floats:
    """exp, without overflow: what is too large to matter stays merely large."""
    return np.exp(np.minimum(exponent, LARGEST_EXPONENT))


def log_sum(log_terms: Floats) -> Floats:
    """log Σ_k exp(log_terms[k]) over the first axis, at any magnitude."""
    largest = np.maximum(log_terms.max(axis=0, initial=-np.inf), -1e300)
    with np.errstate(divide='ignore'):
        return np.asarray(largest + np.log(np.exp(log_terms - largest).sum(axis=0)))
