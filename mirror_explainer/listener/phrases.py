"""What a person hears beside the steps of a plan; each phrase can be set in the user model."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, fields
from typing import Any

from mirror_explainer.errors import meant_or_known
from mirror_explainer.listener.wording import parts


def _phrase(
    default: str,
    when: str,
    *,
    place: str = '',
    must_have_it: bool = True,
    may_be_empty: bool = False,
) -> Any:
    """Declare a phrase: `place` is what it may have in braces, and must unless that is said."""
    metadata = {
        'when': when,
        'place': place,
        'must_have_it': must_have_it,
        'may_be_empty': may_be_empty,
    }
    return field(default=default, metadata=metadata)


@dataclass(frozen=True)
class Phrases:
    """The phrases, with their English defaults."""

    reached: str = _phrase(
        'I am done.', 'Nothing is left to do. What the robot achieved is said before it.'
    )
    detour_done: str = _phrase(
        'I have not finished what I was doing before.',
        'In its place where the task came in the midst of another one, which it put off.',
    )
    no_plan: str = _phrase('I have nothing to do right now.', 'The robot has no plan.')
    no_plan_yet: str = _phrase('I have no plan yet.', 'No plan has come since the node started.')
    stopped: str = _phrase(
        'I have stopped. I have nothing to do right now.',
        'The robot has no plan any more, and told that it had begun its last one, but not that it '
        'was through with it.',
    )
    not_ready: str = _phrase(
        'I do not know yet. Please ask me again in a moment.',
        'The plan is still being read, or something else that it takes has not come.',
    )
    wrong_input: str = _phrase(
        '{reason}',
        'A message or a file is wrong. {reason} names it, the line and what is wrong with it, for '
        'whoever mends it; leave it out where calls are heard by others.',
        place='reason',
        must_have_it=False,
    )
    all_heard: str = _phrase(
        'You have heard all that I am up to.', 'Every step of the plan was said before.'
    )
    nothing_more: str = _phrase(
        'The rest is only details.',
        'Steps are left that were not said, but they would tell this listener nothing.',
    )
    new_task: str = _phrase(
        'I have a new task.',
        'Before the first answer about any other goal than the last answer was about.',
        may_be_empty=True,
    )
    replanned: str = _phrase(
        'I have changed my plan.',
        'Before the first answer about another plan for the same goal, or for one that shares '
        'with it what is still to be achieved, or was on the way.',
        may_be_empty=True,
    )
    restarted: str = _phrase(
        'I have started again.',
        'Before the first answer about a plan that the robot begins once more, before it was '
        'through with it.',
        may_be_empty=True,
    )
    resumed: str = _phrase(
        'I have gone back to what I was doing.',
        'Before the first answer about the goal that a new task had put off.',
        may_be_empty=True,
    )
    failed: str = _phrase(
        'I am stuck: {step}',
        'A step failed. {step} is "I cannot …" of a sentence with "I will …", else the sentence. '
        "The robot's reason, if it gives one, is the next sentence.",
        place='step',
    )
    skipped: str = _phrase(
        'Left out: {sentence}',
        'Before the sentence of a step that was left out, where it does not begin with "I will".',
        place='sentence',
    )
    already: str = _phrase(
        'Already done: {sentence}',
        'Before the sentence of a step that is done, where it has no form for the past.',
        place='sentence',
    )
    and_: str = _phrase('and', 'Joins the last two of several objects: "the cup and the plate".')
    others: str = _phrase(
        'others',
        'Ends a list that is not whole, of ends that are alike: "the cup, the plate and others".',
        may_be_empty=True,
    )
    other: str = _phrase(
        'one more',
        'In its place where one is left: "the cup, the plate and one more". Without it the '
        '`others` that you set.',
        may_be_empty=True,
    )

    @staticmethod
    def names() -> tuple[str, ...]:
        """Return the phrases' names as a user model writes them."""
        return tuple(each.name.rstrip('_') for each in fields(Phrases))

    @staticmethod
    def of(texts: Mapping[str, str]) -> 'Phrases':
        """Return the phrases with those that a user model sets."""
        names = {each.name.rstrip('_'): each.name for each in fields(Phrases)}
        if 'others' in texts:
            texts = {'other': texts['others'], **texts}
        return Phrases(**{names[name]: ' '.join(text.split()) for name, text in texts.items()})


def phrase_faults(texts: Mapping[Any, Any]) -> Iterator[tuple[Any, str]]:
    """Find what is wrong with a user model's phrases; yield each one's name and the reason."""
    known = {each.name.rstrip('_'): each for each in fields(Phrases)}
    for name, text in texts.items():
        if name not in known:
            yield name, 'unknown phrase' + meant_or_known(str(name), known)
        elif isinstance(text, str) and not text.strip():
            if not known[name].metadata['may_be_empty']:
                yield name, 'this text is blank'
        elif isinstance(text, str):  # what is none is reported by the file's schema
            metadata = known[name].metadata
            faults = _faults(text, metadata['place'], metadata['must_have_it'])
            yield from ((name, fault) for fault in faults)


def _faults(text: str, place: str, must_have_it: bool) -> Iterator[str]:
    """Find what a phrase has in braces and should not, and what it should have."""
    try:
        found = [name for _, name in parts(text) if name] if place else []
    except ValueError as error:
        yield f'"{text}": {error}'
        return
    for name in found or re.findall(r'\{(\w*)\}', text if not place else ''):
        if name != place:
            hint = f' (write {{{place}}})' if place else ''
            yield f'"{text}": {{{name}}} has no place here{hint}'
    if place and must_have_it and place not in found:
        yield f'"{text}" lacks {{{place}}}'
