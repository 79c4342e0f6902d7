"""One call: what is known about the robot and its listener, and a question, in; an answer out.

`explain` is VERBALIZE-PLAN of Algorithm 1, from a preparation (`listener/preparation.py`)
with as much planning as there was time for.
"""

import time
from collections.abc import Sequence
from dataclasses import replace

from mirror_explainer.errors import InputError, NoPlanError, did_you_mean
from mirror_explainer.input_limits import InputLimits
from mirror_explainer.listener.explanation import Explanation
from mirror_explainer.listener.listeners import chosen
from mirror_explainer.listener.mirror_model import MirrorModel
from mirror_explainer.listener.preparation import Preparation, RobotPlan
from mirror_explainer.pddl import Task
from mirror_explainer.pddl.plan_check import check_plan
from mirror_explainer.pddl.plan_text import read_plan, without_dummy
from mirror_explainer.pddl.situation import (
    NEW_TASK,
    REPLANNED,
    RESTARTED,
    RESUMED,
    Situation,
)
from mirror_explainer.planning import Plan
from mirror_explainer.selection.choice import (
    Selection,
    baseline,
    most_informative,
    smallest_sufficient,
)
from mirror_explainer.settings import Question

EMPTY_PLAN = 'the plan is empty, and the goal does not hold yet'


def robot_plan(
    task: Task, text: str, source: str = 'plan', limits: InputLimits | None = None
) -> RobotPlan:
    """Return π_R from its text, checked against the task.

    Raises InputError for a text that is no plan of the task, NoPlanError for
    an empty one unless the goal already holds.
    """
    steps = without_dummy(task, read_plan(text, source, limits))
    try:
        run = check_plan(task, steps, source, limits)
    except InputError as error:
        if steps:
            raise
        raise NoPlanError(source, EMPTY_PLAN, cure='Write a step a line: (move a b).') from error
    return RobotPlan(Plan(tuple(step.action for step in steps), run.cost), run)


def robot_plan_of(situation: Situation) -> RobotPlan:
    """Return π_R of an episode."""
    episode = situation.episode
    return RobotPlan(Plan(episode.actions, episode.run.cost), episode.run)


def explain(
    preparation: Preparation,
    question: Question | None = None,
    said: Sequence[str] = (),
    said_source: str = 'sentences said earlier',
    last_episode: int | None = None,
) -> Explanation:
    """Choose what to say.

    `said` are sentences that the listener has heard, from `said_source`, and `last_episode`
    the number of the episode that the last answer was about, if there was one. What was left
    out for a reason is told in each answer: it is one of the sentences that were asked for, but
    one more is chosen in any case. Raises InputError for a sentence that is not in the plan.
    """
    started = time.perf_counter()
    question = question or Question()
    listener = chosen(preparation.listener, question.listener, question.min_gain)
    model = preparation.model_for(listener)
    known = {*positions_of(said, said_source, model)}
    told = {*preparation.excused, *preparation.failed}  # whatever is chosen
    known |= {places[-1] for places in model.places if not told.isdisjoint(places)}
    first = not known
    if not question.tell_past:
        known |= {*_past(preparation, model)}
    left = replace(question, n=max(1, question.n - len(preparation.excused)))
    selection = _selection(model, left, sorted(known), first)
    return Explanation(
        preparation,
        model,
        question,
        selection,
        tuple(sorted(known)),
        time.perf_counter() - started,
        _opening(preparation, last_episode),
    )


def _past(preparation: Preparation, model: MirrorModel) -> list[int]:
    """Return the positions that sentences stand for of which every step is over."""
    statuses = preparation.statuses
    return [
        places[-1] for places in model.places if all(statuses[place].is_over for place in places)
    ]


def _opening(preparation: Preparation, last_episode: int | None) -> str:
    """Return what is said first if the last answer was about another episode."""
    situation, phrases = preparation.situation, preparation.sentences.phrases
    if situation is None or last_episode in (None, situation.number):
        return ''
    if situation.like_before:
        return phrases.replanned
    openings = {
        REPLANNED: phrases.replanned,
        RESTARTED: phrases.restarted,
        NEW_TASK: phrases.new_task,
        RESUMED: phrases.resumed,
    }
    return openings.get(situation.reason, '')


def _selection(
    model: MirrorModel, question: Question, known: Sequence[int], first: bool
) -> Selection:
    evidence = model.evidence(known)
    nothing = Selection((), 0.0)
    if not evidence.places or (known and evidence.doubt_before < question.threshold):
        return nothing
    if question.strategy != 'informative':
        return baseline(evidence, question.strategy, question.n, question.threshold)
    budget = question.selection_budget
    if question.threshold > 0:
        return smallest_sufficient(evidence, question.threshold, question.n, budget)
    return most_informative(evidence, question.n, budget, first=first)


def positions_of(said: Sequence[str], source: str, model: MirrorModel) -> tuple[int, ...]:
    """Return the plan positions that the sentences said stand for, ascending.

    Raises InputError, with the source, for a sentence that no step is said as.
    """
    places = dict(zip(model.told, model.places, strict=True))
    for sentence in said:
        if sentence not in places:
            raise InputError(
                source,
                f'no step of the plan is said as "{sentence}"{did_you_mean(sentence, places)}',
                cure='Leave it out, or give the plan and the user model it was said with.',
            )
    return tuple(sorted({places[sentence][-1] for sentence in said}))
