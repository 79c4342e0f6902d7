"""The answers to calls: what was said is remembered as long as it is about what the robot does."""

import gc
import threading
from collections.abc import Callable

import pytest
from patience import PATIENCE

from mirror_explainer.explainer import Explanation, Preparation, Seconds
from mirror_explainer.listener.mirror_model import mirror_model
from mirror_explainer.listener.prior import Prior
from mirror_explainer.listener.sentences import Sentences
from mirror_explainer.listener.user_model import CandidateGoal
from mirror_explainer.node import answers as module
from mirror_explainer.node.answers import Answers
from mirror_explainer.planning import Belief, BeliefPlans, BeliefSpace, Plan, Status
from mirror_explainer.settings import Question

ONE = Question(n=1)
GOALS = (CandidateGoal('fetch', '(fetched)', 0.5), CandidateGoal('leave', '(left)', 0.5))
SPACE = BeliefSpace('', '', tuple(goal.goal for goal in GOALS))


def preparation(robot_goal: int, *actions: str) -> Preparation:
    """Return a robot with this goal and plan; with the other goal it would dance."""
    own, other = Plan(actions, len(actions)), Plan(('(dance)',), 1)
    plans = [own, other] if robot_goal == 0 else [other, own]
    prior = Prior(SPACE, GOALS, (Belief(0), Belief(1)), (0.5, 0.5), robot_goal, ())
    results = [BeliefPlans(Status.SOLVED, (plan,)) for plan in plans]
    return Preparation(mirror_model(prior, results, own, Sentences({}), 1.0), Seconds(), 0)


class Listener:
    """Asks for one sentence at a time, and hears what is published."""

    def __init__(self) -> None:
        self.heard: list[str] = []
        self.answers = Answers(lambda text, report: self.heard.append(text))

    def update(self, number: int, robot: Preparation) -> Callable[[], str]:
        """Make an update's answer; return what asks about it."""
        self.answers.make(robot, number, ONE)
        return lambda: self.answers.give(robot, number, ONE, remember=True)


@pytest.fixture
def listener() -> Listener:
    return Listener()


def test_asking_again_tells_what_was_not_said_also_of_what_is_left_of_the_plan(listener) -> None:
    ask = listener.update(1, preparation(0, '(go)', '(grab)', '(return)'))
    first = [ask(), ask()]
    ask = listener.update(2, preparation(0, '(grab)', '(return)'))

    assert first == ['I will go.', 'I will grab.']
    assert [ask(), ask()] == ['I will return.', 'You have heard every step of my plan.']


def test_what_was_said_is_forgotten_with_the_goal_it_was_about(listener) -> None:
    listener.update(1, preparation(0, '(go)', '(grab)'))()
    ask = listener.update(2, preparation(1, '(go)', '(exit)'))

    assert ask() == 'I will go.'


def test_what_was_said_of_steps_that_are_done_is_not_taken_for_said_when_they_come_again(
    listener,
) -> None:
    listener.update(1, preparation(0, '(go)', '(grab)'))()
    listener.update(2, preparation(0, '(grab)'))
    ask = listener.update(3, preparation(0, '(go)', '(grab)'))

    assert ask() == 'I will go.'


def test_a_call_that_comes_before_the_answer_is_made_loses_nothing(listener) -> None:
    robot = preparation(0, '(go)', '(grab)')
    first = listener.answers.give(robot, 1, ONE, remember=True)
    ask = listener.update(1, robot)

    assert [first, ask()] == ['I will go.', 'I will grab.']


def test_an_older_answer_is_not_published_after_a_newer_one(listener) -> None:
    older = listener.update(1, preparation(0, '(go)', '(grab)'))
    newer = listener.update(2, preparation(1, '(run)', '(exit)'))

    assert newer() == 'I will run.'
    assert older() == 'I will go.'
    assert listener.heard == ['I will run.']


def test_many_answers_after_what_was_said_take_no_more_memory_than_a_few(listener) -> None:
    robot = preparation(0, *(f'(go room{i})' for i in range(60)))
    ask = listener.update(1, robot)

    sizes = []
    for _ in range(3):
        for _ in range(20):
            ask()
        gc.collect()
        sizes.append(sum(type(thing) is Explanation for thing in gc.get_objects()))

    assert sizes[0] == sizes[1] == sizes[2]


def test_a_call_waits_for_its_turn_only_so_long(monkeypatch, listener) -> None:
    monkeypatch.setattr(module, 'TURN_SECONDS', 0.01)
    robot = preparation(0, '(go)', '(grab)')
    ask = listener.update(1, robot)
    begun, goes_on = threading.Event(), threading.Event()

    def publish(text: str, report: str) -> None:
        begun.set()
        goes_on.wait(PATIENCE)

    listener.answers = Answers(publish)
    other = threading.Thread(target=ask)
    other.start()
    begun.wait(PATIENCE)
    heard = ask()
    goes_on.set()
    other.join()

    assert heard is None
    assert ask() == 'I will grab.'


def test_nobody_is_answered_after_the_end(listener) -> None:
    ask = listener.update(1, preparation(0, '(go)'))
    listener.answers.close()

    assert ask() is None
    assert listener.heard == []
