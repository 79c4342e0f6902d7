"""The goals that a robot was seen to have, and how often: a file that people can read and edit.

goals_seen:
  (and (delivered insulin ward_1b) (docked)): 12
taken_up:
  (and (delivered insulin ward_1b) (docked)): '2026-05-04T09:30:00+00:00'

"""

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from datetime import datetime

import yaml

from mirror_explainer.errors import InputError, some_of
from mirror_explainer.input_limits import InputLimits
from mirror_explainer.listener.goals import parts_of
from mirror_explainer.listener.user_model import UserModel
from mirror_explainer.listener.user_model_file import parse_yaml
from mirror_explainer.pddl import Task, goal_expression
from mirror_explainer.text_files import read_text

# With more goals than this the rarest are dropped.
MOST_GOALS = 300
_MOST_TIMES = 10**9
_KEY = 'goals_seen'
_TAKEN_UP = 'taken_up'
_CURE = 'Write one goal a line, or remove the file and let the node count anew.'


@dataclass(frozen=True)
class GoalsSeen:
    """How often each goal was seen, and when those of late were taken up."""

    counts: Mapping[str, int] = field(default_factory=dict)
    taken_up: Mapping[str, datetime] = field(default_factory=dict)


def read_goals_seen(path: str, limits: InputLimits | None = None) -> GoalsSeen:
    """Return the goals in a file; raises InputError.

    A file that has no counts, but a goal a line, is taken as well; a blank one has no goals.
    """
    text = read_text(path, limits)
    lines = [line.strip() for line in text.split('\n')]
    lines = [line for line in lines if line and not line.startswith(('#', ';'))]
    if all(line.startswith('(') and line.endswith(')') for line in lines):
        return GoalsSeen({line: lines.count(line) for line in lines})
    wanted = f'this has no "{_KEY}" with goals and whole numbers'
    _, data = parse_yaml(text, path, wanted)
    counts = data.get(_KEY) if data.keys() <= {_KEY, _TAKEN_UP} else None
    if not isinstance(counts, dict) or not all(isinstance(goal, str) for goal in counts):
        raise InputError(path, wanted, cure=_CURE)
    wrong = [goal for goal, count in counts.items() if not _is_count(count)]
    if wrong:
        reason = f'this has no whole number of times for {some_of(wrong)}'
        raise InputError(path, reason, cure=_CURE)
    moments = data.get(_TAKEN_UP)
    return GoalsSeen(counts, _moments(moments) if isinstance(moments, dict) else {})


def _moments(written: Mapping[object, object]) -> dict[str, datetime]:
    """Return the moments that are written as the node writes them; people may have edited."""
    moments = {}
    for goal, text in written.items():
        with suppress(ValueError):
            moment = datetime.fromisoformat(str(text))
            if isinstance(goal, str) and moment.tzinfo:
                moments[goal] = moment
    return moments


def goals_seen_text(seen: GoalsSeen) -> str:
    """Return the file's text, the most frequent goals first, bounded in number."""
    often = dict(sorted(seen.counts.items(), key=lambda item: -item[1])[:MOST_GOALS])
    head = '# Goals that the robot had, and how often. The node counts; you may edit.\n'
    text = head + yaml.safe_dump({_KEY: often}, sort_keys=False, allow_unicode=True)
    late = {g: t.isoformat(timespec='seconds') for g, t in seen.taken_up.items() if g in often}
    if not late:
        return text
    head = '# When it took up the latest: a node that starts anew counts none of them twice.\n'
    return text + head + yaml.safe_dump({_TAKEN_UP: late}, sort_keys=False, allow_unicode=True)


def with_goals_seen(user_model: UserModel, task: Task, counts: Mapping[str, int]) -> UserModel:
    """Return the user model with P(G) as of a listener who saw the robot have these goals.

    P(g) ∝ K p(g) + n(g): the model's own probabilities p weigh as much as one sight of each
    of the K candidates. Goals are the same where they mean the same; those that are no
    candidates, or of other objects, are left out.
    """
    seen: dict[object, int] = {}
    for goal, times in counts.items():
        try:
            meaning = _meaning(goal, task)
        except InputError:  # of another task
            continue
        seen[meaning] = seen.get(meaning, 0) + times
    size = len(user_model.goals)
    weights = [
        # Each sight counts for the first of equal candidates, and for none that is ruled out.
        size * goal.probability + seen.pop(_meaning(goal.goal, task), 0)
        if goal.probability
        else 0.0
        for goal in user_model.goals
    ]
    total = sum(weights)
    goals = (
        replace(goal, probability=weight / total)
        for goal, weight in zip(user_model.goals, weights, strict=True)
    )
    return replace(user_model, goals=tuple(goals))


def _meaning(goal: str, task: Task) -> object:
    return frozenset(parts_of(goal_expression(task.model, goal), task.model))


def _is_count(value: object) -> bool:
    if not isinstance(value, int) or isinstance(value, bool):
        return False
    return 0 <= value <= _MOST_TIMES
