"""Datalog with stratified negation: all that follows from some facts by rules.

A rule may need that a fact does not follow, if that is settled before: the
predicates are in layers, and each layer is worked out before the next. In a layer,
every new fact is joined with the others once (semi-naive evaluation).
"""

from collections import defaultdict, deque
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


@dataclass(frozen=True)
class _Join:
    """A rule's positive atoms in the order to match them; the first with a new fact, if any."""

    rule: Rule
    first: Atom | None
    others: tuple[Atom, ...]


class Program:
    """Rules, ready to be applied. Raises UnstratifiedError."""

    def __init__(self, rules: Iterable[Rule]) -> None:
        layers: dict[int, list[Rule]] = defaultdict(list)
        rules = tuple(rules)
        levels = _levels(rules)
        for rule in rules:
            layers[levels[rule.head.predicate]].append(rule)
        self._layers = [_Layer(layers[level]) for level in sorted(layers)]

    def consequences(self, facts: Iterable[Fact], most_steps: int) -> tuple[set[Fact], int]:
        """Return the facts and all that follows from them, and how many steps are left.

        A step looks at a fact. Raises ExplosionError when none is left.
        """
        known = _Facts(facts, most_steps)
        for layer in self._layers:
            layer.apply(known)
        return known.all, known.left


def _levels(rules: Sequence[Rule]) -> dict[str, int]:
    """Return a layer for each head: as low as it can be, above all that the rules negate."""
    levels = dict.fromkeys((rule.head.predicate for rule in rules), 0)
    rising = True
    while rising:
        rising = False
        for rule in rules:
            least = max(
                [
                    *(levels.get(atom.predicate, 0) for atom in rule.positive),
                    *(levels.get(atom.predicate, -1) + 1 for atom in rule.negative),
                ],
                default=0,
            )
            if least > levels[rule.head.predicate]:
                if least >= len(levels):
                    raise UnstratifiedError(_self_negating(rules))
                levels[rule.head.predicate] = least
                rising = True
    return levels


def _self_negating(rules: Sequence[Rule]) -> list[str]:
    """Return the predicates that depend on themselves with a negation on the way."""
    uses: dict[str, set[str]] = defaultdict(set)
    for rule in rules:
        uses[rule.head.predicate].update(a.predicate for a in (*rule.positive, *rule.negative))

    def reached(start: str) -> set[str]:
        found, waiting = {start}, [start]
        while waiting:
            new = uses.get(waiting.pop(), set()) - found
            found |= new
            waiting += new
        return found

    heads = list(dict.fromkeys(rule.head.predicate for rule in rules))
    below = {head: reached(head) for head in heads}
    return [
        head
        for head in heads
        if any(
            rule.head.predicate in below[head] and head in below.get(atom.predicate, ())
            for rule in rules
            for atom in rule.negative
        )
    ]


class _Layer:
    """The rules of one layer, with the joins that each new fact of the layer asks for."""

    def __init__(self, rules: Sequence[Rule]) -> None:
        heads = {rule.head.predicate for rule in rules}
        self._joins = [_Join(rule, None, _ordered(rule.positive, set())) for rule in rules]
        self._joins_of: dict[str, list[_Join]] = defaultdict(list)
        for rule in rules:
            for index, atom in enumerate(rule.positive):
                if atom.predicate in heads:
                    others = (*rule.positive[:index], *rule.positive[index + 1 :])
                    join = _Join(rule, atom, _ordered(others, _variables(atom)))
                    self._joins_of[atom.predicate].append(join)

    def apply(self, known: '_Facts') -> None:
        """Add all that follows by the layer's rules."""
        new: deque[Fact] = deque()
        for join in self._joins:
            new += known.add(_heads(join, {}, known))
        while new:
            fact = new.popleft()
            for join in self._joins_of.get(fact[0], ()):
                assert join.first is not None
                binding = _extended({}, join.first, fact)
                if binding is not None:
                    new += known.add(_heads(join, binding, known))


def _variables(atom: Atom) -> set[int]:
    return {term for term in atom.terms if isinstance(term, int)}


def _ordered(atoms: Sequence[Atom], bound: set[int]) -> tuple[Atom, ...]:
    """Return the atoms in an order in which each has few variables that are still open."""
    ordered, left, bound = list[Atom](), list(atoms), set(bound)
    while left:
        best = min(left, key=lambda a: (len(_variables(a) - bound), -len(a.terms)))
        left.remove(best)
        ordered.append(best)
        bound |= _variables(best)
    return tuple(ordered)


def _heads(join: _Join, binding: _Binding, known: '_Facts') -> list[Fact]:
    """Return what the rule says of the bindings that it holds for."""
    return [
        join.rule.head.fact(found)
        for found in _bindings(join.others, binding, known)
        if not any(atom.fact(found) in known.all for atom in join.rule.negative)
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
        self._by_predicate: dict[str, list[Fact]] = defaultdict(list)
        self._indexes: dict[str, dict[tuple[int, ...], dict[tuple[str, ...], list[Fact]]]] = (
            defaultdict(dict)
        )
        self.add(facts)

    def add(self, facts: Iterable[Fact]) -> list[Fact]:
        """Take in facts, and return the new ones."""
        new = [fact for fact in dict.fromkeys(facts) if fact not in self.all]
        self.all.update(new)
        for fact in new:
            self._by_predicate[fact[0]].append(fact)
            for places, index in self._indexes[fact[0]].items():
                index[tuple(fact[place] for place in places)].append(fact)
        return new

    def matching(self, atom: Atom, binding: _Binding) -> Sequence[Fact]:
        """Return the facts that agree with the atom where its terms are known."""
        places, values = list[int](), list[str]()
        for place, term in enumerate(atom.terms, start=1):
            value = term if isinstance(term, str) else binding.get(term)
            if value is not None:
                places.append(place)
                values.append(value)
        found = self._index(atom.predicate, tuple(places)).get(tuple(values), ())
        self.left -= 1 + len(found)
        if self.left < 0:
            raise ExplosionError
        return found

    def _index(self, predicate: str, places: tuple[int, ...]) -> dict[tuple[str, ...], list[Fact]]:
        indexes = self._indexes[predicate]
        if places not in indexes:
            index: dict[tuple[str, ...], list[Fact]] = defaultdict(list)
            for fact in self._by_predicate[predicate]:
                index[tuple(fact[place] for place in places)].append(fact)
            indexes[places] = index
        return indexes[places]
