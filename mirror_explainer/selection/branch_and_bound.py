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

Why not a solver library: F is a sum of products, not linear. Written out for
HiGHS (`scipy.optimize.milp`), where ratios are only 0 or 1 and it is a maximum
cover with one more variable a hypothesis, 100 actions against 100 hypotheses
took it 0.2 to 7 s for one N, 2 to 400 times as long as this search; with other
ratios it would need the logarithms made piecewise linear, and be inexact.
"""

import time
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from mirror_explainer.selection.bounds import leading_copies, tangents
from mirror_explainer.selection.columns import ROUNDING, TIE, Booleans, Columns, Floats, Ints, exp
from mirror_explainer.selection.scores import Scores

TANGENT_ROUNDS = 3
ROOT_ROUNDS = 15
CELLS_OPEN = 10_000_000  # nodes × hypotheses kept while not going deep
CELLS_AT_ONCE = 1_500_000  # nodes × hypotheses × positions handled in one step


@dataclass(frozen=True)
class Completion:
    """A set of sentences: how many copies of each (T,), its F, and its sum of single gains.

    `tied` says that others with the same sum may have been passed over for it.
    """

    counts: Ints
    value: float
    gain: float
    tied: bool


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
        self._coefficients = np.vstack([columns.cost, columns.hits])
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
                following = np.minimum(self.columns.first_copy + nodes.taken, rank.shape[1] - 1)
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
            merit = np.where(good, gain, -np.inf)
            best = int(merit.argmax())
            tied = bool((merit >= merit[best] - TIE).sum() > 1)
            yield Completion(counts[best], float(value[best]), float(gain[best]), tied)

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
        return nodes.taken + np.add.reduceat(
            leading, self.columns.first_copy, axis=1, dtype=np.int64
        )

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
            tied = bool((merit >= merit[node, last] - TIE).sum() > 1)
            yield Completion(counts, float(value[node, last]), float(gain[node, last]), tied)

    def _expand(self, nodes: Nodes, by_score: tuple[Ints, Ints] | None = None) -> None:
        """Close the nodes that cannot lead within the limits, and branch on the others.

        A set within the limits needs one of the sentences that lead in marginals
        and, if there are scores, one of those that lead in scores, which come
        as ranks (B, T) and numbers (B,); or else one of those that hit some
        hypothesis, unless that stays unhit. The smallest choice is branched on.
        """
        missing, every = nodes.missing, np.arange(len(nodes))
        unhit = exp(nodes.log_weight + self.columns.least[:, missing])  # (B, K)
        hitters = (nodes.left > 0) @ self.columns.lacking.T.astype(float)  # (B, K)
        floor = np.where(hitters == 0, unhit, 0.0).sum(axis=1)
        allowed = self.columns.copy < nodes.left[:, self.columns.sentence]
        lower, total, marginal = self._bound(nodes, allowed, unhit)
        lower = np.maximum(np.maximum(lower, floor), nodes.lower)

        rank, width = leading_copies(
            marginal, allowed, missing, total * (1 - ROUNDING) - self.limit
        )
        rank = rank[:, self.columns.first_copy]
        if by_score is not None:
            narrower = by_score[1] < width
            rank = np.where(narrower[:, None], by_score[0], rank)
            width = np.where(narrower, by_score[1], width)
        branch = (rank < width[:, None]) & (nodes.left > 0)  # (B, T) the witness sets

        hypothesis, effort = self._easiest_hit(unhit, hitters, floor)
        split = effort < branch.sum(axis=1)
        hitting = self.columns.lacking[hypothesis] & (nodes.left > 0)
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
        self._open.append(self._children(nodes, branch & alive[:, None], rank, lower))

    def _easiest_hit(self, unhit: Floats, hitters: Floats, floor: Floats) -> tuple[Ints, Floats]:
        """The hypothesis (B,) that few sentences hit and that weighs much, and what it takes (B,).

        `unhit` (B, K) is what each leaves of F without a hit, `hitters` (B, K) how many
        sentences hit it, `floor` (B,) what none can hit.
        """
        slack = np.maximum(self.limit - floor, ROUNDING)[:, None]
        urgency = np.minimum(1.0, unhit / slack)
        effort = np.divide(
            hitters,
            urgency,
            out=np.full_like(hitters, np.inf),
            where=(hitters > 0) & (urgency > 0),
        )
        hypothesis = effort.argmin(axis=1)
        return hypothesis, effort[np.arange(len(effort)), hypothesis]

    def _children(self, nodes: Nodes, branch: Booleans, rank: Ints, lower: Floats) -> Nodes:
        """Take each of the sentences `branch` (B, T) in turn, in order of rank (B, T).

        What an earlier child took, a later one must not take any more: no set is met twice.
        """
        every = np.arange(len(nodes))[:, None]
        last = rank.max(initial=0) + 1
        order = np.argsort(np.where(branch, rank, last), axis=1, kind='stable')
        place = np.empty_like(order)
        place[every, order] = np.arange(order.shape[1])
        node, nth = np.nonzero(np.arange(order.shape[1]) < branch.sum(axis=1)[:, None])
        chosen = order[node, nth]
        child = np.arange(len(node))
        left = np.where(place[node] < nth[:, None], 0, nodes.left[node])
        taken = nodes.taken[node]
        left[child, chosen] -= 1
        taken[child, chosen] += 1
        return Nodes(
            nodes.missing - 1,
            nodes.log_weight[node] + self.columns.log_ratio.T[chosen],
            left,
            taken,
            lower[node],
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
        at_root = self.scores is None and not nodes.taken.any()
        for step in range(ROOT_ROUNDS if at_root else TANGENT_ROUNDS):
            if step > 0:
                spared = np.maximum(1.0 - point[rows] @ self.columns.hits.T, 0.0)
                cost = point[rows] @ self.columns.cost.T / np.maximum(spared, ROUNDING)
            height, slope = tangents(ceiling[rows], unhit[rows], cost, spared > ROUNDING)
            gain = np.concatenate([slope, height], axis=1) @ self._coefficients
            gain[~allowed[rows]] = -1.0
            each = np.arange(len(rows))[:, None]
            best = np.argpartition(-gain, missing - 1, axis=1)[:, :missing]
            summed = height.sum(axis=1)
            bound = summed * (1 - ROUNDING) - gain[each, best].sum(axis=1)
            better = bound > lower[rows]
            lower[rows[better]] = bound[better]
            total[rows[better]], marginal[rows[better]] = summed[better], gain[better]
            corner = np.zeros(gain.shape)
            corner[each, best] = 1.0
            point[rows] += (corner - point[rows]) / (step + 1)
            rows = rows[lower[rows] <= self.limit]
            if not len(rows):
                break
        return lower, total, marginal
