"""Actions that take time as actions that happen at once, with the same outcome when alone.

What must hold after the start is asked for before it, by regression: p(x) holds after
the start if the start adds it, or if it held and the start does not take it away. Where start
and end disagree about a fact, the end has the last word.
"""

import itertools
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

from mirror_explainer.pddl.text.actions import (
    ACTION,
    CHANGES,
    Action,
    Effect,
    effects,
    timed_conditions,
    variables_of,
)
from mirror_explainer.pddl.text.declarations import Declarations, Kinds
from mirror_explainer.pddl.text.tree import Branch, Tree, Word, word, words

_TRUE = Branch([Word('and')])
_FALSE = Branch([Word('or')])


def at_once(
    action: Action, declared: Declarations, derived: Iterable[Branch], source: str
) -> tuple[Action, Tree | None]:
    """Return a durative action as one without duration, and what of it could not be kept.

    `derived` are the domain's derived predicates. One that must hold later, and depends on
    what the start changes, is not kept.
    """
    every = [*effects(action.parts.get(':effect'), source, True)]
    start = [effect for effect in every if effect.phase == 'start' and not _is_number(effect)]
    end = [effect for effect in every if effect.phase == 'end' and not _is_number(effect)]
    numbers = [replace(effect, phase='') for effect in every if _is_number(effect)]
    after = _After(start, declared, _rests_on(derived))
    types = dict(action.parameters)
    needs: list[Tree] = []
    for phase, condition in timed_conditions(action.parts.get(':condition'), source):
        needs.append(condition if phase == 'start' else after.holds(condition, types))
    changes = [after.effect(effect, types) for effect in end]
    for effect in start:
        outlasts = _not(_any(after.takes_back(effect, changed, types) for changed in changes))
        if outlasts != _FALSE:
            more = () if outlasts == _TRUE else (outlasts,)
            changes.append(replace(effect, phase='', conditions=(*effect.conditions, *more)))
    place = action.section
    parts: dict[str, Tree] = {
        ':parameters': action.parts.get(':parameters', place.like([])),
        ':precondition': _at(place, _all(needs)),
        ':effect': _at(place, _all_of([effect.tree() for effect in (*changes, *numbers)])),
    }
    section = place.like([word(ACTION, place), *place[1:]])
    return Action(action.name, False, action.parameters, parts, section), after.lost


@dataclass
class _After:
    """What holds after the start of an action, in terms of what held before."""

    start: Sequence[Effect]
    declared: Declarations
    rests_on: Mapping[str, frozenset[str]]
    lost: Tree | None = None

    def holds(self, tree: Tree, types: Mapping[str, Kinds]) -> Tree:
        """Return the condition before the start for another after it."""
        if isinstance(tree, Word) or not tree or tree.head == '=':
            return tree
        head = tree.head
        if head in ('forall', 'exists') and len(tree) == 3 and isinstance(tree[1], Branch):
            inner = {**types, **variables_of(tree[1])}
            return tree.like([*tree[:2], self.holds(tree[2], inner)])
        if head == 'not' and len(tree) == 2:
            return _not(self.holds(tree[1], types))
        if head == 'and':
            return _all([self.holds(part, types) for part in tree[1:]])
        if head == 'or':
            return _any(self.holds(part, types) for part in tree[1:])
        if head == 'imply':
            return tree.like([tree[0], *(self.holds(part, types) for part in tree[1:])])
        if head in self.rests_on:
            if self.rests_on[head] & {_atom(effect).head for effect in self.start}:
                self.lost = tree
                return _TRUE
            return tree
        added = _any(self._same(tree, e, types) for e in self.start if _adds(e))
        taken = _any(self._same(tree, e, types) for e in self.start if not _adds(e))
        return _any([added, _all([tree, _not(taken)])])

    def effect(self, effect: Effect, types: Mapping[str, Kinds]) -> Effect:
        """Return an effect at the end, with its conditions before the start."""
        inner = dict(types)
        for names in effect.variables:
            inner |= variables_of(names)
        conditions = tuple(self.holds(condition, inner) for condition in effect.conditions)
        kept = tuple(condition for condition in conditions if condition != _TRUE)
        return replace(effect, phase='', conditions=kept)

    def takes_back(self, early: Effect, late: Effect, types: Mapping[str, Kinds]) -> Tree:
        """Return when an effect at the end undoes one at the start.

        One that takes a fact away needs no such care: what adds it in the same action wins.
        """
        if not _adds(early) or _adds(late):
            return _FALSE
        inner = dict(types)
        for names in early.variables:
            inner |= variables_of(names)
        return self._same(_atom(early), late, inner)

    def _same(self, atom: Branch, effect: Effect, types: Mapping[str, Kinds]) -> Tree:
        """Return the condition that an effect is about an atom, and happens."""
        changed = _atom(effect)
        if changed.head != atom.head or len(changed) != len(atom):
            return _FALSE
        own: dict[str, Kinds] = {}
        for names in effect.variables:
            own |= variables_of(names)
        # The effect's own variables may be called as those around the atom are.
        fresh = {name: f'{name}-{len(types)}' for name in own}
        parts = [
            self._equal(one, _renamed(other, fresh), {**types, **_named(own, fresh)})
            for one, other in zip(atom[1:], changed[1:], strict=True)
        ]
        conditions = (_renamed(condition, fresh) for condition in effect.conditions)
        found = _all([*parts, *conditions])
        if own and found != _FALSE:
            listed = ' '.join(f'{fresh[name]} - {kinds[0]}' for name, kinds in own.items())
            bound = Branch((word(text, atom) for text in listed.split()), atom.line, atom.column)
            return Branch([word('exists', atom), bound, found], atom.line, atom.column)
        return found

    def _equal(self, one: Tree, other: Tree, types: Mapping[str, Kinds]) -> Tree:
        """Return the condition that two names stand for one object: false if they never can."""
        if one == other:
            return _TRUE
        extents = [
            set(self.declared.extent(types[str(name)])) if str(name) in types else {str(name)}
            for name in (one, other)
        ]
        if not extents[0] & extents[1]:
            return _FALSE
        return Branch([word('=', one), one, other], one.line, one.column)


def _rests_on(derived: Iterable[Branch]) -> dict[str, frozenset[str]]:
    """Return for each derived predicate what it, and what it is made of, depends on."""
    direct: dict[str, set[str]] = {}
    for section in derived:
        if len(section) == 3 and isinstance(section[1], Branch):
            direct.setdefault(section[1].head, set()).update(map(str, words(section[2])))
    for middle, name in itertools.product(list(direct), list(direct)):
        if middle in direct[name]:
            direct[name] |= direct[middle]
    return {name: frozenset(below) for name, below in direct.items()}


def _is_number(effect: Effect) -> bool:
    return effect.change.head in CHANGES


def _adds(effect: Effect) -> bool:
    return effect.change.head != 'not'


def _atom(effect: Effect) -> Branch:
    """Return the fact that an effect is about."""
    atom = effect.change if _adds(effect) else effect.change[1]
    return atom if isinstance(atom, Branch) else Branch([atom])


def _renamed(tree: Tree, names: Mapping[str, str]) -> Tree:
    if isinstance(tree, Word):
        return word(names[tree], tree) if tree in names else tree
    return tree.like(_renamed(part, names) for part in tree)


def _named(types: Mapping[str, Kinds], names: Mapping[str, str]) -> dict[str, Kinds]:
    return {names[name]: kinds for name, kinds in types.items()}


def _all(parts: Iterable[Tree]) -> Tree:
    """Return the conjunction, simplified."""
    flat: list[Tree] = []
    for part in parts:
        inner = part[1:] if isinstance(part, Branch) and part.head == 'and' else [part]
        flat += [one for one in inner if one not in flat and one != _TRUE and one != []]
    if _FALSE in flat or any(_not(part) in flat for part in flat):
        return _FALSE
    return flat[0] if len(flat) == 1 else _all_of(flat)


def _any(parts: Iterable[Tree]) -> Tree:
    """Return the disjunction, simplified."""
    kept: list[Tree] = []
    for part in parts:
        if part == _TRUE:
            return _TRUE
        if part != _FALSE and part not in kept:
            kept.append(part)
    return kept[0] if len(kept) == 1 else Branch([Word('or'), *kept])


def _not(tree: Tree) -> Tree:
    """Return the negation, simplified."""
    if tree == _TRUE:
        return _FALSE
    if tree == _FALSE:
        return _TRUE
    if isinstance(tree, Branch) and tree.head == 'not' and len(tree) == 2:
        return tree[1]
    if isinstance(tree, Branch) and tree.head == 'or':
        return _all([_not(part) for part in tree[1:]])
    return Branch([Word('not'), tree], tree.line, tree.column)


def _all_of(parts: Sequence[Tree]) -> Branch:
    return Branch([Word('and'), *parts])


def _at(place: Tree, tree: Tree) -> Tree:
    """Return a tree all of which is at one place."""
    if isinstance(tree, Word):
        return word(tree, place)
    return Branch((_at(place, part) for part in tree), place.line, place.column)
