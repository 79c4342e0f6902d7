"""What an action's parameters do in it, read off its effects: what comes about, what moves where.

The readable default of a sentence is made from this.
"""

import itertools
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import unified_planning.model as up

from mirror_explainer.listener.english import word_set
from mirror_explainer.pddl import Task, conjuncts

# Names of what is counted rather than meant: a battery's level, seconds, free places.
_AMOUNTS = word_set(
    'level fuel battery energy power number num count counter amount capacity size time tick '
    'step percent int integer quantity'
)
_AMOUNT_ENDS = ('level', 'amount', 'capacity')  # "fuellevel"
# Predicates that name what holds a thing before the thing.
HOLDING = word_set('contains containing holding holds carrying carries lifting gripping grasping')
# Predicates that say whether a thing can be used, which no listener asks for.
_USE = word_set(
    'free empty clear full available avail idle vacant busy occupied handempty handfree unused '
    'reserved'
)
AGENTS = word_set('robot bot agent rover drone uav agv amr manipulator')
# Predicates of who has, or where there is, a thing, before the thing.
_HAVING = word_set('has have having owns')
# Kinds of people and animals, which have names, and such of which some have.
PEOPLE = word_set(
    'person people human patient passenger customer guest user horse pony dog cat pet'
)
MAYBE_NAMED = word_set('robot agent human nurse doctor child visitor resident')


@dataclass(frozen=True)
class Atom:
    """A predicate with an action's parameters; '' stands for an object.

    What is somewhere goes before where it is: (holding ?hand ?cup) is turned around, and so is
    what somebody has, (has ?nurse ?cup): it is `owned`.
    """

    predicate: str
    arguments: tuple[str, ...]
    owned: bool = False

    @cached_property
    def turned(self) -> bool:
        """Whether it says who holds, carries or contains something."""
        return not HOLDING.isdisjoint(words_in(self.predicate))

    @cached_property
    def about_use(self) -> bool:
        """Whether it says no more than that something can be used."""
        return not _USE.isdisjoint(words_in(self.predicate)) or self.predicate in _USE


@dataclass(frozen=True)
class Move:
    """A predicate whose one argument changes from `origin` to `destination`, two parameters."""

    predicate: str
    origin: str
    destination: str


@dataclass(frozen=True)
class Roles:
    """The atoms that an action needs, makes true and makes false, and its parameters' kinds.

    `kinds` are the nouns for each parameter: its type and those above it, or, without types,
    the predicates that say what it is. `agents` are parameters for who acts: the robot.
    `measured` are the numbers that it changes.
    """

    name: str
    kinds: Mapping[str, tuple[str, ...]]
    needed: tuple[Atom, ...]
    made: tuple[Atom, ...]
    undone: tuple[Atom, ...]
    measured: tuple[Atom, ...] = ()
    agents: tuple[str, ...] = ()

    @property
    def parameters(self) -> tuple[str, ...]:
        """The parameters' names, in order."""
        return tuple(self.kinds)

    @cached_property
    def moves(self) -> tuple['Move', ...]:
        """What changes its place: (at ?r ?a) is undone, and (at ?r ?b) made."""
        pairs = itertools.product(self.made, self.undone)
        moves = (_move(m, undone) for m, undone in pairs if not (m.about_use or m.owned))
        return tuple(
            move
            for move in moves
            if move
            and not self.is_amount(move.destination)
            and _AMOUNTS.isdisjoint(words_in(move.predicate))
        )

    def is_amount(self, parameter: str) -> bool:
        """Say whether a parameter is a number in disguise."""
        words = [word for kind in self.kinds[parameter] for word in words_in(kind)]
        return any(word in _AMOUNTS or word.endswith(_AMOUNT_ENDS) for word in words)


def roles_of(task: Task) -> dict[str, Roles]:
    """Return the roles of each action of the task's domain."""
    static = {fluent.name for fluent in task.model.get_static_fluents()}
    roles = {action.name: _roles(action, static) for action in task.model.actions}
    acting = _acting_kinds(roles)
    return {
        name: replace(
            role,
            agents=tuple(p for p, kinds in role.kinds.items() if not acting.isdisjoint(kinds)),
        )
        for name, role in roles.items()
    }


def _roles(action: up.InstantaneousAction, static: set[str]) -> Roles:
    needed = tuple(
        _atom(literal)
        for condition in action.preconditions
        for literal in conjuncts(condition)
        if literal.is_fluent_exp()
    )
    kinds = {}
    for parameter in action.parameters:
        said_by = [
            atom.predicate
            for atom in needed
            if atom.predicate in static and atom.arguments == (parameter.name,)
        ]
        types = [kind.name for kind in _with_types_above(parameter.type)]
        kinds[parameter.name] = tuple([kind for kind in types if kind != 'object'] + said_by)
    effects = [e for e in action.effects if e.fluent.type.is_bool_type() and e.is_assignment()]
    made = tuple(_atom(e.fluent) for e in effects if e.value.is_true())
    undone = tuple(a for e in effects if e.value.is_false() and (a := _atom(e.fluent)) not in made)
    made, undone = _owned(made, undone, kinds), _owned(undone, made, kinds)
    measured = tuple(_atom(e.fluent) for e in action.effects if not e.fluent.type.is_bool_type())
    return Roles(action.name, kinds, needed, made, undone, measured)


def _atom(expression: up.FNode) -> Atom:
    name = expression.fluent().name
    arguments = [a.parameter().name if a.is_parameter_exp() else '' for a in expression.args]
    if len(arguments) == 2 and not HOLDING.isdisjoint(words_in(name)):
        arguments.reverse()
    return Atom(name, tuple(arguments))


def _owned(
    atoms: Iterable[Atom], others: Iterable[Atom], kinds: Mapping[str, tuple[str, ...]]
) -> tuple[Atom, ...]:
    """Return effects, in those of what somebody has the thing first.

    Where the `others`, which are made so the other way, are of the same owner, it is what that is
    like: (has ?robot ?colour).
    """
    likenesses = {(other.predicate, other.arguments[:1]) for other in others}

    def is_owned(atom: Atom) -> bool:
        if len(atom.arguments) != 2 or _HAVING.isdisjoint(words_in(atom.predicate)):
            return False
        words = {word for kind in kinds.get(atom.arguments[0], ()) for word in words_in(kind)}
        is_somebody = not words.isdisjoint(PEOPLE | MAYBE_NAMED | AGENTS)
        return is_somebody and (atom.predicate, atom.arguments[:1]) not in likenesses

    return tuple(
        Atom(atom.predicate, atom.arguments[::-1], owned=True) if is_owned(atom) else atom
        for atom in atoms
    )


def _move(made: Atom, undone: Atom) -> Move | None:
    if made.predicate != undone.predicate:
        return None
    pairs = list(zip(undone.arguments, made.arguments, strict=True))
    changed = [(i, pair) for i, pair in enumerate(pairs) if pair[0] != pair[1]]
    if len(changed) != 1 or not all(changed[0][1]):
        return None
    place, (origin, destination) = changed[0]
    # What stands first of several is what is somewhere, rather than where.
    return Move(made.predicate, origin, destination) if place or len(pairs) == 1 else None


def _with_types_above(kind: up.Type | None) -> Iterator[up.Type]:
    while kind is not None and kind.is_user_type():
        yield kind
        kind = kind.father


def _acting_kinds(roles: Mapping[str, Roles]) -> set[str]:
    """Return the kinds of who acts: what is called a robot, or what every action has as one."""
    having = [role for role in roles.values() if role.kinds]
    counts = Counter(kind for role in having for kind in {k[0] for k in role.kinds.values() if k})
    moving = {
        role.kinds[argument][0]
        for role in having
        for move in role.moves
        for atom in role.made
        if atom.predicate == move.predicate
        for argument in atom.arguments
        if argument not in ('', move.destination) and role.kinds[argument]
    }
    everywhere = {kind for kind, count in counts.items() if count == len(having) > 1}
    robots = {kind for kind in counts if not AGENTS.isdisjoint(words_in(kind))}
    return robots | (everywhere & moving) - place_kinds(roles.values())


def place_kinds(roles: Iterable[Roles]) -> set[str]:
    """Return the kinds of what things get to."""
    return {
        role.kinds[move.destination][0]
        for role in roles
        for move in role.moves
        if role.kinds[move.destination]
    }


def words_in(name: str) -> list[str]:
    """Return the words of a PDDL name, in lower case: "place_inFixture-2" has four."""
    spaced = re.sub(r'(?<=[a-z])(?=[A-Z][a-z])|(?<=[a-z]{2})(?=[A-Z])', ' ', name)
    return [word for word in re.split(r'[-_\s]+', spaced.lower()) if word] or [name]
