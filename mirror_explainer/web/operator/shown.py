"""What the operator's page says of what was heard: the words, and the rows of its tables.

It never passes off an old answer as new, and says one thing about how things stand: the one
that matters most now (`status`).
"""

import itertools
from dataclasses import dataclass

from mirror_explainer.web.operator.heard import Answer, Fact, Goal, Heard, Step

MOST_GOALS = 6  # that are shown at once; the others on request
SLIDER_END = 10  # where the length of the plan is not known yet
MOST_STEPS = 12  # of a timeline with its sentences; a longer one is a row that can be opened


@dataclass(frozen=True)
class Status:
    """How things stand: a kind (the style's name), a word, a sentence, what to do, details.

    `details` are the explainer's own words, for whoever mends it.
    """

    kind: str
    word: str
    sentence: str
    cure: str = ''
    details: str = ''


def status(heard: Heard) -> Status:
    """Say how things stand: what is wrong, or else what is new, or that all is well."""
    failure = heard.failure
    if failure and failure.state != heard.state:
        failure = None  # the reason has passed
    reason = failure.reason if failure else ''
    told = heard.status
    if told is None or heard.silent:
        return _silent(heard, reason)
    if told.level > 1 and told.state != 'planning':
        sentence = 'What the robot tells of its task has a fault: it cannot be explained.'
        return Status('fault', 'Fault', sentence, told.cure, told.message)
    if failure:
        sentence = f'There was no answer at {failure.at}.'
        return Status('fault', 'No answer', sentence, 'Ask again.', reason)
    if told.state == 'planning':
        return Status('working', 'Working', 'The robot works out what to say.')
    if heard.answer is not None and not heard.is_current and heard.state == 'ready':
        sentence = 'The robot has another plan since: this answer is about the one before.'
        return Status('old', 'New plan', sentence, 'Ask again.')
    if told.level and told.state == 'ready':
        sentence = 'The robot can be asked, with a reservation.'
        return Status('remark', 'Ready', sentence, told.cure, told.message)
    if told.level:
        sentence = 'The robot has not told what it is up to yet.'
        return Status('working', 'Waiting', sentence, told.cure, told.message)
    return Status('ready', 'Ready', 'The robot can be asked.')


def _silent(heard: Heard, reason: str) -> Status:
    cure = 'Is the explainer running? An answer below may be old.'
    if heard.status is None:
        cure = 'Is the explainer running?'
        sentence = f'Nothing was heard of {heard.explainer} yet.'
    else:
        sentence = f'No news from {heard.explainer} for 5 s, the last at {heard.status_at}.'
    return Status('silent', 'Silent', sentence, cure, reason)


def progress(heard: Heard) -> str:
    """Return how far the work is: it changes often, and is not to be read aloud."""
    working = heard.status is not None and heard.state == 'planning'
    return heard.status.message if heard.status and working else ''


@dataclass(frozen=True)
class Said:
    """What the robot said last, a sentence each; `old` where that may be about another plan."""

    sentences: tuple[str, ...] = ()
    at: str = ''
    old: bool = False


def said(heard: Heard) -> Said:
    """Return what the robot said."""
    answer = heard.answer
    if answer is None:
        return Said()
    lines = answer.spoken.split('\n') if answer.spoken else answer.sentences
    return Said(tuple(lines), heard.answered_at, _may_be_old(heard))


def _may_be_old(heard: Heard) -> bool:
    """Whether the answer may be about another plan than the robot's present one."""
    return heard.silent or not heard.is_current


def asks(heard: Heard, follow: bool) -> str:
    """Return the task that it is time to ask about, for a browser that does so by itself.

    Once for each, the first included. Not with `remember`, for that would use up what
    there is to say.
    """
    due = heard.answer is None or not heard.is_current
    settled = heard.settings is not None and not heard.settings.remember
    if not (follow and due and settled and heard.status and heard.state == 'ready'):
        return ''
    return heard.status.task()


@dataclass(frozen=True)
class Belief:
    """How likely the listener finds the robot's goal: before, after, and had it told other steps.

    `instead` are names of other steps and how likely it would be then; `old` is that of `Said`.
    """

    goal: str
    before: float
    after: float
    instead: tuple[tuple[str, float], ...]
    planned: float
    old: bool


def belief(heard: Heard) -> Belief | None:
    """Return what the answer does to the listener's belief; None where there is none."""
    answer = heard.answer
    if answer is None:
        return None
    number = len(answer.positions)
    steps = 'step' if number == 1 else f'{number} steps'
    names = {'increasing': f'its first {steps}', 'decreasing': f'its last {steps}'}
    return Belief(
        answer.called(answer.true_goal),
        answer.understanding_before,
        answer.understanding,
        tuple(
            (names[other.strategy], other.understanding)
            for other in answer.baselines
            if other.strategy in names and other.strategy != answer.strategy and number
        ),
        answer.planned,
        _may_be_old(heard),
    )


@dataclass(frozen=True)
class Mark:
    """A step of the timeline: its number from 1, its sentence, whether it is told, its status.

    `others` is the sentence in other tenses, for which there is to be place, too.
    """

    number: int
    sentence: str
    said: bool
    status: str
    others: tuple[str, ...] = ()


@dataclass(frozen=True)
class Timeline:
    """The plan from its first step to the last; `long` ones are a row that can be opened.

    `restarts` says that the robot can begin again, and has come to the end; `old` is that of
    `Said`.
    """

    marks: tuple[Mark, ...]
    restarts: bool = False
    old: bool = False

    @property
    def long(self) -> bool:
        """Whether there are too many for their sentences to be shown."""
        return len(self.marks) > MOST_STEPS

    @property
    def done(self) -> int:
        """How many steps are done."""
        return sum(mark.status == 'done' for mark in self.marks)

    @property
    def said(self) -> int:
        """How many steps are told."""
        return sum(mark.said for mark in self.marks)


def timeline(heard: Heard) -> Timeline | None:
    """Return the plan as a timeline; None where there is none.

    What was done since the answer is ticked off as the explainer tells of it.
    """
    answer = heard.answer
    if answer is None or not answer.plan:
        return None
    told = heard.status if heard.is_current else None
    done, running = (told.done, told.running) if told and told.episode else (0, 0)
    marks, places = [], itertools.count()
    for i, step in enumerate(answer.plan):
        status = step.status
        place = next(places) if status != 'skipped' else done + running
        if place < done:
            status = 'done'
        elif place < done + running:
            status = 'running'
        sentence = step.tenses.get(status, step.sentence)
        others = tuple(dict.fromkeys(s for s in step.tenses.values() if s != sentence))
        marks.append(Mark(i + 1, sentence, step.position in answer.positions, status, others))
    at_end = all(mark.status in ('done', 'skipped') for mark in marks)
    return Timeline(tuple(marks), heard.restarts and at_end, _may_be_old(heard))


@dataclass(frozen=True)
class Explained:
    """The tables under an answer: the plan, the goals, likeliest first, and what was tried."""

    answer: Answer
    steps: tuple[tuple[Step, bool], ...]  # whether it is said
    goals: tuple[Goal, ...]
    other_goals: tuple[Goal, ...]
    facts: tuple[Fact, ...]
    tried: tuple[Answer, ...]


def explained(heard: Heard) -> Explained | None:
    """Return the tables, None where there is no answer."""
    answer = heard.answer
    if answer is None:
        return None
    goals = sorted(answer.goals, key=lambda goal: (-goal.posterior, -goal.prior))
    # The true goal is among the first, however unlikely.
    first = {goal.name for goal in goals[:MOST_GOALS]} | {answer.true_goal}
    return Explained(
        answer,
        tuple((step, step.position in answer.positions) for step in answer.plan),
        tuple(goal for goal in goals if goal.name in first),
        tuple(goal for goal in goals if goal.name not in first),
        answer.facts,
        heard.tried if len(heard.tried) > 1 else (),
    )


@dataclass(frozen=True)
class Controls:
    """The slider, the choice, and what else decides how much is said; None: not known yet."""

    n: int | None = None
    most: int = SLIDER_END
    strategy: str = ''
    threshold: float = 0.0
    remember: bool = False


def controls(heard: Heard) -> Controls:
    """Return how the controls stand."""
    settings = heard.settings
    if settings is None:
        return Controls()
    length = len(heard.answer.plan) if heard.answer else SLIDER_END
    most = max(length, settings.n, 2)
    return Controls(settings.n, most, settings.strategy, settings.threshold, settings.remember)


def parts(heard: Heard, follow: bool) -> dict[str, object]:
    """Return all that the page shows, by the names of its parts."""
    return {
        'status': status(heard),
        'progress': progress(heard),
        'asks': asks(heard, follow),
        'said': said(heard),
        'belief': belief(heard),
        'timeline': timeline(heard),
        'explained': explained(heard),
        'controls': controls(heard),
    }


def percent(probability: float) -> str:
    """Return a probability in words that never say 0 % or 100 % of what is not certain."""
    if 0 < probability < 0.01:
        return 'under 1\u00a0%'
    if 0.99 < probability < 1 - 1e-9:
        return 'over 99\u00a0%'
    return f'{100 * probability:.0f}\u00a0%'
