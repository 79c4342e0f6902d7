"""PDDL's arithmetic, exactly, on the numbers that a problem begins with."""

import itertools
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction

from mirror_explainer.pddl.text.actions import CHANGES, Parts, effects
from mirror_explainer.pddl.text.declarations import Declarations, Kinds
from mirror_explainer.pddl.text.initial import initial_values
from mirror_explainer.pddl.text.numerals import number
from mirror_explainer.pddl.text.tree import Branch, Tree, Word

# As many as can be written and planned with.
MOST_TUPLES = 100_000
_COMPARE = {
    '=': lambda a, b: a == b,
    '<': lambda a, b: a < b,
    '<=': lambda a, b: a <= b,
    '>': lambda a, b: a > b,
    '>=': lambda a, b: a >= b,
}

Binding = Mapping[str, str]


class TooManyError(Exception):
    """There are more combinations of objects than can be worked out."""


@dataclass(frozen=True)
class Numbers:
    """The initial numbers of a task, and which of its functions change."""

    declared: Declarations
    values: Mapping[tuple[str, ...], Fraction]
    changing: frozenset[str]

    def functions(self, tree: Tree) -> set[str]:
        """Return the functions that a number, or a comparison of numbers, is made of."""
        if isinstance(tree, Word):
            return {str(tree)} & self.declared.functions.keys()
        found = {tree.head} & self.declared.functions.keys()
        return found.union(*map(self.functions, tree[1:]))

    def is_static(self, tree: Tree) -> bool:
        """Say whether a number is the same in all states."""
        return not self.functions(tree) & self.changing

    def is_comparison(self, tree: Branch) -> bool:
        """Say whether a condition compares numbers."""
        if tree.head not in _COMPARE or len(tree) != 3:
            return False
        return tree.head != '=' or any(
            isinstance(side, Branch)
            or (
                side not in self.declared.objects
                and (number(side) is not None or side in self.declared.functions)
            )
            for side in tree[1:]
        )

    def value(self, tree: Tree, binding: Binding) -> Fraction | None:
        """Return what a number comes to initially, None where it has no value.

        Raises ZeroDivisionError.
        """
        if isinstance(tree, Word):
            given = number(tree)
            return self.values.get((str(tree),)) if given is None else given
        head, parts = tree.head, tree[1:]
        if head in ('+', '-', '*', '/'):
            values = [self.value(part, binding) for part in parts]
            known = [value for value in values if value is not None]
            if not known or len(known) < len(values):
                return None
            return _result(head, known)
        names = (binding.get(str(word), str(word)) for word in parts if isinstance(word, Word))
        return self.values.get((head, *names))

    def holds(self, comparison: Branch, binding: Binding) -> bool:
        """Say whether a comparison holds initially; it does not where a number has no value."""
        try:
            left, right = (self.value(side, binding) for side in comparison[1:])
        except ZeroDivisionError:
            return False
        if left is None or right is None:
            return False
        return bool(_COMPARE[comparison.head](left, right))

    def bindings(self, variables: Mapping[str, Kinds]) -> Iterator[dict[str, str]]:
        """Yield every choice of objects for some variables. Raises TooManyError."""
        extents = [self.declared.extent(kinds) for kinds in variables.values()]
        if math.prod(map(len, extents)) > MOST_TUPLES:
            raise TooManyError
        for objects in itertools.product(*extents):
            yield dict(zip(variables, objects, strict=True))


def numbers_of(parts: Parts, declared: Declarations) -> Numbers:
    """Return the numbers of a task."""
    values: dict[tuple[str, ...], Fraction] = {}
    for atom, value in initial_values(parts.problem):
        if not isinstance(value, bool):
            values[tuple(map(str, atom))] = value
    return Numbers(declared, values, frozenset(name for name, _ in changes(parts)))


def changes(parts: Parts) -> Iterator[tuple[str, Tree]]:
    """Yield each function that actions change, and by what."""
    for action in parts.actions:
        for effect in effects(action.parts.get(':effect'), parts.domain.source, action.durative):
            if name := changed_function(effect.change):
                yield name, effect.change[2]


def changed_function(change: Branch) -> str:
    """Return the function that a change of a number is about, "" if it is about none."""
    if change.head not in CHANGES or len(change) != 3:
        return ''
    return change[1].head if isinstance(change[1], Branch) else str(change[1])


def used_variables(tree: Tree) -> list[str]:
    """Return the variables in a tree, each once."""
    if isinstance(tree, Word):
        return [str(tree)] if tree.startswith('?') else []
    return [*dict.fromkeys(name for part in tree for name in used_variables(part))]


def decimal(value: Fraction, digits: int = 6) -> str:
    """Return a number with at most so many decimals, exactly where they are enough."""
    rounded = Fraction(round(value * 10**digits), 10**digits)
    sign = '-' if rounded < 0 else ''
    whole, rest = divmod(abs(rounded), 1)
    decimals = str(int(rest * 10**digits)).zfill(digits).rstrip('0') if digits else ''
    return f'{sign}{whole}.{decimals}' if decimals else f'{sign}{whole}'


def _result(operator: str, values: list[Fraction]) -> Fraction | None:
    if operator == '+':
        return sum(values, Fraction(0))
    if operator == '*':
        return math.prod(values, start=Fraction(1))
    if operator == '-':
        return -values[0] if len(values) == 1 else values[0] - sum(values[1:])
    return values[0] / math.prod(values[1:], start=Fraction(1))
