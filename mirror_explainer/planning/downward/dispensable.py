"""Operators that can be dispensed with: another one, or none, does as well in their place.

A lift need not stop where nobody waits or wants to go: one move is cheaper than two. An arm need
not put a part on another that the goal does not want there: the table does as well.

What is done instead leaves one variable with another value, and perhaps others with a better one:
whatever it is, no condition wants the one that they would have. From then on the rest of the plan
must do all the same: what needs the one value must have a counterpart that does with the other,
until the variable is the same again.
"""

import itertools
from collections import defaultdict
from collections.abc import Collection, Iterable, Iterator, Sequence

from mirror_explainer.planning.downward.ground_task import Fact, Operator

# What an operator makes of a variable that it needs, None if that stays; its cost, and what else
# it needs and makes true.
_Use = tuple[int | None, int, frozenset[Fact], frozenset[Fact]]

# After so many operators have been gone through, only those without an equal are.
_FEW = 3

_NOTHING = Operator('', (), (), 0)


def indispensable(
    operators: Sequence[Operator],
    goal: Iterable[Fact],
    mutexes: Iterable[frozenset[Fact]] = (),
    gain: int = 0,
) -> list[Operator]:
    """Return the operators without those that can be dispensed with.

    For each plan with one of these there is one without it that costs no more, and less by `gain`
    at least. Of the facts in one of `mutexes` one at most is ever true.
    """
    weighing = _Weighing(operators, goal, mutexes, gain)
    return [operator for operator in operators if not weighing.dispense_with(operator)]


class _Weighing:
    """Weighs one operator against those that are left."""

    def __init__(
        self,
        operators: Sequence[Operator],
        goal: Iterable[Fact],
        mutexes: Iterable[frozenset[Fact]],
        gain: int,
    ) -> None:
        self._goal = frozenset(goal)
        self._gain = gain
        self._mutexes: dict[Fact, set[Fact]] = defaultdict(set)
        for group in mutexes:
            for fact in group:
                self._mutexes[fact] |= group
        # By the facts that they need, and by what they make of these, None if they stay; those
        # that need least come first.
        self._users: dict[Fact, list[Operator]] = defaultdict(list)
        self._same: dict[tuple[Fact, int | None], list[Operator]] = defaultdict(list)
        for operator in sorted(operators, key=lambda operator: len(operator.needs)):
            for users in self._lists_of(operator):
                users.append(operator)
        self._wanted: dict[int, set[int]] = defaultdict(set)
        for variable, value in (*self._goal, *self._users):
            self._wanted[variable].add(value)
        # What each variable may become whatever it was.
        self._at_once: dict[int, set[int]] = defaultdict(set)
        for operator in operators:
            for variable, value in operator.changes.items():
                if variable not in operator.needs:
                    self._at_once[variable].add(value)
        self._uses: dict[Fact, dict[_Use, list[Operator]]] = {}

    def _lists_of(self, operator: Operator) -> Iterator[list[Operator]]:
        for fact in operator.needs.items():
            yield self._users[fact]
            yield self._same[fact, operator.changes.get(fact[0])]

    def dispense_with(self, operator: Operator) -> bool:
        """Say whether the operator can be dispensed with, and leave it out from then on."""
        matter = {v for v, value in operator.changes.items() if value in self._wanted[v]}
        spoils = len(matter) < len(operator.changes)
        if len(matter) > 1 and not spoils:
            return False  # to do one thing of several never does as well
        for variable in matter & operator.needs.keys():
            made = variable, operator.changes[variable]
            if made not in self._goal and self._is_needless(operator, made, spoils):
                self._leave_out(operator)
                return True
        return False

    def _leave_out(self, operator: Operator) -> None:
        for users in self._lists_of(operator):
            users.remove(operator)
        for fact in self._uses.keys() & operator.needs.items():
            equals = self._uses[fact][_use(operator, fact)]
            equals.remove(operator)
            if not equals:
                del self._uses[fact][_use(operator, fact)]

    def _is_needless(self, operator: Operator, made: Fact, spoils: bool) -> bool:
        """Say whether something else does as well that does not make this fact true."""
        variable, value = made
        before = operator.needs[variable]
        # What spoils nothing is weighed against doing nothing only, for others are mostly as good.
        others = self._users[variable, before] if spoils else ()
        for instead in itertools.chain((_NOTHING,), others):
            if len(instead.needs) >= len(operator.needs):
                break
            other = instead.changes.get(variable, before)
            saved = operator.cost - instead.cost - self._gain
            if (
                other != value
                and saved >= 0
                and instead.needs.items() <= operator.needs.items()
                and self._is_as_good(instead, operator, variable)
            ):
                kept = self._kept(made, instead, operator)
                if self._is_followed(made, other, saved, kept):
                    return True
        return False

    def _kept(self, made: Fact, instead: Operator, operator: Operator) -> set[Fact]:
        """Return what is true instead, and stays so, as long as the fact would be true.

        The operator makes it false; nothing can make it true again before the other fact is false,
        nor make anything else of it, which would have to find it true.
        """
        return {
            (v, kept)
            for v, value in operator.changes.items()
            if value not in self._wanted[v]
            and (kept := instead.changes.get(v, operator.needs.get(v))) is not None
            and (v, kept) in self._mutexes[made]
            and self._at_once[v] <= {kept}
        }

    def _is_followed(self, made: Fact, other: int, saved: float, kept: Collection[Fact]) -> bool:
        """Say whether all that needs a fact has a counterpart that does with the other value.

        The counterpart may cost more by what was `saved`, and find true what is `kept` so.
        """
        fact = (made[0], other)
        for number, after in enumerate(self._users[made]):
            if number == _FEW:
                uses = self._uses_of(made)
                unlike = uses.keys() - self._uses_of(fact).keys()
                return all(self._has_counterpart(uses[u][0], fact, saved, kept) for u in unlike)
            if not self._has_counterpart(after, fact, saved, kept):
                return False
        return True

    def _has_counterpart(
        self, after: Operator, fact: Fact, saved: float, kept: Collection[Fact]
    ) -> bool:
        end = after.changes.get(fact[0])
        most = after.cost if end is None else after.cost + saved
        return any(
            then.cost <= most
            and then.needs.items() - {fact} <= after.needs.items()
            and self._is_as_good(then, after, fact[0], kept)
            for then in self._counterparts(fact, end)
        )

    def _uses_of(self, fact: Fact) -> dict[_Use, list[Operator]]:
        """Return what needs a fact, by all that matters of it."""
        if fact not in self._uses:
            uses = self._uses[fact] = defaultdict(list)
            for operator in self._users[fact]:
                uses[_use(operator, fact)].append(operator)
        return self._uses[fact]

    def _counterparts(self, fact: Fact, end: int | None) -> Iterator[Operator]:
        """Yield what needs a fact and makes this of its variable."""
        yield from self._same.get((fact, end), ())
        if end == fact[1]:
            yield _NOTHING
            yield from self._same.get((fact, None), ())

    def _is_as_good(
        self, instead: Operator, operator: Operator, but: int, kept: Collection[Fact] = ()
    ) -> bool:
        """Say whether one leaves all variables but one as good as the other does."""
        ours, theirs = instead.changes, operator.changes
        for variable in (ours.keys() | theirs.keys()) - {but}:
            mine, wanted = ours.get(variable), self._wanted[variable]
            if variable not in theirs:
                good = wanted <= {mine}
            else:
                value = theirs[variable]
                good = (
                    value == mine
                    or value not in wanted
                    or (mine is None and (variable, value) in kept)
                )
            if not good:
                return False
        return True


def _use(operator: Operator, fact: Fact) -> _Use:
    """Return all that matters of an operator that needs a fact."""
    others = (change for change in operator.changes.items() if change[0] != fact[0])
    rest = frozenset(operator.needs.items() - {fact})
    return operator.changes.get(fact[0]), operator.cost, rest, frozenset(others)
