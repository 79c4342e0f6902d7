"""Optimal plans put together from pieces of others, where a task falls into independent parts.

The actions of an optimal plan that belong to one part are an optimal plan for that
part's share of the goal: a cheaper one could take their place. So what was found
for two initial states also answers a third that is like one here and like the other there.
"""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass

from mirror_explainer.planning.downward.ground_task import Fact, GroundTask, State
from mirror_explainer.planning.downward.independent_parts import independent_parts

Piece = tuple[int, tuple[Fact, ...], tuple[int, ...]]


@dataclass(frozen=True)
class _Part:
    """The variables that a part changes, and all that it reads or changes."""

    changes: frozenset[int]
    concerns: tuple[int, ...]


class PiecedPlans:
    """What optimal plans have shown about each part: nothing where a task is all one part."""

    def __init__(self, task: GroundTask) -> None:
        self._parts: list[_Part] = []
        self._part_of: dict[str, set[int]] = defaultdict(set)
        self._known: dict[Piece, tuple[str, ...]] = {}
        for number, operators in enumerate(independent_parts(task.operators)):
            changes = {variable for o in operators for variable, _ in o.effect}
            reads = {variable for o in operators for variable, _ in o.condition}
            self._parts.append(_Part(frozenset(changes), tuple(sorted(changes | reads))))
            for operator in operators:
                self._part_of[operator.name].add(number)
        # An action with alternatives in its condition is several operators of one name.
        self._apart = len(self._parts) > 1 and all(len(p) == 1 for p in self._part_of.values())

    def learn(self, state: State, goal: Sequence[Fact], plan: Sequence[str]) -> None:
        """Take in an optimal plan."""
        if self._apart:
            for piece in self._pieces(state, goal):
                own = tuple(name for name in plan if piece[0] in self._part_of[name])
                self._known.setdefault(piece, own)

    def plan(self, state: State, goal: Sequence[Fact]) -> tuple[str, ...] | None:
        """Return an optimal plan if all its pieces are known, None otherwise.

        Not to be asked for a goal with a fact that does not hold and that no operator changes.
        """
        if not self._apart:
            return None
        pieces = [self._known.get(piece) for piece in self._pieces(state, goal)]
        known = [piece for piece in pieces if piece is not None]
        if len(known) < len(pieces):
            return None
        return tuple(action for piece in known for action in piece)

    def _pieces(self, state: State, goal: Sequence[Fact]) -> list[Piece]:
        """Return what each part has to reach, and from where."""
        pieces = []
        for number, part in enumerate(self._parts):
            facts = tuple(fact for fact in goal if fact[0] in part.changes)
            if facts:
                pieces.append((number, facts, tuple(state[v] for v in part.concerns)))
        return pieces
