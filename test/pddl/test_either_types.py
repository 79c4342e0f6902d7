"""Variables of the type (either a b), from the texts to plans."""

import pytest

from mirror_explainer.errors import InputError
from mirror_explainer.explainer import robot_plan
from mirror_explainer.pddl import read_task
from mirror_explainer.planning import Belief, BeliefSpace, Planner, Status

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

    both = robot_plan(task, '(look-at c yard)\n(look-at s depot)').plan.cost

    assert both == 7.0
    with pytest.raises(InputError, match=r'step 1 of 1: \(is-parcel-or-shelf t\) does not hold'):
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


def test_an_object_may_have_two_types() -> None:
    problem = PROBLEM.replace('c - parcel', 'c - (either parcel truck)').replace('(at c yard)', '')

    task = read_task(DOMAIN, problem.replace('(at t yard)', '(at t yard) (at c yard)'))

    assert (
        robot_plan(task, '(drive c yard depot)\n(look-at c depot)\n(look-at s depot)').plan.cost
        == 8
    )
    with pytest.raises(InputError, match=r'\(is-vehicle s\) does not hold'):
        robot_plan(task, '(drive s depot yard)')


TWO_ABOVE = """
(define (domain ferry)
  (:requirements :adl :typing)
  (:types amphibian - ship amphibian - car car ship - vehicle vehicle quay - object)
  (:predicates (at ?v - vehicle ?q - quay) (wet ?s - ship) (parked ?c - car))
  (:action swim :parameters (?s - ship ?a ?b - quay) :precondition (at ?s ?a)
    :effect (and (at ?s ?b) (not (at ?s ?a)) (wet ?s)))
  (:action park :parameters (?c - car ?q - quay) :precondition (at ?c ?q) :effect (parked ?c))
  (:action rinse :parameters () :precondition (exists (?s - ship) (wet ?s))
    :effect (forall (?s - ship) (not (wet ?s)))))
"""
FERRY = """
(define (problem p) (:domain ferry)
  (:objects f - ship c - car a - amphibian q r - quay)
  (:init (at f q) (at c q) (at a q))
  (:goal (and (forall (?s - ship) (not (wet ?s))) (parked a) (at a r))))
"""


def test_a_type_may_have_two_supertypes() -> None:
    task = read_task(TWO_ABOVE, FERRY)

    assert robot_plan(task, '(swim a q r)\n(park a r)\n(rinse)').plan.cost == 3
    with pytest.raises(InputError, match=r'step 1 of 1: \(is-ship c\) does not hold'):
        robot_plan(task, '(swim c q r)')
    with pytest.raises(InputError, match='does not reach the goal'):
        robot_plan(task, '(swim a q r)\n(park a r)')


def test_fast_downward_plans_with_two_supertypes() -> None:
    task = read_task(TWO_ABOVE, FERRY)
    space = BeliefSpace(task.domain, task.problem, ('(at a r)', '(at c r)'))
    with Planner('fast-downward-opt') as planner:
        found = planner.plan(space, [Belief(0), Belief(1)])

    assert [result.status for result in found.results] == [Status.SOLVED, Status.UNSOLVABLE]
    assert found.results[0].plans[0].actions == ('(swim a q r)',)
