"""Operators that have nothing to do with one another: plans for them can be found apart."""

from collections import defaultdict
from collections.abc import Sequence

from mirror_explainer.planning.downward.ground_task import Operator


def independent_parts(operators: Sequence[Operator]) -> list[list[Operator]]:
    """Split the operators so that no part changes a variable that another reads or changes."""
    changed = {variable for operator in operators for variable, _ in operator.effect}
    joined_to = {variable: variable for variable in changed}

    def root(variable: int) -> int:
        while joined_to[variable] != variable:
            joined_to[variable] = joined_to[joined_to[variable]]
            variable = joined_to[variable]
        return variable

    for operator in operators:
        first, *others = _variables(operator, changed)
        for variable in others:
            joined_to[root(variable)] = root(first)
    parts: dict[int, list[Operator]] = defaultdict(list)
    for operator in operators:
        parts[root(_variables(operator, changed)[0])].append(operator)
    return list(parts.values())


def _variables(operator: Operator, changed: set[int]) -> list[int]:
    """Return those of an operator's variables that are changed, first the ones it changes."""
    return [
        variable for variable, _ in (*operator.effect, *operator.condition) if variable in changed
    ]
