"""What the demo robot publishes after each step, on domains of every kind."""

from collections.abc import Iterator

import pytest
from conftest import WAREHOUSE

from mirror_explainer.pddl import read_task
from mirror_explainer.pddl.plan_check import check_plan
from mirror_explainer.pddl.plan_text import Step, read_plan
from mirror_explainer.pddl.problem_text import with_state

# A gardener whose cart is full or not by an axiom, with a water level and a metric.
DERIVED_DOMAIN = """
(define (domain garden)
  (:requirements :adl :derived-predicates :fluents :action-costs)
  (:types bed pot)
  (:predicates (at ?b - bed) (carries ?p - pot) (Stands ?p - pot ?b - bed) (burdened))
  (:functions (water) (total-cost) (thirst ?p - pot))
  (:derived (burdened) (exists (?p - pot) (carries ?p)))
  (:action take :parameters (?p - pot ?b - bed)
    :precondition (and (at ?b) (Stands ?p ?b) (not (burdened)))
    :effect (and (carries ?p) (not (stands ?p ?b)) (increase (total-cost) 2)))
  (:action pour-for :parameters (?p - pot)
    :precondition (and (carries ?p) (burdened) (>= (water) (thirst ?p)))
    :effect (and (decrease (water) 0.25) (increase (total-cost) 1)))
  (:action drop :parameters (?p - pot ?b - bed)
    :precondition (and (at ?b) (carries ?p))
    :effect (and (not (carries ?p)) (stands ?p ?b) (increase (total-cost) 1))))
"""
DERIVED_PROBLEM = """
(define (problem g) (:domain garden)  ; the first of May
  (:objects Herbs roses - bed basil - pot mint - pot)
  (:init (at herbs) (stands basil herbs) (stands mint Herbs) (= (water) 1) (= (thirst basil) 0.5)
    (= (thirst mint) 0.5) (= (total-cost) 0))
  (:goal (and (carries mint) (stands basil herbs)))
  (:metric minimize (total-cost)))
"""
DERIVED_PLAN = '(take basil herbs)\n(pour-for basil)\n(drop basil herbs)\n(TAKE mint herbs)'

DURATIVE_DOMAIN = """
(define (domain bakery)
  (:requirements :durative-actions :typing)
  (:types loaf)
  (:predicates (hot) (raw ?l - loaf) (baked ?l - loaf))
  (:durative-action heat :parameters () :duration (= ?duration 5) :condition ()
    :effect (at end (hot)))
  (:durative-action bake :parameters (?l - loaf) :duration (= ?duration 30)
    :condition (and (at start (raw ?l)) (over all (hot)))
    :effect (and (at start (not (raw ?l))) (at end (baked ?l)))))
"""
DURATIVE_PROBLEM = """
(define (problem b) (:domain bakery) (:objects rye - loaf oat - loaf)
  (:init (raw rye) (raw oat)) (:goal (and (baked rye) (baked oat))))
"""
DURATIVE_PLAN = '0: (heat) [5]\n5.1: (bake rye) [30]\n35.2: (bake oat) [30]'

ROBOTS = {
    'warehouse': tuple(
        (WAREHOUSE / name).read_text() for name in ('domain.pddl', 'problem.pddl', 'plan.txt')
    ),
    'derived facts and numbers': (DERIVED_DOMAIN, DERIVED_PROBLEM, DERIVED_PLAN),
    'durations': (DURATIVE_DOMAIN, DURATIVE_PROBLEM, DURATIVE_PLAN),
}


def published(domain: str, problem: str, plan: str) -> Iterator[tuple[str, tuple[Step, ...]]]:
    """Yield the problem after each step, and what is left of the plan."""
    task, steps = read_task(domain, problem), read_plan(plan)
    for done, state in enumerate(check_plan(task, steps).states):
        yield with_state(problem, state), steps[done:]


@pytest.mark.parametrize('robot', ROBOTS)
def test_what_is_left_of_the_plan_can_be_carried_out_from_each_problem(robot: str) -> None:
    domain, problem, plan = ROBOTS[robot]
    whole = check_plan(read_task(domain, problem), read_plan(plan))

    for done, (now, remaining) in enumerate(published(domain, problem, plan)):
        run = check_plan(read_task(domain, now), remaining)  # it raises if not

        assert len(run.states) == len(whole.states) - done


def test_the_first_problem_says_what_the_given_one_says() -> None:
    for domain, problem, plan in ROBOTS.values():
        now, _ = next(published(domain, problem, plan))

        assert read_task(domain, now).initial_facts == read_task(domain, problem).initial_facts
        assert now.split('(:goal')[1].split() == problem.split('(:goal')[1].split()


def test_facts_and_numbers_are_those_of_the_domain_and_nothing_derived_or_made_up_is_said() -> (
    None
):
    after_watering = list(published(*ROBOTS['derived facts and numbers']))[2][0]
    baked = list(published(*ROBOTS['durations']))[-1][0]

    # 1 - 0.25 is left of the water; costs are counted from here on.
    assert after_watering.split('(:init')[1].split('(:goal')[0].split('\n')[1:-1] == [
        '    (at herbs)',
        '    (carries basil)',
        '    (stands mint herbs)',
        '    (= (thirst basil) 0.500000)',
        '    (= (thirst mint) 0.500000)',
        '    (= (total-cost) 0)',
        '    (= (water) 0.750000))',
    ]
    assert 'total-cost' not in baked
    assert '(baked oat)' in baked
