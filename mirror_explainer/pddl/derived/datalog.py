"""Datalog with stratified negation: all that follows from some facts by rules.

A rule may need that a fact does not follow, if that is settled before: the
predicates are in layers, and each layer is worked out before the next. In a layer,
every new fact is joined with the others once (semi-naive evaluation).
"""

from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

# A predicate's name, then the objects' names.
Fact = tuple[str, ...]

_Binding = dict[int, str]


class UnstratifiedError(Exception):
    """Some `predicates` rest on their own negation."""

    def __init__(self, predicates: Sequence[str]) -> None:
        super().__init__(', '.join(predicates))
        self.predicates = tuple(predicates)


class ExplosionError(Exception):
    """Working out what follows takes more steps than allowed."""


@dataclass(frozen=True)
class Atom:
    """A predicate with its terms: objects by name, variables by number."""

    predicate: str
    terms: tuple[str | int, ...] = ()

    @property
    def variables(self) -> set[int]:
        """The numbers of its variables."""
        return {term for term in self.terms if isinstance(term, int)}

    def fact(self, binding: _Binding) -> Fact:
        """Return the atom with its variables bound."""
        return (self.predicate, *(t if isinstance(t, str) else binding[t] for t in self.terms))


@dataclass(frozen=True)
class Rule:
    """`head` holds where all `positive` atoms hold and no `negative` one.

    Every variable occurs in a positive atom.
    """

    head: Atom
    positive: tuple[Atom, ...]
    negative: tuple[Atom, ...] = ()

    @property
    def predicates(self) -> set[str]:
        """The predicates that the rule looks at."""
        return {atom.predicate for atom in (*self.positive, *self.negative)}


def consequences(
    rules: Sequence[Rule], facts: Iterable[Fact], most_steps: int
) -> tuple[set[Fact], int]:
    """Return the facts and all that follows from them, and how many steps are left.

    A step looks at a fact. Raises ExplosionError when none is left, UnstratifiedError.
    """
    known = _Facts(facts, most_steps)
    levels = layers(rules)
    for level in range(max(levels.values(), default=-1) + 1):
        _apply([rule for rule in rules if levels[rule.head.predicate] == level], known)
    return known.all, known.left


def layers(rules: Sequence[Rule]) -> dict[str, int]:
    """Return a layer for each head: as low as it can be, above all that the rules negate.

    Raises UnstratifiedError.
    """
    levels = dict.fromkeys((rule.head.predicate for rule in rules), 0)
    for _ in range(len(levels) + 1):
        before = dict(levels)
        for rule in rules:
            levels[rule.head.predicate] = max(
                [
                    levels[rule.head.predicate],
                    *(levels.get(atom.predicate, 0) for atom in rule.positive),
                    *(levels.get(atom.predicate, -1) + 1 for atom in rule.negative),
                ]
            )
        if levels == before:
            return levels
    below = {head: reached([head], rules) for head in levels}
    raise UnstratifiedError(
        [
            head
            for head in levels
            if any(
                rule.head.predicate in below[head] and head in below.get(atom.predicate, ())
                for rule in rules
                for atom in rule.negative
            )
        ]
    )


def reached(predicates: Iterable[str], rules: Iterable[Rule]) -> frozenset[str]:
    """Return the predicates, and all that they depend on by the rules."""
    found, waiting = set(predicates), [*predicates]
    while waiting:
        name = waiting.pop()
        new = {p for r in rules if r.head.predicate == name for p in r.predicates} - found
        found |= new
        waiting += new
    return frozenset(found)


def _apply(rules: Sequence[Rule], known: '_Facts') -> None:
    """Add all that follows by the rules of one layer."""
    heads = {rule.head.predicate for rule in rules}
    new: list[Fact] = []
    joins: dict[str, list[tuple[Rule, Atom, tuple[Atom, ...]]]] = defaultdict(list)
    for rule in rules:
        new += known.add(_heads(rule, _ordered(rule.positive, set()), {}, known))
        for index, atom in enumerate(rule.positive):
            if atom.predicate in heads:
                others = (*rule.positive[:index], *rule.positive[index + 1 :])
                joins[atom.predicate].append((rule, atom, _ordered(others, atom.variables)))
    while new:
        fact = new.pop()
        for rule, first, rest in joins.get(fact[0], ()):
            binding = _extended({}, first, fact)
            if binding is not None:
                new += known.add(_heads(rule, rest, binding, known))


def _ordered(atoms: Sequence[Atom], bound: set[int]) -> tuple[Atom, ...]:
    """Return the atoms in an order in which each has few variables that are still open."""
    if not atoms:
        return ()
    best = min(atoms, key=lambda atom: (len(atom.variables - bound), -len(atom.terms)))
    rest = list(atoms)
    rest.remove(best)
    return (best, *_ordered(rest, bound | best.variables))


def _heads(rule: Rule, atoms: Sequence[Atom], binding: _Binding, known: '_Facts') -> list[Fact]:
    """Return what the rule says of the bindings that it holds for."""
    return [
        rule.head.fact(found)
        for found in _bindings(atoms, binding, known)
        if not any(atom.fact(found) in known.all for atom in rule.negative)
    ]


def _bindings(atoms: Sequence[Atom], binding: _Binding, known: '_Facts') -> Iterator[_Binding]:
    """Yield every way to bind the atoms' variables so that all of them hold."""
    if not atoms:
        yield binding
        return
    for fact in known.matching(atoms[0], binding):
        extended = _extended(binding, atoms[0], fact)
        if extended is not None:
            yield from _bindings(atoms[1:], extended, known)


def _extended(binding: _Binding, atom: Atom, fact: Fact) -> _Binding | None:
    """Return the binding under which the atom is the fact, None if there is none."""
    extended = dict(binding)
    for term, name in zip(atom.terms, fact[1:], strict=True):
        if (term if isinstance(term, str) else extended.setdefault(term, name)) != name:
            return None
    return extended


class _Facts:
    """Facts, found by any of their places; indexes are made when first asked for."""

    def __init__(self, facts: Iterable[Fact], most_steps: int) -> None:
        self.all: set[Fact] = set()
        self.left = most_steps
        # By predicate, places and the names there.
        self._indexes: dict[str, dict[tuple[int, ...], dict[Fact, list[Fact]]]] = defaultdict(
            lambda: {(): defaultdict(list)}
        )
        self.add(facts)

    def add(self, facts: Iterable[Fact]) -> list[Fact]:
        """Take in facts, and return the new ones."""
        new = [fact for fact in dict.fromkeys(facts) if fact not in self.all]
        self.all.update(new)
        for fact in new:
            for places, index in self._indexes[fact[0]].items():
                index[tuple(fact[place] for place in places)].append(fact)
        return new

    def matching(self, atom: Atom, binding: _Binding) -> Sequence[Fact]:
        """Return the facts that agree with the atom where its terms are known."""
        known = {
            place: name
            for place, term in enumerate(atom.terms, start=1)
            if (name := term if isinstance(term, str) else binding.get(term)) is not None
        }
        indexes, places = self._indexes[atom.predicate], tuple(known)
        if places not in indexes:
            indexes[places] = defaultdict(list)
            for fact in indexes[()][()]:
                indexes[places][tuple(fact[place] for place in places)].append(fact)
        found = indexes[places].get(tuple(known.values()), [])
        self.left -= 1 + len(found)
        if self.left < 0:
            raise ExplosionError
        return found
