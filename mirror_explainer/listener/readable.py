"""The readable default: how an action is said that the user model has no sentence for.

The verb comes from the action's name, the objects from its effects: what it brings about
is what a listener wants to hear, not everything that it needs.
"""

from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass, field
from functools import cached_property

from mirror_explainer.listener.english import indefinite, infinitive, word_set
from mirror_explainer.listener.essentials import (
    DISPENSING,
    DOORS,
    PICTURES,
    TAKING,
    TO,
    Essentials,
)
from mirror_explainer.listener.names import VAGUE, is_code
from mirror_explainer.listener.roles import (
    AGENTS,
    MAYBE_NAMED,
    PEOPLE,
    Roles,
    place_kinds,
    words_in,
)
from mirror_explainer.listener.verb_phrase import (
    DIRECTIONS,
    PARTICLES,
    PHASES,
    PREPOSITIONS,
    is_adverb,
    parted,
    tells_how,
    without_variant,
)

# More are said only to tell steps apart: nobody remembers four things of one sentence.
_MOST = 3
# What a bare verb says in full.
_IN_FULL = {'pick': 'pick up', 'put': 'put down'}
# These are done to something somewhere.
_BRINGING = word_set('deliver bring carry hand give send transport transfer return')
_ONTO = word_set('screw mount bolt glue weld stack board embark')
_KEEPING = word_set('stow store')
_LOADING = DISPENSING | word_set('load insert pour pack')
_INTO = _LOADING | word_set('put place fill drop')
# What their object needs before it, where the name has no word for it: "look at", "wait for".
_BEFORE_OBJECT = {
    **dict.fromkeys(('look', 'stare', 'gaze', 'glance', 'point', 'aim', 'wave', 'smile'), 'at'),
    **dict.fromkeys(('listen', 'talk', 'speak', 'apologize', 'respond', 'reply', 'attend'), 'to'),
    **dict.fromkeys(('dock', 'arrive'), 'at'),
    **dict.fromkeys(('undock', 'depart'), 'from'),
    **dict.fromkeys(('wait', 'care'), 'for'),
    **dict.fromkeys(('knock', 'sit', 'lean'), 'on'),
    **dict.fromkeys(('interact', 'chat'), 'with'),
}
# Where these get to, one is "at": "dock at the charger".
_ARRIVING = word_set('dock arrive park land stop wait stay ask charge recharge')
# What is found out so is what something is looked at for: "test the sample for iron".
_EXAMINING = word_set('measure test analyse analyze check examine inspect screen')
_INSTRUMENTS = word_set(
    'camera sensor lens tool device instrument machine scanner gripper probe meter arm'
)
# Verbs of moving something: "move-cart" moves what the cart is.
_MOVING = word_set(
    'move drive fly sail push pull drag steer roll slide shift transfer bring carry'
)
# Verbs of going whose aim is their object: "enter the room".
_AIMING = word_set(
    'enter visit reach approach inspect climb cross leave exit explore search clean find patrol'
)
_THROUGH = word_set('exit leave enter pass')
_BUILDING = word_set('build construct install erect set')
# What is done into, or from, a thing of the action's name is done to something: "tip-into-press".
_TO_WHERE = word_set('into onto from in on with')
# Two objects behind one of these share it: "with the cup and the plate".
_SHARED = word_set('with for from using')
# What follows these is said of an object as it is: "mark-as-done", "wait-until-dry".
_CLAUSES = word_set('as until while')
_STATES = word_set('let keep')
_TELLING = word_set('say read sing explain announce describe play')
# These are done with somebody: "shake the hands with Anna".
_TOGETHER = word_set('play shake dance share')
# Nouns of a name that stand for whatever object there is.
_GENERIC = word_set(
    'room waypoint place location area zone position pose site point spot object item thing target'
)
# Things are done in these.
MANNERS = word_set('mode color colour style language')
_SOMEBODY = PEOPLE | MAYBE_NAMED
# What goes there is the robot: "move-base".
_ITSELF = AGENTS | {'base'}
_AS_IT_IS = PARTICLES | DIRECTIONS | {'and'}
_ROOMS = word_set(
    'room area zone city cell ward kitchen office lab laboratory hall corridor garage garden '
    'field yard house building workshop town country'
)
_PLACES = _ROOMS | word_set('place location site position')
# One serves something there, and to somebody.
_TABLES = word_set('table seat desk bed bench counter')
# What is put down, taken or brought is what the action's name calls it: "deliver-parcel".
_HANDLING = (TAKING | TO | _ONTO | _KEEPING | _INTO | word_set('release unload leave')) - {'fill'}
_COPULAS = word_set('be stay remain become')
# What is said without "the".
_BARE = word_set('hello goodbye hi')


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
    one object only. `heads` are the nouns in the names of objects, by kind.
    """

    roles: Mapping[str, Roles]
    spelling: Mapping[str, str]
    alone: frozenset[str]
    heads: Mapping[str, Set[str]] = field(default_factory=dict)

    @cached_property
    def _moving(self) -> frozenset[str]:
        return frozenset(move.predicate for role in self.roles.values() for move in role.moves)

    @cached_property
    def _places(self) -> frozenset[str]:
        return frozenset(place_kinds(self.roles.values()))

    @cached_property
    def _words(self) -> dict[str, tuple[str, ...]]:
        words = {name: parted(words_in(self.spelling.get(name, name))) for name in self.roles}

        made = {name: tuple(a.predicate for a in role.made) for name, role in self.roles.items()}
        alike: dict[tuple[str, ...], set[tuple[str, ...]]] = {}
        for name, own in words.items():
            alike.setdefault(made[name], set()).add(own)
        return {
            n: without_variant(own, words.values(), alike[made[n]]) for n, own in words.items()
        }

    def of(self, action: str, more: int = 0) -> Readable:
        """Return an action's sentence, with `more` parameters than its effects ask for."""
        roles = self.roles[action]
        silent = frozenset(
            p
            for p, kinds in roles.kinds.items()
            if roles.is_amount(p) or (p in roles.agents and kinds and kinds[0] in self.alone)
        )
        words = self._words[action]
        known = self._moving, self._places, self.heads
        return _Maker(Essentials(roles, words, silent, *known)).readable(more)


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
        # What robots bring somewhere gets there, rather than they.
        brought = not self.it.handled.isdisjoint(p for p in things if p not in agents)
        is_acting = (brought or not self.it.aim) and len(agents) < len(things)
        acting = agents if is_acting else []
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
        before = ['', *said.values()]
        joined = [
            'and' if word in _SHARED and word == earlier else word
            for earlier, word in zip(before, said.values(), strict=False)
        ]
        words = start.words
        if words[-1] == 'in' and joined[:1] == ['to']:
            words, joined = words[:-1], ['into', *joined[1:]]
        places = [f'{word} {{{p}}}'.strip() for p, word in zip(said, joined, strict=True)]
        if start.after:
            places.insert(min(1, len(places)), start.after)
        means = [p for p, word in said.items() if word in ('with', 'in')]
        kinds = {p: ' '.join(words_in(k[0])) for p in means if (k := self.it.roles.kinds[p])}
        kinds = {p: kind for p, kind in kinds.items() if kind not in VAGUE}
        mover = {objects[0]: start.names} if start.names else {}
        sentence = f'I will {" ".join([*words, *places])}.'
        return Readable(sentence, mover | self.it.kind_nouns | kinds, frozenset(kinds))

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
            said[direct] = start.joined.get(direct, self._before(direct))
        others = [p for p in objects if p != direct]
        if not others and (source := self.it.source(direct)):
            said[source] = 'out of' if coming == 'out of' else 'from'
        for p in others:
            given = start.joined.get(p) or coming
            coming = coming if p in start.joined else ''
            of = start.has_object and p == others[0]
            said[p] = given or (self._of(p) if of else self._joining(p, direct))
        if aim := self.it.aim:
            verb = self.it.phrase.verb
            is_through = verb in ('pass', 'cross') or coming == 'through'
            if is_through and not objects and not start.has_object and (door := self.it.door):
                said[door], coming = 'through', ''
            itself = verb in _AIMING and not said and not start.has_object
            to = '' if itself else 'at' if verb in _ARRIVING else 'to'
            said[aim] = start.joined.get(aim) or coming or to
        return self._between(said)

    def _before(self, direct: str) -> str:
        """Return the word before what the verb is done to, if the name does not have it."""
        verb, rest = self.it.phrase.verb, self.it.phrase.rest
        if verb in _THROUGH and self.it.is_a(direct, DOORS):
            return 'through'
        if rest[-1:] and rest[-1] in _BARE:
            return 'to'
        has_it = not (PREPOSITIONS | PARTICLES).isdisjoint(rest) or direct in self.it.roles.agents
        return '' if has_it or self.it.aim else _BEFORE_OBJECT.get(verb, '')

    def _between(self, said: dict[str, str]) -> dict[str, str]:
        """Return what is said, where two places belong together "between" them: not at both."""
        places = [p for p, word in said.items() if word in ('at', 'in') and self._is_place(p)]
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
        is_moved = verb in _MOVING and bool(self.it.aim)
        is_handled = verb in _HANDLING and not is_moved
        is_handled = is_handled and not self.it.handled.isdisjoint(objects[:1])
        picked = rest[:1] and rest[0] not in stands_for and not self._joins_or_is_generic(rest[0])
        picked = picked and not is_handled
        bare = (
            'up' not in rest and not picked if verb == 'pick' else not rest and len(objects) == 1
        )
        words = [_IN_FULL.get(verb, verb) if bare else verb]
        joined: dict[str, str] = {}
        coming, after, own, there, how = '', '', list[str](), list[str](), list[str]()
        is_named = False  # otherwise: "deliver-parcel"
        for before, word, following in zip((verb, *rest), rest, (*rest, '')[1:], strict=False):
            both = word in PREPOSITIONS and word in PARTICLES
            if word.startswith('to '):  # what somebody is asked for
                coming, after = (word, '') if following in stands_for else (coming, word)
            elif (word, following) == ('out', 'of'):
                coming = 'out of'
            elif word == 'of' and coming:
                continue
            elif is_code(word) and before in stands_for:
                continue  # a variant: "tag-coral-4"
            elif word in stands_for:
                if coming:
                    joined[stands_for[word]], coming = coming, ''
            elif word in PREPOSITIONS and (not both or len(objects) > 1 or self.it.nouns):
                coming = word
            elif objects and (verb in _STATES or not _CLAUSES.isdisjoint([word, *how])):
                how.append(word)
            elif is_named:
                continue
            elif coming == 'to' and word in DIRECTIONS and not following:
                words, coming = [*words, word], ''
            elif not own and self._is_how(word, following):
                (how if objects else words).append(word)
            elif not (own or coming) and (self._is_plain(word) or words[-1] == 'and'):
                words.append(word)
            elif word in _GENERIC and (objects or self.it.aim):
                continue  # it is what the object is: "search-room"
            elif word in _SOMEBODY and objects and self.it.is_a(objects[0], _SOMEBODY):
                continue
            elif is_handled and not coming and not there:
                is_named = True
            elif coming == 'to' and self.it.aim and not objects:
                continue  # it is what the place is called: "return-to-base"
            elif word not in self.it.unsaid_nouns and following not in stands_for:
                if objects and (there or (coming in _TO_WHERE and not own)):
                    there, coming = [*(there or [coming]), word], ''
                    continue
                words += [coming] if coming else []
                coming, own = '', [*own, word]
        if len(own) == 1 and verb in _MOVING and self.it.aim:
            if objects:
                return _Start(words, joined, coming, after=' '.join(how), names=own[0])
            own = [] if own[0] in _ITSELF else own
        of_somebody = bool(objects) and self.it.is_a(objects[0], _SOMEBODY)
        is_bare = own == ['help'] and not of_somebody  # "call for help"
        article = [_article(own[-1])] if own and not is_bare else []
        if verb == 'ask' and own and own[0] != 'question' and 'for' not in rest and not after:
            words.append('for')
        if coming and not own and len(objects) < 2 and not self.it.aim:
            words += [] if self.it.source(''.join(objects)) else [coming]
            coming = coming if coming == 'out of' else ''
        to_there = [there[0], _article(there[-1]), *there[1:]] if there else []
        after = ' '.join(filter(None, [*how, *to_there, after]))
        return _Start([*words, *article, *own], joined, coming, bool(own), after)

    def _joins_or_is_generic(self, word: str) -> bool:
        """Say whether a word of the name is no thing of its own: "from", "slowly", "object"."""
        return word in PREPOSITIONS or word in _GENERIC or self._is_plain(word)

    def _is_plain(self, word: str) -> bool:
        """Say whether a word of the name is said without "the": "up", "slowly", "making"."""
        verb = self.it.phrase.verb
        manner = word in _AS_IT_IS or is_adverb(word) or is_code(word)
        is_bare = word in _BARE or verb in _COPULAS
        return manner or is_bare or bool(verb in PHASES and infinitive(word))

    def _is_how(self, word: str, following: str) -> bool:
        """Say whether a word of the name tells how, and not what the next word is like."""
        stands_alone = following in PREPOSITIONS or not following or tells_how(following)
        return tells_how(word) and stands_alone

    def _of(self, parameter: str) -> str:
        """Return what joins to "take the image", "sample the soil": of the moon, at the rock."""
        verb = self.it.phrase.verb
        if verb in TO | _TOGETHER and self.it.is_a(parameter, _SOMEBODY):
            return 'to' if verb in TO else 'with'
        picture = not PICTURES.isdisjoint(self.it.phrase.rest)
        built = verb in _BUILDING and self.it.is_a(parameter, _PLACES)
        is_there = self._is_there(parameter) or self.it.is_a(parameter, _ROOMS)
        return self._at(parameter) if built or (is_there and not picture) else 'of'

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
                if verb in _BRINGING and relation in ('at', 'in', 'on'):
                    return 'to'
                if relation in ('at', 'in', 'on') and self.it.is_a(parameter, _ROOMS):
                    return 'in'
                return 'into' if relation == 'in' and verb in _INTO else relation
        if made and verb == 'serve' and self._is_place(parameter, _TABLES):
            return 'at'
        if made and (verb in TO or any(atom.owned for atom in together)):
            return 'to'
        if together and verb in _ONTO | _LOADING | _KEEPING:
            return 'onto' if verb in _ONTO else 'in' if verb in _KEEPING else 'into'
        if self.it.is_a(parameter, MANNERS):
            return 'in'
        if self._is_place(parameter):
            return self._at(parameter)
        is_told = verb in _TELLING and self.it.is_a(parameter, _SOMEBODY)
        if is_told and not (direct and self.it.is_a(direct, _SOMEBODY)):
            return 'to'
        kinds = self.it.roles.kinds
        found_out = verb in _EXAMINING and not self.it.is_a(parameter, _INSTRUMENTS | AGENTS)
        return 'for' if found_out and kinds[parameter] != kinds.get(direct) else 'with'

    def _at(self, place: str) -> str:
        """Return "in" for what one is inside of, such as a room, else "at"."""
        return 'in' if self.it.is_a(place, _ROOMS) else 'at'

    def _is_place(self, parameter: str, others: frozenset[str] = frozenset()) -> bool:
        """Say whether a parameter is a place, or of a kind that has one of the other words."""
        return self._is_there(parameter) or self.it.is_a(parameter, _PLACES | others)

    def _is_there(self, parameter: str) -> bool:
        """Say whether the robot must be at this place."""
        needed = (a for a in self.it.roles.needed if a.predicate in self.it.moving)
        return any(parameter in atom.arguments[-1:] for atom in needed)


def _article(noun: str) -> str:
    """Return "a" for what there is more of with every step, such as pictures, else "the"."""
    return indefinite(noun) if noun in PICTURES else 'the'
