"""Derived predicates: what holds in a state because other facts do.

unified-planning has none: in its model, what the axioms, (:derived …), define are plain
predicates. Here the axioms become rules of Datalog, by which every state has its
derived facts.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import unified_planning.model as up

from mirror_explainer.errors import InputError
from mirror_explainer.pddl.atoms import effects_in
from mirror_explainer.pddl.derived.axiom_rules import Axiom, AxiomRules, is_made_up
from mirror_explainer.pddl.derived.datalog import Fact, Rule, UnstratifiedError, layers, reached
from mirror_explainer.pddl.expressions import Expressions
from mirror_explainer.pddl.text.definition import Definition
from mirror_explainer.pddl.text.tree import Branch, Tree, branches


@dataclass(frozen=True)
class Axioms:
    """The axioms of a task, whose model has what they define as plain fluents.

    `names` are the predicates that are derived, `rules` and `given` (what is fixed about
    types and equality) say of what; `source` names the domain in errors.
    """

    names: frozenset[str]
    rules: tuple[Rule, ...]
    given: tuple[Fact, ...]
    source: str

    def basis(self, predicates: Iterable[str]) -> frozenset[str]:
        """Return the predicates, and all that they depend on by the axioms."""
        return reached(predicates, self.rules)


def read_axioms(model: up.Problem, domain: Definition, problem: Definition) -> Axioms | None:
    """Return the domain's axioms, None if it has none; `model` was read without them.

    Raises InputError that names what is wrong with them, and the line.
    """
    source = domain.source
    found = []
    for part in domain.all(':derived'):
        try:
            found.append(_axiom(model, part, source))
        except InputError as error:
            raise InputError(source, error.reason, error.line or part.line) from error
    if not found:
        return None
    rules = AxiomRules(found)
    names = frozenset(axiom.fluent.name for axiom in found)
    _require_derived_only(names, model, domain, problem)
    try:
        layers(rules.rules)
    except UnstratifiedError as error:
        negated = [name for name in error.predicates if not is_made_up(name)]
        raise InputError(
            source,
            'derived predicates depend on their own negation, or on (forall …) about themselves: '
            + ', '.join(f'"{name}"' for name in negated),
            next((axiom.line for axiom in domain.all(':derived') if axiom[1][0] in negated), None),
            cure='Then nothing says when they hold: take these conditions out of (:derived …).',
        ) from error
    return Axioms(names, tuple(rules.rules), rules.facts(model), source)


def _axiom(model: up.Problem, words: Any, source: str) -> Axiom:
    if len(words) != 3 or not all(isinstance(part, list) for part in words[1:]) or not words[1]:
        raise InputError(
            source, '(:derived …) takes a predicate with its variables, and one condition'
        )
    (name, *parameters), body = words[1:]
    shown = f'the derived predicate "{name}"'
    if not isinstance(name, str) or not model.has_fluent(name):
        raise InputError(source, f'{shown} is not declared in :predicates')
    fluent = model.fluent(name)
    expressions = Expressions(model)
    bound = expressions.variables(parameters)
    expressions.require_known(source)
    if not fluent.type.is_bool_type():
        raise InputError(source, f'{shown} is declared as a number')
    if fluent.arity != len(bound):
        raise InputError(
            source, f'{shown} is declared with {fluent.arity} arguments, not {len(bound)}'
        )
    for (variable, given), declared in zip(bound.items(), fluent.signature, strict=True):
        if given.type.is_compatible(declared.type):  # the declared type is the narrower one
            bound[variable] = up.Variable(given.name, declared.type, model.environment)
        elif not declared.type.is_compatible(given.type):
            raise InputError(
                source,
                f'{shown} is declared with a {declared.type.name}, not a {given.type.name}, as '
                f'{variable}',
            )
    condition = expressions.expression(body, bound)
    expressions.require_known(source)
    return Axiom(fluent, tuple(bound.values()), condition)


def _require_derived_only(
    names: frozenset[str], model: up.Problem, domain: Definition, problem: Definition
) -> None:
    """Raise InputError if an action, or the initial state, sets a derived fact."""
    for action in model.actions:
        for effect in effects_in(action):
            name = effect.fluent.fluent().name
            if name in names:
                raise InputError(
                    domain.source,
                    f'"{name}" is derived, but the action "{action.name}" changes it',
                    _line_of_effect(name, action.name, domain),
                    cure=f'Leave ({name} …) out of its effect, or (:derived ({name} …) …) out.',
                )
    for atom, value in model.explicit_initial_values.items():
        name = atom.fluent().name
        if value.is_true() and name in names:
            raise InputError(
                problem.source,
                f'"{name}" is derived, so it cannot be among the initial facts',
                _line_of(name, problem.contents(':init'), 0),
            )


def _line_of_effect(name: str, action: str, domain: Definition) -> int | None:
    """Return the line of the last place at which an action has a predicate: in its effect."""
    sections = (s for s in domain.all(':action', ':durative-action') if s[1:2] == [action])
    places = [tree.line for section in sections for tree in branches(section) if tree.head == name]
    return places[-1] if places else None


def _line_of(name: str, trees: Sequence[Tree], position: int) -> int | None:
    """Return the line of the first tree that has a name at a position."""
    named = (t for t in trees if isinstance(t, Branch) and t[position : position + 1] == [name])
    return next((tree.line for tree in named), None)
