"""A task as Fast Downward's search reads it, of some variables, which are numbered anew."""

from collections import defaultdict
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property

from mirror_explainer.planning.downward.ground_task import Fact, Operator, State


@dataclass(frozen=True)
class SearchTask:
    """A task without its initial state: variable v has `sizes[v]` values."""

    sizes: tuple[int, ...]
    goal: tuple[Fact, ...]
    operators: tuple[Operator, ...]

    def text(self, state: State) -> bytes:
        """Return the input of the search (www.fast-downward.org: "translator output format")."""
        return '\n'.join([self._head, *map(str, state), self._rest]).encode()

    @cached_property
    def _head(self) -> str:
        lines = ['begin_version', '3', 'end_version', 'begin_metric', '1', 'end_metric']
        lines.append(str(len(self.sizes)))
        for variable, size in enumerate(self.sizes):
            lines += ['begin_variable', f'var{variable}', '-1', str(size)]
            lines += [f'Atom v{variable}({value})' for value in range(size)]
            lines.append('end_variable')
        return '\n'.join([*lines, '0', 'begin_state'])

    @cached_property
    def _rest(self) -> str:
        lines = ['end_state', 'begin_goal', *_listed(self.goal), 'end_goal']
        lines.append(str(len(self.operators)))
        for operator in self.operators:
            needs, changes = operator.needs, operator.changes
            stays = [fact for fact in needs.items() if fact[0] not in changes]
            lines += ['begin_operator', operator.name[1:-1], *_listed(stays), str(len(changes))]
            lines += [f'0 {v} {needs.get(v, -1)} {value}' for v, value in changes.items()]
            lines += [str(operator.cost), 'end_operator']
        return '\n'.join([*lines, '0', ''])


def _listed(facts: Sequence[Fact]) -> list[str]:
    return [str(len(facts)), *(f'{variable} {value}' for variable, value in facts)]


class Numbering:
    """New numbers for some variables, as far as they are needed, and for their values.

    All values that nothing needs become one. `sizes` are the numbers of values as before.
    Variables that are left out must always be as the conditions on them want.
    """

    def __init__(
        self,
        sizes: Sequence[int],
        operators: Sequence[Operator],
        goal: Sequence[Fact],
        variables: Collection[int],
    ) -> None:
        needed: dict[int, set[int]] = defaultdict(set)
        for variable, value in (*goal, *(fact for o in operators for fact in o.condition)):
            if variable in variables:
                needed[variable].add(value)
        self._variables = {variable: number for number, variable in enumerate(sorted(needed))}
        self._values = {
            variable: {value: number for number, value in enumerate(sorted(values))}
            for variable, values in needed.items()
        }
        self.task = SearchTask(
            tuple(min(len(self._values[v]) + 1, sizes[v]) for v in self._variables),
            self._facts(goal),
            tuple(
                Operator(o.name, self._facts(o.condition), self._facts(o.effect), o.cost)
                for o in operators
            ),
        )

    def state(self, state: State) -> State:
        """Return a state in the new numbers."""
        return tuple(value for _, value in self._facts((v, state[v]) for v in self._variables))

    def _facts(self, facts: Iterable[Fact]) -> tuple[Fact, ...]:
        return tuple(
            (self._variables[v], self._values[v].get(value, len(self._values[v])))
            for v, value in facts
            if v in self._variables
        )
