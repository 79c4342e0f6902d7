"""Random domains with derived predicates, and what they mean, worked out by brute force."""

import itertools
import re
from dataclasses import dataclass
from random import Random
from typing import Any

from mirror_explainer.planning import BeliefSpace

OBJECTS = {'a': 'spot', 'b': 'spot', 'c': 'box', 'd': 'box'}
ARITY = {'at': 1, 'link': 2, 'free': 1, 'lit': 0}
DERIVED = {'near': 2, 'busy': 1, 'calm': 0, 'wide': 1}
# A predicate may use those of its own layer and of lower ones, and negate those of lower ones.
LAYER = {'near': 1, 'busy': 1, 'calm': 2, 'wide': 3} | dict.fromkeys(ARITY, 0)

State = frozenset[tuple[str, ...]]


def random_derived_space(random: Random) -> BeliefSpace:
    """Return a small domain with stratified axioms, some of them recursive, in all conditions."""
    axioms = [_axiom(random, name) for name in [*DERIVED, *random.choices([*DERIVED], k=2)]]
    costs = random.random() < 0.5
    actions = [
        '(:action go :parameters (?x ?y - spot) :precondition (and (at ?x) (link ?x ?y))'
        f' :effect (and (at ?y) (not (at ?x)){_cost(random, costs)}))'
    ]
    for index in range(random.randint(3, 5)):
        parameters = {'?x': random.choice(['spot', 'box', 'object'])}
        condition = _formula(random, [*parameters, 'A'], random.randint(0, 2), 4, True)
        effects = ' '.join(_atom(random, [*parameters, 'b'], [*ARITY]) for _ in range(2))
        if random.random() < 0.5:
            effects += f' (not {_atom(random, [*parameters, "c"], [*ARITY])})'
        if random.random() < 0.2:
            effects += f' (when {_formula(random, ["?x"], 1, 4, True)} (not (lit)))'
        actions.append(
            f'(:action act{index} :parameters ({_typed(parameters)})'
            f' :precondition {condition} :effect (and {effects}{_cost(random, costs)}))'
        )
    domain = f"""
    (define (domain random)
      (:requirements :adl :Derived-Predicates :action-costs)
      (:types spot box - object)
      (:constants a b - spot c - box)
      (:predicates (at ?x) (link ?x ?y) (free ?x) (lit)
                   (near ?x ?y) (Busy ?x) (calm) (wide ?x))
      (:functions (total-cost))
      {' '.join(random.sample(axioms + actions, len(axioms + actions)))})
    """
    facts = random.sample(ATOMS, random.randint(2, 8))
    problem = f"""
    (define (problem random)
      (:domain random)
      (:objects d - box)
      (:init {' '.join(facts)} (= (total-cost) 0))
      (:goal (and))
      {'(:metric minimize (total-cost))' if costs else ''})
    """
    goals = [
        f'(and {_atom(random, ["a", "d"], [*DERIVED])} {_formula(random, ["b"], 2, 4, True)})',
        f'(and {" ".join(_atom(random, list("abcd"), [*ARITY, *DERIVED]) for _ in range(3))})',
    ]
    return BeliefSpace(domain, problem, tuple(goals), tuple(random.sample(ATOMS, 3)))


ATOMS = [
    f'({" ".join([name, *terms])})'
    for name, arity in ARITY.items()
    for terms in itertools.product(OBJECTS, repeat=arity)
]


def _cost(random: Random, costs: bool) -> str:
    return f' (increase (total-cost) {random.randint(0, 4)})' if costs else ''


def _typed(variables: dict[str, str]) -> str:
    return ' '.join(f'{name} - {kind}' for name, kind in variables.items())


def _axiom(random: Random, name: str) -> str:
    kinds = random.choices(['object', 'spot', 'box'], [4, 1, 1], k=DERIVED[name])
    variables = dict(zip(['?x', '?y'], kinds, strict=False))
    body = _formula(random, [*variables, random.choice('abc')], 2, LAYER[name], True)
    return f'(:derived ({name} {_typed(variables)}) {body})'


def _atom(random: Random, terms: list[str], names: list[str]) -> str:
    name = random.choice(names)
    arity = (ARITY | DERIVED)[name]
    return f'({" ".join([name, *(random.choice(terms) for _ in range(arity))])})'


def _formula(random: Random, terms: list[str], depth: int, layer: int, holds: bool) -> str:
    """Return a condition that needs the layer's own predicates to hold, never not to."""
    kinds = ['atom'] * 2 + ['='] + ['and', 'or', 'imply', 'not', 'exists', 'forall'] * (depth > 0)
    kind = random.choice(kinds)
    if kind == 'atom':
        allowed = layer if holds else layer - 1
        return _atom(
            random, terms, [name for name, own in LAYER.items() if own <= max(0, allowed)]
        )
    if kind == '=':
        return f'(= {random.choice(terms)} {random.choice(terms)})'
    if kind in ('exists', 'forall'):
        variable = random.choice(['?x', '?z'])
        sort = random.choice([' - spot', ' - box', ''])
        lower = layer - 1 if kind == 'forall' else layer  # a universal is a negation, too
        body = _formula(random, [*terms, variable], depth - 1, lower, holds)
        return f'({kind} ({variable}{sort}) {body})'
    if kind == 'not':
        return f'(not {_formula(random, terms, depth - 1, layer, not holds)})'
    first = _formula(random, terms, depth - 1, layer, (kind != 'imply') == holds)
    return f'({kind} {first} {_formula(random, terms, depth - 1, layer, holds)})'


def words(text: str) -> Any:
    """Return a PDDL text as nested lists of words."""
    stack: list[list[Any]] = [[]]
    for word in re.findall(r'[()]|[^\s()]+', text.lower()):
        if word == '(':
            stack.append([])
        elif word == ')':
            stack[-2].append(stack.pop())
        else:
            stack[-1].append(word)
    return stack[0][0]


@dataclass(frozen=True)
class Referee:
    """What a domain of this file means: every object for every variable, again and again."""

    domain: str

    def closed(self, state: State) -> State:
        """Return the state with its derived facts."""
        axioms = [part[1:] for part in words(self.domain)[1:] if part[0] == ':derived']
        for layer in range(1, 4):
            before = None
            while state != before:
                before = state
                for (name, *parameters), body in axioms:
                    if LAYER[name] == layer:
                        state |= {
                            (name, *bound.values())
                            for bound in bindings(parameters)
                            if holds(body, bound, state)
                        }
        return state

    def after(self, state: State, action: tuple[str, ...]) -> State | None:
        """Return the state without derived facts after an action, None if it is impossible."""
        name, *objects = action
        _, _, _, parameters, _, condition, _, effect = next(
            part for part in words(self.domain)[1:] if part[:2] == [':action', name]
        )
        bound = dict(zip([word for word in parameters if word[0] == '?'], objects, strict=True))
        closed = self.closed(state)
        if not holds(condition, bound, closed):
            return None
        added, deleted = set(), set()
        for part in effect[1:]:
            if part[0] == 'when':
                if not holds(part[1], bound, closed):
                    continue
                part = part[2]
            if part[0] == 'not':
                deleted.add(ground(part[1], bound))
            elif part[0] != 'increase':
                added.add(ground(part, bound))
        return state - deleted | added


def bindings(typed: list[str]) -> list[dict[str, str]]:
    """Return every way to give "?x ?y - type" objects."""
    kinds, names = {}, list[str]()
    listed = iter(typed)
    for word in listed:
        if word == '-':
            kind = next(listed)
            kinds.update(dict.fromkeys(names, kind))
            names = []
        else:
            names.append(word)
    kinds.update(dict.fromkeys(names, 'object'))
    domains = [
        [o for o, own in OBJECTS.items() if kind in (own, 'object')] for kind in kinds.values()
    ]
    return [dict(zip(kinds, objects, strict=True)) for objects in itertools.product(*domains)]


def ground(atom: list[str], bound: dict[str, str]) -> tuple[str, ...]:
    """Return an atom with its variables bound."""
    return (atom[0], *(bound.get(term, term) for term in atom[1:]))


def holds(condition: Any, bound: dict[str, str], state: State) -> bool:
    """Say whether a condition holds in a state that has its derived facts."""
    kind = condition[0]
    if kind == 'and':
        return all(holds(part, bound, state) for part in condition[1:])
    if kind == 'or':
        return any(holds(part, bound, state) for part in condition[1:])
    if kind == 'not':
        return not holds(condition[1], bound, state)
    if kind == 'imply':
        return not holds(condition[1], bound, state) or holds(condition[2], bound, state)
    if kind == '=':
        return len({bound.get(term, term) for term in condition[1:]}) == 1
    if kind in ('exists', 'forall'):
        each = (holds(condition[2], bound | own, state) for own in bindings(condition[1]))
        return any(each) if kind == 'exists' else all(each)
    return ground(condition, bound) in state
