"""Updates that their answers tell apart: each sends the robot for a parcel of its own."""

import re
from dataclasses import dataclass
from pathlib import Path

from prepared import prepared

from mirror_explainer.explainer import explain
from mirror_explainer.listener.phrases import Phrases
from mirror_explainer.listener.user_model import read_user_model
from mirror_explainer.pddl import read_task
from mirror_explainer.planning import Planner

CONFIG = Path(__file__).parents[2] / 'config' / 'warehouse'
DOMAIN = (CONFIG / 'domain.pddl').read_text()
_PROBLEM = (CONFIG / 'problem.pddl').read_text()
_PLAN = (CONFIG / 'plan.txt').read_text()

# Of four goals none is the robot's own: what it fetches is the news.
FEW_GOALS = """goals:
  - goal: (and (holding red_circle) (holding blue_cube) (outside bottom_door))
  - goal: (and (holding red_circle) (holding blue_circle) (outside bottom_door))
  - goal: (and (holding red_triangle) (holding blue_cube) (outside top_left_door))
  - goal: (and (holding red_cube) (holding blue_circle) (outside top_right_door))
"""


def _name(number: int) -> str:
    return f'parcel_{number:06}'


def problem(number: int) -> str:
    """Return the problem of an update: a parcel lies in the red room, and is to be fetched."""
    name = _name(number)
    return (
        _PROBLEM.replace('red_cube blue_cube', f'red_cube {name} blue_cube')
        .replace('(charged))', f'(charged) (item-at {name} red_room))')
        .replace('(:goal (and (holding red_circle)', f'(:goal (and (holding {name})')
    )


def plan(number: int) -> str:
    """Return the plan of an update. It is no plan for any other update's problem."""
    return _PLAN.replace('red_circle', _name(number))


def number_in(text: str) -> int | None:
    """Return the number of the update that a text speaks of, None if of none or of several."""
    found = set(re.findall(r'parcel[ _](\d+)', text))
    return int(found.pop()) if len(found) == 1 else None


@dataclass(frozen=True)
class RightAnswers:
    """What the core answers to every update: the same but for the parcel's number."""

    template: str

    def to(self, number: int) -> str:
        """Return the answer to an update."""
        return self.template.replace(_number_words(0), _number_words(number))

    def are(self, message: str, number: int) -> bool:
        """Say whether a message is the answer to an update, be it told as something new or not."""
        first, _, rest = message.partition('\n')
        is_news = first in (Phrases.new_task, Phrases.replanned)
        return (rest if is_news else message) == self.to(number)


def _number_words(number: int) -> str:
    return _name(number).replace('_', ' ')


def right_answers(user_model: Path) -> RightAnswers:
    """Compute the answer to one update, and prove on another that only the number differs."""
    with Planner() as planner:
        first, other = (_answer(number, user_model, planner) for number in (0, 123456))
    answers = RightAnswers(first)
    assert number_in(first) == 0, first
    assert other == answers.to(123456), other
    return answers


def _answer(number: int, user_model: Path, planner: Planner) -> str:
    task = read_task(DOMAIN, problem(number))
    listener = read_user_model(user_model, task)
    return explain(prepared(task, plan(number), listener, planner)).spoken
