"""The answers to calls: what was said is remembered as long as it is about what the robot does."""

import gc
import threading
from collections.abc import Callable
from pathlib import Path

import pytest
from patience import PATIENCE

from mirror_explainer.explainer import robot_plan
from mirror_explainer.listener.explanation import Explanation
from mirror_explainer.listener.preparation import Preparation, prepare
from mirror_explainer.listener.user_model import read_user_model
from mirror_explainer.node import answers as module
from mirror_explainer.node.answers import Answers
from mirror_explainer.pddl import read_task
from mirror_explainer.settings import Question

ONE = Question(n=1)
DOMAIN = """(define (domain chores) (:requirements :typing) (:types chore)
  (:predicates (done ?c - chore))
  (:action do :parameters (?c - chore) :precondition () :effect (done ?c)))
"""


def preparation(folder: Path, goal: str, plan: str) -> Preparation:
    """Return a robot that does the chores of a plan, one letter each, as far as its goal's."""
    done = ''.join(f'(done {chore})' for chore in goal if chore not in plan)
    goals = f'(and {" ".join(f"(done {chore})" for chore in goal)})'
    task = read_task(
        DOMAIN,
        f'(define (problem p) (:domain chores) (:objects {" ".join(goal)} - chore)'
        f'(:init {done}) (:goal {goals}))',
    )
    user_model = folder / 'user_model.yaml'
    user_model.write_text(f'goals: [{{goal: "{goals}"}}]\nsentences: {{do: "I will do {{c}}."}}')
    steps = '\n'.join(f'(do {chore})' for chore in plan)
    return prepare(task, robot_plan(task, steps), read_user_model(user_model, task))


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


@pytest.fixture
def chores(tmp_path: Path) -> Callable[..., Preparation]:
    """Return what makes a robot of a goal and a plan; without a plan it does all in order."""
    return lambda goal, plan='': preparation(tmp_path, goal, plan or goal)


# All chores tell as much as each other, and of such the later ones are said.


def test_asking_again_tells_what_was_not_said_also_of_what_is_left_of_the_plan(
    listener, chores
) -> None:
    ask = listener.update(1, chores('abc'))
    first = [ask(), ask()]
    second = listener.update(2, chores('abc', 'ac'))()
    third = listener.update(3, chores('abc', 'a'))()

    assert first == ['I will do c.', 'I will do b.']
    assert [second, third] == ['I will do a.', 'You have heard all that I am up to.']


def test_what_was_said_is_forgotten_with_the_goal_it_was_about(listener, chores) -> None:
    listener.update(1, chores('ab'))()
    ask = listener.update(2, chores('cb'))

    assert ask() == 'I will do b.'


def test_what_was_said_of_steps_that_are_done_is_not_taken_for_said_when_they_come_again(
    listener, chores
) -> None:
    listener.update(1, chores('ab', 'ba'))()
    listener.update(2, chores('ab', 'b'))
    ask = listener.update(3, chores('ab', 'ba'))

    assert ask() == 'I will do a.'


def test_what_planning_adds_to_an_update_takes_nothing_of_what_was_said_away(
    listener, chores
) -> None:
    robot = chores('ab')
    first = listener.update(1, robot)()
    refined = listener.update(1, chores('ab'))

    assert [first, refined()] == ['I will do b.', 'I will do a.']


def test_a_call_that_comes_before_the_answer_is_made_loses_nothing(listener, chores) -> None:
    robot = chores('ab')
    first = listener.answers.give(robot, 1, ONE, remember=True)
    ask = listener.update(1, robot)

    assert [first, ask()] == ['I will do b.', 'I will do a.']


def test_an_older_answer_is_not_published_after_a_newer_one(listener, chores) -> None:
    older = listener.update(1, chores('ab'))
    newer = listener.update(2, chores('cd'))

    assert newer() == 'I will do d.'
    assert older() == 'I will do b.'
    assert listener.heard == ['I will do d.']


def test_many_answers_after_what_was_said_take_no_more_memory_than_a_few(listener, chores) -> None:
    ask = listener.update(1, chores('abcdefghijklmnopqrstuvwxyz'))

    sizes = []
    for _ in range(3):
        for _ in range(10):
            ask()
        gc.collect()
        sizes.append(sum(type(thing) is Explanation for thing in gc.get_objects()))

    assert sizes[0] == sizes[1] == sizes[2]


def test_a_call_waits_for_its_turn_only_so_long(monkeypatch, listener, chores) -> None:
    monkeypatch.setattr(module, 'TURN_SECONDS', 0.01)
    robot = chores('ab')
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
    assert ask() == 'I will do a.'


def test_nobody_is_answered_after_the_end(listener, chores) -> None:
    ask = listener.update(1, chores('a'))
    listener.answers.close()

    assert ask() is None
    assert listener.heard == []
