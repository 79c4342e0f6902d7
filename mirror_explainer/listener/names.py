"""What objects are called that the user model has no name for: "the big gripper", "ward 1B"."""

import re
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass

from mirror_explainer.listener.english import word_set
from mirror_explainer.listener.roles import words_in
from mirror_explainer.pddl import Task

_PEOPLE = word_set('person people human patient passenger customer guest user')
# Kinds of things that have names of their own.
_NAMED = word_set('city town village country host server planet star')
# Kinds that tell nothing.
_VAGUE = word_set('tool item object thing place location device instrument')
# Kinds of people that are no one's name.
_ROLES = word_set(
    'nurse doctor surgeon patient child guest visitor customer operator user resident chef cook '
    'waiter worker manager boss owner driver passenger student teacher engineer technician '
    'person human man woman boy girl'
)


@dataclass(frozen=True)
class Name:
    """An object's name as words, as they are written, and what kinds of object it is."""

    words: tuple[str, ...]
    kinds: tuple[str, ...] = ()

    @property
    def code(self) -> str:
        """The number or letter that tells it from others, as in "ward 1b" and "lift a"."""
        return self.words[-1] if is_code(self.words[-1]) else ''

    def called(self, words: Sequence[str] = (), noun: str = '', always: bool = False) -> str:
        """Return the name in a sentence, with "the" where English wants it.

        `words` are those of its words that are said, if not all. `noun` says what it is,
        where the name does not: "truck tru1", but "truck 1" and "the big one"; "the big one
        truck" only where a noun is `always` wanted.
        """
        words = words or self.words
        if len(words) == 1 and len(words[0]) == 1 and self.kinds:
            noun = noun or ('' if self.kinds[0] in _VAGUE else self.kinds[0])
        said = ' '.join(words)
        named = not noun or any(_names(word.lower(), noun) for word in words)
        if is_code(words[-1]):
            return said if named else f'{noun} {said}'
        if self._is_proper:
            return said
        return (
            f'the {said} {noun}' if always and not named and noun not in _VAGUE else f'the {said}'
        )

    @property
    def _is_proper(self) -> bool:
        if re.match('[A-Z][a-z]', self.words[0]):
            return True
        kinds = {word for kind in self.kinds for word in words_in(kind)}
        if not kinds.isdisjoint(_NAMED):
            return True
        person = len(self.words) == 1 and not kinds.isdisjoint(_PEOPLE)
        return person and self.words[0].lower() not in _ROLES


def is_code(word: str) -> bool:
    """Say whether this is a number or a letter rather than a word: "2", "1B", "w12", "a"."""
    return len(word) == 1 or any(letter.isdigit() for letter in word)


def object_names(task: Task) -> dict[str, Name]:
    """Return the names of the task's objects, by the object in lower case."""
    objects = [(item.name.lower(), item.type) for item in task.model.all_objects]
    kinds = {kind: _types(kind) for kind in {kind for _, kind in objects}}
    spelt = _spelt(task.written_objects.values(), [name for name, _ in objects])
    return {name: Name(_words(spelt[name]), kinds[kind]) for name, kind in objects}


def action_names(task: Task) -> dict[str, str]:
    """Return the names of the domain's actions as they are written, by those in lower case."""
    return _spelt(task.written_actions.values(), [action.name for action in task.model.actions])


def _spelt(written: Iterable[str], names: Collection[str]) -> dict[str, str]:
    """Return names, given in lower case, as they are written.

    Where all are written in capitals, that says nothing.
    """
    known = set(names)
    spelt = {name: name for name in names} | {w.lower(): w for w in written if w.lower() in known}
    if any(word != word.upper() for word in spelt.values() if re.search('[a-zA-Z]{2}', word)):
        return spelt
    return {name: name for name in names}


def _words(spelt: str) -> tuple[str, ...]:
    """Return a name's words as they are written; those of a "redCircle" in lower case."""
    plain = [word for word in re.split(r'[-_\s]+', spelt) if word]
    words = words_in(spelt)
    if len(words) == len(plain):
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
