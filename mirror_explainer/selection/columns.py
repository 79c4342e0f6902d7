"""The positions of a plan as a search sees them: equal sentences made one, in logarithms.

Sums of logarithms neither overflow nor vanish, however long the plan and
however small the robot's own weight.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Booleans = NDArray[np.bool_]

TIE = 1e-9  # nats; gains that differ by less are equal
ROUNDING = 1e-12  # relative; sums of differences are not trusted beyond this
LARGEST_EXPONENT = 600.0  # exp of more would leave no room for sums


@dataclass(frozen=True)
class Columns:
    """The positions' columns, equal ones made one: K hypotheses, T sentences, P positions.

    Sentences are sorted by their single gain, the largest first; the P copies
    repeat every sentence as often as the plan has it, in the same order.
    """

    log_weight: Floats  # (K,) log w_k
    log_ratio: Floats  # (K, T) log r_k(s), −inf where the sentence is not in plan k
    single_gain: Floats  # (T,) information gain of the sentence alone, nats
    places: tuple[tuple[int, ...], ...]  # T × the columns that say this sentence, ascending
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
        places = [np.flatnonzero(sentence_of == t) for t in range(len(single_gain))]
        order = sorted(range(len(places)), key=lambda t: (-single_gain[t], places[t][0]))
        log_ratio, single_gain = log_ratio[:, order], single_gain[order]
        copies = np.array([len(places[t]) for t in order], dtype=np.int64)

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
            places=tuple(tuple(int(c) for c in places[t]) for t in order),
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
        return dict(sorted((c, t) for t, of in enumerate(self.places) for c in of))

    @cached_property
    def lacking(self) -> Booleans:
        """Where plan k lacks the sentence, shape (K, T)."""
        return np.isneginf(self.log_ratio)

    @cached_property
    def first_copy(self) -> Ints:
        """The place of each sentence's first copy among the P copies, shape (T,)."""
        return np.cumsum(self.copies) - self.copies

    @cached_property
    def _finite(self) -> Floats:
        """log r_k(s), 0 where plan k lacks the sentence, shape (K, T)."""
        return np.where(self.lacking, 0.0, self.log_ratio)

    def log_products(self, counts: Ints) -> Floats:
        """log w_k ∏_{i∈o} r_k(s_i), shape (..., K), of sets given as counts (..., T)."""
        hit = counts @ self.lacking.T > 0
        return np.where(hit, -np.inf, self.log_weight + counts @ self._finite.T)

    def log_value(self, counts: Ints) -> float:
        """log F of a set given as counts (T,)."""
        return float(log_sum(self.log_products(counts)))

    def log_floor(self, n: int) -> float:
        """A bound that no set of n sentences can go below: each hypothesis at its smallest."""
        never_hit = ~self.hits.any(axis=1)
        return float(log_sum((self.log_weight + self.least[:, n])[never_hit]))


def exp(exponent: 'Floats | float') -> Floats:
    """exp, without overflow: what is too large to matter stays merely large."""
    return np.exp(np.minimum(exponent, LARGEST_EXPONENT))


def log_sum(log_terms: Floats) -> Floats:
    """log Σ_k exp(log_terms[k]) over the first axis, at any magnitude."""
    largest = np.maximum(log_terms.max(axis=0, initial=-np.inf), -1e300)
    with np.errstate(divide='ignore'):
        return np.asarray(largest + np.log(np.exp(log_terms - largest).sum(axis=0)))
