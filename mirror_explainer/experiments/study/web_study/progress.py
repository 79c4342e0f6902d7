"""Where a participant is, and the steps on: every one a transaction of its own.

Whatever is sent twice, late, or from an old page changes nothing: only the step that
is due can be answered, and an answer once given stays.
"""

import secrets
from dataclasses import dataclass

from django.db import transaction
from django.db.models import F
from django.utils import timezone

from mirror_explainer.experiments.study.design import DONT_KNOW
from mirror_explainer.experiments.study.web_study.design import Design, Encounter, turns
from mirror_explainer.experiments.study.web_study.models import Participant, Step

_LETTERS = 'abcdefghjkmnpqrstuvwxyz23456789'  # none that looks like another
_CODE_GROUPS, _CODE_GROUP = 3, 4  # 59 bits


@dataclass(frozen=True)
class Due:
    """What a participant is to do next: answer step `step` (from 1) of an encounter.

    `place` is 0 for the practice and counts the scenarios from 1; `begun` tells
    whether its first step was shown already.
    """

    encounter: Encounter
    strategy: str
    place: int
    step: int
    begun: bool

    @property
    def practice(self) -> bool:
        """Whether this is the practice."""
        return self.place == 0

    @property
    def said(self) -> list[str]:
        """The sentences said so far, in the order in which they were."""
        order = self.encounter.orders[self.strategy][: self.step]
        return [self.encounter.sentences[position] for position in order]


def enter(design: Design, code: str) -> Participant:
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
            name=f'p-{_random(6)}', code=code, number=number, turns=turns(design, number)
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


def due(participant: Participant, design: Design) -> Due | None:
    """Return what the participant is to do next; None: everything is done."""
    steps = Step.objects.filter(participant=participant)
    shown = set(steps.values_list('scenario', flat=True))
    answered = list(steps.exclude(answer=None).values_list('scenario', flat=True))
    for place, (name, strategy) in enumerate(participant.turns):
        encounter, done = design.encounter(name), answered.count(name)
        if done < encounter.steps:
            return Due(encounter, strategy, place, done + 1, name in shown)
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
    participant: Participant, design: Design, scenario: str, step: str, choice: str
) -> bool:
    """Keep an answer: "0" … "2" for a choice, "?" for "I don't know".

    Returns False where the choice is none of these. An answer to another step than
    the one that is due is ignored.
    """
    with transaction.atomic():
        now = timezone.now()
        next_ = due(participant, design)
        if next_ is None or (next_.encounter.name, str(next_.step)) != (scenario, step):
            return True
        choices = {str(i): goal.name for i, goal in enumerate(next_.encounter.choices)}
        given = {**choices, '?': DONT_KNOW}.get(choice)
        if given is None:
            return False
        steps = Step.objects.filter(participant=participant, scenario=scenario)
        shown = steps.filter(step=next_.step).first()
        if shown is not None:
            shown.answer = given
            shown.seconds = max(0.0, (now - shown.shown_at).total_seconds())
            shown.save(update_fields=['answer', 'seconds'])
    return True


def _random(length: int) -> str:
    return ''.join(secrets.choice(_LETTERS) for _ in range(length))
