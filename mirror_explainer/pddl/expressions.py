"""PDDL conditions and numbers, given as text or trees, as unified-planning's expressions.

All that a condition names and the task does not have is collected, so that
one error can tell it all.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any

import unified_planning.model as up

from mirror_explainer.errors import InputError, did_you_mean
from mirror_explainer.pddl.text.declarations import OBJECT, Kinds, typed_names
from mirror_explainer.pddl.text.numerals import number
from mirror_explainer.pddl.text.tree import Branch, Tree, Word, as_text, expression

__all__ = ['Expressions', 'as_text', 'nested_words', 'text_conjuncts']

# What a variable's name stands for: something a quantifier or an action's parameters declare.
Bound = Mapping[str, 'up.Variable | up.Parameter']

COMPARISONS = ('=', '<', '<=', '>', '>=')
_FORMS = {
    'not': '(not condition)',
    'imply': '(imply condition condition)',
    'forall': '(forall (?x - type) condition)',
    'exists': '(exists (?x - type) condition)',
    **{sign: f'({sign} one other)' for sign in COMPARISONS},
}


@dataclass(frozen=True)
class _Fault:
    reason: str
    line: int | None


class Expressions:
    """Builds expressions of a task's model from trees, and collects the `faults` it meets."""

    def __init__(self, model: up.Problem) -> None:
        self._model = model
        self._manager = model.environment.expression_manager
        self._faults: list[_Fault] = []

    @cached_property
    def _fluents(self) -> dict[str, up.Fluent]:
        return {fluent.name: fluent for fluent in self._model.fluents}

    @cached_property
    def _objects(self) -> dict[str, up.Object]:
        return {item.name: item for item in self._model.all_objects}

    @cached_property
    def _types(self) -> dict[str, up.Type]:
        return {kind.name: kind for kind in self._model.user_types}

    @property
    def faults(self) -> list[str]:
        """What was wrong, each thing once."""
        return [*dict.fromkeys(fault.reason for fault in self._faults)]

    def require_known(self, source: str, *, lines: bool = False) -> None:
        """Raise InputError that tells all faults, if there are any.

        With the line of the first, if the trees stand in a text that has more than one.
        """
        if self._faults:
            line = self._faults[0].line if lines else None
            raise InputError(source, '; '.join(self.faults), line)

    def expression(self, tree: Any, variables: Bound) -> up.FNode:
        """Return a condition; `variables` are those it may use, by name with the question mark."""
        if isinstance(tree, str) or (tree and not isinstance(tree[0], str)):
            shown = as_text(tree)[:80]
            return self._fault(f'"{shown}" is no condition: write (predicate object …)', tree)
        head = tree[0].lower() if tree else 'and'
        parts = tree[1:]
        connectives = {'and': self._manager.And, 'or': self._manager.Or}
        if head in connectives:
            return connectives[head](*[self.expression(part, variables) for part in parts])
        if head == 'not' and len(parts) == 1:
            return self._manager.Not(self.expression(parts[0], variables))
        if head == 'imply' and len(parts) == 2:
            return self._manager.Implies(*[self.expression(part, variables) for part in parts])
        if head in ('forall', 'exists') and len(parts) == 2 and not isinstance(parts[0], str):
            bound = self.variables(parts[0])
            body = self.expression(parts[1], {**variables, **bound})
            quantifier = self._manager.Forall if head == 'forall' else self._manager.Exists
            return quantifier(body, *bound.values()) if bound else body
        if head in COMPARISONS and len(parts) == 2:
            if head != '=' or any(map(self._is_number, parts)):
                return self._comparison(head, *(self.number(part, variables) for part in parts))
            left, right = (self._term(part, variables) for part in parts)
            return self._manager.Equals(left, right) if left and right else self._manager.TRUE()
        if head in _FORMS:
            return self._fault(f'"{as_text(tree)[:80]}" is wrong: write {_FORMS[head]}', tree)
        return self.atom(tree, variables)

    def atom(self, tree: Any, variables: Bound) -> up.FNode:
        """Return the expression of one atom: true in place of one that has a fault."""
        if isinstance(tree, str) or not tree or not all(isinstance(word, str) for word in tree):
            return self._fault(f'"{as_text(tree)}" is no atom such as (predicate object)', tree)
        fluent = self._fluents.get(tree[0].lower())
        if fluent is None:
            names = [fluent.name for fluent in self._model.fluents if fluent.type.is_bool_type()]
            reason = f'{as_text(tree)}: the domain has no predicate "{tree[0].lower()}"'
            return self._fault(reason, tree, tree[0].lower(), names)
        if not fluent.type.is_bool_type():
            reason = f'{as_text(tree)}: "{fluent.name}" is a number, not a fact'
            return self._fault(reason, tree)
        return self._of(fluent, tree, variables) or self._manager.TRUE()

    def number(self, tree: Any, variables: Bound) -> up.FNode:
        """Return what (+ 1 (level ?x)) comes to: 0 in place of what has a fault."""
        nothing: up.FNode = self._manager.Int(0)
        if isinstance(tree, str):
            value = number(tree)
            if value is not None:
                return self._constant(value)
            fluent = self._fluents.get(tree.lower())
            if fluent is not None and fluent.arity == 0 and not fluent.type.is_bool_type():
                return self._manager.FluentExp(fluent)
            self._fault(f'"{as_text(tree)}" is no number', tree)
            return nothing
        head = tree[0].lower() if tree and isinstance(tree[0], str) else ''
        operators = {'+': self._manager.Plus, '*': self._manager.Times}
        if head in ('+', '-', '*', '/'):
            parts = [self.number(part, variables) for part in tree[1:]]
            if len(parts) == 1 and head == '-':
                return self._manager.Times(self._manager.Int(-1), parts[0])
            if head in operators and parts:
                return operators[head](*parts)
            if len(parts) == 2:
                if head == '/' and parts[1].is_constant() and not parts[1].constant_value():
                    self._fault(f'"{as_text(tree)[:80]}" divides by zero', tree)
                    return nothing
                pair = self._manager.Minus if head == '-' else self._manager.Div
                return pair(*parts)
            self._fault(f'"{as_text(tree)[:80]}" is wrong: write ({head} number number)', tree)
            return nothing
        fluent = self._fluents.get(head)
        if fluent is None or fluent.type.is_bool_type():
            names = [f.name for f in self._model.fluents if not f.type.is_bool_type()]
            shown = as_text(tree)[:80]
            self._fault(f'{shown}: the domain has no function "{head}"', tree, head, names)
            return nothing
        return self._of(fluent, tree, variables) or nothing

    def _of(self, fluent: up.Fluent, tree: Any, variables: Bound) -> up.FNode | None:
        """Return a predicate or function of its arguments, None if they do not fit."""
        if len(tree) - 1 != fluent.arity:
            self._fault(
                f'{as_text(tree)}: "{fluent.name}" takes {arguments(fluent.arity)}, '
                f'not {len(tree) - 1}',
                tree,
            )
            return None
        terms = [self._term(word, variables) for word in tree[1:]]
        for word, term, parameter in zip(tree[1:], terms, fluent.signature, strict=True):
            if term is not None and not parameter.type.is_compatible(term.type):
                self._fault(
                    f'{as_text(tree)}: {word.lower()} is of type {term.type.name}, '
                    f'but "{fluent.name}" takes a {parameter.type.name} there',
                    tree,
                )
                return None
        if any(term is None for term in terms):
            return None
        return self._manager.FluentExp(fluent, terms)

    def _term(self, word: Any, variables: Bound) -> up.FNode | None:
        name = word.lower() if isinstance(word, str) else as_text(word)
        if name in variables:
            found = variables[name]
            if isinstance(found, up.Parameter):
                return self._manager.ParameterExp(found)
            return self._manager.VariableExp(found)
        if name in self._objects:
            return self._manager.ObjectExp(self._objects[name])
        if name.startswith('?'):
            self._fault(
                f'the variable {name} is not declared', word, name, [str(v) for v in variables]
            )
        else:
            self._fault(f'the problem has no object "{name}"', word, name, self._objects)
        return None

    def variables(self, words: Any) -> dict[str, up.Variable]:
        """Return the variables of "(?a ?b - type …)" by name, question mark included."""
        bound: dict[str, up.Variable] = {}
        try:
            names = typed_names(words, '')
        except InputError as error:
            self._faults.append(_Fault(error.reason, error.line))
            return bound
        for name, kinds in names:
            kind = self.kind(tuple(map(str, kinds)), name)
            if not name.startswith('?'):
                self._fault(f'"{name}" stands where a variable is expected, such as ?x', name)
            elif kind is not None:
                bound[str(name)] = up.Variable(name[1:], kind, self._model.environment)
        return bound

    def kind(self, kinds: Kinds, place: Tree) -> up.Type | None:
        """Return unified-planning's type of this name, None if there is none."""
        name = kinds[0]
        if len(kinds) == 1 and name in self._types:
            return self._types[name]
        if name == OBJECT and len(kinds) == 1 and not self._types:
            return self._model.environment.type_manager.UserType(OBJECT)
        shown = name if len(kinds) == 1 else f'(either {" ".join(kinds)})'
        self._fault(f'the domain has no type "{shown}"', place, name, self._types)
        return None

    def _is_number(self, tree: Tree) -> bool:
        """Say whether this side of an equation is a number."""
        if not isinstance(tree, str):
            return True
        if tree in self._objects or tree.startswith('?'):
            return False
        fluent = self._fluents.get(tree)
        return number(tree) is not None or (fluent is not None and fluent.arity == 0)

    def _comparison(self, head: str, left: up.FNode, right: up.FNode) -> up.FNode:
        compare = {
            '=': self._manager.Equals,
            '<': self._manager.LT,
            '<=': self._manager.LE,
            '>': self._manager.GT,
            '>=': self._manager.GE,
        }[head]
        compared: up.FNode = compare(left, right)
        return compared

    def _constant(self, value: Fraction) -> up.FNode:
        if value.denominator == 1:
            return self._manager.Int(value.numerator)
        return self._manager.Real(value)

    def _fault(
        self, reason: str, tree: Any, name: str = '', names: Iterable[str] = ()
    ) -> up.FNode:
        line = tree.line if isinstance(tree, Word | Branch) else None
        self._faults.append(_Fault(reason + did_you_mean(name, names), line))
        return self._manager.TRUE()


def arguments(count: int) -> str:
    """Return "2 arguments", or "1 argument"."""
    return f'{count} argument{"" if count == 1 else "s"}'


def nested_words(text: str, source: str) -> Any:
    """Return "(a (b c))" as a tree."""
    return expression(text, source)


def text_conjuncts(text: str, source: str) -> list[str]:
    """Return the conditions that a text asks for together, each as a text."""
    if not text.strip():
        return []
    try:
        return _joined(nested_words(text, source))
    except InputError as error:
        raise InputError(source, error.reason) from error


def _joined(tree: Any) -> list[str]:
    if isinstance(tree, list) and tree and tree[0] == 'and':
        return [condition for part in tree[1:] for condition in _joined(part)]
    return [as_text(tree)]
