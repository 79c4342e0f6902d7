"""The name of an action as English: "pick-up", "open_door", "gripper-close"."""

from collections.abc import Iterable, Sequence, Set
from dataclasses import dataclass

from mirror_explainer.listener.english import infinitive, is_known, is_verb, word_set

PREPOSITIONS = word_set(
    'to into onto at from with toward towards through under in on by for behind near across '
    'along around inside of beside'
)
PARTICLES = word_set('up down off over out away back together on in apart open shut')
DIRECTIONS = word_set('home up down left right north south east west forward backward back')
_ORDINALS = word_set('first second third fourth')
_ADVERBS = _ORDINALS | word_set('last again now')
# Verbs that need not be said before another: "do-polish".
DOING = word_set('do perform execute')
# Verbs with "-ing" after them: "start-charging", unlike "floor-cleaning".
PHASES = word_set('start stop begin end finish keep continue resume go')


@dataclass(frozen=True)
class VerbPhrase:
    """A verb, and what else the action's name says: "take", ("lift",)."""

    verb: str
    rest: tuple[str, ...]


def verb_phrase(words: Sequence[str], nouns: Set[str]) -> VerbPhrase:
    """Find the verb in the words of an action's name; `nouns` stand for its parameters."""
    first, *rest = [part for word in words for part in _split(word)]
    if first in DOING and rest and is_verb(rest[0]):
        first, *rest = rest
    if first in DIRECTIONS:
        return VerbPhrase('go', (first, *rest))
    if rest and first not in PHASES and (verb := infinitive(rest[-1])):
        return VerbPhrase(verb, (first, *rest[:-1]))
    # A verb behind the noun that it is about: "gripper-open". What follows a preposition is none.
    end = next((i for i, word in enumerate(rest) if word in PREPOSITIONS), len(rest))
    verbs = [i for i, w in enumerate(rest[:end]) if is_verb(w) and w not in nouns | PARTICLES]
    if is_verb(first) and not (first in nouns and verbs):
        return VerbPhrase(first, tuple(rest))
    if verb := infinitive(first):
        return VerbPhrase(verb, tuple(rest))
    if verbs:
        at = verbs[0]
        return VerbPhrase(rest[at], (first, *rest[:at], *rest[at + 1 :]))
    if is_known(first):
        return VerbPhrase('do', (first, *rest))
    return VerbPhrase(first, tuple(rest))


def is_adverb(word: str) -> bool:
    """Say whether this word of a name tells how, rather than what."""
    return word in _ADVERBS or word.endswith('ly')


def without_variant(words: Sequence[str], others: Iterable[Sequence[str]]) -> tuple[str, ...]:
    """Return an action's words without a number or letter that marks it as a variant of another.

    `others` are the words of all actions: "load-first" and "load-second" are said alike.
    """
    same = {tuple(map(_unmarked, other)) for other in others if list(other) != list(words)}
    marked = [word for word in words[1:] if _unmarked(word) == '']
    if len(marked) == 1 and (
        tuple(map(_unmarked, words)) in same or tuple(filter(_unmarked, words)) in same
    ):
        return tuple(filter(_unmarked, words))
    return tuple(words)


def _unmarked(word: str) -> str:
    return '' if word in _ORDINALS or word.isdigit() or len(word) == 1 else word


def _split(word: str) -> list[str]:
    """Return "pick", "up" for "pickup"."""
    if not is_verb(word):
        for end in sorted(PREPOSITIONS | PARTICLES, key=len, reverse=True):
            if word.endswith(end) and is_verb(word.removesuffix(end)):
                return [word.removesuffix(end), end]
    return [word]
