"""A robot's texts as its state changes: read in part, and as if they were read whole."""

from random import Random

import pytest
from pddl_cases import random_space, with_changed_state
from test_durative import DOMAIN as DURATIVE
from test_durative import PROBLEM as DURATIVE_PROBLEM

from mirror_explainer.errors import InputError
from mirror_explainer.explainer import robot_plan
from mirror_explainer.pddl import read_task
from mirror_explainer.pddl.task_reader import TaskReader

DOMAIN = """
(define (domain hall)
  (:types lamp switch - thing)
  (:predicates (lit ?l - lamp) (near ?t - (either lamp switch)) (bright))
  (:functions (watts ?l - lamp))
  (:derived (bright) (exists (?l - lamp) (lit ?l)))
  (:action press :parameters (?s - switch ?l - lamp)
    :precondition (and (near ?s) (>= (watts ?l) 40)) :effect (lit ?l)))
"""
PROBLEM = """
(define (problem p) (:domain hall) (:objects a b - lamp s - switch)
  (:init ; as it is (now
    (near s) (= (watts a) 60) (= (watts b) 10))
  (:goal (and (lit a) (bright))))
"""


def facts(task) -> frozenset[str]:
    return task.initial_facts


def test_another_state_is_read_as_if_all_were_read() -> None:
    reader = TaskReader()
    reader.read(DOMAIN, PROBLEM)

    changed = PROBLEM.replace('(near s)', '(lit b)\n(near a)')
    task = reader.read(DOMAIN, changed)

    assert reader._in_a_row == 1
    whole = read_task(DOMAIN, changed)
    assert facts(task) == facts(whole)
    assert read_task(task.domain, task.problem).initial_facts >= {'(lit b)', '(near a)'}
    with pytest.raises(InputError, match=r'\(near s\) does not hold'):
        robot_plan(task, '(press s a)')


@pytest.mark.parametrize(
    ('change', 'said'),
    [
        (('(near s)', '(nere s)'), r'problem, line 4: \(nere s\): the domain has no predicate'),
        (('(near s)', '\n(near t)'), 'problem, line 5: the problem has no object "t"'),
        (('(near s)', '(near s'), r'problem, line 3: "\(:init" is not closed before'),
        (('(near s)', '(bright)'), 'problem, line 4: "bright" is derived'),
    ],
)
def test_what_is_wrong_in_another_state_is_told_with_its_line(
    change: tuple[str, str], said: str
) -> None:
    reader = TaskReader()
    reader.read(DOMAIN, PROBLEM)

    with pytest.raises(InputError, match=f'^{said}'):
        reader.read(DOMAIN, PROBLEM.replace(*change))

    assert reader.read(DOMAIN, PROBLEM).goal_text == '(and (lit a) (bright))'


@pytest.mark.parametrize(
    'change',
    [
        ('(= (watts b) 10)', '(= (watts b) 90)'),
        ('(lit a) (b', '(lit b) (b'),
        ('s - sw', 's t - sw'),
    ],
)
def test_what_else_changes_is_read_whole(change: tuple[str, str]) -> None:
    reader = TaskReader()
    reader.read(DOMAIN, PROBLEM)

    task = reader.read(DOMAIN, PROBLEM.replace(*change))

    assert reader._in_a_row == 0
    assert task.goal_text == read_task(DOMAIN, PROBLEM.replace(*change)).goal_text


def test_random_states_are_read_in_part_as_they_are_whole() -> None:
    random, in_part = Random(5), 0
    for _ in range(20):
        space, reader = random_space(random), TaskReader()
        reader.read(space.domain, space.problem)
        for _ in range(4):
            space = with_changed_state(space, random)
            task = reader.read(space.domain, space.problem)
            in_part += reader._in_a_row > 0
            whole = read_task(space.domain, space.problem)
            assert task.model == whole.model
            assert sorted(task.problem.split()) == sorted(whole.problem.split())
    assert in_part > 70


def test_a_robot_whose_actions_take_time_is_read_in_part() -> None:
    reader = TaskReader()
    reader.read(DURATIVE, DURATIVE_PROBLEM)
    changed = DURATIVE_PROBLEM.replace('( robot_at leia Kitchen )', '(robot_at leia problem)')

    task = reader.read(DURATIVE, changed)

    assert reader._in_a_row == 1
    whole = read_task(DURATIVE, changed)
    assert (task.model, task.timed) == (whole.model, whole.timed)
