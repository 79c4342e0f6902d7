"""P(s|way) / P(s|π_R): how much better a sentence fits another way than the robot's own."""

from collections import Counter
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from mirror_explainer.listener.ends import Aim
from mirror_explainer.listener.listeners import Listener
from mirror_explainer.listener.way import Way
from mirror_explainer.planning import Plan

Floats = NDArray[np.float64]

_VALUES = -1  # in place of a plan's length, for a row that is given by its values


class Ratios:
    """The different rows of ratios, one value for each of the sentences told of π_R.

    `sentence_of` says a ground action; `goal` is the index of G_R, and `own_plans` are what
    planning found for b_R. Ways with the same row behave alike, whatever else they are.
    """

    def __init__(
        self,
        listener: Listener,
        way: Way,
        goal: int,
        sentence_of: Callable[[str], str],
        own_plans: Sequence[Plan],
    ) -> None:
        self.told = tuple(dict.fromkeys(way.sentences[::-1]))[
            ::-1
        ]  # in order of their last places
        self._open, self._delta = listener.is_open, listener.other_ends
        self._sentences = way.sentences
        self._sentence_of = sentence_of
        self._column = {sentence: column for column, sentence in enumerate(self.told)}
        counts = Counter(way.sentences)
        self._share = np.array([counts[s] for s in self.told]) / max(1, len(way.sentences))
        self._columns_of: dict[str, int | None] = {}
        self._row_of_plan: dict[tuple[str, ...], int] = {}
        # Rows by what they are made from: how often a plan has each sentence and how long it
        # is, or the values themselves.
        self._rows: dict[tuple[bytes, int], int] = {}
        self._own_ends = self._ends(way.aims[goal][0])
        ends = {column for aims in way.aims for column in self._ends(aims[0])}
        self._means = [column for column in range(len(self.told)) if column not in ends]
        needed = {self._column_of(action) for plan in own_plans for action in plan.actions}
        self._needless = [m for m in self._means if own_plans and m not in needed]

    def of_plan(self, actions: tuple[str, ...]) -> int:
        """Return the row of a foreseen way.

        For the planner's listener count(s in π) / |π| as a multiple of that of π_R; an empty
        plan says nothing. For the open one 1 where it has the sentence, else 0; but 1 for
        a means of π_R that is in no plan found for b_R: not even who believes what the
        robot does foresees it, so it tells nothing of what they believe.
        """
        row = self._row_of_plan.get(actions)
        if row is None:
            counts = self._counts(actions)
            row = self._row_of_plan[actions] = self._row(counts, 0 if self._open else len(actions))
        return row

    def _counts(self, actions: tuple[str, ...]) -> bytes:
        """How often a way has each sentence; to the open listener, whether it has it."""
        counts = [0] * len(self.told)
        for action in actions:
            column = self._column_of(action)
            if column is not None:
                counts[column] += 1
        if self._open:
            for column in self._needless:
                counts[column] = 1
            return bytes(map(bool, counts))
        return np.array(counts, dtype=np.uint32).tobytes()

    def of_aim(self, aim: Aim, means: Floats) -> int:
        """Return the row of an unforeseen way: κ of the method, section 1.

        For the open listener `means`, shape (T,), is what a sentence weighs that is nobody's
        end.
        """
        ends = self._ends(aim)
        row = np.ones(len(self.told))
        if self._open:
            row[self._means] = means[self._means]
        row[list(self._own_ends - ends)] = self._delta
        row[list(ends - self._own_ends)] = 1.0 / self._delta
        return self._row(row.tobytes(), _VALUES)

    @property
    def rows(self) -> Floats:
        """All rows, shape (R, T)."""
        rows = np.empty((len(self._rows), len(self.told)), order='F')
        if not self.told:
            return rows
        kinds = np.array([length for _, length in self._rows])
        for values, of_kind, dtype in (
            (True, kinds == _VALUES, np.float64),
            (False, kinds != _VALUES, np.uint8 if self._open else np.uint32),
        ):
            texts = [text for text, length in self._rows if (length == _VALUES) is values]
            rows[of_kind] = np.frombuffer(b''.join(texts), dtype).reshape(-1, len(self.told))
        if not self._open:
            lengths = np.where(kinds == _VALUES, 1, kinds)
            scale = np.where(kinds[:, None] == _VALUES, 1.0, self._share)
            rows /= np.maximum(lengths, 1)[:, None] * scale
        return rows

    def _ends(self, aim: Aim) -> frozenset[int]:
        return frozenset(self._column[self._sentences[position]] for position in aim.ends.values())

    def _column_of(self, action: str) -> int | None:
        if action not in self._columns_of:
            self._columns_of[action] = self._column.get(self._sentence_of(action))
        return self._columns_of[action]

    def _row(self, text: bytes, length: int) -> int:
        return self._rows.setdefault((text, length), len(self._rows))
