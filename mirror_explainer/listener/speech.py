"""An answer as a person hears it: steps in their tenses, like ones in one breath."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import groupby
from types import MappingProxyType
from typing import NamedTuple

from mirror_explainer.listener.english import before_name, inability, intention
from mirror_explainer.listener.frame import ARTICLES, framed
from mirror_explainer.listener.phrases import Phrases
from mirror_explainer.listener.sentences import Said, Sentences
from mirror_explainer.listener.wording import listed, parts
from mirror_explainer.pddl.progress import StepStatus

Step = tuple[str, StepStatus]  # a ground action, and how far it is
_OF = re.compile(r'of\b', re.IGNORECASE)  # so a reason begins that is no sentence
_ENGLISH = re.compile(r'\bI (?:cannot|did not|was not)\b')
_NO_REASONS: Mapping[str, str] = MappingProxyType({})


class _Told(NamedTuple):
    """A step as it is said, and how far it is; `why` it was left out, '' if it was not."""

    said: Said
    status: StepStatus
    why: str


def spoken(
    sentences: Sentences,
    steps: Sequence[Step],
    unsaid: Sequence[Step] = (),
    is_stuck: bool = False,
    reasons: Mapping[str, str] = _NO_REASONS,
) -> str:
    """Return the text for the steps of an answer, in plan order; a sentence a line.

    Neighbours of one tense that differ in one object become one sentence: "I will photograph
    the bridge, the tower and the lock." So do tasks that have the verb: those that differ in one
    thing, "I will wash the cup and the pan.", and others, "I will boil water and wait." A list
    is heard as the whole of it: so one that steps left `unsaid` would be in, too, ends with "and
    one more" or "and others"; but that of different tasks promises no more than two sentences
    would. A robot that `is_stuck` promises nothing: "I meant to photograph the lock." for "I
    will …", and no other sentence. After what was left out stands why, if `reasons` have that,
    by ground action: after the last one of those in a row that have the same reason.
    """
    told = [
        _Told(said, step[1], reasons.get(step[0], '') if step[1] is StepStatus.SKIPPED else '')
        for step in steps
        if (said := _worded(sentences, step, is_stuck))
    ]
    following = [*(each.why for each in told), ''][1:]
    told = [
        each._replace(why='') if each.why == why and not _OF.match(why) else each
        for each, why in zip(told, following, strict=True)
    ]
    left = [said for step in unsaid if (said := _worded(sentences, step, is_stuck))]
    placed = [*framed([each.said for each in told])]
    for _, frame in placed:
        if frame:
            left = [frame.of(step) or step for step in left]
    told = [each._replace(said=said) for each, (said, _) in zip(told, placed, strict=True)]
    lines = [
        _with_reason(
            _together([each.said for each in group], left, sentences.phrases), group[0].why
        )
        for group in _groups(told)
    ]
    return '\n'.join(lines)


def _groups(told: Sequence[_Told]) -> list[list[_Told]]:
    """Divide steps into those that are said in one sentence each.

    "I did not wash the cup and the plate" might be heard as if one of them was washed.
    """
    groups: list[list[_Told]] = []
    for each in told:
        before = groups[-1] if groups else []
        alike = before and before[-1].status is each.status is not StepStatus.SKIPPED
        if alike and _differing([*(one.said for one in before), each.said]):
            before.append(each)
        else:
            groups.append([each])
    return groups


def _worded(sentences: Sentences, step: Step, is_stuck: bool) -> Said | None:
    """Return how a step is said; None for what a robot that is stuck cannot say that it meant."""
    said = sentences.worded(*step)
    if not is_stuck or step[1] is not StepStatus.AHEAD:
        return said
    meant = intention(said.text)
    return None if meant is None else replace(said, text=meant)


def reached(
    sentences: Sentences,
    steps: Sequence[Step],
    unsaid: Sequence[Step] = (),
    reasons: Mapping[str, str] = _NO_REASONS,
    is_detour: bool = False,
) -> str:
    """Return what is said when nothing is left to do; of the `steps` it is told what they did.

    A robot that came to it from another task, by a detour, is not done with that.
    """
    phrases = sentences.phrases
    end = phrases.detour_done if is_detour else phrases.reached
    return '\n'.join(filter(None, (spoken(sentences, steps, unsaid, reasons=reasons), end)))


def stuck(sentences: Sentences, failed: Mapping[str, str]) -> str:
    """Return what is said when steps failed: ground actions, with the robot's reasons, '' if none.

    A reason of several in a row is said once, after the last of them.
    """
    lines: list[str] = []
    for reason, actions in groupby(failed, failed.__getitem__):
        meant = [*dict.fromkeys(map(sentences.of, actions))]
        for sentence in meant:
            cannot, why = inability(sentence), reason if sentence == meant[-1] else ''
            step, *rest = _with_reason(cannot or sentence, why).split('\n', 1)
            if not (lines and cannot):
                step = sentences.phrases.failed.replace('{step}', step)
            lines += [step, *rest]
    return '\n'.join(lines)


def _with_reason(sentence: str, reason: str) -> str:
    """Return a sentence, and the robot's reason, if it gave one, as the next.

    "Because of the waves" would be none: "I cannot simmer soup because of the waves."
    """
    if not reason:
        return sentence
    end = '' if reason.endswith(('.', '!', '?', '…')) else '.'
    if _OF.match(reason) and _ENGLISH.search(sentence):
        return f'{sentence.rstrip(".")} because {reason[0].lower()}{reason[1:]}{end}'
    return f'{sentence}\n{reason[0].upper()}{reason[1:]}{end}'


def _differing(group: Sequence[Said]) -> str:
    """Return the one parameter in which the steps of a group differ; '' if they are not alike.

    It must stand in their sentence once, and not at its beginning: that would be its
    subject, and several need another verb ("{i} is next.").
    """
    text, places = group[0].text, [place for _, place in parts(group[0].text)]
    if any(said.text != text for said in group):
        return ''
    differing = {p for p in places if p and len({said.called[p] for said in group}) > 1}
    if len(differing) != 1:
        return ''
    (parameter,) = differing
    called = [said.called[parameter] for said in group]
    once = places.count(parameter) == 1 and len(set(called)) == len(called)
    return parameter if once and next(parts(text))[0].strip() else ''


def _together(group: Sequence[Said], unsaid: Sequence[Said], phrases: Phrases) -> str:
    """Return one sentence for a group of steps, given the steps that are left unsaid."""
    if len(group) == 1:
        return group[0].sentence
    parameter = _differing(group)
    before = next(text for text, place in parts(group[0].text) if place == parameter).split()
    article = f'{before[-1]} ' if before and before[-1] in ARTICLES else ''
    first, *following = [said.called[parameter] for said in group]
    things = [first, *(before_name(article, called) + called for called in following)]
    alike = (said for said in unsaid if _differing([*group, said]) == parameter)
    left = len({said.called[parameter] for said in alike})
    others = phrases.others if left > 1 else phrases.other if left else ''
    if others and parameter != group[0].verb:
        things.append(others)
    together = listed(things, phrases.and_)
    return Said(group[0].text, {**group[0].called, parameter: together}).sentence
