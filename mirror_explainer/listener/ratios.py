"""P(s|way) / P(s|π_R): how much better a sentence fits another way than the robot's own."""

import functools
from collections.abc import Sequence

import numpy as np

from mirror_explainer.listener.ends import Aim
from mirror_explainer.listener.listeners import Listener
from mirror_explainer.listener.way import Way
from mirror_explainer.planning import Plan
from mirror_explainer.selection.evidence import Floats


class Ratios:
    """The different rows of ratios, one value for each of the T sentences told of π_R.

    `told` are these, in the order of their last places. `goal` is the index of G_R, and
    `own_plans` are what planning found for b_R. Ways with the same row behave alike, whatever
    else they are.
    """

    def __init__(self, listener: Listener, way: Way, goal: int, own_plans: Sequence[Plan]) -> None:
        self.told = tuple(dict.fromkeys(way.sentences[::-1]))[::-1]
        self._listener, self._way = listener, way
        self._column = {sentence: column for column, sentence in enumerate(self.told)}
        self._column_of = functools.cache(lambda action: self._column.get(way.sentence_of(action)))
        self._row_of_plan: dict[tuple[str, ...], int] = {}
        self._rows: dict[bytes, int] = {}  # by their values
        self._own_ends = self._ends(way.aims[goal][0])
        ends = {column for aims in way.aims for column in self._ends(aims[0])}
        self._means = [column for column in range(len(self.told)) if column not in ends]
        needed = {column for plan in own_plans for column in self._columns(plan.actions)}
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
            if self._listener.is_open:
                ratios = np.zeros(len(self.told))
                ratios[self._columns(actions) + self._needless] = 1.0
            else:
                ratios = self._share(actions) / self._own_share
            row = self._row_of_plan[actions] = self._row(ratios)
        return row

    def of_aim(self, aim: Aim, means: Floats) -> int:
        """Return the row of an unforeseen way: κ of the method, section 1.

        For the open listener `means`, shape (T,), is what a sentence weighs that is nobody's
        end.
        """
        ends, delta = self._ends(aim), self._listener.other_ends
        ratios = np.ones(len(self.told))
        if self._listener.is_open:
            ratios[self._means] = means[self._means]
        ratios[list(self._own_ends - ends)] = delta
        ratios[list(ends - self._own_ends)] = 1.0 / delta
        return self._row(ratios)

    @property
    def rows(self) -> Floats:
        """All rows, shape (R, T); each sentence's ratios are next to each other in memory."""
        rows = np.frombuffer(b''.join(self._rows)).reshape(len(self._rows), len(self.told))
        return np.asfortranarray(rows)

    @functools.cached_property
    def _own_share(self) -> Floats:
        return self._share(self._way.plan.actions)

    def _share(self, actions: Sequence[str]) -> Floats:
        """Count(s in π) / |π| for each sentence."""
        counts = np.bincount(self._columns(actions), minlength=len(self.told))
        return counts / max(1, len(actions))

    def _columns(self, actions: Sequence[str]) -> list[int]:
        """The columns of the actions whose sentences π_R has, too."""
        return [c for action in actions if (c := self._column_of(action)) is not None]

    def _ends(self, aim: Aim) -> frozenset[int]:
        return frozenset(self._columns([self._way.plan.actions[p] for p in aim.positions]))

    def _row(self, ratios: Floats) -> int:
        return self._rows.setdefault(ratios.tobytes(), len(self._rows))
