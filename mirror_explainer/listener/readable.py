"""The readable default: how an action is said that the user model has no sentence for.

The verb comes from the action's name, the objects from its effects: what it brings about
is what a listener wants to hear, not everything that it needs.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

from mirror_explainer.listener.english import infinitive, word_set
from mirror_explainer.listener.essentials import DISPENSING, Essentials
from mirror_explainer.listener.names import VAGUE, is_code
from mirror_explainer.listener.roles import Roles, place_kinds, words_in
from mirror_explainer.listener.verb_phrase import (
    DIRECTIONS,
    PARTICLES,
    PHASES,
    PREPOSITIONS,
    is_adverb,
    without_variant,
)

# More are said only to tell steps apart: nobody remembers four things of one sentence.
_MOST = 3
# What a bare verb says in full.
_IN_FULL = {'pick': 'pick up', 'put': 'put down'}
# Where the first object of these verbs gets to, if the effects do not tell.
_TO = word_set(
    'deliver bring carry hand give send transport transfer attach connect fasten fit assign '
    'show tell serve report move'
)
_ONTO = word_set('screw mount bolt glue weld stack')
_LOADING = DISPENSING | word_set('load insert pour pack stow store')
_INTO = _LOADING | word_set('put place fill drop')
# Verbs of moving something: "move-cart" moves what the cart is.
_MOVING = word_set(
    'move drive fly sail push pull drag steer roll slide shift transfer bring carry'
)
# Verbs of going whose aim is their object: "enter the room".
_AIMING = word_set(
    'enter visit reach approach inspect climb cross leave exit explore search clean find'
)
_THROUGH = word_set('exit leave enter pass')
_DOORS = word_set('door gate exit doorway window passage')
_PICTURES = word_set(
    'image picture photo photograph video scan measurement reading snapshot recording'
)
_BUILDING = word_set('build construct install erect set')
# What is done into, or from, a thing of the action's name is done to something: "tip-into-press".
_TO_WHERE = word_set('into onto from in on')
# Nouns of a name that stand for whatever object there is.
_GENERIC = word_set(
    'room waypoint place location area zone position pose site point spot object item thing target'
)
_MANNERS = word_set('mode color colour style language')
_AS_IT_IS = PARTICLES | DIRECTIONS | {'and'}
_PLACES = word_set('place location room site area zone city cell position')


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

    `spelling` has the names that are written with capitals; of the kinds in `alone` there is
    one object only.
    """

    roles: Mapping[str, Roles]
    spelling: Mapping[str, str]
    alone: frozenset[str]

    @cached_property
    def _moving(self) -> frozenset[str]:
        return frozenset(move.predicate for role in self.roles.values() for move in role.moves)

    @cached_property
    def _places(self) -> frozenset[str]:
        return frozenset(place_kinds(self.roles.values()))

    @cached_property
    def _words(self) -> dict[str, tuple[str, ...]]:
        words = {name: words_in(self.spelling.get(name, name)) for name in self.roles}
        return {name: without_variant(own, words.values()) for name, own in words.items()}

    def of(self, action: str, more: int = 0) -> Readable:
        """Return an action's sentence, with `more` parameters than its effects ask for."""
        roles = self.roles[action]
        silent = frozenset(
            p
            for p, kinds in roles.kinds.items()
            if roles.is_amount(p) or (p in roles.agents and kinds and kinds[0] in self.alone)
        )
        words = self._words[action]
        return _Maker(Essentials(roles, words, silent, self._moving, self._places)).readable(more)


@dataclass(frozen=True)
class _Start:
    """How a sentence begins: the verb, particles, and an object of its own, "take the image".

    `joined` are the prepositions that the action's name gives, by parameter, and `next` the
    one for whatever comes next. `after` follows the first object: "move it up".
    """

    words: list[str]
    joined: dict[str, str]
    next: str = ''
    has_object: bool = False
    after: str = ''
    names: str = ''


@dataclass(frozen=True)
class _Maker:
    """Makes one action's sentence: what is said is joined by the right words."""

    it: Essentials

    def readable(self, more: int) -> Readable:
        things = self.it.things
        agents = [p for p in things if p in self.it.roles.agents]
        acting = agents if not self.it.aim and len(agents) < len(things) else []
        objects = [p for p in things if p not in acting]
        start = self._start(objects)
        said = self._joined(objects, start)
        said |= dict.fromkeys(acting, 'using')
        kept = self._kept(list(said), objects[:1], more)
        direct = objects[0] if objects and not start.has_object else ''
        others = [p for p in self.it.roles.parameters if p not in said.keys() | self.it.silent]
        extra = others[: max(0, more - (len(said) - min(len(said), _MOST)))]
        said = {p: word for p, word in said.items() if p in kept}
        said |= {p: self._joining(p, direct) for p in extra}
        places = [f'{word} {{{p}}}'.strip() for p, word in said.items()]
        if start.after:
            places.insert(min(1, len(places)), start.after)
        means = [p for p, word in said.items() if word in ('with', 'in')]
        kinds = {p: ' '.join(words_in(k[0])) for p in means if (k := self.it.roles.kinds[p])}
        kinds = {p: kind for p, kind in kinds.items() if kind not in VAGUE}
        mover = {objects[0]: start.names} if start.names else {}
        sentence = f'I will {" ".join([*start.words, *places])}.'
        return Readable(sentence, mover | self.it.nouns | kinds, frozenset(kinds))

    def _kept(self, said: Sequence[str], direct: Sequence[str], more: int) -> set[str]:
        """Return the parameters that are said, of those that may be: the most important ones."""
        first = {*direct, self.it.aim, *self.it.nouns}
        ranked = sorted(said, key=lambda p: p not in first)
        return set(ranked[: _MOST + more])

    def _joined(self, objects: Sequence[str], start: _Start) -> dict[str, str]:
        """Return the parameters to say, in order, each with the word before it."""
        said: dict[str, str] = {}
        coming = start.next
        direct = '' if start.has_object or not objects else objects[0]
        if direct:
            through = self.it.phrase.verb in _THROUGH and self._is(direct, _DOORS)
            said[direct] = start.joined.get(direct, 'through' if through else '')
        others = [p for p in objects if p != direct]
        if not others and (source := self.it.source(direct)):
            said[source] = 'out of' if coming == 'out of' else 'from'
        for p in others:
            given = start.joined.get(p) or coming
            coming = coming if p in start.joined else ''
            of = start.has_object and p == others[0]
            said[p] = given or (self._of(p) if of else self._joining(p, direct))
        if aim := self.it.aim:
            itself = self.it.phrase.verb in _AIMING and not direct and not start.has_object
            said[aim] = start.joined.get(aim) or coming or ('' if itself else 'to')
        return self._between(said)

    def _between(self, said: dict[str, str]) -> dict[str, str]:
        """Return what is said, where two places belong together "between" them: not at both."""
        places = [p for p, word in said.items() if word == 'at']
        related = (set(atom.arguments) for atom in self.it.roles.made)
        if len(places) == 2 and any(set(places) <= both for both in related):
            return said | dict(zip(places, ('between', 'and'), strict=True))
        return said

    def _start(self, objects: Sequence[str]) -> _Start:
        """Return how the sentence begins, from the words of the action's name."""
        verb, rest = self.it.phrase.verb, self.it.phrase.rest
        if rest and rest[0] in DIRECTIONS and verb == 'go' and objects:
            return _Start(['move'], {}, after=rest[0])
        stands_for = {noun: parameter for parameter, noun in self.it.nouns.items()}
        # Apples that the name tells of are picked from a tree: "pick-apples".
        picked = rest[:1] and rest[0] not in stands_for and not self._joins_or_is_generic(rest[0])
        bare = (
            'up' not in rest and not picked if verb == 'pick' else not rest and len(objects) == 1
        )
        words = [_IN_FULL.get(verb, verb) if bare else verb]
        joined: dict[str, str] = {}
        coming, own, there = '', list[str](), list[str]()
        for word, following in zip(rest, (*rest, '')[1:], strict=True):
            both = word in PREPOSITIONS and word in PARTICLES
            if (word, following) == ('out', 'of'):
                coming = 'out of'
            elif word == 'of' and coming:
                continue
            elif word in stands_for:
                if coming:
                    joined[stands_for[word]], coming = coming, ''
            elif word in PREPOSITIONS and (not both or len(objects) > 1 or self.it.nouns):
                coming = word
            elif not own and (self._is_plain(word) or words[-1] == 'and'):
                words.append(word)
            elif word in _GENERIC and (objects or self.it.aim):
                continue  # it is what the object is: "search-room"
            elif word not in self.it.unsaid_nouns and following not in stands_for:
                if objects and (there or (coming in _TO_WHERE and not own)):
                    there, coming = [*(there or [coming]), word], ''
                    continue
                words += [coming] if coming else []
                coming, own = '', [*own, word]
        if len(own) == 1 and verb in _MOVING and self.it.aim and objects:
            return _Start(words, joined, coming, names=own[0])
        article = [_article(own[-1])] if own and verb != 'do' else []
        if coming and not own and len(objects) < 2 and not self.it.aim:
            words += [] if self.it.source(''.join(objects)) else [coming]
            coming = coming if coming == 'out of' else ''
        after = ' '.join([there[0], _article(there[-1]), *there[1:]]) if there else ''
        return _Start([*words, *article, *own], joined, coming, bool(own), after)

    def _joins_or_is_generic(self, word: str) -> bool:
        """Say whether a word of the name is no thing of its own: "from", "slowly", "object"."""
        return word in PREPOSITIONS or word in _GENERIC or self._is_plain(word)

    def _is_plain(self, word: str) -> bool:
        """Say whether a word of the name is said without "the": "up", "slowly", "making"."""
        manner = word in _AS_IT_IS or is_adverb(word) or is_code(word)
        return manner or bool(self.it.phrase.verb in PHASES and infinitive(word))

    def _of(self, parameter: str) -> str:
        """Return what joins to "take the image", "sample the soil": of the moon, at the rock."""
        picture = not _PICTURES.isdisjoint(self.it.phrase.rest)
        built = self.it.phrase.verb in _BUILDING and self._is(parameter, _PLACES)
        return 'at' if built or (self._is_there(parameter) and not picture) else 'of'

    def _joining(self, parameter: str, direct: str) -> str:
        """Return what joins another object to what was said."""
        verb, roles = self.it.phrase.verb, self.it.roles
        made = [a for a in roles.made if parameter in a.arguments and not a.about_use]
        undone = [a for a in roles.undone if parameter in a.arguments and not a.about_use]
        if parameter in self.it.origins or (undone and not made):
            return 'of' if any(atom.turned for atom in undone) else 'from'
        together = [atom for atom in made if direct in atom.arguments]
        if any(atom.turned and atom.arguments[0] == direct for atom in together):
            return 'in' if any('contain' in atom.predicate for atom in together) else 'with'
        for first, *others in (words_in(atom.predicate) for atom in together):
            at_end = others[-1] if others else first
            fits = not others or self.it.is_kind(parameter, at_end)
            relation = first if first in PREPOSITIONS and fits else at_end
            if relation in PREPOSITIONS:
                return 'into' if relation == 'in' and verb in _INTO else relation
        if made and verb in _TO:
            return 'to'
        if together and verb in _ONTO | _LOADING:
            return 'onto' if verb in _ONTO else 'into'
        if self._is(parameter, _MANNERS):
            return 'in'
        place = self._is_there(parameter) or self._is(parameter, _PLACES)
        return 'at' if place else 'with'

    def _is_there(self, parameter: str) -> bool:
        """Say whether the robot must be at this place."""
        needed = (a for a in self.it.roles.needed if a.predicate in self.it.moving)
        return any(parameter in atom.arguments[-1:] for atom in needed)

    def _is(self, parameter: str, nouns: frozenset[str]) -> bool:
        kinds = self.it.roles.kinds[parameter]
        return any(not nouns.isdisjoint(words_in(kind)) for kind in kinds)


def _article(noun: str) -> str:
    """Return "a" for what there is more of with every step, such as pictures, else "the"."""
    if noun in _PICTURES:
        return 'an' if noun[0] in 'aeiou' else 'a'
    return 'the'
