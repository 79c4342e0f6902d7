"""What objects are called that the user model has no name for: "the big gripper", "ward 1B"."""

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from mirror_explainer.listener.english import has_no_article, is_known, word_set
from mirror_explainer.listener.roles import MAYBE_NAMED, PEOPLE, words_in
from mirror_explainer.pddl import Task

_NO_NAME = re.compile(r'.*(?:er|or|bot|arm)|agv|amr|uav|ugv')  # "gripper", which is no known word
# Kinds of things that have names of their own.
_NAMED = word_set('city town village country host server planet star')
# Kinds whose names are mostly what they are like: "infrared", "slow", "red".
_QUALIFIED = word_set(
    'camera sensor lens filter film light mode setting program recipe colour color speed channel '
    'style size shape surface material'
)
# What things are like, and not what they are: "the left gripper".
_LIKE = word_set(
    'left right top bottom front back rear upper lower inner outer big small large little first '
    'second third last north south east west red green blue yellow black white grey orange'
)
# Kinds that tell nothing.
VAGUE = word_set('tool item object thing place location device instrument')
# Kinds of people and animals that are no one's name.
_ROLES = word_set(
    'nurse doctor surgeon patient child guest visitor customer operator user resident chef cook '
    'waiter worker manager boss owner driver passenger student teacher engineer technician '
    'person human man woman boy girl mare stallion foal puppy kitten'
)

_TITLES = word_set('mr mrs ms miss mister dr prof')


@dataclass(frozen=True)
class Name:
    """An object's name as words, as they are written, and what kinds of object it is."""

    words: tuple[str, ...]
    kinds: tuple[str, ...] = ()

    @property
    def code(self) -> str:
        """The number or letter that tells it from others, as in "ward 1b" and "lift a"."""
        return self.words[-1] if is_code(self.words[-1]) else ''

    def called(self, words: Sequence[str] = (), noun: str = '', qualified: bool = False) -> str:
        """Return the name in a sentence, with "the" where English wants it.

        `words` are those of its words that are said, if not all. `noun` says what it is,
        where the name does not: "truck tru1", but "truck 1", "brush 1" and "the big one". Where
        it is `qualified` by the name, it is said too: "the infrared camera".
        """
        words = words or self.words
        is_like = len(self.words) == 1 and words[0].lower() in _LIKE
        if (is_like or (len(words) == 1 and len(words[0]) == 1)) and self.kinds:
            noun = noun or ('' if self.kinds[0] in VAGUE else ' '.join(words_in(self.kinds[0])))
        said = ' '.join(words)
        named = not noun or any(_names(word.lower(), noun) for word in words)
        if is_code(words[-1]):
            own = {words_in(kind)[-1] for kind in self.kinds}
            known = named or any(_names(word.lower(), kind) for word in words for kind in own)
            return said if known else f'{noun} {said}'
        if self._is_proper or has_no_article(said):
            return said
        wanted = not named and (is_like or (qualified and noun in _QUALIFIED))
        return f'the {said} {noun}' if wanted else f'the {said}'

    @property
    def _is_proper(self) -> bool:
        if re.match('[A-Z][a-z]', self.words[0]):
            return True
        kinds = {word for kind in self.kinds for word in words_in(kind)}
        if not kinds.isdisjoint(_NAMED):
            return True
        word = self.words[0].lower()
        if len(self.words) > 1:
            is_person = not kinds.isdisjoint(PEOPLE) and not is_known(word)
            return word in _TITLES or is_person
        if word in _ROLES:
            return False
        if not kinds.isdisjoint(PEOPLE):
            return True
        is_word = is_known(word) or _NO_NAME.fullmatch(word)
        # Others are called what they are: "vinny", but "the left crane".
        return not kinds.isdisjoint(MAYBE_NAMED) and not is_word


def is_code(word: str) -> bool:
    """Say whether this is a number or a letter rather than a word: "2", "1B", "w12", "a"."""
    return len(word) == 1 or any(letter.isdigit() for letter in word)


def object_names(task: Task, stated: Mapping[str, Sequence[str]]) -> dict[str, Name]:
    """Return the names of the task's objects, by the object in lower case.

    Without types the predicates are kinds that are `stated` of an object, such as (room hall).
    """
    objects = [(item.name.lower(), item.type) for item in task.model.all_objects]
    types = {kind: _types(kind) for kind in {kind for _, kind in objects}}
    kinds = {n: types[kind] or tuple(stated.get(n, ())) for n, kind in objects}
    written = spelling(task.written_objects)
    return {n: Name(_parted(_words(written.get(n, n)), kinds[n]), kinds[n]) for n, _ in objects}


def _parted(words: tuple[str, ...], kinds: Iterable[str]) -> tuple[str, ...]:
    """Return the words of a name, for a letter behind its kind both: "room", "a" for "rooma"."""
    kind, letter = words[0][:-1], words[0][-1]
    is_lettered = len(words) == 1 and kind in kinds and letter.isalpha()
    return (kind, letter) if is_lettered and not is_known(words[0]) else words


def heads_of(names: Iterable[Name]) -> dict[str, set[str]]:
    """Return the nouns in names by kind: "cup" of red_cup and cup_2."""
    heads: dict[str, set[str]] = {}
    for name in names:
        plain = [re.sub(r'\d+$', '', word.lower()) for word in name.words]
        nouns = [word for word in plain if len(word) > 2 and not is_code(word)]
        for kind in name.kinds if nouns else ():
            heads.setdefault(kind, set()).add(nouns[-1])
    return heads


def spelling(written: Mapping[str, str]) -> Mapping[str, str]:
    """Return names as they are written, none where most are in capitals: that tells nothing."""
    words = [name for name in written.values() if re.search('[a-zA-Z]{2}', name)]
    return written if 2 * sum(word != word.upper() for word in words) >= len(words) else {}


def _words(spelt: str) -> tuple[str, ...]:
    """Return a name's words as they are written; those of a "redCircle" in lower case."""
    plain = [word for word in re.split(r'[-_\s]+', spelt) if word]
    words = words_in(spelt)
    if not plain or len(words) == len(plain):
        return tuple(plain) or (spelt,)
    written = iter(re.findall('.', ''.join(plain)))
    again = [''.join(next(written) for _ in word) for word in words]
    return tuple(word if word.isupper() and is_code(word) else word.lower() for word in again)


def _types(kind: object) -> tuple[str, ...]:
    types = []
    while kind is not None:
        if (name := getattr(kind, 'name', 'object')) != 'object':
            types.append(name)
        kind = getattr(kind, 'father', None)
    return tuple(types)


def _names(word: str, noun: str) -> bool:
    """Say whether a word is the noun, its plural, or a number of it: "truck1"."""
    return re.fullmatch(rf'{re.escape(noun)}(?:s|es)?\d*', word) is not None
