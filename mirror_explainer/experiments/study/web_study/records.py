"""What people answered, from the database: rows as the simulated study has them, times, people."""

from collections import Counter
from collections.abc import Iterator, Sequence
from datetime import datetime
from statistics import median

from mirror_explainer.experiments.study.design import DONT_KNOW, PEOPLE, Answer
from mirror_explainer.experiments.study.web_study.design import ATTENTION, PRACTICE, Design, Turn
from mirror_explainer.experiments.study.web_study.models import Participant, Step
from mirror_explainer.experiments.study.web_study.progress import due, turns_of
from mirror_explainer.experiments.study.web_study.study_file import StudyFile

TIME_COLUMNS = (
    'participant', 'finished', 'place', 'scenario', 'strategy', 'step', 'answer', 'seconds',
    'seconds_in_browser', 'pages', 'shown', 'position', 'right_position',
)  # fmt: skip
# From when on a participant is flagged. None is left out for that: who analyses decides.
FAST = 1.0  # s, for the median answer
MOST_TRIES = 2
ALIKE = 0.9  # of the goals chosen, at one and the same position
FEW = 10  # goals chosen, below which nothing is said of positions
QUIET = 30.0  # minutes without an answer, after which somebody has dropped out


def participants(design: Design, study: StudyFile) -> tuple[list[Participant], list[Participant]]:
    """Return those who have answered everything, and the others, each in order of entry."""
    finished: list[Participant] = []
    others: list[Participant] = []
    for participant in Participant.objects.order_by('number'):
        (finished if has_finished(participant, design, study) else others).append(participant)
    return finished, others


def has_finished(participant: Participant, design: Design, study: StudyFile) -> bool:
    """Whether somebody has met everything, and sent the last page where there is one."""
    asked = bool(study.questions or study.closing_comment)
    return due(participant, design) is None and not (asked and participant.closing is None)


def answers(participant: Participant, design: Design) -> Iterator[Answer]:
    """Yield what a participant answered, scenario by scenario: no practice, no attention trial."""
    strategies = {turn.scenario: turn.strategy for turn in turns_of(participant)}
    given = _answered(participant)
    for encounter in design.encounters:
        order = encounter.orders[strategies[encounter.name]]
        for step in (step for step in given if step.scenario == encounter.name):
            yield Answer(
                participant=participant.name,
                observer=PEOPLE,
                scenario=encounter.name,
                strategy=strategies[encounter.name],
                step=step.step,
                steps=encounter.steps,
                plan_length=len(encounter.sentences),
                said=' '.join(map(str, sorted(order[: step.step]))),
                goal=encounter.goal,
                answer=step.answer,
            )


def times(
    of: Sequence[Participant], finished: bool, design: Design
) -> Iterator[dict[str, object]]:
    """Yield every answer with its time in seconds, as it was given, the practice among them.

    `shown` are the goals in the order of the page, `position` is that of the answer and
    `right_position` that of the robot's goal, from 1. With `pages` above 1 the page was
    sent again before the answer came, so that its time may hold a break.
    """
    for participant in of:
        turns = {turn.scenario: (place, turn) for place, turn in enumerate(turns_of(participant))}
        for step in sorted(_answered(participant), key=lambda s: (turns[s.scenario][0], s.step)):
            place, turn = turns[step.scenario]
            shown = _shown(design, turn)
            row = (
                participant.name, finished, place, step.scenario, turn.strategy, step.step,
                step.answer, step.seconds, step.in_browser, step.pages, ' | '.join(shown),
                shown.index(step.answer) + 1 if step.answer in shown else None,
                shown.index(design.encounter(step.scenario).goal) + 1,
            )  # fmt: skip
            yield dict(zip(TIME_COLUMNS, row, strict=True))


def people(
    of: Sequence[Participant], finished: bool, design: Design, study: StudyFile
) -> Iterator[dict[str, object]]:
    """Yield a row for each participant: how it went, what was asked, and what to doubt."""
    for participant in of:
        given = _answered(participant)
        turns = {turn.scenario: turn for turn in turns_of(participant)}
        trials = [step for step in given if turns[step.scenario].strategy == ATTENTION]
        right = sum(step.answer == design.encounter(step.scenario).goal for step in trials)
        counted = [s for s in given if s not in trials and s.scenario != PRACTICE]
        seconds = [s.seconds if s.in_browser is None else s.in_browser for s in counted]
        positions = Counter(
            _shown(design, turns[s.scenario]).index(s.answer)
            for s in counted
            if s.answer != DONT_KNOW
        )
        named = positions.total()
        alike = max(positions.values(), default=0) / named if named else 0.0
        typical = median(seconds) if seconds else None
        told = participant.closing or {}
        flags = {
            'failed attention': right < len(trials),
            'rules unclear': participant.checks > MOST_TRIES,
            'too fast': typical is not None and typical < FAST,
            'always one position': named >= FEW and alike >= ALIKE,
            'never a goal': bool(counted) and named == 0,
        }
        yield {
            'participant': participant.name,
            'finished': finished,
            'language': participant.language,
            'began': participant.began and participant.began.isoformat(timespec='seconds'),
            'minutes': minutes(participant),
            'answers': len(counted),
            'checks': participant.checks,
            'attention_right': right,
            'attention_trials': len(trials),
            'median_seconds': typical,
            'reloads': sum(max(0, step.pages - 1) for step in counted),
            'dont_know': (len(counted) - named) / len(counted) if counted else None,
            'most_used_position': alike if named else None,
            'flags': '; '.join(flag for flag, is_so in flags.items() if is_so),
            **{n: _plain(participant.parameters.get(n, '')) for n in study.keep_parameters},
            **{q.name: _plain(told.get(q.name, '')) for q in study.questions},
            'comment': _plain(told.get('', '')),
        }


def last_answer(participant: Participant) -> datetime | None:
    """Return when the newest answer came, or else when somebody began."""
    newest: datetime | None = max(
        (step.shown_at for step in _answered(participant)), default=participant.began
    )
    return newest


def minutes(participant: Participant) -> float | None:
    """Return how long somebody took up to the newest answer, breaks included."""
    last = last_answer(participant)
    if participant.began is None or last is None:
        return None
    return float((last - participant.began).total_seconds() / 60)


def _plain(text: str) -> str:
    """Return what somebody wrote so that a spreadsheet does not take it for a formula."""
    return f"'{text}" if text.startswith(('=', '+', '-', '@')) else text


def _shown(design: Design, turn: Turn) -> list[str]:
    choices = design.encounter(turn.scenario).choices
    return [choices[index].name for index in turn.choices]


def _answered(participant: Participant) -> list[Step]:
    steps = Step.objects.filter(participant=participant).exclude(answer=None)
    return list(steps.order_by('scenario', 'step'))
