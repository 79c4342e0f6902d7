"""What matters to one goal: no optimal plan needs the operators and variables left out here.

Every search gets a task of its own, mostly much smaller than what was grounded for all beliefs.
Costs stay exact: whatever plan uses an operator left out, there is one without it that is
no dearer.
"""

from collections import defaultdict
from collections.abc import Iterable, Sequence
from functools import cached_property

from mirror_explainer.planning.downward.dispensable import indispensable
from mirror_explainer.planning.downward.ground_task import Fact, GroundTask, Operator, State
from mirror_explainer.planning.downward.portfolio import Try, plain
from mirror_explainer.planning.downward.search_task import SearchTask


class GoalTask:
    """One goal of a ground task: what matters to it, from each initial state.

    `operators` are those that can help, and cannot be dispensed with at this `gain` in cost:
    with 1 every optimal plan stays one, with 0 it is enough that one does. Nothing but
    `variables` matters.
    """

    def __init__(self, task: GroundTask, goal: tuple[Fact, ...], gain: int = 1) -> None:
        self.goal = goal
        self._helpful = helpful(task.operators, goal)
        self.variables = {v for o in self._helpful for v in o.needs} | {v for v, _ in goal}
        self._task = task
        self._gain = gain

    @cached_property
    def operators(self) -> list[Operator]:
        """The operators that can help, and cannot be dispensed with."""
        left = indispensable(self._helpful, self.goal, self._task.mutexes, self._gain)
        return helpful(left, self.goal) if len(left) < len(self._helpful) else self._helpful

    @cached_property
    def _relaxation(self) -> 'Relaxation':
        return Relaxation(self.operators)

    def may_be_reached(self, state: State) -> bool:
        """Say whether the goal could be reached if nothing ever became false."""
        return self._relaxation.reached(state).issuperset(self.goal)

    def text(self, state: State) -> bytes:
        """Return the input of a search from a state."""
        return self._search_task.text(state)

    @cached_property
    def searches(self) -> tuple[tuple[str, ...], Try | None]:
        """Which searches to try, and what suits in all likelihood."""
        return plain(self.operators)

    @cached_property
    def _search_task(self) -> SearchTask:
        return SearchTask(self._task.sizes, self.operators, self.goal, self.variables)


def helpful(operators: Sequence[Operator], goal: Iterable[Fact]) -> list[Operator]:
    """Return the operators that bring about the goal, or what one of these needs.

    A plan stays one without the others: every fact that is needed is true as it was.
    """
    bringing = defaultdict(list)
    for index, operator in enumerate(operators):
        for fact in operator.changes.items():
            bringing[fact].append(index)
    found: set[int] = set()
    needed = set(goal)
    open_facts = list(needed)
    while open_facts:
        for index in bringing.get(open_facts.pop(), ()):
            if index not in found:
                found.add(index)
                new = set(operators[index].condition) - needed
                needed |= new
                open_facts += new
    return [operators[index] for index in sorted(found)]


class Relaxation:
    """What operators could reach if nothing ever became false."""

    def __init__(self, operators: Sequence[Operator]) -> None:
        self._effects = [operator.effect for operator in operators]
        self._missing = [len(operator.condition) for operator in operators]
        self._needed_by: dict[Fact, list[int]] = defaultdict(list)
        for index, operator in enumerate(operators):
            for fact in operator.condition:
                self._needed_by[fact].append(index)

    def reached(self, state: State) -> set[Fact]:
        """Return the facts that are true sometime."""
        missing = list(self._missing)
        reached = set(enumerate(state))
        for index, count in enumerate(missing):
            if not count:
                reached.update(self._effects[index])
        open_facts = list(reached)
        while open_facts:
            for index in self._needed_by.get(open_facts.pop(), ()):
                missing[index] -= 1
                if not missing[index]:
                    for fact in self._effects[index]:
                        if fact not in reached:
                            reached.add(fact)
                            open_facts.append(fact)
        return reached
