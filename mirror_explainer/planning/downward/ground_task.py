"""A planning task in finite-domain variables, without an initial state and goal.

A state is a tuple of values, one a variable; a fact is a (variable, value) pair.
"""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

Fact = tuple[int, int]
State = tuple[int, ...]

# The names of ground actions, in order.
Actions = tuple[str, ...]


def canonical(action: str) -> str:
    """Return the name of a ground action such as "(act )" as "(act)"."""
    return f'({" ".join(action.strip("() ").split())})'


@dataclass(frozen=True, eq=False)
class Operator:
    """A ground action, named "(move left center)": what it needs, what it makes true, its cost."""

    name: str
    condition: tuple[Fact, ...]
    effect: tuple[Fact, ...]
    cost: int

    @cached_property
    def needs(self) -> dict[int, int]:
        """The value that each variable must have."""
        return dict(self.condition)

    @cached_property
    def changes(self) -> dict[int, int]:
        """The value that each variable then gets, unless it must have it before."""
        return {v: value for v, value in self.effect if self.needs.get(v) != value}


@dataclass(frozen=True)
class GroundTask:
    """The operators of a task, for every initial state and goal.

    Variable v has `sizes[v]` values. Of the facts in one of `mutexes` one at most is ever true.
    """

    operators: tuple[Operator, ...]
    sizes: tuple[int, ...] = ()
    mutexes: tuple[frozenset[Fact], ...] = ()

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
