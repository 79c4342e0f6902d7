"""What changes by itself, with no step of the robot: its plan may wait for it."""

import pytest

from mirror_explainer.errors import InputError
from mirror_explainer.explainer import robot_plan
from mirror_explainer.pddl import Task, read_task
from mirror_explainer.pddl.task_reader import TaskReader

DOMAIN = """
(define (domain post)
  (:types place)
  (:predicates (at ?p - place) (open ?p - place) (served ?p - place) (late))
  (:functions (fuel))
  (:durative-action go :parameters (?a ?b - place) :duration (= ?duration 4)
    :condition (and (at start (at ?a)) (at start (>= (fuel) 1)))
    :effect (and (at start (not (at ?a))) (at end (at ?b)) (at end (decrease (fuel) 1))))
  (:durative-action serve :parameters (?p - place) :duration (= ?duration 2)
    :condition (and (over all (at ?p)) (over all (open ?p)))
    :effect (at end (served ?p))))
"""
PROBLEM = """
(define (problem round) (:domain post) (:objects office bakery school - place)
  (:init (at office) (open bakery) (= (fuel) 5)
    (at 6 (not (open bakery))) (at 8 (open school)) (at 9 (late)))
  (:goal (and (served bakery) (served school))))
"""
PLAN = """
0.0: (go office bakery) [4]
4.0: (serve bakery) [2]
6.1: (go bakery school) [4]
10.2: (serve school) [2]
"""


def facts(task: Task, *predicates: str) -> set[str]:
    return {fact for fact in task.initial_facts if fact[1:].split()[0].strip(')') in predicates}


def test_a_plan_may_wait_for_what_comes_true_by_itself() -> None:
    task = read_task(DOMAIN, PROBLEM)

    assert len(robot_plan(task, PLAN).plan.actions) == 4
    assert facts(task, 'open', 'late') == {'(open bakery)', '(open school)', '(late)'}
    (warning,) = [w for w in task.warnings if 'by itself' in w]
    assert warning.startswith('problem, line 4: what comes true by itself at a time')


def test_a_slip_in_what_comes_true_by_itself_is_told_with_its_line() -> None:
    with pytest.raises(InputError, match='problem, line 4: the problem has no object "schol"'):
        read_task(DOMAIN, PROBLEM.replace('(open school)', '(open schol)'))


def test_events_make_true_what_their_variables_may_stand_for() -> None:
    event = '(:event dawn :parameters (?p - place) :effect (open ?p)) (:durative-action go'
    domain = DOMAIN.replace('(:durative-action go', event)

    task = read_task(domain, PROBLEM.replace('(at 8 (open school))', ''))

    assert facts(task, 'open') == {'(open office)', '(open bakery)', '(open school)'}
    assert len(robot_plan(task, PLAN).plan.actions) == 4


def test_what_is_wanted_false_somewhere_is_not_taken_as_true() -> None:
    for condition in ('(not (late))', '(imply (late) (open ?p))', '(not (hasty))'):
        domain = DOMAIN.replace('(over all (open ?p))', f'(over all {condition})').replace(
            '(:durative-action go', '(:derived (hasty) (late)) (:durative-action go'
        )
        domain = domain.replace('(late))', '(late) (hasty))', 1)

        task = read_task(domain, PROBLEM)

        assert facts(task, 'late') == set(), condition
        assert len(robot_plan(task, PLAN).plan.actions) == 4, condition


def test_conditions_on_a_number_that_changes_by_itself_are_left_out() -> None:
    """And on what is reckoned from it: the fuel in the tank, too."""
    domain = DOMAIN.replace('(fuel))', '(fuel) (can))').replace(
        '(at end (served ?p))', '(and (at end (served ?p)) (at end (assign (fuel) (can))))'
    )
    problem = PROBLEM.replace('(= (fuel) 5)', '(= (fuel) 1) (= (can) 0) (at 5 (= (can) 9))')

    task = read_task(domain, problem)

    assert len(robot_plan(task, PLAN).plan.actions) == 4


def test_a_new_state_of_the_problem_keeps_what_comes_true_by_itself() -> None:
    reader = TaskReader()
    later = PROBLEM.replace('(at office)', '(at bakery)')
    open_now = PROBLEM.replace('(at office)', '(at office) (open school)')
    for problem in (open_now, later, PROBLEM):
        task = reader.read(DOMAIN, problem)
        assert facts(task, 'open') == {'(open bakery)', '(open school)'}
        assert task.problem.count('(open school)') == 1
        assert '(open school)' in task.problem
    assert facts(task, 'at') == {'(at office)'}
