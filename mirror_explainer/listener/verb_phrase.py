"""The name of an action as English: "pick-up", "open_door", "gripper-close"."""

from collections.abc import Iterable, Sequence, Set
from dataclasses import dataclass

from mirror_explainer.listener.english import (
    infinitive,
    is_first_noun,
    is_known,
    is_participle,
    is_verb,
    word_set,
)

PREPOSITIONS = word_set(
    'to into onto at from with toward towards through under in on by for behind near across '
    'along around inside of beside'
)
PARTICLES = word_set('up down off over out away back together on in apart open shut')
DIRECTIONS = word_set('home up down left right north south east west forward backward back')
_ORDINALS = word_set('first second third fourth')
_ADVERBS = _ORDINALS | word_set('last again now')
_MANNERS = word_set('fast slow straight ahead upstairs downstairs')
# What is done so is said as a noun: "do the quick scan", "do the self test".
_SORTS = word_set('self auto emergency full quick deep final visual night safety')
# Verbs that need not be said before another: "do-polish".
DOING = word_set('do perform execute')
_IN_FULL = {'nav': 'navigate', 'init': 'initialize'}
_PREFIXES = word_set('re un pre de dis')
# Verbs with "-ing" after them: "start-charging", unlike "floor-cleaning".
PHASES = word_set('start stop begin end finish keep continue resume go')
# Verbs with "to" and another verb behind whom they are about: "ask-visitor-to-wait".
_ASKING = word_set(
    'ask tell remind invite help teach instruct urge encourage advise request allow persuade wait'
)


@dataclass(frozen=True)
class VerbPhrase:
    """A verb, and what else the action's name says: "take", ("lift",).

    What somebody is asked for is one word of it: "ask", ("visitor", "to wait").
    """

    verb: str
    rest: tuple[str, ...]


def verb_phrase(words: Sequence[str], nouns: Set[str]) -> VerbPhrase:
    """Find the verb in the words of an action's name; `nouns` stand for its parameters."""
    first, *rest = [part for word in words for part in _split(_IN_FULL.get(word, word))]
    if first in _PREFIXES and rest and is_verb(rest[0]):
        first, rest = first + rest[0], rest[1:]
    if first in DOING and rest and (is_verb(rest[0]) or rest[0] in _SORTS):
        first, *rest = rest
    if first in _SORTS and rest:
        return VerbPhrase('do', (first, *rest))
    if first in DIRECTIONS:
        return VerbPhrase('go', (first, *rest))
    if joins_verbs([first, *rest]):
        return VerbPhrase(first, tuple(rest))
    start = rest.index('to') if 'to' in rest[:-1] and first in _ASKING else len(rest)
    if start < len(rest) and is_verb(rest[start + 1]) and rest[start + 1] not in nouns:
        ends = (i for i, w in enumerate(rest) if i > start + 1 and w in nouns | PREPOSITIONS)
        end = next((i for i in ends if rest[i] not in PARTICLES), len(rest))
        return VerbPhrase(first, (*rest[:start], ' '.join(rest[start:end]), *rest[end:]))
    if rest and first not in PHASES and (verb := infinitive(rest[-1])):
        return VerbPhrase(verb, (first, *rest[:-1]))
    # A verb behind the noun that it is about: "gripper-open". What follows a preposition is none.
    end = next((i for i, word in enumerate(rest) if word in PREPOSITIONS), len(rest))
    verbs = [i for i, w in enumerate(rest[:end]) if is_verb(w) and w not in nouns | PARTICLES]
    is_noun = (first in nouns and verbs) or (is_first_noun(first) and rest)
    if is_verb(first) and not is_noun:
        return VerbPhrase(first, tuple(rest))
    if verb := infinitive(first):
        return VerbPhrase(verb, tuple(rest))
    if verbs:
        at = verbs[0]
        return VerbPhrase(rest[at], (first, *rest[:at], *rest[at + 1 :]))
    if is_known(first):
        return VerbPhrase('do', (first, *rest))
    return VerbPhrase(first, tuple(rest))


def joins_verbs(words: Sequence[str]) -> bool:
    """Say whether a name begins with two verbs: "dock-and-charge"."""
    return len(words) > 2 and words[1] == 'and' and is_verb(words[0]) and is_verb(words[2])


def is_adverb(word: str) -> bool:
    """Say whether this word of a name tells how, rather than what."""
    return word in _ADVERBS or word.endswith('ly')


def tells_how(word: str) -> bool:
    """Say whether this word of a name tells how something is moved or done: "fast", "cooled"."""
    return word in _MANNERS or word.endswith('ly') or is_participle(word)


def parted(words: Sequence[str]) -> tuple[str, ...]:
    """Return the words of an action's name, of a first one such as "opendoor" both."""
    word, *rest = words
    if not (is_verb(word) or is_known(word) or infinitive(word)):
        for end in range(len(word) - 3, 2, -1):
            if is_verb(word[:end]) and is_known(word[end:]):
                return (word[:end], word[end:], *rest)
    return tuple(words)


def without_variant(
    words: Sequence[str], others: Iterable[Sequence[str]], alike: Set[tuple[str, ...]]
) -> tuple[str, ...]:
    """Return an action's words without a number or letter that marks it as a variant of another.

    `others` are the words of all actions: "load-first" and "load-second" are said alike. So are
    those that bring about what an action that is `alike` does, and tell more of how:
    "photograph-cooled", where there is "photograph".
    """
    plain = tuple(word for word in words if not is_participle(word))
    if len(plain) < len(words) and plain in alike:
        return plain
    marked = [word for word in words[1:] if _unmarked(word) == '']
    if len(marked) == 1:
        same = {tuple(map(_unmarked, other)) for other in others if list(other) != list(words)}
        unmarked = tuple(filter(_unmarked, words))
        if tuple(map(_unmarked, words)) in same or unmarked in same:
            return unmarked
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
