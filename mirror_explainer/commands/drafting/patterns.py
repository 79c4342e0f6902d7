"""Patterns of goals: what one goal tells of its like, by exchanging its objects.

A goal is lifted to variables over the types that actions take in the places of its objects.
What never changes and holds between them ("goes on", "belongs to") is asked of the others as
well, so that few choices make no sense; likewise what some of a type are ("is a room"), if more
than one is.
"""

import math
import re
from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations

import unified_planning.model as up

from mirror_explainer.listener.goals import parts_of
from mirror_explainer.listener.sentences import DONE_TYPE, doings
from mirror_explainer.pddl import Task, conjuncts, goal_expression, words_of
from mirror_explainer.pddl.atoms import effects_in, fluents_in
from mirror_explainer.pddl.expressions import text_conjuncts

# A pattern with more choices than this is cut into ones with fewer variables.
MOST_CHOICES = 350
# Or with more in whatever order: who reads the draft looks at 20,000, with unfinished ones.
_MOST_ORDERED = 7_000
# With more objects than this nothing is expected to be done to all of them.
_MOST_AT_ONCE = 8
_ATOM = re.compile(r'\(([^()]+)\)')


@dataclass(frozen=True)
class Pattern:
    """Candidate goals of one form: `parts` and `where` have {variables}, of these types."""

    parts: tuple[str, ...]
    types: tuple[tuple[str, str], ...] = ()
    where: tuple[str, ...] = ()

    @property
    def goal(self) -> str:
        """The goal, as the user model takes it."""
        return self.parts[0] if len(self.parts) == 1 else f'(and {" ".join(self.parts)})'

    @cached_property
    def kinds(self) -> list[str]:
        """The predicates or connectives of the parts, sorted."""
        return sorted(map(kind_of, self.parts))

    @cached_property
    def alike(self) -> dict[str, str]:
        """Of each variable the first that it can be exchanged with: the goals stay the same."""
        first: dict[str, str] = {}
        for variable, kind in self.types:
            others = (other for other in first.values() if (other, kind) in self.types)
            found = (other for other in others if self._stays_with(other, variable))
            first[variable] = next(found, variable)
        return first

    def _stays_with(self, variable: str, other: str) -> bool:
        """Say whether two variables exchanged leave the pattern as it is."""
        exchange = {f'{{{variable}}}': f'{{{other}}}', f'{{{other}}}': f'{{{variable}}}'}
        return all(
            {_renamed(text, exchange) for text in texts} == {*texts}
            for texts in (self.parts, self.where)
        )

    @cached_property
    def orders(self) -> int:
        """In how many ways objects can be chosen for the same goal."""
        return math.prod(math.factorial(size) for size in Counter(self.alike.values()).values())


@dataclass(frozen=True)
class World:
    """What of a task the patterns are made from."""

    task: Task

    @cached_property
    def types(self) -> dict[str, str]:
        """Each object's own type."""
        return {item.name.lower(): type_name(item) for item in self.task.model.all_objects}

    @cached_property
    def of_type(self) -> dict[str, list[str]]:
        """The objects of each type, those of its subtypes included."""
        found: dict[str, list[str]] = {'object': list(self.types)}
        for kind in self.task.model.user_types:
            found[kind.name] = [item.name.lower() for item in self.task.model.objects(kind)]
        return found

    @cached_property
    def _made(self) -> dict[str, list[tuple[up.Action, up.FNode]]]:
        """The actions that make each predicate true, and the atom that they do so."""
        made: dict[str, list[tuple[up.Action, up.FNode]]] = {}
        for action in self.task.model.actions:
            for effect in effects_in(action):
                if effect.value.is_true():
                    predicate = effect.fluent.fluent().name.lower()
                    made.setdefault(predicate, []).append((action, effect.fluent))
        return made

    def _widest(self, item: str, parts: Sequence[str]) -> str:
        """Return the widest type that actions take in all places of an object in a goal."""
        kinds = [self.types[item]]
        for predicate, *objects in map(str.split, _ATOM.findall(' '.join(parts))):
            for place in (place for place, other in enumerate(objects) if other == item):
                made = {type_name(atom.args[place]) for _, atom in self._made.get(predicate, ())}
                able = [kind for kind in made if item in self.of_type[kind]]
                kinds += [max(able, key=self._size)] if able else []
        return min(kinds[1:] or kinds, key=self._size)

    def _size(self, kind: str) -> tuple[int, str]:
        return len(self.of_type[kind]), kind

    @cached_property
    def ends(self) -> list[str]:
        """The predicates that some action makes true and none needs: they are made for goals."""
        needed = {
            fluent.name.lower()
            for action in self.task.model.actions
            for fluent in fluents_in(
                *action.preconditions, *(effect.condition for effect in effects_in(action))
            )
        }
        if axioms := self.task.axioms:
            needed |= axioms.basis(axioms.names)
        return [predicate for predicate in self._made if predicate not in needed]

    @cached_property
    def changing(self) -> frozenset[str]:
        """The predicates that actions change, and those that are derived."""
        changed = frozenset(
            effect.fluent.fluent().name.lower()
            for action in self.task.model.actions
            for effect in effects_in(action)
        )
        return changed | (self.task.axioms.names if self.task.axioms else frozenset())

    @cached_property
    def static_facts(self) -> frozenset[str]:
        """The initial facts that no action changes."""
        return frozenset(f for f in self.task.initial_facts if words_of(f)[0] not in self.changing)

    def parts(self, goal: str) -> tuple[str, ...]:
        """Return a goal's parts as texts; raises InputError for what is no goal here.

        What is asked of all of many objects is one part.
        """
        model = self.task.model
        goal_expression(model, goal)  # all of its faults at once
        parts: list[str] = []
        for condition in text_conjuncts(goal, 'goal'):
            ground = parts_of(goal_expression(model, condition), model)
            is_of_many = len(ground) > _MOST_AT_ONCE
            parts += [condition] if is_of_many else map(str, ground)
        return tuple(dict.fromkeys(parts))

    def holds(self, part: str) -> bool:
        """Say whether a part of a goal, an atom or its negation, holds initially."""
        if part.startswith('(not '):
            return part.removeprefix('(not ').removesuffix(')') not in self.task.initial_facts
        return part in self.task.initial_facts

    def _kept(self, parts: Sequence[str]) -> set[str]:
        """Return whole tasks, and objects that only parts name which hold already."""
        new, old = (
            {word for part in some for word in _words(part) if word in self.types}
            for some in ([p for p in parts if not self.holds(p)], filter(self.holds, parts))
        )
        return self._whole_tasks | (old - new if len(parts) > 1 else set())

    @cached_property
    def _whole_tasks(self) -> set[str]:
        """The objects that have a verb of their own: no other does as well in their place."""
        return {*self.of_type[DONE_TYPE]} if doings(self.task) else set()

    def lifted(self, parts: Sequence[str], fixed: Collection[str] = ()) -> Pattern:
        """Return the pattern of a goal's parts, whose objects vary but for the fixed ones."""
        names: dict[str, str] = {}
        kinds: dict[str, str] = {}
        for part in parts:
            for word in _words(part):
                if word in self.types and word not in names and word not in fixed:
                    kinds[word] = self._widest(word, parts)
                    names[word] = _variable(kinds[word], names.values())
        where = sorted(
            _renamed(fact, names)
            for fact in self.static_facts
            if (objects := set(words_of(fact)[1:])) and objects <= names.keys()
            if len(objects) > 1 or self._shared(*words_of(fact)[:2])
        )
        types = tuple((name.strip('{}'), kinds[item]) for item, name in names.items())
        return Pattern(tuple(_renamed(part, names) for part in parts), types, tuple(where))

    def _shared(self, predicate: str, item: str) -> bool:
        """Say whether another object of the item's type is as the predicate says, too."""
        others = (other for other in self.of_type[self.types[item]] if other != item)
        return any(f'({predicate} {other})' in self.static_facts for other in others)

    def like(self, parts: Sequence[str]) -> list[Pattern]:
        """Return patterns of goals like this one, each with a bounded number of choices.

        All objects vary, but for those that are kept; or where that
        is too much, those of one type at a time, or each by itself.
        """
        named = [word for part in parts for word in _words(part) if word in self.types]
        kept = self._kept(parts)
        objects = [word for word in named if word not in kept]
        by_type = [{o for o in objects if self.types[o] == kind} for kind in self._kinds(objects)]
        for groups in ([set(objects)], by_type, [{item} for item in dict.fromkeys(objects)]):
            found = [self.lifted(parts, set(named) - varying) for varying in groups]
            if all(self.count(pattern) <= MOST_CHOICES for pattern in found):
                return list(dict.fromkeys(found))
        return [Pattern(tuple(parts))]

    def with_one_twice(self, parts: Sequence[str]) -> list[Pattern]:
        """Return patterns of goals like this one in which one object has the place of two.

        What never changes is asked of the one where it relates objects; what it tells of either
        of the two alone may differ.
        """
        found = []
        for pattern in self.like(parts):
            for (kept, kind), (gone, other) in combinations(pattern.types, 2):
                alone = ({f'{{{kept}}}'}, {f'{{{gone}}}'})
                merge = {f'{{{gone}}}': f'{{{kept}}}'}
                merged = Pattern(
                    tuple(dict.fromkeys(_renamed(part, merge) for part in pattern.parts)),
                    tuple(item for item in pattern.types if item[0] != gone),
                    tuple(_renamed(c, merge) for c in pattern.where if _variables(c) not in alone),
                )
                sensible = kind == other and len(merged.parts) == len(pattern.parts)
                if sensible and 0 < self.count(merged) <= MOST_CHOICES:
                    found.append(merged)
        return found

    def twice(self, pattern: Pattern) -> list[Pattern]:
        """Return the pattern of two different goals of a pattern at once, if they are not many."""
        first = [f'{{{variable}}}' for variable, _ in pattern.types]
        again: dict[str, str] = {}
        for name, (_, kind) in zip(first, pattern.types, strict=True):
            again[name] = _variable(kind, [*first, *again.values()])
        parts, types, where = (
            tuple(dict.fromkeys([*once, *more]))
            for once, more in (
                (pattern.parts, [_renamed(part, again) for part in pattern.parts]),
                (pattern.types, [(again[f'{{{v}}}'].strip('{}'), k) for v, k in pattern.types]),
                (pattern.where, [_renamed(condition, again) for condition in pattern.where]),
            )
        )
        both = Pattern(tuple(sorted(parts, key=lambda part: '{' not in part)), types, where)
        return [both] if 0 < self.count(both) <= MOST_CHOICES else []

    def all_of(self, pattern: Pattern) -> list[Pattern]:
        """Return the goal of all of a pattern's goals, more than two, at once, if they are few.

        They are told apart by one variable.
        """
        if len(pattern.types) != 1 or not 2 < self.count(pattern) <= _MOST_AT_ONCE:
            return []
        each = dict.fromkeys(part for goal in self.goals(pattern) for part in goal)
        return [Pattern(tuple(sorted(each, key=lambda part: part in pattern.parts)))]

    def end(self, predicate: str) -> Pattern:
        """Return the pattern of what actions make true of a predicate, the one for most objects.

        What never changes is asked of the objects as the action does.
        """
        found = []
        for action, made in self._made[predicate]:
            names: dict[str, str] = {}
            for term in (term for term in made.args if not term.is_object_exp()):
                names.setdefault(str(term), _variable(type_name(term), names.values()))
            types = {str(term): type_name(term) for term in made.args}
            where = [
                _ground(atom, names)
                for given in action.preconditions
                for atom in conjuncts(given)
                if atom.is_fluent_exp()
                and atom.fluent().name.lower() not in self.changing
                and {str(term) for term in atom.args} & names.keys()
                and {str(term) for term in atom.args} <= types.keys()
            ]
            variables = tuple((name.strip('{}'), types[t]) for t, name in names.items())
            found.append(Pattern((_ground(made, names),), variables, tuple(where)))
        return max(found, key=self.count)

    def _kinds(self, objects: Sequence[str]) -> list[str]:
        return list(dict.fromkeys(self.types[item] for item in objects))

    @cached_property
    def _meant(self) -> dict[Pattern, frozenset[frozenset[str]]]:
        return {}

    def stands_for(self, wider: Pattern, narrower: Pattern) -> bool:
        """Say whether a pattern stands for all the goals of another; both have few."""
        if wider.kinds != narrower.kinds:
            return False
        for pattern in (wider, narrower):
            if pattern not in self._meant:
                self._meant[pattern] = frozenset(map(frozenset, self.goals(pattern)))
        return self._meant[wider] >= self._meant[narrower]

    def count(self, pattern: Pattern) -> int:
        """Return how many goals a pattern stands for, a little over the most if it is too many."""
        goals = set()
        for goal in self.goals(pattern):
            goals.add(frozenset(goal))
            if len(goals) > MOST_CHOICES or len(goals) * pattern.orders > _MOST_ORDERED:
                return MOST_CHOICES + 1
        return len(goals)

    def goals(self, pattern: Pattern) -> Iterator[tuple[str, ...]]:
        """Yield the parts of each goal of a pattern; the same goal may come more than once.

        But not by other orders of variables that are alike: their objects come as declared.
        """
        left = [
            sum(pattern.alike[other] == pattern.alike[variable] for other, _ in pattern.types[i:])
            for i, (variable, _) in enumerate(pattern.types)
        ]

        def choices(chosen: dict[str, str], last: dict[str, int]) -> Iterator[tuple[str, ...]]:
            place = len(chosen)
            if place == len(pattern.types):
                yield tuple(_renamed(part, chosen) for part in pattern.parts)
                return
            variable, kind = pattern.types[place]
            first = pattern.alike[variable]
            items = self.of_type[kind]
            for number in range(last.get(first, -1) + 1, len(items) - left[place] + 1):
                if items[number] not in chosen.values():
                    more = chosen | {f'{{{variable}}}': items[number]}
                    if self._possible(pattern.where, more):
                        yield from choices(more, last | {first: number})

        yield from choices({}, {})

    def _possible(self, where: Sequence[str], chosen: Mapping[str, str]) -> bool:
        """Say whether all conditions hold whose variables are chosen already."""
        ground = (_renamed(condition, chosen) for condition in where)
        return all('{' in condition or condition in self.static_facts for condition in ground)


def type_name(typed: up.Object | up.Parameter | up.FNode) -> str:
    """Return the name of the own type of an object, a parameter or a term."""
    return typed.type.name if typed.type.is_user_type() else 'object'


def kind_of(part: str) -> str:
    """Return a part's predicate with its bracket, or the connective of a larger condition."""
    return part.split()[0]


def _renamed(text: str, names: Mapping[str, str]) -> str:
    """Return a text with its words replaced by the names they have there."""
    renamed = ' '.join(names.get(word, word) for word in _words(text))
    return renamed.replace('( ', '(').replace(' )', ')')


def _ground(atom: up.FNode, names: Mapping[str, str]) -> str:
    """Return an atom as text, with its parameters renamed."""
    words = [atom.fluent().name, *(names.get(str(term), str(term)) for term in atom.args)]
    return f'({" ".join(words)})'.lower()


def _variable(kind: str, taken: Collection[str]) -> str:
    """Return a variable for an object of a type: "{place}", or "{place2}" beside it."""
    number = 1
    while (name := f'{{{kind}{number if number > 1 else ""}}}') in taken:
        number += 1
    return name


def _variables(text: str) -> set[str]:
    return {word for word in _words(text) if word.startswith('{')}


def _words(text: str) -> list[str]:
    """Return a text's words and brackets."""
    return text.replace('(', ' ( ').replace(')', ' ) ').split()
