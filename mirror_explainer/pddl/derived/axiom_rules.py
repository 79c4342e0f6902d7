"""Axioms of PDDL as rules of Datalog: their conditions, taken apart.

What a conjunction needs stands in one rule. A disjunction becomes a predicate of
its own with a rule for each alternative, a universal condition the negation of one.
"""

import itertools
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

import unified_planning.model as up

from mirror_explainer.pddl.derived.datalog import Atom, Fact, Rule

# Names of predicates that the rules need besides the domain's; none clashes with a PDDL name.
_EQUAL, _TYPE, _PART, _NEVER = '=', 'type:', 'part:', 'never:'


@dataclass(frozen=True)
class Axiom:
    """A derived predicate holds of the `variables` where the `body` does."""

    fluent: up.Fluent
    variables: tuple[up.Variable, ...]
    body: up.FNode


def is_made_up(predicate: str) -> bool:
    """Say whether the rules' predicate is not one of the domain."""
    return predicate.startswith(_PART)


class AxiomRules:
    """The rules that axioms come to; a part that is no conjunction gets rules of its own."""

    def __init__(self, axioms: Iterable[Axiom]) -> None:
        self.rules: list[Rule] = []
        self._kinds: set[up.Type] = set()
        self._count = itertools.count()
        for axiom in axioms:
            numbers = self._numbered(axiom.variables)
            head = Atom(axiom.fluent.name, tuple(numbers.values()))
            self._add(head, axiom.body, True, numbers)

    def facts(self, model: up.Problem) -> tuple[Fact, ...]:
        """Return the facts about equality and types that the rules need in every state."""
        equal = ((_EQUAL, item.name, item.name) for item in model.all_objects)
        typed = (
            (f'{_TYPE}{kind.name}', item.name)
            for kind in self._kinds
            for item in model.objects(kind)
        )
        return (*equal, *typed)

    def _add(
        self, head: Atom, body: up.FNode, holds: bool, numbers: Mapping[up.Variable, int]
    ) -> None:
        """Add the rule that the head holds if the body does, or does not; see `_literals`."""
        literals = [*self._literals(body, holds, numbers)]
        own = {variable: number for variable, number in numbers.items() if number in head.terms}
        positive = [atom for atom, wanted in literals if wanted]
        self.rules.append(
            Rule(
                head,
                (*positive, *self._types(own)),
                tuple(atom for atom, wanted in literals if not wanted),
            )
        )

    def _literals(
        self, part: up.FNode, holds: bool, numbers: Mapping[up.Variable, int]
    ) -> Iterator[tuple[Atom, bool]]:
        """Yield atoms that must hold, or must not, so that the part holds, or does not."""
        if part.is_not():
            yield from self._literals(part.arg(0), not holds, numbers)
        elif part.is_bool_constant():
            if part.is_true() != holds:
                yield Atom(_NEVER), True
        elif part.is_fluent_exp():
            yield Atom(part.fluent().name, _terms(part.args, numbers)), holds
        elif part.is_equals():
            yield Atom(_EQUAL, _terms(part.args, numbers)), holds
        elif part.is_and() if holds else part.is_or():
            for conjunct in part.args:
                yield from self._literals(conjunct, holds, numbers)
        elif part.is_implies() and not holds:
            yield from self._literals(part.arg(0), True, numbers)
            yield from self._literals(part.arg(1), False, numbers)
        elif part.is_exists() if holds else part.is_forall():
            own = self._numbered(part.variables())
            yield from self._literals(part.arg(0), holds, {**numbers, **own})
            yield from ((atom, True) for atom in self._types(own))
        else:
            yield self._part(part, holds, numbers)

    def _part(
        self, part: up.FNode, holds: bool, numbers: Mapping[up.Variable, int]
    ) -> tuple[Atom, bool]:
        """Return an atom for a part that is no conjunction, and whether it must hold."""
        free = sorted(_variables(part), key=lambda variable: numbers[variable])
        name = f'{_PART}{next(self._count)}'
        own = self._numbered(free)
        head = Atom(name, tuple(own.values()))
        if part.is_exists() or part.is_forall():  # nothing, or not all, is as it says
            self._add(head, part, not holds, own)
        elif part.is_implies():
            self._add(head, part.arg(0), False, own)
            self._add(head, part.arg(1), True, own)
        else:
            for alternative in part.args:
                self._add(head, alternative, holds, own)
        atom = Atom(name, tuple(numbers[variable] for variable in free))
        return atom, not (part.is_exists() or part.is_forall())

    def _numbered(self, variables: Iterable[up.Variable]) -> dict[up.Variable, int]:
        return {variable: next(self._count) for variable in variables}

    def _types(self, numbers: Mapping[up.Variable, int]) -> Iterator[Atom]:
        for variable, number in numbers.items():
            self._kinds.add(variable.type)
            yield Atom(f'{_TYPE}{variable.type.name}', (number,))


def _variables(expression: up.FNode) -> set[up.Variable]:
    """Return the variables that are free in an expression."""
    if expression.is_variable_exp():
        return {expression.variable()}
    bound = (
        set(expression.variables())
        if expression.is_exists() or expression.is_forall()
        else set[up.Variable]()
    )
    return set[up.Variable]().union(*map(_variables, expression.args)) - bound


def _terms(
    arguments: Iterable[up.FNode], numbers: Mapping[up.Variable, int]
) -> tuple[str | int, ...]:
    return tuple(
        numbers[argument.variable()] if argument.is_variable_exp() else str(argument)
        for argument in arguments
    )
