"""PDDL conditions, given as text or nested lists of words, as unified-planning's expressions.

All that a condition names and the problem does not have is collected, so that
one error can tell it all.
"""

import re
from collections.abc import Iterable, Sequence
from typing import Any

import pyparsing
import unified_planning.model as up
from unified_planning.exceptions import UPException

from mirror_explainer.errors import InputError, did_you_mean
from mirror_explainer.pddl.text.size import require_shallow

# "(a (b c))" as nested lists of words. Without quoted strings, which PDDL does not have, it is
# ten times faster.
NESTED = pyparsing.nested_expr(content=pyparsing.Regex(r'[^\s()]+'), ignore_expr=None)


class Expressions:
    """Builds expressions from nested lists of words, and collects the `faults` it meets."""

    def __init__(self, model: up.Problem) -> None:
        self._model = model
        self._manager = model.environment.expression_manager
        self.faults: list[str] = []

    def require_known(self, source: str) -> None:
        """Raise InputError that tells all faults, if there are any."""
        if self.faults:
            raise InputError(source, '; '.join(self.faults))

    def expression(self, tree: Any, variables: dict[str, up.Variable]) -> up.FNode:
        """Return a condition; `variables` are those it may use, by name with the question mark."""
        if isinstance(tree, str) or (tree and not isinstance(tree[0], str)):
            return self._fault(f'"{as_text(tree)}" is no PDDL condition')
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
            body = self.expression(parts[1], variables | bound)
            quantifier = self._manager.Forall if head == 'forall' else self._manager.Exists
            return quantifier(body, *bound.values()) if bound else body
        if head == '=' and len(parts) == 2:
            left, right = (self._term(part, variables) for part in parts)
            return self._manager.Equals(left, right) if left and right else self._manager.TRUE()
        return self.atom(tree, variables)

    def atom(self, tree: Any, variables: dict[str, up.Variable]) -> up.FNode:
        """Return the expression of one atom: true in place of one that has a fault."""
        if isinstance(tree, str) or not tree or not all(isinstance(word, str) for word in tree):
            return self._fault(f'"{as_text(tree)}" is no atom such as (predicate object)')
        name = tree[0].lower()
        if not self._model.has_fluent(name):
            names = [fluent.name for fluent in self._model.fluents]
            return self._fault(
                f'{as_text(tree)}: the domain has no predicate "{name}"', name, names
            )
        fluent = self._model.fluent(name)
        if not fluent.type.is_bool_type():
            return self._fault(f'{as_text(tree)}: "{name}" is a number, not a fact')
        if len(tree) - 1 != fluent.arity:
            return self._fault(
                f'{as_text(tree)}: "{name}" takes {fluent.arity} arguments, not {len(tree) - 1}'
            )
        terms = [self._term(word, variables) for word in tree[1:]]
        for word, term, parameter in zip(tree[1:], terms, fluent.signature, strict=True):
            if term is not None and not parameter.type.is_compatible(term.type):
                self._fault(
                    f'{as_text(tree)}: {word.lower()} is of type {term.type.name}, '
                    f'but "{name}" takes a {parameter.type.name} there'
                )
                return self._manager.TRUE()
        if any(term is None for term in terms):
            return self._manager.TRUE()
        return self._manager.FluentExp(fluent, terms)

    def _term(self, word: Any, variables: dict[str, up.Variable]) -> up.FNode | None:
        name = word.lower() if isinstance(word, str) else as_text(word)
        if name in variables:
            return self._manager.VariableExp(variables[name])
        if self._model.has_object(name):
            return self._manager.ObjectExp(self._model.object(name))
        names = [item.name for item in self._model.all_objects]
        self._fault(f'the problem has no object "{name}"', name, names)
        return None

    def variables(self, words: Sequence[Any]) -> dict[str, up.Variable]:
        """Return the variables of "(?a ?b - type …)" by name, question mark included."""
        bound: dict[str, up.Variable] = {}
        for names, type_name in re.findall(
            r'((?:\?\S+\s*)+)(?:-\s*(\S+))?', as_text(words).lower()[1:-1]
        ):
            try:
                variable_type = self._model.user_type(type_name or 'object')
            except UPException:
                self._fault(f'the domain has no type "{type_name or "object"}"')
                continue
            for name in names.split():
                bound[name] = up.Variable(name[1:], variable_type, self._model.environment)
        return bound

    def _fault(self, reason: str, name: str = '', names: Iterable[str] = ()) -> up.FNode:
        self.faults.append(reason + did_you_mean(name, names))
        return self._manager.TRUE()


def nested_words(text: str, source: str) -> Any:
    """Return "(a (b c))" as nested lists of words."""
    require_shallow(text, source)
    try:
        return NESTED.parse_string(text, parse_all=True).as_list()[0]
    except pyparsing.ParseBaseException as error:
        shown = text.strip()[:80]
        raise InputError(
            source, f'"{shown}" is not one expression in balanced parentheses'
        ) from error


def as_text(tree: Any) -> str:
    """Return nested lists of words as they stand in PDDL, with single spaces."""
    return tree if isinstance(tree, str) else f'({" ".join(as_text(part) for part in tree)})'
