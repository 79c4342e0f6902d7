"""What people answered, from the database: rows as the simulated study has them, and times."""

from collections.abc import Iterator, Sequence

from mirror_explainer.experiments.study.design import PEOPLE, Answer
from mirror_explainer.experiments.study.web_study.design import Design
from mirror_explainer.experiments.study.web_study.models import Participant, Step
from mirror_explainer.experiments.study.web_study.progress import due

TIME_COLUMNS = (
    'participant',
    'finished',
    'place',
    'scenario',
    'strategy',
    'step',
    'answer',
    'seconds',
    'pages',
)


def participants(design: Design) -> tuple[list[Participant], list[Participant]]:
    """Return those who have answered everything, and the others, each in order of entry."""
    finished: list[Participant] = []
    others: list[Participant] = []
    for participant in Participant.objects.order_by('number'):
        (others if due(participant, design) else finished).append(participant)
    return finished, others


def answers(participant: Participant, design: Design) -> Iterator[Answer]:
    """Yield what a participant answered, scenario by scenario; the practice is no part of it."""
    strategies = dict(participant.turns)
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
                said=' '.join(map(str, sorted(order[: step.step]))),
                goal=encounter.goal,
                answer=step.answer,
            )


def times(of: Sequence[Participant], finished: bool) -> Iterator[dict[str, object]]:
    """Yield every answer with its time in seconds, in the order given, the practice among them.

    With `pages` above 1 the page was sent again before the answer came, so that its
    time may hold a break.
    """
    for participant in of:
        places = {name: place for place, (name, _) in enumerate(participant.turns)}
        strategies = dict(participant.turns)
        for step in sorted(_answered(participant), key=lambda s: (places[s.scenario], s.step)):
            row = (
                participant.name, finished, places[step.scenario], step.scenario,
                strategies[step.scenario], step.step, step.answer, step.seconds, step.pages,
            )  # fmt: skip
            yield dict(zip(TIME_COLUMNS, row, strict=True))


def _answered(participant: Participant) -> list[Step]:
    steps = Step.objects.filter(participant=participant).exclude(answer=None)
    return list(steps.order_by('scenario', 'step'))
