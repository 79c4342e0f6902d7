"""The table of docs/pddl.md, held against what is read: each row has an example here."""

import re
from pathlib import Path

import pytest

from mirror_explainer.errors import InputError
from mirror_explainer.explainer import robot_plan
from mirror_explainer.pddl import Task, read_task
from mirror_explainer.planning import Belief, BeliefSpace, Planner, Status

DOCS = Path(__file__).parents[2] / 'docs' / 'pddl.md'

DOMAIN = """
(define (domain garden)
  (:requirements :typing)
  (:types bed can - place)
  (:predicates (at ?p - place) (wet ?b - bed) (full))
  (:functions (way ?a ?b - place) (water) (total-cost))
  (:action go :parameters (?a ?b - place) :precondition (at ?a)
    :effect (and (at ?b) (not (at ?a)) (increase (total-cost) 1)))
  (:action pour :parameters (?b - bed) :precondition (and (at ?b) (full))
    :effect (and (wet ?b) (increase (total-cost) 1))))
"""
PROBLEM = """
(define (problem evening)
  (:domain garden)
  (:objects roses beans - bed tank - can)
  (:init (at tank) (full) (= (water) 3) (= (total-cost) 0)
    (= (way tank roses) 2) (= (way tank beans) 9) (= (way roses beans) 4) (= (way beans roses) 4)
    (= (way roses tank) 2) (= (way beans tank) 9) (= (way tank tank) 0) (= (way roses roses) 0)
    (= (way beans beans) 0))
  (:goal (wet roses))
  (:metric minimize (total-cost)))
"""
PLAN = '(go tank roses)\n(pour roses)'
TIMED = (
    DOMAIN.replace('(increase (total-cost) 1)', '')
    .replace('(:action', '(:durative-action')
    .replace(':precondition (at ?a)', ':duration (= ?duration 2) :condition (at start (at ?a))')
    .replace(
        ':precondition (and (at ?b) (full))',
        ':duration (= ?duration 5) :condition (and (over all (at ?b)) (at start (full)))',
    )
    .replace('(and (at ?b) (not (at ?a)) )', '(and (at end (at ?b)) (at start (not (at ?a))))')
    .replace('(and (wet ?b) )', '(and (at end (wet ?b)))')
)
UNTIMED_PROBLEM = PROBLEM.replace('(:metric minimize (total-cost))', '')

# What the domain and the problem have in place of something, and what must come of it: the
# cost of the plan, and the beginning of the only warning, if there is one.
Example = tuple[dict[str, str], dict[str, str], float, str]


def plain(
    domain: dict[str, str] | None = None,
    problem: dict[str, str] | None = None,
    cost: float = 2.0,
    warning: str = '',
) -> Example:
    return domain or {}, problem or {}, cost, warning


ROWS: dict[str, Example] = {
    'sections in any order': plain(
        {
            '(:types bed can - place)': '(:constants shed - can)',
            '(:functions': '(:types bed can - place) (:functions )(:functions',
            '(wet ?b - bed) (full))': '(wet ?b - bed) (full)) (:predicates (full))',
        },
        {'(:goal (wet roses))': '', '(:objects': '(:goal (wet roses)) (:objects'},
    ),
    'letter case': plain({'(wet ?b)': '(WET ?B) ; (dry ?b)\r\n'}, {'\n(define': '\ufeff(define'}),
    'one name for': plain(
        {'(full)': '(can)', '(wet ?b': '(pour ?b'}, {'(full)': '(can)', 'wet': 'pour'}
    ),
    'names that begin with a digit': plain({}, {'beans': '2nd.bed#1@north/a+b', 'tank': 'tank'}),
    'requirements': plain({':typing': ':goal-utilities :who-knows'}),
    'types, types with two': plain(
        {
            'bed can - place': 'bed - place bed - plot can - place place plot - object',
            '(wet ?b - bed)': '(wet ?b - (either bed can))',
            '(?b - bed)': '(?b - (either bed plot))',
        }
    ),
    'negative, disjunctive': plain(
        {'(and (at ?b) (full))': '(and (or (at ?b) (not (full))) (imply (= ?b ?b) (full)))'}
    ),
    'conditional and universal': plain(
        {'(and (wet ?b)': '(and (forall (?c - bed) (when (= ?c ?b) (forall (?d - can) (wet ?c))))'}
    ),
    'derived predicates': plain(
        {
            '(:action go': '(:derived (full) (exists (?c - can) (open ?c))) (:action go',
            '(wet ?b - bed) (full))': '(wet ?b - bed) (full) (open ?c - can))',
        },
        {'(full)': '(open tank)'},
    ),
    'metrics that add up': plain(
        {
            '(increase (total-cost) 1)': '(increase (water) (* 2 (way ?b ?b)))'
            ' (increase (total-cost) 3)'
        },
        {'(total-cost)))': '(+ (* 2 (total-cost)) (+ (water) 7))))'},
        12.0,
    ),
    'other metrics': plain(
        {},
        {'minimize': 'maximize'},
        2.0,
        'problem, line 10: the metric is no sum of what actions cost',
    ),
    'numbers that never change': plain({'(at ?a)\n': '(and (at ?a) (< (way ?a ?b) (* 2 4)))\n'}),
    'numbers that change': plain(
        {
            '(and (at ?b) (full))': '(and (at ?b) (>= (water) 1))',
            '(and (wet ?b)': '(and (wet ?b) (decrease (water) 1)',
        },
        {},
        2.0,
        'domain, line 9: numbers that change count when the plan of the robot is checked',
    ),
    'what depends on': plain(
        {'(and (wet ?b)': '(and (wet ?b) (when (> (water) 2) (full)) (decrease (water) 1)'},
        {},
        2.0,
        'domain, line 10: effects, and derived predicates, that depend on numbers that change',
    ),
    'numbers that multiply': plain(
        {'(and (wet ?b)': '(and (wet ?b) (assign (water) (* (water) (water)))'},
        {},
        2.0,
        'domain, line 10: numbers that multiply or divide',
    ),
    'preferences': plain(
        {},
        {'(wet roses)': '(and (wet roses) (preference p (wet beans)))'},
        2.0,
        'problem, line 9: soft goals',
    ),
    'trajectory constraints': plain(
        {},
        {'(:goal': '(:constraints (always (full))) (:goal'},
        2.0,
        'problem, line 9: constraints',
    ),
    'timed initial literals': plain(
        {},
        {'(full)': '(at 8 (full)) (at 9 (not (full)))'},
        2.0,
        'problem, line 5: what comes true by itself',
    ),
    'processes and events': plain(
        {
            '(:action go': '(:process rain :parameters () :effect (increase (water) (* #t 2)))'
            ' (:event fills :parameters () :precondition (>= (water) 9)'
            ' :effect (and (full) (when (full) (not (full))))) (:action go',
            '(and (at ?b) (full))': '(and (at ?b) (full) (> (water) 8))',
        },
        {'(full)': ''},
        2.0,
        'domain, line 7: what happens by itself',
    ),
    'tasks and methods': plain(
        {'(:action go': '(:task care :parameters ()) (:action go'},
        {},
        2.0,
        'domain, line 7: tasks and methods',
    ),
}

TIMED_ROWS: dict[str, tuple[dict[str, str], float, str]] = {
    'durative actions': ({}, 7.0, ''),
    'conditions of any form': (
        {'(at start (at ?a))': '(over all (forall (?p - place) (imply (= ?p ?a) (not (at ?p)))))'},
        7.0,
        '',
    ),
    'durations that are left open': (
        {'(= ?duration 2)': '(and (>= ?duration 2) (<= ?duration 3))'},
        7.0,
        'domain, line 7: durations that are left open',
    ),
    'durations of numbers': (
        {
            '(= ?duration 2)': '(= ?duration (water))',
            '(at end (wet ?b))': '(at end (wet ?b)) (at end (decrease (water) 1))',
        },
        8.0,
        'domain, line 7: durations that change as the plan runs',
    ),
    '`?duration` in effects': (
        {'(at end (wet ?b))': '(at end (wet ?b)) (at end (increase (water) ?duration))'},
        7.0,
        '',
    ),
    'continuous effects': (
        {
            '(at start (full))': '(at start (full)) (at start (>= (water) 4))',
            '(at start (not (at ?a)))': '(at start (not (at ?a))) (increase (water) (* #t 2))',
        },
        7.0,
        'domain, line 8: effects that go on all the while',
    ),
}

REFUSED = {
    'axioms in an old form': (
        {'(:action go': '(:axiom :context (full)) (:action go'},
        'domain, line 7: (:axiom …) is an old form of axioms; write (:derived ',
    ),
    'conditional effects that depend': (
        {'(at end (wet ?b))': '(when (at start (full)) (at end (wet ?b)))'},
        'domain, line 10: this effect depends on what held at another time',
    ),
    'functions of objects': (
        {'(way ?a ?b - place)': '(way ?a ?b - place) - place'},
        'domain, line 6: functions are read as numbers, not as "place"',
    ),
}


def changed(text: str, changes: dict[str, str]) -> str:
    for old, new in changes.items():
        assert old in text, old
        text = text.replace(old, new)
    return text


def require_planned(task: Task, cost: float) -> None:
    """Let Fast Downward find the same plan, of the same cost."""
    space = BeliefSpace(task.domain, task.problem, (task.goal_text,))
    with Planner() as planner:
        (found,) = planner.plan(space, [Belief(0)]).results
    assert found.status is Status.SOLVED, found.reason
    assert found.plans[0].cost == cost


@pytest.mark.parametrize(('row', 'example'), ROWS.items())
def test_what_the_table_names_is_read_checked_and_planned_for(row: str, example: Example) -> None:
    domain, problem, cost, warning = example

    task = read_task(changed(DOMAIN, domain), changed(PROBLEM, problem))

    assert [w for w in task.warnings if not w.startswith(warning or 'none')] == []
    assert len(task.warnings) == bool(warning)
    assert task.loses_plans == any('unforeseen' in warning for warning in task.warnings)
    assert robot_plan(task, PLAN).plan.cost == cost
    require_planned(task, cost)


@pytest.mark.parametrize(
    ('change', 'loses'),
    [
        ({'(and (at ?b) (full))': '(and (at ?b) (full) (>= (water) 9))'}, False),
        ({'(and (wet ?b)': '(and (wet ?b) (when (>= (water) 1) (full))'}, True),
        (
            {
                '(wet ?b - bed) (full))': '(wet ?b - bed) (full) (dry))',
                '(:action go': '(:derived (dry) (<= (water) 0)) (:action go',
                '(and (at ?b) (full))': '(and (at ?b) (not (dry)))',
            },
            True,
        ),
    ],
)
def test_that_there_is_no_plan_without_conditions_on_numbers_proves_that_there_is_none(
    change: dict[str, str], loses: bool
) -> None:
    domain = changed(DOMAIN, change | {'(at ?b) (not (at ?a))': '(at ?b) (decrease (water) 1)'})

    assert read_task(domain, PROBLEM).loses_plans == loses


@pytest.mark.parametrize(('row', 'example'), TIMED_ROWS.items())
def test_what_the_table_names_of_actions_that_take_time(
    row: str, example: tuple[dict[str, str], float, str]
) -> None:
    changes, cost, warning = example

    task = read_task(changed(TIMED, changes), UNTIMED_PROBLEM)

    assert [w for w in task.warnings if not w.startswith(warning or 'none')] == []
    assert len(task.warnings) == bool(warning)
    assert robot_plan(task, PLAN).plan.cost == cost
    require_planned(task, cost)


@pytest.mark.parametrize(('row', 'example'), REFUSED.items())
def test_what_the_table_says_is_refused(row: str, example: tuple[dict[str, str], str]) -> None:
    changes, said = example
    domain = TIMED if '(at end' in next(iter(changes)) else DOMAIN

    with pytest.raises(InputError) as refused:
        read_task(changed(domain, changes), PROBLEM)

    assert str(refused.value).startswith(said)


def test_every_row_of_the_table_has_an_example_that_agrees_with_it() -> None:
    table = DOCS.read_text().split('\n## ')[0]
    rows = re.findall(r'^\| (.+?) \| (.+?) \|$', table, re.MULTILINE)[1:]
    examples = [*ROWS, *TIMED_ROWS, *REFUSED]
    assert len(rows) == len(examples)
    for what, how in rows:
        (name,) = [example for example in examples if what.startswith(example)]
        if name not in REFUSED:
            warning = ROWS[name][3] if name in ROWS else TIMED_ROWS[name][2]
            assert ('a warning' in how) == bool(warning), what
        assert how.startswith('refused') == (name in REFUSED), what


def test_a_type_may_be_called_number_which_fast_downward_has_for_itself() -> None:
    domain = changed(
        DOMAIN, {'bed': 'number', '(water) (total-cost)': '(water) (total-cost) - number'}
    )
    task = read_task(domain, changed(PROBLEM, {'- bed': '- number'}))

    assert robot_plan(task, PLAN).plan.cost == 2
    require_planned(task, 2.0)
    with pytest.raises(InputError, match='tank is of type can, but "wet" takes a number there'):
        read_task(domain, changed(PROBLEM, {'- bed': '- number', '(wet roses)': '(wet tank)'}))
