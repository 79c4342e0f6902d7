"""A task as Fast Downward's search reads it, of some variables, which are numbered anew."""

from collections import defaultdict
from collections.abc import Collection, Iterator, Sequence

from mirror_explainer.planning.downward.ground_task import Fact, Operator, State


class SearchTask:
    """A task without its initial state, of some `variables` as far as they are needed.

    All values that nothing needs become one. `sizes` are the numbers of values before that.
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
        for variable, value in (*goal, *(fact for o in operators for fact in o.needs.items())):
            if variable in variables:
                needed[variable].add(value)
        self._numbers = {variable: number for number, variable in enumerate(sorted(needed))}
        self._values: dict[Fact, int] = {}
        for variable in self._numbers:
            values = sorted(needed[variable])
            others = sorted({*range(sizes[variable])} - needed[variable])
            self._values |= {(variable, value): number for number, value in enumerate(values)}
            self._values |= {(variable, value): len(values) for value in others}
        counts = [min(len(needed[v]) + 1, sizes[v]) for v in self._numbers]
        self._head = '\n'.join(_head(counts))
        self._rest = '\n'.join(self._operators_and_goal(operators, goal))

    def text(self, state: State) -> bytes:
        """Return the input of the search (www.fast-downward.org: "translator output format")."""
        values = (str(self._values[v, state[v]]) for v in self._numbers)
        return '\n'.join([self._head, *values, self._rest]).encode()

    def _operators_and_goal(
        self, operators: Sequence[Operator], goal: Sequence[Fact]
    ) -> Iterator[str]:
        numbers, values = self._numbers, self._values
        facts = {fact: f'{numbers[fact[0]]} {value}' for fact, value in values.items()}
        wanted = [facts[fact] for fact in goal if fact in facts]
        yield from ('end_state', 'begin_goal', str(len(wanted)), *wanted, 'end_goal')
        yield str(len(operators))
        for operator in operators:
            needs, changes = operator.needs, operator.changes
            stays = [facts[f] for f in needs.items() if f in facts and f[0] not in changes]
            makes = [
                f'0 {numbers[v]} {values[v, needs[v]] if v in needs else -1} {values[v, value]}'
                for v, value in changes.items()
                if v in numbers
            ]
            yield from ('begin_operator', operator.name[1:-1], str(len(stays)), *stays)
            yield from (str(len(makes)), *makes, str(operator.cost), 'end_operator')
        yield from ('0', '')


def _head(sizes: Sequence[int]) -> Iterator[str]:
    yield from ('begin_version', '3', 'end_version', 'begin_metric', '1', 'end_metric')
    yield str(len(sizes))
    for variable, size in enumerate(sizes):
        yield from ('begin_variable', f'var{variable}', '-1', str(size))
        yield from (f'Atom v{variable}({value})' for value in range(size))
        yield 'end_variable'
    yield from ('0', 'begin_state')
