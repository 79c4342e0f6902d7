"""States as plain values, and what conditions and effects come to in them.

A state outlives unified-planning's expressions, which are forgotten now and then; an
`Evaluator` reads these, and must be used before.
"""

import itertools
import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

import unified_planning.model as up
from unified_planning.model.operators import OperatorKind as Kind

from mirror_explainer.pddl.atoms import ground_text
from mirror_explainer.pddl.derived.facts import DerivedFacts
from mirror_explainer.pddl.task import Task

# What a condition or an expression comes to: a truth value, a number, or an object's name.
Value = bool | Fraction | str
# The objects that parameters and variables stand for, by their names without question marks.
Binding = Mapping[str, str]

_FREE: Binding = {}


class UnknownNumberError(Exception):
    """A number that is needed has no value; `atom` is its text."""

    def __init__(self, atom: str) -> None:
        super().__init__(atom)
        self.atom = atom


class ConflictError(Exception):
    """Effects at one moment give a number different values."""


@dataclass(frozen=True)
class State:
    """What holds: the atoms that are true, derived ones left out, and the numbers' values.

    Atoms are texts as `atom_text` makes them.
    """

    facts: frozenset[str]
    numbers: Mapping[str, Fraction] = field(default_factory=dict)

    def after(self, changes: Mapping[str, bool | Fraction]) -> 'State':
        """Return the state with some atoms' values changed."""
        added = {atom for atom, value in changes.items() if value is True}
        deleted = {atom for atom, value in changes.items() if value is False}
        numbers = {a: value for a, value in changes.items() if not isinstance(value, bool)}
        return State(
            self.facts - deleted | added, {**self.numbers, **numbers} if numbers else self.numbers
        )


class Evaluator:
    """Works out conditions and effects of a task in its states.

    Raises UnknownNumberError for a number without a value, and NotImplementedError
    for what no state tells, such as a trajectory constraint.
    """

    def __init__(self, task: Task) -> None:
        self.model = task.timed or task.model
        self.derived = DerivedFacts(task.axioms)
        self._objects: dict[up.Type, list[str]] = {}

    def first_state(self) -> State:
        """Return the task's initial state."""
        facts, numbers = set[str](), dict[str, Fraction]()
        for expression, value in self.model.explicit_initial_values.items():
            if value.is_bool_constant():
                if value.is_true():
                    facts.add(self.atom(expression))
            else:
                numbers[self.atom(expression)] = Fraction(value.constant_value())
        return State(frozenset(facts), numbers)

    def atom(self, expression: up.FNode, binding: Binding = _FREE) -> str:
        """Return the ground atom, as text, that a predicate or function with terms stands for."""
        return ground_text(
            expression.fluent().name, [_term(term, binding) for term in expression.args]
        )

    def holds(self, condition: up.FNode, state: State, binding: Binding = _FREE) -> bool:
        """Say whether a condition holds in the state."""
        return self.value(condition, state, binding) is True

    def value(self, expression: up.FNode, state: State, binding: Binding = _FREE) -> Value:
        """Return what the expression comes to in the state."""
        kind, args = expression.node_type, expression.args
        if kind is Kind.FLUENT_EXP:
            return self.value_of(self.atom(expression, binding), state, expression.fluent())
        if kind in _TERMS:
            return _term(expression, binding)
        if expression.is_constant():
            constant = expression.constant_value()
            return constant if isinstance(constant, bool) else Fraction(constant)
        if kind is Kind.NOT:
            return not self.holds(args[0], state, binding)
        if kind is Kind.IMPLIES:
            return not self.holds(args[0], state, binding) or self.holds(args[1], state, binding)
        if kind in (Kind.AND, Kind.OR):
            every = (self.holds(part, state, binding) for part in args)
            return all(every) if kind is Kind.AND else any(every)
        if kind in (Kind.FORALL, Kind.EXISTS):
            each = (
                self.holds(args[0], state, own)
                for own in self.bindings(expression.variables(), binding)
            )
            return all(each) if kind is Kind.FORALL else any(each)
        if kind not in _CALCULATED:
            raise NotImplementedError(f'{expression}')
        found: Value = _CALCULATED[kind](*(self.value(part, state, binding) for part in args))
        return found

    def value_of(self, atom: str, state: State, fluent: up.Fluent | None = None) -> Value:
        """Return whether an atom holds, or a number's value."""
        if fluent is None or fluent.type.is_bool_type():
            if fluent is None and atom in state.numbers:
                return state.numbers[atom]
            return atom in state.facts or self.derived.hold(atom, state.facts)
        if atom not in state.numbers:
            raise UnknownNumberError(atom)
        return state.numbers[atom]

    def bindings(
        self, variables: Sequence[up.Variable], binding: Binding = _FREE
    ) -> Iterator[Binding]:
        """Yield the binding with every choice of objects for the variables."""
        for objects in itertools.product(*(self._named(v.type) for v in variables)):
            own = zip((variable.name for variable in variables), objects, strict=True)
            yield {**binding, **dict(own)}

    def changes(
        self, effects: Iterable[up.Effect], state: State, binding: Binding = _FREE
    ) -> dict[str, bool | Fraction]:
        """Return the values that effects at one moment give to atoms; added beats deleted.

        A number without a value stays without one. Raises ConflictError.
        """
        changes: dict[str, bool | Fraction] = {}
        assigned, counted = set[str](), set[str]()
        for effect in effects:
            for own in self.bindings(effect.forall, binding):
                if not self.holds(effect.condition, state, own):
                    continue
                atom = self.atom(effect.fluent, own)
                if effect.fluent.fluent().type.is_bool_type():
                    holds = self.holds(effect.value, state, own)
                    changes[atom] = holds or changes.get(atom) is True
                    continue
                try:
                    change = self.value(effect.value, state, own)
                    old = changes.get(atom, state.numbers.get(atom))
                except UnknownNumberError:
                    continue
                assert isinstance(change, Fraction)
                if effect.is_assignment():
                    if atom in counted or changes.get(atom, change) != change:
                        raise ConflictError(atom)
                    assigned.add(atom)
                    changes[atom] = change
                elif atom in assigned:
                    raise ConflictError(atom)
                elif old is not None:
                    counted.add(atom)
                    changes[atom] = old + (change if effect.is_increase() else -change)
        return changes

    def atoms(self, expression: up.FNode, binding: Binding = _FREE) -> Iterator[str]:
        """Yield every ground atom that the expression looks at, quantifiers expanded."""
        if expression.is_fluent_exp():
            yield self.atom(expression, binding)
        elif expression.is_forall() or expression.is_exists():
            for own in self.bindings(expression.variables(), binding):
                yield from self.atoms(expression.arg(0), own)
        else:
            for part in expression.args:
                yield from self.atoms(part, binding)

    def _named(self, kind: up.Type) -> list[str]:
        if kind not in self._objects:
            self._objects[kind] = [item.name for item in self.model.objects(kind)]
        return self._objects[kind]


_TERMS = (Kind.PARAM_EXP, Kind.VARIABLE_EXP, Kind.OBJECT_EXP)


def _term(term: up.FNode, binding: Binding) -> str:
    """Return the object that a term stands for."""
    if term.is_parameter_exp():
        return binding[term.parameter().name]
    if term.is_variable_exp():
        return binding[term.variable().name]
    return str(term.object().name)


_CALCULATED: dict[Kind, Callable[..., Any]] = {
    Kind.IFF: lambda one, other: one == other,
    Kind.EQUALS: lambda one, other: one == other,
    Kind.LE: lambda one, other: one <= other,
    Kind.LT: lambda one, other: one < other,
    Kind.PLUS: lambda *terms: sum(terms),
    Kind.MINUS: lambda one, other: one - other,
    Kind.TIMES: lambda *factors: math.prod(factors),
    Kind.DIV: lambda one, other: one / other,
}
