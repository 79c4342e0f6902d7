"""A planning task in finite-domain variables, as Fast Downward's search reads it.

A state is a tuple of values, one a variable; a fact is a (variable, value) pair.
"""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

Fact = tuple[int, int]
State = tuple[int, ...]


@dataclass(frozen=True)
class Operator:
    """A ground action, named "(move left center)": what it needs, what it makes true, its cost.

    `text` says the same as the search reads it.
    """

    name: str
    condition: tuple[Fact, ...]
    effect: tuple[Fact, ...]
    cost: int
    text: str


@dataclass(frozen=True)
class GroundTask:
    """All of a task but its initial state and goal.

    `head` and `axioms` are what the search reads before the initial state, and
    after the operators.
    """

    operators: tuple[Operator, ...]
    head: str
    axioms: str

    def text(self, state: State, goal: Sequence[Fact]) -> bytes:
        """Return the input of the search from a state to a goal."""
        values = '\n'.join(map(str, state))
        pairs = '\n'.join(f'{variable} {value}' for variable, value in goal)
        middle = f'begin_state\n{values}\nend_state\nbegin_goal\n{len(goal)}\n{pairs}\nend_goal\n'
        operators = ''.join([f'{len(self.operators)}\n', *(o.text for o in self.operators)])
        return f'{self.head}{middle}{operators}{self.axioms}'.encode()

    @cached_property
    def _by_name(self) -> dict[str, list[Operator]]:
        by_name: dict[str, list[Operator]] = defaultdict(list)
        for operator in self.operators:
            by_name[operator.name].append(operator)
        return by_name

    def cost(self, actions: Sequence[str]) -> int:
        """Return the summed cost of the actions."""
        return sum(self._by_name[name][0].cost for name in actions)

    def leads(self, actions: Sequence[str], state: State, goal: Sequence[Fact]) -> bool:
        """Say whether the actions can be done one after another, and then the goal holds."""
        values = list(state)
        for name in actions:
            for operator in self._by_name.get(name, ()):
                if all(values[variable] == value for variable, value in operator.condition):
                    for variable, value in operator.effect:
                        values[variable] = value
                    break
            else:
                return False
        return all(values[variable] == value for variable, value in goal)

    @cached_property
    def _needed_by(self) -> dict[Fact, list[int]]:
        needed_by: dict[Fact, list[int]] = defaultdict(list)
        for index, operator in enumerate(self.operators):
            for fact in operator.condition:
                needed_by[fact].append(index)
        return needed_by

    def relaxed_reachable(self, state: State) -> set[Fact]:
        """Return the facts that can be reached if nothing ever became false.

        A goal with a fact that is not among them has no plan.
        """
        missing = [len(operator.condition) for operator in self.operators]
        reached = set(enumerate(state))
        frontier = list(reached)
        for operator in self.operators:
            if not operator.condition:
                frontier += [fact for fact in operator.effect if fact not in reached]
                reached.update(operator.effect)
        while frontier:
            for index in self._needed_by.get(frontier.pop(), ()):
                missing[index] -= 1
                if not missing[index]:
                    for fact in self.operators[index].effect:
                        if fact not in reached:
                            reached.add(fact)
                            frontier.append(fact)
        return reached
