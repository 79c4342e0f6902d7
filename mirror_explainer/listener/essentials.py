"""What of an action's objects a listener wants to hear, in which order: chosen by its effects."""

from collections.abc import Iterable, Mapping, Sequence, Set
from dataclasses import dataclass
from functools import cached_property

from mirror_explainer.listener.english import word_set
from mirror_explainer.listener.roles import (
    HOLDING,
    MAYBE_NAMED,
    PEOPLE,
    Atom,
    Roles,
    words_in,
)
from mirror_explainer.listener.verb_phrase import (
    PREPOSITIONS,
    VerbPhrase,
    joins_verbs,
    verb_phrase,
)

# What is taken is told from where, not with which hand or into which pocket.
TAKING = word_set('pick grab grasp take get collect fetch lift')
# Where the first object of these verbs gets to, if the effects do not tell.
TO = word_set(
    'deliver bring carry hand give send transport transfer attach connect fasten fit assign '
    'show tell serve report move offer pass lend sell return'
)
PICTURES = word_set(
    'image picture photo photograph video scan measurement reading snapshot recording'
)
# What is done so to a liquid gets it into something, and it is no more what it was.
DISPENSING = word_set('dispense inject squirt drip')
_HELD = HOLDING | word_set('held carried grasped gripped')
DOORS = word_set('door gate exit doorway window passage')
_SOMEWHERE = PREPOSITIONS | word_set('stored lies located location loc position pos parked')


@dataclass(frozen=True)
class Essentials:
    """The parameters that are said of an action, whose name has these words.

    Nothing is said of the `silent` ones. `moving` are the predicates that say where things
    are, and `places` the kinds of where they are; `heads` are the nouns in the names of
    objects, by kind: "cup" of red_cup and cup2.
    """

    roles: Roles
    words: Sequence[str]
    silent: frozenset[str]
    moving: frozenset[str]
    places: frozenset[str]
    heads: Mapping[str, Set[str]]

    @cached_property
    def aim(self) -> str:
        """The parameter for where the robot, or what it moves, gets to; '' if none."""
        aims = [move.destination for move in self.roles.moves]
        return next((aim for aim in aims if aim not in self.silent), '')

    @cached_property
    def origins(self) -> frozenset[str]:
        """The parameters for where what moves was before."""
        return frozenset(move.origin for move in self.roles.moves)

    @cached_property
    def nouns(self) -> dict[str, str]:
        """The words of the action's name that stand for its parameters, by parameter."""
        named: dict[str, str] = {}
        changing = self._in(self.roles.made) + self._in(self.roles.undone)
        first, *rest = self.words
        candidates = [p for p in (self.aim, *changing, *self.roles.parameters) if p]
        in_order = rest[2:] if joins_verbs(self.words) else [*rest, first]
        for word in in_order:
            taken = self.silent | self.origins | named.keys()
            free = [p for p in candidates if p not in taken and word not in PREPOSITIONS]
            called = [p for p in free if self._is_called(p, word)]
            if not called and word in rest and word not in PICTURES:
                called = [p for p in self.roles.parameters if p in free and self._is_head(p, word)]
                after = self.words[self.words.index(word, 1) - 1]
                called = called[::-1] if after in PREPOSITIONS else called  # "place-on-table"
            if called:
                named[called[0]] = word
        return named

    def _is_called(self, parameter: str, noun: str) -> bool:
        return noun == parameter or self.is_kind(parameter, noun)

    def _is_head(self, parameter: str, noun: str) -> bool:
        return any(noun in self.heads.get(kind, ()) for kind in self.roles.kinds[parameter][:1])

    @property
    def kind_nouns(self) -> dict[str, str]:
        """The nouns that say what kind of object is meant, by parameter."""
        return {p: noun for p, noun in self.nouns.items() if self._is_called(p, noun)}

    def is_kind(self, parameter: str, noun: str) -> bool:
        """Say whether a noun is a parameter's kind, or the last word of it: "slow-lift"."""
        return any(words_in(kind)[-1] == noun for kind in self.roles.kinds[parameter])

    @cached_property
    def phrase(self) -> VerbPhrase:
        """The action's name as a verb and what else it says."""
        return verb_phrase(self.words, set(self.nouns.values()))

    @cached_property
    def things(self) -> tuple[str, ...]:
        """The parameters to say beside the aim, those that something is brought about for.

        The first one is what the verb is done to.
        """
        made, undone = self.roles.made, self.roles.undone
        things = self._in(atom for atom in made if not atom.about_use)
        if not things and not self.aim:
            things = (
                self._in(atom for atom in undone if not atom.about_use)
                or self._in(made)
                or self._in(undone)
                or self._in(self.roles.measured)
            )
        order = self.roles.parameters.index
        for named in self.nouns:
            if named not in things and named != self.aim:
                later = [i for i, p in enumerate(things) if order(p) > order(named)]
                things.insert(later[0] if later else len(things), named)
        # What was elsewhere before goes first, then what the verb names: "load truck", "fill cup";
        # but before all who it names that something is done to: "attend-person".
        first = self._named_first
        is_person = first and self.phrase.verb not in TO and self.is_a(first, PEOPLE | MAYBE_NAMED)
        things.sort(
            key=lambda p: (p != first if is_person else p not in self._shifted, p != first)
        )
        hands = self._hands(things)
        tool = [self.tool] if self.tool and self.tool not in things else []
        return tuple([p for p in things if p not in hands] + tool)

    @cached_property
    def tool(self) -> str:
        """The parameter for what a thing is cleaned or cut with, if the name ends in "with"."""
        unlike = {*self.silent, *self.origins, *self.roles.agents, self.aim}
        unlike |= {p for atom in (*self.roles.made, *self.roles.undone) for p in atom.arguments}
        if self.phrase.rest[-1:] != ('with',) or self.aim:
            return ''
        spare = (p for p in self.roles.parameters if p not in unlike and not self.is_place(p))
        return next(spare, '')

    @cached_property
    def handled(self) -> frozenset[str]:
        """The parameters for what is moved, taken or put down."""
        taken = {a.arguments[0] for a in self.roles.made if self._is_held(a)}
        return frozenset((self._shifted | taken).difference(self.roles.agents))

    @cached_property
    def _shifted(self) -> set[str]:
        """The parameters for what was elsewhere before, or in a hand."""
        made, undone = self.roles.made, self.roles.undone
        least = 1 if self.phrase.verb in DISPENSING else 2
        shifted = {
            a.arguments[0]
            for a in undone
            if not a.about_use and (len(a.arguments) >= least or self._is_held(a))
        }
        return shifted & {p for atom in made if not atom.about_use for p in atom.arguments}

    @staticmethod
    def _is_held(atom: Atom) -> bool:
        return bool(atom.arguments) and not _HELD.isdisjoint(words_in(atom.predicate))

    @property
    def door(self) -> str:
        """The parameter for a door on the way, '' if none is named."""
        doors = (p for p in self.roles.parameters if p not in self.things and self.is_a(p, DOORS))
        return next(doors, '') if self.aim else ''

    def is_a(self, parameter: str, nouns: frozenset[str]) -> bool:
        """Say whether a parameter is of a kind that has one of these words."""
        return any(not nouns.isdisjoint(words_in(kind)) for kind in self.roles.kinds[parameter])

    def is_place(self, parameter: str) -> bool:
        """Say whether a parameter is of the kind of what something gets to."""
        return not self.places.isdisjoint(self.roles.kinds[parameter])

    @property
    def _named_first(self) -> str:
        """The parameter that the word after the verb stands for, '' if it stands for none."""
        following = self.phrase.rest[:1]
        return next((p for p, noun in self.nouns.items() if (noun,) == following), '')

    @cached_property
    def unsaid_nouns(self) -> set[str]:
        """The words of the name that stand for parameters that are not said."""
        unsaid = self.origins | self.silent
        return {word for word in self.words for p in unsaid if self.is_kind(p, word)}

    def _hands(self, things: Sequence[str]) -> set[str]:
        """Return what a thing is only taken with, or into: it is free no more, or free again."""
        if self.phrase.verb not in TAKING and self.aim:
            return set()
        effects = (*self.roles.made, *self.roles.undone)
        used = self._in(atom for atom in effects if atom.about_use)
        holding = {
            a.arguments[1]
            for a in effects
            if len(a.arguments) == 2 and a.turned and a.arguments[0] in things[:1]
        }
        kinds = [self.roles.kinds[p] for p in things[:1]]
        return {
            p
            for p in used
            if p not in {*things[:1], *self.nouns} and self.roles.kinds[p] not in kinds
            if self.phrase.verb in TAKING or p in holding
        }

    def source(self, direct: str) -> str:
        """Return where the direct object is taken away from, '' if that is not told."""
        unsaid = {'', direct, *self.silent, *self.origins, *self.roles.agents, *self.things}
        for atom in self.roles.undone:
            if direct and atom.arguments[:1] == (direct,):
                for p in atom.arguments:
                    if p not in unsaid and self.is_at(atom, p):
                        return p
        return ''

    def is_at(self, atom: Atom, parameter: str) -> bool:
        """Say whether an atom tells that something is at, on or in what a parameter stands for."""
        return not atom.about_use and (
            atom.owned
            or self.is_place(parameter)
            or not _SOMEWHERE.isdisjoint(words_in(atom.predicate))
        )

    def _in(self, atoms: Iterable[Atom]) -> list[str]:
        """Return the parameters in some atoms, those of the widest atom first."""
        ordered = sorted(atoms, key=lambda atom: -len(atom.arguments))
        found = dict.fromkeys(p for atom in ordered for p in atom.arguments if p)
        return [p for p in found if p not in self.silent and p != self.aim]
