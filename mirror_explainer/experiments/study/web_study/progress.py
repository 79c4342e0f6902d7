"""Where a participant is, and the steps on: every one a transaction of its own.

Whatever is sent twice, late, or from an old page changes nothing: only the step that
is due can be answered, and an answer once given stays.
"""

import math
import secrets
from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum

from django.db import transaction
from django.db.models import F
from django.utils import timezone

from mirror_explainer.experiments.study.design import DONT_KNOW
from mirror_explainer.experiments.study.web_study.design import (
    Choice,
    Design,
    Encounter,
    Turn,
    turns,
)
from mirror_explainer.experiments.study.web_study.models import Participant, Step

_LETTERS = 'abcdefghjkmnpqrstuvwxyz23456789'  # none that looks like another
_CODE_GROUPS, _CODE_GROUP = 3, 4  # 59 bits
_OWN_PACE = 10  # answers, from which on somebody's own time tells how long the rest takes
_LONGEST = 30.0  # s for an answer that counts for that: longer ones are breaks
_BETWEEN = 8.0  # s from one encounter to the next
LONGEST_BROWSER_TIME = 24 * 3600.0  # s


@dataclass(frozen=True)
class Due:
    """What a participant is to do next: answer step `step` (from 1) of an encounter.

    `place` is 0 for the practice and counts the others from 1; `begun` tells
    whether its first step was shown already; `last` is the answer to the step before.
    """

    encounter: Encounter
    turn: Turn
    place: int
    step: int
    begun: bool
    last: str | None

    @property
    def practice(self) -> bool:
        """Whether this is the practice."""
        return self.place == 0

    @property
    def said(self) -> tuple[int, ...]:
        """The positions of what was said so far, in the order in which it was."""
        return self.encounter.orders[self.turn.strategy][: self.step]

    @property
    def choices(self) -> list[Choice]:
        """The goals to choose from, as they are shown."""
        return [self.encounter.choices[index] for index in self.turn.choices]


class Outcome(Enum):
    """What became of an answer."""

    KEPT = 'kept'
    STALE = 'to another step than the one that is due'
    NONE = 'no answer that there is'


def enter(design: Design, code: str, language: str, parameters: Mapping[str, str]) -> Participant:
    """Return the participant of this new code: added, but for who sent the form twice.

    A new one gets the first number that nobody has.
    """
    with transaction.atomic():
        participant: Participant | None = Participant.objects.filter(code=code).first()
        if participant is not None:
            return participant
        taken = set(Participant.objects.values_list('number', flat=True))
        number = next(n for n in range(len(taken) + 1) if n not in taken)
        participant = Participant(
            name=f'p-{_random(6)}',
            code=code,
            number=number,
            turns=[turn.as_list() for turn in turns(design, number)],
            language=language,
            parameters=dict(parameters),
            began=timezone.now(),
        )
        participant.save(force_insert=True)
    return participant


def new_code() -> str:
    """Return a new code to come back with."""
    return '-'.join(_random(_CODE_GROUP) for _ in range(_CODE_GROUPS))


def is_code(text: str) -> bool:
    """Whether a text may be a code."""
    groups = text.split('-')
    return len(groups) == _CODE_GROUPS and all(
        len(group) == _CODE_GROUP and set(group) <= set(_LETTERS) for group in groups
    )


def turns_of(participant: Participant) -> list[Turn]:
    """Return what a participant meets; where no order was drawn, choices are as designed."""
    return [
        Turn(scenario, strategy, tuple(order[0]) if order else (0, 1, 2))
        for scenario, strategy, *order in participant.turns
    ]


def due(participant: Participant, design: Design) -> Due | None:
    """Return what the participant is to do next; None: every encounter is done."""
    answers: dict[str, dict[int, str]] = {}
    steps = Step.objects.filter(participant=participant)
    for scenario, step, answer in steps.values_list('scenario', 'step', 'answer'):
        of = answers.setdefault(scenario, {})
        if answer is not None:
            of[step] = answer
    for place, turn in enumerate(turns_of(participant)):
        encounter, given = design.encounter(turn.scenario), answers.get(turn.scenario)
        done = len(given or ())
        if done < encounter.steps:
            last = given.get(done) if given else None
            return Due(encounter, turn, place, done + 1, given is not None, last)
    return None


def begin(participant: Participant, what: Due) -> None:
    """Note that a step is to be shown now: its time runs from here."""
    Step.objects.get_or_create(
        participant=participant,
        scenario=what.encounter.name,
        step=what.step,
        defaults={'shown_at': timezone.now()},
    )


def show(participant: Participant, what: Due) -> None:
    """Note that the page of a step is sent."""
    with transaction.atomic():
        begin(participant, what)
        Step.objects.filter(
            participant=participant, scenario=what.encounter.name, step=what.step
        ).update(pages=F('pages') + 1)


def answer(
    participant: Participant,
    design: Design,
    scenario: str,
    step: str,
    choice: str,
    in_browser: str = '',
) -> Outcome:
    """Keep an answer: "0" … "2" for a choice as it is shown, "?" for "I don't know".

    An answer to another step than the one that is due is not kept; where it is the one
    that was given there, somebody only pressed twice. `in_browser` is the time that it
    took there in seconds, as the browser tells it; anything else counts as not told.
    """
    with transaction.atomic():
        now = timezone.now()
        next_ = due(participant, design)
        if next_ is None or (next_.encounter.name, str(next_.step)) != (scenario, step):
            return _late(participant, design, scenario, step, choice)
        given = _given(next_.encounter, next_.turn, choice)
        if given is None:
            return Outcome.NONE
        steps = Step.objects.filter(participant=participant, scenario=scenario)
        shown = steps.filter(step=next_.step).first()
        if shown is not None:
            shown.answer = given
            shown.seconds = max(0.0, (now - shown.shown_at).total_seconds())
            shown.in_browser = _seconds(in_browser)
            shown.save(update_fields=['answer', 'seconds', 'in_browser'])
    return Outcome.KEPT


def minutes_left(participant: Participant, design: Design, expected: int) -> tuple[float, int]:
    """Return the share of the study that is done, and how many minutes the rest may take.

    `expected` is what the whole study takes, by which a beginner is judged.
    """
    seconds = list(
        Step.objects.filter(participant=participant)
        .exclude(answer=None)
        .values_list('seconds', flat=True)
    )
    every = [design.encounter(turn.scenario).steps for turn in turns_of(participant)]
    total, done = sum(every), len(seconds)
    if done < _OWN_PACE:
        return done / total, math.ceil(expected * (1 - done / total))
    pace = sum(min(each, _LONGEST) for each in seconds) / done + _BETWEEN * len(every) / total
    return done / total, math.ceil(pace * (total - done) / 60)


def _late(
    participant: Participant, design: Design, scenario: str, step: str, choice: str
) -> Outcome:
    """Say whether an answer to a step that is not due repeats what was answered there."""
    turn = next((turn for turn in turns_of(participant) if turn.scenario == scenario), None)
    if turn is None or not (step.isdecimal() and len(step) < 4):
        return Outcome.STALE
    steps = Step.objects.filter(participant=participant, scenario=scenario, step=int(step))
    kept = steps.values_list('answer', flat=True).first()
    repeated = kept is not None and kept == _given(design.encounter(scenario), turn, choice)
    return Outcome.KEPT if repeated else Outcome.STALE


def _given(encounter: Encounter, turn: Turn, choice: str) -> str | None:
    """Return what a choice stands for, None where there is no such."""
    shown = {str(i): encounter.choices[index].name for i, index in enumerate(turn.choices)}
    return {**shown, '?': DONT_KNOW}.get(choice)


def _seconds(told: str) -> float | None:
    try:
        seconds = float(told)
    except ValueError:
        return None
    return seconds if 0 <= seconds <= LONGEST_BROWSER_TIME else None


def _random(length: int) -> str:
    return ''.join(secrets.choice(_LETTERS) for _ in range(length))
