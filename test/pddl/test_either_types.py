"""Variables of the type (either a b), from the texts to plans."""

import pytest

from mirror_explainer.errors import InputError
from mirror_explainer.explainer import robot_plan
from mirror_explainer.pddl import read_task
from mirror_explainer.planning import Belief, BeliefSpace, Planner

DOMAIN = """
(define (domain depot)
  (:requirements :adl :typing :action-costs)
  (:types truck drone - vehicle
          parcel shelf place)
  (:constants depot - place)
  (:predicates (at ?x - (either vehicle parcel shelf) ?p - place) (in ?c - parcel ?v - vehicle)
               (seen ?x - (Either parcel SHELF)))
  (:functions (weight ?x - (either parcel shelf)) (total-cost))
  (:action look-at
    :parameters (?x - (either parcel
                              shelf) ?p - place)
    :precondition (and (at ?x ?p) (exists (?v - (either truck vehicle)) (at ?v ?p)))
    :effect (and (seen ?x) (increase (total-cost) (weight ?x))))
  (:action drive
    :parameters (?v - vehicle ?from ?to - place)
    :precondition (at ?v ?from)
    :effect (and (at ?v ?to) (not (at ?v ?from)) (increase (total-cost) 1))))
"""
PROBLEM = """
(define (problem look)
  (:domain depot)
  (:objects t - truck d - drone c - parcel s - shelf yard - place)
  (:init (at t yard) (at d depot) (at c yard) (at s depot)
         (= (weight c) 2) (= (weight s) 5) (= (total-cost) 0))
  (:goal (forall (?x - (either shelf parcel)) (seen ?x)))
  (:metric minimize (total-cost)))
"""


def test_a_variable_of_several_types_ranges_over_the_objects_of_all() -> None:
    task = read_task(DOMAIN, PROBLEM)

    both = robot_plan(task, '(look-at c yard)\n(look-at s depot)').cost

    assert both == 7.0
    with pytest.raises(
        InputError, match=r'\(look-at t yard\): t is of type truck, but "look-at" '
    ):
        robot_plan(task, '(look-at t yard)')
    with pytest.raises(InputError, match='does not reach the goal'):
        robot_plan(task, '(look-at c yard)')


def test_fast_downward_plans_for_variables_of_several_types() -> None:
    task = read_task(DOMAIN, PROBLEM)
    goals = (task.goal_text, '(seen s)', '(and (at t depot) (seen c))')
    space = BeliefSpace(task.domain, task.problem, goals, ('(at d yard)', '(at d depot)'))
    with Planner('fast-downward-opt') as planner:
        nowhere = planner.plan(space, [Belief(goal) for goal in range(3)])
        home = planner.plan(space, [Belief(0, frozenset(['(at d depot)']))])

    # 5 + 2 and one drive, since the drone is nowhere; 5 and a drive; the same for t and c
    assert [result.plans[0].cost for result in nowhere.results] == [8, 6, 3]
    assert home.results[0].plans[0].cost == 7


def test_lines_stay_where_they_were() -> None:
    with pytest.raises(InputError, match='^domain, line 15: .*vehicel'):
        read_task(DOMAIN.strip().replace('?v - vehicle ?from', '?v - vehicel ?from'), PROBLEM)


KEPT = {
    'types of different supertypes': ('(either parcel\n', '(either truck\n'),
    'types that overlap with others': ('(either truck vehicle)', '(either shelf place)'),
    'an object': ('depot - place', 'depot - (either place shelf)'),
    'a type that is not declared': ('(either parcel\n', '(either crate\n'),
    'a name that is taken': ('look-at\n', 'parcel-or-shelf\n'),
}


@pytest.mark.parametrize('change', KEPT.values(), ids=KEPT)
def test_what_one_supertype_does_not_express_is_refused(change: tuple[str, str]) -> None:
    assert change[0] in DOMAIN

    with pytest.raises(InputError, match=r'line \d+: no one type stands for "\(either'):
        read_task(DOMAIN.replace(*change, 1), PROBLEM)


def test_an_either_among_the_types_themselves_is_refused_as_it_was_written() -> None:
    domain = (
        '(define (domain d) (:requirements :typing) (:types a b - (either c d) c d - object)'
        ' (:predicates (p ?x - a) (g))'
        ' (:action m :parameters (?x - (either a b)) :precondition (p ?x) :effect (g)))'
    )
    problem = '(define (problem q) (:domain d) (:objects o - a) (:init (p o)) (:goal (g)))'

    with pytest.raises(InputError, match=r'\(either c d\)'):
        read_task(domain, problem)
