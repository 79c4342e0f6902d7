"""What the operator's page says of what was heard: the words, and the rows of its tables.

It never passes off an old answer as new: `currency` says what is known of its age.
"""

from dataclasses import dataclass

from mirror_explainer.web.operator.heard import Answer, Goal, Heard, Step

MOST_GOALS = 6  # that are shown at once; the others on request
SLIDER_END = 10  # where the length of the plan is not known yet


@dataclass(frozen=True)
class Condition:
    """How the explainer is: a kind (a word, and a name for the style), and words."""

    kind: str
    words: str


def condition(heard: Heard) -> Condition:
    """Say how the explainer is."""
    status = heard.status
    if status is None:
        return Condition(
            'silent', f'Nothing was heard of {heard.explainer} on /diagnostics yet. Is it running?'
        )
    if heard.silent:
        return Condition(
            'silent', f'No news from {heard.explainer} for 5 s, the last at {heard.status_at}.'
        )
    if status.state == 'planning':
        return Condition('working', 'The robot works out what to say.')
    if status.level:
        kind = 'error' if status.level > 1 else 'warning'
        return Condition(kind, f'{_sentence(status.message)} {status.cure}'.strip())
    return Condition('ready', 'The robot can be asked.')


def progress(heard: Heard) -> str:
    """Return how far the work is: it changes often, and is not to be read aloud."""
    working = heard.status is not None and heard.state == 'planning'
    return heard.status.message if heard.status and working else ''


@dataclass(frozen=True)
class Currency:
    """Whether the answer is about the newest inputs: words if not, or if that is not known.

    `ask` names the inputs that it is time to ask about, for a browser that does so by
    itself: once for each.
    """

    words: str = ''
    ask: str = ''


def currency(heard: Heard, follow: bool) -> Currency:
    """Say whether the answer shown is about what the robot is up to now.

    A browser that follows asks again once the robot is ready; not with `remember`,
    for that would use up what there is to say.
    """
    if heard.answer is None:
        return Currency()
    if heard.status is None or heard.silent:
        return Currency('This answer may be old: it is not known what the robot plans now.')
    if heard.status.inputs == heard.answer.inputs:
        return Currency()
    old = 'This answer is about an older plan: what the robot plans or knows has changed since.'
    if heard.state == 'ready':
        asks = follow and heard.settings is not None and not heard.settings.remember
        return Currency(f'{old} Ask again.', heard.status.inputs if asks else '')
    if heard.state == 'planning':
        return Currency(f'{old} The robot works out a new one.')
    return Currency(f'{old} A new one cannot be given now.')


@dataclass(frozen=True)
class Said:
    """The outcome of the newest call: sentences, or a note in their place, and its time."""

    sentences: tuple[str, ...] = ()
    note: str = ''
    failure: str = ''
    at: str = ''


def said(heard: Heard) -> Said:
    """Return what the robot said, and why it said no more."""
    failure = heard.failure
    reason = ''
    if failure and failure.state == heard.state:  # else the reason has passed
        reason = f'At {failure.at} there was no answer: {_sentence(failure.reason)}'
    if heard.answer is None:
        return Said(note='Nobody has asked yet.', failure=reason)
    note = ''
    if not heard.answer.plan:
        note = "Nothing is left to do: the robot's goal is reached."
    elif not heard.answer.sentences:
        note = 'There is nothing more to say about this plan.'
    return Said(heard.answer.sentences, note, reason, heard.answered_at)


@dataclass(frozen=True)
class Explained:
    """The tables under an answer: the plan, the goals, likeliest first, and what was tried."""

    answer: Answer
    steps: tuple[tuple[Step, bool], ...]  # whether it is said
    goals: tuple[Goal, ...]
    other_goals: tuple[Goal, ...]
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
        'condition': condition(heard),
        'progress': progress(heard),
        'currency': currency(heard, follow),
        'said': said(heard),
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


def _sentence(text: str) -> str:
    """Return a message as a sentence of its own."""
    text = text.strip()
    return text[:1].upper() + text[1:] + ('' if text.endswith(('.', '?', '!')) else '.')
