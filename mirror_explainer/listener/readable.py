"""The readable default: how an action is said that the user model has no sentence for.

The verb comes from the action's name, the objects from its effects: what it brings about
is what a listener wants to hear, not everything that it needs.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

from mirror_explainer.listener.english import word_set
from mirror_explainer.listener.roles import Atom, Roles, words_in
from mirror_explainer.listener.verb_phrase import (
    PARTICLES,
    PREPOSITIONS,
    VerbPhrase,
    is_adverb,
    verb_phrase,
)

# What a bare verb says in full, where it has one object.
_IN_FULL = {'pick': ('pick', 'up'), 'put': ('put', 'down')}
# Where the first object of these verbs gets to, if the effects do not tell.
_TO = word_set(
    'deliver bring carry hand give send transport transfer attach connect fasten fit assign '
    'show tell serve report move'
)
_ONTO = word_set('screw mount bolt glue weld stack')
_INTO = word_set('load put insert pour place fill drop pack stow store')
# Verbs of going whose aim is their object: "enter the room".
_AIMING = word_set(
    'enter visit reach approach inspect climb cross leave exit explore search clean find'
)
_THROUGH = word_set('exit leave enter pass')
_DOORS = word_set('door gate exit doorway window passage')
# What is taken is told from where, not with which hand or into which pocket.
_TAKING = word_set('pick grab grasp take get collect fetch lift')
_PICTURES = word_set(
    'image picture photo photograph video scan measurement reading snapshot recording'
)
_MANNERS = word_set('mode color colour style language')


@dataclass(frozen=True)
class Readable:
    """A sentence made from an action's name and effects, "I will take {l} to {b}.".

    `nouns` say what an object is, by parameter, where the action's name does: "load truck".
    `means` are parameters that are said with their kind: "with the infrared camera".
    """

    sentence: str
    nouns: Mapping[str, str] = field(default_factory=dict)
    means: frozenset[str] = frozenset()


@dataclass(frozen=True)
class Readables:
    """Makes the default sentences of a domain's actions.

    `spelt` are the actions' names as they are written; of the kinds in `alone` there is
    one object only.
    """

    roles: Mapping[str, Roles]
    spelt: Mapping[str, str]
    alone: frozenset[str]

    @cached_property
    def moving(self) -> frozenset[str]:
        """The predicates that say where things are: those that actions change so."""
        return frozenset(move.predicate for role in self.roles.values() for move in role.moves)

    def of(self, action: str, more: int = 0) -> Readable:
        """Return an action's sentence, with `more` parameters than its effects ask for."""
        roles = self.roles[action]
        silent = {
            p
            for p, kinds in roles.kinds.items()
            if roles.is_amount(p) or (p in roles.agents and kinds and kinds[0] in self.alone)
        }
        words = words_in(self.spelt[action])
        return _Maker(roles, words, frozenset(silent), self.moving).readable(more)


@dataclass(frozen=True)
class _Maker:
    """Makes one action's sentence: what is said, joined by which words, in which order."""

    roles: Roles
    words: Sequence[str]
    silent: frozenset[str]
    moving: frozenset[str]

    @cached_property
    def nouns(self) -> dict[str, str]:
        """The words of the action's name that stand for its parameters, by parameter."""
        named: dict[str, str] = {}
        changing = self._in(self.roles.made) + self._in(self.roles.undone)
        candidates = [p for p in (self.aim, *changing, *self.roles.parameters) if p]
        for word in [*self.words[1:], self.words[0]]:
            if word not in PREPOSITIONS:
                for p in candidates:
                    if p not in self.silent | named.keys() and word in (*self.roles.kinds[p], p):
                        named[p] = word
                        break
        return named

    @cached_property
    def phrase(self) -> VerbPhrase:
        return verb_phrase(self.words, set(self.nouns.values()))

    @cached_property
    def aim(self) -> str:
        """The parameter for where the robot, or what it moves, gets to; '' if none."""
        aims = [move.destination for move in self.roles.moves]
        return next((aim for aim in aims if aim not in self.silent), '')

    @cached_property
    def origins(self) -> set[str]:
        return {move.origin for move in self.roles.moves}

    @cached_property
    def things(self) -> tuple[str, ...]:
        """The parameters to say beside the aim: those that something is brought about for."""
        made, undone = self.roles.made, self.roles.undone
        things = self._in(atom for atom in made if not atom.about_use)
        if not things and not self.aim:
            things = (
                self._in(atom for atom in undone if not atom.about_use)
                or self._in(made)
                or self._in(undone)
            )
        for named in self.nouns:
            if named not in things and named != self.aim:
                order = self.roles.parameters.index
                later = [i for i, p in enumerate(things) if order(p) > order(named)]
                things.insert(later[0] if later else len(things), named)
        if self.phrase.verb in _TAKING and things:
            taken = self.roles.kinds[things[0]]
            used = set(self._in(atom for atom in (*made, *undone) if atom.about_use))
            hands = {p for p in used - self.nouns.keys() if self.roles.kinds[p] != taken}
            things = [p for p in things if p not in hands]
        return tuple(things)

    def _in(self, atoms: Iterable[Atom]) -> list[str]:
        """Return the parameters in some atoms, those of the widest atom first."""
        ordered = sorted(atoms, key=lambda atom: -len(atom.arguments))
        found = dict.fromkeys(p for atom in ordered for p in atom.arguments if p)
        return [p for p in found if p not in self.silent and p != self.aim]

    def readable(self, more: int) -> Readable:
        moved = self.aim and self.things
        objects = [p for p in self.things if moved or p not in self.roles.agents]
        verb, joined, object_said = self._verb(objects)
        direct = '' if object_said or not objects else objects[0]
        others = [p for p in objects if p != direct]
        said: dict[str, str] = {}  # parameter → the word before it
        if direct:
            through = self.phrase.verb in _THROUGH and self._is(direct, _DOORS)
            said[direct] = joined.pop(direct, 'through' if through else '')
        if not others:
            said |= dict.fromkeys(self._sources(direct), 'from')
        after = joined.pop('', '')
        for p in others:
            if p not in joined and after:
                joined[p], after = after, ''
            of = object_said and p == others[0]
            said[p] = joined.get(p) or (self._of(p) if of else self._joining(p, direct))
        if self.aim:
            aimed_at = self.phrase.verb in _AIMING and not direct and not object_said
            said[self.aim] = joined.get(self.aim) or after or ('' if aimed_at else 'to')
        said |= dict.fromkeys((p for p in self.things if p not in said), 'using')
        left = [p for p in self.roles.parameters if p not in said.keys() | self.silent]
        said |= {p: self._joining(p, direct) for p in left[:more]}
        words = [*verb, *(f'{word} {{{p}}}'.strip() for p, word in said.items())]
        means = frozenset(p for p, word in said.items() if word in ('with', 'in'))
        kinds = {p: self.roles.kinds[p][0] for p in means if self.roles.kinds[p]}
        return Readable(f'I will {" ".join(words)}.', self.nouns | kinds, means & kinds.keys())

    def _verb(self, objects: Sequence[str]) -> tuple[list[str], dict[str, str], bool]:
        """Return the verb with its particles and an object of the name's own: "take the image".

        Also the prepositions of the name by parameter, of the next one to come by '', and
        whether there is such an object.
        """
        verb, rest = self.phrase.verb, self.phrase.rest
        out = list(_IN_FULL.get(verb, [verb]) if not rest and len(objects) == 1 else [verb])
        if verb == 'pick' and not rest:
            out = [*_IN_FULL[verb]]
        joined: dict[str, str] = {}
        preposition, object_said = '', False
        stands_for = {noun: parameter for parameter, noun in self.nouns.items()}
        for word in rest:
            both = word in PREPOSITIONS and word in PARTICLES
            if word in stands_for:
                if preposition:
                    joined[stands_for[word]], preposition = preposition, ''
            elif word in PREPOSITIONS and (not both or len(objects) > 1 or self.nouns):
                preposition = word
            elif word in PARTICLES or is_adverb(word):
                out.append(word)
            else:
                article = [] if object_said or verb == 'do' else ['the']
                out += [*([preposition] if preposition else []), *article, word]
                preposition, object_said = '', True
        if preposition and len(objects) < 2 and not self.aim:
            out.append(preposition)
        elif preposition:
            joined[''] = preposition
        return out, joined, object_said

    def _sources(self, direct: str) -> Iterator[str]:
        """Yield where the direct object is taken away from."""
        for atom in self.roles.undone:
            if direct and direct in atom.arguments and not atom.about_use:
                for p in atom.arguments:
                    if p not in {'', direct, *self.silent, *self.origins, *self.roles.agents}:
                        yield p

    def _of(self, parameter: str) -> str:
        """Return what joins to "take the image", "sample the soil": of the moon, at the rock."""
        picture = not _PICTURES.isdisjoint(self.phrase.rest)
        return 'at' if self._is_there(parameter) and not picture else 'of'

    def _joining(self, parameter: str, direct: str) -> str:
        """Return what joins another object to what was said."""
        verb, roles = self.phrase.verb, self.roles
        made = [a for a in roles.made if parameter in a.arguments and not a.about_use]
        undone = [a for a in roles.undone if parameter in a.arguments and not a.about_use]
        if undone and not made:
            return 'from'
        together = [word for a in made if direct in a.arguments for word in words_in(a.predicate)]
        relation = next((word for word in together if word in PREPOSITIONS), '')
        if relation:
            return 'into' if relation == 'in' and verb in _INTO else relation
        if together and verb in _TO | _ONTO:
            return 'to' if verb in _TO else 'onto'
        if self._is_there(parameter):
            return 'at'
        return 'in' if self._is(parameter, _MANNERS) else 'with'

    def _is_there(self, parameter: str) -> bool:
        """Say whether the robot must be at this place."""
        needed = (a for a in self.roles.needed if a.predicate in self.moving)
        return any(parameter in atom.arguments for atom in needed)

    def _is(self, parameter: str, nouns: frozenset[str]) -> bool:
        return any(not nouns.isdisjoint(words_in(kind)) for kind in self.roles.kinds[parameter])
