"""What whole tasks share: "bring tea to ward 1" and "bring tea to ward 2" differ in one thing."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import takewhile

from mirror_explainer.listener.english import word_set
from mirror_explainer.listener.sentences import Said
from mirror_explainer.listener.verb_phrase import DIRECTIONS, PARTICLES, PREPOSITIONS, is_adverb

# What stands before each of several objects: "the cup and the plate".
ARTICLES = word_set('the a an my your')
_JOINING = word_set('and or then')
# Words with which a phrase is more than what a thing is called.
_MORE = PREPOSITIONS | PARTICLES | DIRECTIONS | _JOINING | {'not'}
_CODE = re.compile(r'\d.*|[^\W\da]')  # "ward 1", "lift b"


@dataclass(frozen=True)
class Frame:
    """The words before and after what differs: "bring tea to" and none."""

    before: tuple[str, ...]
    after: tuple[str, ...]

    def of(self, task: Said) -> Said | None:
        """Return a task with a place for what differs, None for one that does not fit."""
        words = tuple(task.called[task.verb].split()) if task.verb else ()
        thing = words[len(self.before) : len(words) - len(self.after)]
        if (*self.before, *thing, *self.after) != words or not _is_thing(thing):
            return None
        place = f'{{{task.verb}}}'
        framed = task.text.replace(place, ' '.join([*self.before, place, *self.after]))
        return Said(framed, {**task.called, task.verb: ' '.join(thing)})


def framed(tasks: Sequence[Said]) -> Iterator[tuple[Said, Frame | None]]:
    """Yield steps, neighbours among them that are alike but for a thing with a place for it."""
    frame: Frame | None = None
    for at, task in enumerate(tasks):
        fitting = frame.of(task) if frame else None
        if fitting is None:
            frame = _shared(task, tasks[at + 1]) if at + 1 < len(tasks) else None
            fitting = frame.of(task) if frame else None
        yield fitting or task, frame


def _shared(first: Said, second: Said) -> Frame | None:
    """Return the frame of two whole tasks, None where they differ in more than a thing.

    A number or letter is no thing without the word before it. Tasks that are two things to
    do, "go to the hall and wait", share none.
    """
    if not first.verb or first.text != second.text:
        return None
    words, others = (task.called[task.verb].split() for task in (first, second))
    if not _JOINING.isdisjoint(words):
        return None
    before = _same(words, others)
    after = _same(words[len(before) :][::-1], others[len(before) :][::-1])[::-1]
    next_words = (*words[len(before) :][:1], *others[len(before) :][:1])
    if any(map(_CODE.fullmatch, next_words)):
        before = before[:-1]
    frame = Frame(before, after)
    return frame if before and frame.of(first) and frame.of(second) else None


def _same(words: Sequence[str], others: Sequence[str]) -> tuple[str, ...]:
    """Return the words that both begin with."""
    pairs = takewhile(lambda pair: pair[0] == pair[1], zip(words, others, strict=False))
    return tuple(word for word, _ in pairs)


def _is_thing(words: Sequence[str]) -> bool:
    """Say whether words may be what a thing is called, which stands for itself: "the cup"."""
    return bool(words) and not any(
        word in _MORE or is_adverb(word) or re.search(r'[{},;:]', word) for word in words
    )
