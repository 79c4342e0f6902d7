"""Derived predicates: what holds in a state because other facts do.

unified-planning has none. For its reader the axioms, (:derived …), are taken out
of the domain, and what they define are plain predicates; here the axioms become
rules of Datalog, by which every state gets its derived facts.
"""

import itertools
import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import unified_planning.model as up

from mirror_explainer.errors import InputError
from mirror_explainer.pddl.atoms import fluents_in
from mirror_explainer.pddl.derived.axiom_rules import Axiom, AxiomRules, is_made_up
from mirror_explainer.pddl.derived.datalog import ExplosionError, Fact, Program, UnstratifiedError
from mirror_explainer.pddl.expressions import Expressions, nested_words
from mirror_explainer.pddl.text.sections import (
    blanked,
    line_at,
    line_of,
    section,
    sections,
    without_comments,
)
from mirror_explainer.pddl.text.texts import Texts

_DERIVED = ':derived'
_REQUIREMENT = re.compile(r':(?:derived-predicates|domain-axioms)(?![\w-])', re.IGNORECASE)

# Working out what holds in all states that a plan goes through may take some seconds, no more.
_MOST_STEPS = 1_000_000


def without_axioms(domain: str) -> str:
    """Return the domain with blanks for its axioms: its lines stay where they are."""
    for part in sections(domain):
        if part.keyword == _DERIVED:
            domain = blanked(domain, part.start, part.end)
    requirements = section(domain, ':requirements')
    if requirements:
        plain = without_comments(domain)
        for found in _REQUIREMENT.finditer(plain, requirements.start, requirements.end):
            domain = blanked(domain, found.start(), found.end(), ':strips')
    return domain


@dataclass(frozen=True)
class Axioms:
    """The axioms of a task, whose model has what they define as plain fluents.

    `source` names the domain in errors. Besides what actions and goal ask for, the values
    of the fluents `besides` are wanted.
    """

    axioms: tuple[Axiom, ...]
    model: up.Problem = field(repr=False)
    source: str
    besides: frozenset[up.Fluent] = frozenset()

    @cached_property
    def fluents(self) -> frozenset[up.Fluent]:
        """The predicates that are derived."""
        return frozenset(axiom.fluent for axiom in self.axioms)

    def basis(self, fluents: Collection[up.Fluent]) -> frozenset[up.Fluent]:
        """Return the fluents, and all that they depend on by the axioms."""
        found = set(fluents)
        waiting = list(fluents)
        while waiting:
            fluent = waiting.pop()
            for axiom in self.axioms:
                if axiom.fluent == fluent:
                    new = fluents_in(axiom.body) - found
                    found |= new
                    waiting += new
        return frozenset(found)

    @cached_property
    def _asked(self) -> frozenset[up.Fluent]:
        """What the values in a state depend on that are wanted."""
        conditions = [*self.model.goals]
        for action in self.model.actions:
            conditions += action.preconditions
            for effect in action.effects:
                conditions += [effect.condition, effect.value]
        return self.basis(fluents_in(*conditions) | self.besides)

    @cached_property
    def _program(self) -> tuple[Program, tuple[Fact, ...]]:
        """The rules, and the facts about types and equality that they use."""
        rules = AxiomRules(axiom for axiom in self.axioms if axiom.fluent in self._asked)
        return Program(rules.rules), rules.facts(self.model)

    def holding(
        self, values: Mapping[up.FNode, up.FNode], most_steps: int = _MOST_STEPS
    ) -> tuple[frozenset[up.FNode], int]:
        """Return the derived atoms that hold in a state, and how many steps are left.

        They are those that are wanted. Raises InputError where it takes
        too many steps.
        """
        program, fixed = self._program
        names = {fluent.name: fluent for fluent in self._asked & self.fluents}
        given = (
            (atom.fluent().name, *map(str, atom.args))
            for atom, value in values.items()
            if value.is_true() and atom.fluent() in self._asked
        )
        try:
            facts, left = program.consequences(itertools.chain(fixed, given), most_steps)
        except ExplosionError as error:
            raise InputError(
                self.source,
                'its derived predicates hold of too many objects, or look at too many, to be '
                'worked out in time',
                cure='Give them fewer arguments, or arguments of narrower types.',
            ) from error
        manager = self.model.environment.expression_manager
        atoms = (
            manager.FluentExp(names[name], [self.model.object(o) for o in objects])
            for name, *objects in facts
            if name in names
        )
        return frozenset(atoms), left

    def first_state(self) -> '_State':
        """Return the initial state, for unified-planning's simulator of `open_model`."""
        values = dict(self.model.explicit_initial_values)
        return _State(values, self, *self.holding(values))

    def with_derived(
        self, states: Sequence[up.State], conditions: Iterable[up.FNode]
    ) -> Sequence[up.State]:
        """Return a run's states with all derived facts that the conditions ask for."""
        wanted = fluents_in(*conditions) & self.fluents
        if wanted <= self._asked:
            return states
        wider = replace(self, besides=self.besides | wanted)
        return [
            _State(state.given, wider, *wider.holding(state.given))
            for state in states
            if isinstance(state, _State)
        ]

    def changes(self, atoms: Iterable[up.FNode]) -> bool:
        """Say whether a change of these atoms may change what is derived."""
        return any(atom.fluent() in self._asked for atom in atoms)

    def open_model(self) -> up.Problem:
        """Return the model with an action besides that seems to change the derived facts.

        unified-planning would take what no action changes for the same everywhere.
        """
        model = self.model.clone()
        for number, fluent in enumerate(sorted(self.fluents, key=lambda fluent: fluent.name)):
            action = up.InstantaneousAction(
                f'@{number}',
                {parameter.name: parameter.type for parameter in fluent.signature},
                model.environment,
            )
            action.add_effect(fluent(*action.parameters), True)
            model.add_action(action)
        return model


class _State(up.UPState):
    """A state whose derived atoms have the values that the axioms give them.

    `given` are the values that are not derived; `left` is how many steps may be spent on
    the states after it.
    """

    def __init__(
        self,
        values: dict[up.FNode, up.FNode],
        axioms: Axioms,
        derived: frozenset[up.FNode],
        left: int,
    ) -> None:
        self.given = values
        self._axioms = axioms
        self._derived = derived
        self._left = left
        true = axioms.model.environment.expression_manager.TRUE()
        super().__init__(values | dict.fromkeys(derived, true), axioms.model)

    def make_child(self, updated_values: dict[up.FNode, up.FNode]) -> '_State':
        values, derived, left = self.given | updated_values, self._derived, self._left
        if self._axioms.changes(updated_values):
            derived, left = self._axioms.holding(values, left)
        return _State(values, self._axioms, derived, left)


def read_axioms(model: up.Problem, texts: Texts) -> Axioms | None:
    """Return the domain's axioms, None if it has none; `model` was read without them.

    Raises InputError that names what is wrong with them, and the line.
    """
    domain, source = texts.domain, texts.domain_source
    found = []
    for part in sections(domain):
        if part.keyword == _DERIVED:
            text = without_comments(domain[part.start : part.end]).lower()
            try:
                found.append(_axiom(model, nested_words(text, source), source))
            except InputError as error:
                line = line_at(domain, part.start)
                raise InputError(source, error.reason, line) from error
    if not found:
        return None
    axioms = Axioms(tuple(found), model, source)
    _require_derived_only(axioms, texts)
    try:
        Program(AxiomRules(found).rules)
    except UnstratifiedError as error:
        names = ', '.join(f'"{n}"' for n in error.predicates if not is_made_up(n))
        raise InputError(
            source,
            f'derived predicates depend on their own negation, or on (forall …) about '
            f'themselves: {names}',
        ) from error
    return axioms


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


def _require_derived_only(axioms: Axioms, texts: Texts) -> None:
    """Raise InputError if an action, or the initial state, sets a derived fact."""
    for action in axioms.model.actions:
        for effect in _effects(action):
            if effect.fluent.fluent() in axioms.fluents:
                own = rf'\(\s*:\S*action\s+{re.escape(action.name)}(?![\w-])'
                raise InputError(
                    texts.domain_source,
                    f'"{effect.fluent.fluent().name}" is derived, but the action '
                    f'"{action.name}" changes it',
                    line_of(own, texts.domain),
                )
    for atom, value in axioms.model.explicit_initial_values.items():
        name = atom.fluent().name
        if value.is_true() and atom.fluent() in axioms.fluents:
            raise InputError(
                texts.problem_source,
                f'"{name}" is derived, so it cannot be among the initial facts',
                line_of(rf'\(\s*{re.escape(name)}(?![\w-])', texts.problem),
            )


def _effects(action: up.Action) -> list[up.Effect]:
    if isinstance(action, up.DurativeAction):
        return [*itertools.chain.from_iterable(action.effects.values())]
    return [*action.effects]
