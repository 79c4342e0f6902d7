"""Robots whose actions take time, as PlanSys2 and POPF describe them, from PDDL to sentences."""

import itertools
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from random import Random

import pytest
from unified_planning.engines import UPSequentialSimulator
from unified_planning.exceptions import UPInvalidActionError

from mirror_explainer.errors import InputError, PlanningError
from mirror_explainer.explainer import explain, robot_plan
from mirror_explainer.listener.own_plan import plan_for_robot
from mirror_explainer.listener.preparation import (
    Preparation,
    prepare,
    refine,
)
from mirror_explainer.listener.user_model import read_user_model
from mirror_explainer.pddl import Task, atom_text, fluent_expression, ground_text, read_task
from mirror_explainer.pddl.happenings import Happening
from mirror_explainer.pddl.plan_check import check_plan
from mirror_explainer.pddl.plan_text import read_plan
from mirror_explainer.planning import Belief, BeliefSpace, Planner
from mirror_explainer.settings import PlanningSettings, Question

# A robot that must be charged before it moves: moving takes as long as it is far.
DOMAIN = """\
;; rooms
(define (domain Simple)
(:requirements :strips :typing :adl :fluents :durative-actions)
(:types
  robot room)
(:predicates
  (robot_at ?r - robot ?ro - room)
  (connected ?ro1 ?ro2 - room)
  (Battery_Full ?r - robot)
  (charging_point_at ?ro - room)
  (start ?ro - room))
(:functions (distance ?a ?b - room) (speed ?r - robot))
(:durative-action move
  :parameters (?r - robot ?r1 ?r2 - room)
  :duration ( = ?duration (/ (distance ?r1 ?r2) (speed ?r)))
  :condition (and
    (at start(connected ?r1 ?r2))
    (at start(robot_at ?r ?r1))
    (over all(battery_full ?r)))
  :effect (and
    (at start(not(robot_at ?r ?r1))) ; it leaves (:goal
    (at end(robot_at ?r ?r2))))
(:durative-action CHARGE
  :parameters (?r - robot ?ro - room)
  :duration (= ?duration 5.5)
  :condition (and (at start (robot_at ?r ?ro)) (at start (charging_point_at ?ro)))
  :effect (at end (battery_full ?r)))
)
"""
PROBLEM = """\
( define ( problem problem_1 )
( :domain simple )
( :objects
\tLeia - robot
\tKitchen Problem at - room
)
( :init
\t( robot_at leia Kitchen )
\t( connected kitchen problem )
\t( connected problem at )
\t( connected kitchen at )
\t( charging_point_at kitchen )
\t( = ( distance kitchen problem ) 10.0000000000 )
\t( = ( distance problem at ) 3.2500000000 )
\t( = ( distance kitchen at ) 14.0000000000 )
\t( = ( speed leia ) 0.5000000000 )
)
( :goal
\t( and
\t\t( robot_at leia AT )
\t)
)
)
"""
USER_MODEL = """
goals:
  - goal: (robot_at leia at)
  - goal: (robot_at leia problem)
uncertain_facts:
  - {fact: (battery_full leia), probability: 0.5}
sentences:
  charge: I will charge in the {ro}.
"""
TIMED_PLAN = """\
5.501:\t(move leia kitchen problem)\t[20.000]
25.502:\t(move leia problem at)\t[6.500]
0.000:\t(charge leia kitchen)\t[5.500]
"""

Explainer = Callable[..., Preparation]


@pytest.fixture(scope='module')
def planner() -> Iterator[Planner]:
    with Planner() as planner:
        yield planner


@pytest.fixture
def prepared(planner: Planner, tmp_path: Path) -> Explainer:
    """Return a function that prepares an explanation of a task, its plan, and a user model."""

    def prepare_texts(task: Task, plan: str | None, user_model: str) -> Preparation:
        path = tmp_path / 'user.yaml'
        path.write_text(user_model, encoding='utf-8')
        listener = read_user_model(path, task)
        if plan is None:
            found = plan_for_robot(task, listener, planner, PlanningSettings())
            plan = '\n'.join(found.actions)
        return refine(prepare(task, robot_plan(task, plan), listener), planner)

    return prepare_texts


def costs(preparation: Preparation) -> dict[tuple[str, tuple[str, ...]], float]:
    """Return what each hypothesis' plan costs, by its goal and the facts that hold."""
    return {
        (preparation.model.goals[h.goal].name, tuple(h.belief.true_facts)): h.plan.cost
        for h in preparation.model.hypotheses
        if h.belief and h.plan
    }


def test_a_timed_plan_of_durative_actions_is_explained_from_pddl_to_sentences(
    prepared: Explainer,
) -> None:
    preparation = prepared(read_task(DOMAIN, PROBLEM), TIMED_PLAN, USER_MODEL)

    assert preparation.model.sentences == (
        'I will charge in the Kitchen.',
        'I will move to Problem.',
        'I will move to the at.',
    )
    assert preparation.model.complete
    assert explain(preparation, Question(n=1)).information_gain > 0


def test_durations_are_what_plans_cost_and_the_cheapest_are_expected(prepared: Explainer) -> None:
    preparation = prepared(read_task(DOMAIN, PROBLEM), None, USER_MODEL)

    assert costs(preparation) == {
        ('(robot_at leia at)', ()): 5.5 + 20 + 6.5,
        ('(robot_at leia at)', ('(battery_full leia)',)): 20 + 6.5,
        ('(robot_at leia problem)', ()): 5.5 + 20,
        ('(robot_at leia problem)', ('(battery_full leia)',)): 20.0,
    }
    assert preparation.model.plan.actions == (
        '(charge leia kitchen)',
        '(move leia kitchen problem)',
        '(move leia problem at)',
    )


def test_no_name_changes_not_even_one_that_is_a_word_of_pddl() -> None:
    task = read_task(DOMAIN, PROBLEM)

    assert not re.search('durative|duration ', task.domain.replace(':durative-actions', ''))
    assert [action.name for action in task.model.actions] == ['move', 'charge']
    assert {item.name for item in task.model.all_objects} == {'leia', 'kitchen', 'problem', 'at'}
    assert '(connected problem at)' in task.initial_facts
    assert task.goal_text == '(and (robot_at leia at))'
    assert atom_text(fluent_expression(task.model, '(START At)')) == '(start at)'


def test_a_name_may_be_followed_by_a_keyword_without_a_space() -> None:
    domain = re.sub(r'(:durative-action \S+)\s+:parameters', r'\1:parameters', DOMAIN, count=1)
    assert domain != DOMAIN

    task = read_task(domain, PROBLEM)

    assert task.model == read_task(DOMAIN, PROBLEM).model


def test_what_was_read_can_be_read_again() -> None:
    once = read_task(DOMAIN, PROBLEM)

    again = read_task(once.domain, once.problem)

    assert again.model == once.model
    assert read_task(again.domain, again.problem).domain == again.domain


def test_an_action_without_duration_takes_no_time_beside_durative_ones(
    prepared: Explainer,
) -> None:
    domain = DOMAIN.replace(
        '(:durative-action CHARGE',
        """(:action swap-battery
  :parameters (?r - robot ?ro - room)
  :precondition (and (robot_at ?r ?ro) (not (battery_full ?r)))
  :effect (and (battery_full ?r) (increase (total-cost) 7)))
(:durative-action CHARGE""",
    ).replace('(:functions', '(:functions (total-cost)')

    preparation = prepared(read_task(domain, PROBLEM), None, USER_MODEL.split('sentences')[0])

    assert preparation.model.plan.actions[0] == '(swap-battery leia kitchen)'
    assert preparation.model.plan.cost == 26.5


@pytest.mark.parametrize('metric', ['', '(:metric minimize (total-time))'])
def test_total_time_is_the_sum_of_durations(prepared: Explainer, metric: str) -> None:
    problem = PROBLEM.rstrip()[:-1] + metric + ')'

    preparation = prepared(read_task(DOMAIN, problem), None, USER_MODEL)

    assert preparation.model.plan.cost == 32.0


def test_a_metric_of_costs_counts_and_durations_do_not(prepared: Explainer) -> None:
    domain = DOMAIN.replace('(:functions', '(:functions (total-cost)').replace(
        '(at end(robot_at ?r ?r2))', '(at end(robot_at ?r ?r2)) (at end (increase (total-cost) 3))'
    )
    problem = PROBLEM.replace(
        '( robot_at leia Kitchen )', '(robot_at leia Kitchen)(= (total-cost) 0)'
    )
    problem = problem.rstrip()[:-1] + '(:metric minimize (total-cost)))'

    preparation = prepared(read_task(domain, problem), TIMED_PLAN, USER_MODEL)

    assert preparation.model.plan.cost == 6.0
    assert costs(preparation)['(robot_at leia at)', ('(battery_full leia)',)] == 3.0


def test_a_duration_without_finite_decimals_is_taken_as_finely_as_planners_add() -> None:
    task = read_task(DOMAIN, PROBLEM.replace('0.5000000000', '0.3'))

    assert robot_plan(task, TIMED_PLAN).plan.cost == pytest.approx(5.5 + 33.333 + 10.833, abs=1e-3)


def test_durations_with_all_the_digits_of_a_measurement_are_taken_to_a_thousandth(
    prepared: Explainer,
) -> None:
    domain = DOMAIN.replace('(/ (distance ?r1 ?r2) (speed ?r))', '(distance ?r1 ?r2)')
    problem = PROBLEM.replace('10.0000000000', '9.8765432109').replace('14.000', '140.123')

    preparation = prepared(read_task(domain, problem), None, USER_MODEL)

    assert preparation.model.plan.cost == pytest.approx(5.5 + 9.877 + 3.25)


def test_an_action_whose_start_undoes_what_it_needs_cannot_be_carried_out() -> None:
    domain = DOMAIN.replace('(over all(battery_full ?r))', '(over all (robot_at ?r ?r1))')

    with pytest.raises(
        InputError, match=r'step 2 of 3: \(robot_at leia kitchen\) does not hold while it goes on$'
    ):
        robot_plan(read_task(domain, PROBLEM), TIMED_PLAN)


def test_a_duration_that_is_given_where_it_is_needed_only_is_enough(prepared: Explainer) -> None:
    domain = DOMAIN.replace('(/ (distance ?r1 ?r2) (speed ?r))', '(distance ?r1 ?r2)')

    preparation = prepared(read_task(domain, PROBLEM), TIMED_PLAN, USER_MODEL)

    assert preparation.model.plan.cost == 5.5 + 10 + 3.25
    assert costs(preparation)['(robot_at leia problem)', ('(battery_full leia)',)] == 10.0


def test_a_duration_that_is_not_given_where_it_is_needed_is_named() -> None:
    domain = DOMAIN.replace('(/ (distance ?r1 ?r2) (speed ?r))', '(distance ?r1 ?r2)')
    task = read_task(domain, PROBLEM.replace('( = ( distance problem at ) 3.2500000000 )', ''))

    with pytest.raises(InputError) as refused:
        robot_plan(task, TIMED_PLAN)

    assert str(refused.value) == (
        'plan: the problem gives no value for (distance problem at), which the plan needs'
    )


@pytest.mark.parametrize(
    'effect',
    [
        '(and (when (at start (connected ?ro problem)) (at start (battery_full ?r))) '
        '(at end (start ?ro)))',
        '(and (when (at end (connected ?ro problem)) (at end (battery_full ?r))) '
        '(at start (start ?ro)))',
    ],
    ids=['at start', 'at end'],
)
def test_conditional_effects_of_durative_actions_are_taken_into_account(
    prepared: Explainer, effect: str
) -> None:
    domain = DOMAIN.replace('(at end (battery_full ?r))', effect).replace(
        '(:predicates', '(:constants Problem - room)\n(:predicates'
    )
    problem = PROBLEM.replace('Kitchen Problem at', 'Kitchen at')

    assert prepared(read_task(domain, problem), None, USER_MODEL).model.plan.cost == 32.0
    unconnected = problem.replace('( connected kitchen problem )', '')
    with pytest.raises(PlanningError, match="the robot's own goal cannot be reached"):
        prepared(read_task(domain, unconnected), None, USER_MODEL)


TWO_ROBOTS = PROBLEM.replace('Leia - robot', 'Leia Luke - robot').replace(
    '( robot_at leia Kitchen )',
    '(robot_at leia kitchen) (robot_at luke kitchen) (battery_full luke) (= (speed luke) 1)',
)


def test_actions_at_the_same_time_are_taken_in_the_order_in_which_they_begin() -> None:
    task = read_task(DOMAIN, TWO_ROBOTS)
    plan = (
        '0: (charge leia kitchen) [5.5]\n'
        '5.6: (move leia kitchen at) [28]\n'
        '1: (move luke kitchen at) [14]'
    )

    actions = robot_plan(task, plan).plan.actions

    assert actions == (
        '(charge leia kitchen)',
        '(move luke kitchen at)',
        '(move leia kitchen at)',
    )


def test_a_plan_that_works_only_because_actions_overlap_is_carried_out_as_it_is() -> None:
    # Luke may leave while Leia looks after the charging point, and not before or after.
    domain = DOMAIN.replace('(at start(connected ?r1 ?r2))', '(at start (start ?r1))').replace(
        '(at end (battery_full ?r))',
        '(and (at start (start ?ro)) (at end (battery_full ?r)) (at end (not (start ?ro))))',
    )
    problem = TWO_ROBOTS.replace(':init', ':init (start at)').replace(
        '( robot_at leia AT )', '(robot_at luke at)'
    )
    task = read_task(domain, problem)
    charge = '0: (charge leia kitchen) [5.5]\n'

    run = check_plan(task, read_plan(charge + '1: (move luke kitchen at) [14]'))

    assert task.may_need_overlap
    assert run.cost == 5.5 + 14
    assert run.happenings == (
        Happening(0, ends=False),
        Happening(1, ends=False),
        Happening(0, starts=False),
        Happening(1, starts=False),
    )
    luke = [
        [fact for fact in state.facts if fact.startswith('(robot_at luke')]
        for state in (*run.passed, *run.states)
    ]
    there, here = ['(robot_at luke at)'], ['(robot_at luke kitchen)']
    assert luke == [here, here, [], [], there, here, here, there]
    assert run.positions == (0, 1)
    with pytest.raises(InputError) as refused:
        check_plan(task, read_plan(charge + '5.5: (move luke kitchen at) [14]'))
    assert str(refused.value) == (
        'plan, line 2: (move luke kitchen at) cannot be carried out as step 2 of 2: '
        '(start kitchen) does not hold'
    )


def test_what_an_action_needs_all_the_while_is_looked_at_until_it_ends() -> None:
    task = read_task(FUSES, FUSE_PROBLEM)

    assert check_plan(task, read_plan('0: (light-match) [8]\n0: (mend-fuse) [5]')).cost == 13
    assert check_plan(task, read_plan('0: (light-match) [8]\n3: (mend-fuse) [5]')).cost == 13
    for late, lacks in {
        '3.1': '(light) does not hold while it goes on',
        '8': '(light) does not hold while it goes on',
    }.items():
        with pytest.raises(InputError) as refused:
            check_plan(task, read_plan(f'0: (light-match) [8]\n{late}: (mend-fuse) [5]'))
        assert str(refused.value) == (
            f'plan, line 2: (mend-fuse) cannot be carried out as step 2 of 2: {lacks}'
        )


def test_what_an_action_needs_at_its_end_is_looked_at_then() -> None:
    needs = '(and (at start (light)) (at end (not (light))))'
    task = read_task(FUSES.replace('(over all (light))', needs), FUSE_PROBLEM)

    assert check_plan(task, read_plan('0: (light-match) [8]\n4: (mend-fuse) [5]')).cost == 13
    with pytest.raises(InputError, match=r'step 2 of 2: \(light\) holds when it ends$'):
        check_plan(task, read_plan('0: (light-match) [8]\n2: (mend-fuse) [5]'))


def test_actions_overlap_by_their_times_only_where_that_works() -> None:
    task = read_task(DOMAIN, PROBLEM)
    hasty = TIMED_PLAN.replace('5.501:', '5.4:')  # it would leave before it is charged

    run = check_plan(task, read_plan(hasty))

    assert [happening.step for happening in run.happenings] == [0, 0, 1, 1, 2, 2]
    assert run.positions == (0, 1, 2)
    assert run.states == run.passed[::2]


def test_a_plan_without_times_is_carried_out_one_action_after_another() -> None:
    untimed = '(charge leia kitchen)\n(move leia kitchen problem)\n(move leia problem at)'

    run = check_plan(read_task(DOMAIN, PROBLEM), read_plan(untimed))

    at = [[f for f in state.facts if f.startswith('(robot_at')] for state in run.passed]
    kitchen, problem, there = (
        [f'(robot_at leia {room})'] for room in ('kitchen', 'problem', 'at')
    )
    assert at == [kitchen, kitchen, kitchen, [], problem, [], there]


REFUSED_DOMAINS = {
    'a duration that divides by nothing': (
        ('(= ?duration 5.5)', '(= ?duration (/ 5 0))'),
        'domain, line 25: "charge" takes a time that divides by zero',
    ),
    'a duration that must be longer than it may': (
        ('(= ?duration 5.5)', '(and (>= ?duration 6) (<= ?duration 5))'),
        'domain, line 25: "charge" must take longer than it may',
    ),
    'a duration below zero': (
        ('(= ?duration 5.5)', '(= ?duration -1)'),
        'domain, line 25: "charge" takes a time below zero',
    ),
    'an unknown predicate': (
        ('(at start (charging_point_at ?ro))', '(at start (charging_piont_at ?ro))'),
        'domain, line 26: (charging_piont_at ?ro): the domain has no predicate',
    ),
}


@pytest.mark.parametrize(('change', 'said'), REFUSED_DOMAINS.values(), ids=REFUSED_DOMAINS)
def test_what_cannot_be_compiled_is_refused_by_name_and_line(
    change: tuple[str, str], said: str
) -> None:
    assert change[0] in DOMAIN
    with pytest.raises(InputError) as refused:
        read_task(DOMAIN.replace(*change), PROBLEM)

    assert str(refused.value).startswith(said)


@pytest.mark.parametrize(
    ('change', 'said'),
    [
        (
            ('( speed leia ) 0.5', '( speed leia ) 0'),
            'domain, line 15: "move" takes a time that divides by zero',
        ),
        (
            ('( speed leia ) 0.5', '( speed leia ) ( speed leia ) 0.5'),
            'problem, line 16: "(= (speed leia) (speed leia) 0.5000000000)" is no fact that',
        ),
        (('( connected kitchen at )', '(conected kitchen at)'), 'problem, line 11: (conected'),
    ],
)
def test_a_problem_that_cannot_be_compiled_is_refused_by_name_and_line(
    change: tuple[str, str], said: str
) -> None:
    assert change[0] in PROBLEM
    with pytest.raises(InputError) as refused:
        read_task(DOMAIN, PROBLEM.replace(*change))

    assert str(refused.value).startswith(said)


LEFT_OUT = {
    'a duration inequality': (
        ('(= ?duration 5.5)', '(and (>= ?duration 5.5) (<= ?duration 9))'),
        'domain, line 25: durations that are left open count with the least that they can be',
    ),
    'a continuous effect': (
        (
            '(at end (battery_full ?r))',
            '(and (at end (battery_full ?r)) (decrease (speed ?r) #t))',
        ),
        'domain, line 27: effects that go on all the while (#t), and conditions on what they',
    ),
    'a duration that changes': (
        (
            '(at end (battery_full ?r))',
            '(and (at end (battery_full ?r)) (at end (increase (speed ?r) ?duration)))',
        ),
        'domain, line 15: durations that change as the plan runs count with what they are at fir',
    ),
    'a process': (
        ('(:durative-action CHARGE', '(:process rain :parameters ())\n(:durative-action CHARGE'),
        'domain, line 23: what happens by itself, (:process …) and (:event …), is left out; what',
    ),
}


@pytest.mark.parametrize(('change', 'said'), LEFT_OUT.values(), ids=LEFT_OUT)
def test_what_cannot_be_planned_with_is_left_out_with_one_warning(
    change: tuple[str, str], said: str
) -> None:
    assert change[0] in DOMAIN

    task = read_task(DOMAIN.replace(*change), PROBLEM)

    [warning] = task.warnings
    assert warning.startswith(said)
    assert robot_plan(task, '(charge leia kitchen)\n(move leia kitchen at)').plan.cost == 33.5
    assert task.loses_plans == ('unforeseen' in warning)


def test_a_timed_fact_is_left_out_with_a_warning() -> None:
    timed = PROBLEM.replace('( connected kitchen at )', '(at 5.5 (not (connected kitchen at)))')

    task = read_task(DOMAIN, timed)

    assert [warning[:52] for warning in task.warnings] == [
        'problem, line 11: what comes true by itself at a tim'
    ]
    assert task.relaxed


def test_what_must_hold_after_the_start_may_be_any_condition_on_what_it_changes() -> None:
    either = '(over all (or (robot_at ?r ?r1) (battery_full ?r)))'
    task = read_task(DOMAIN.replace('(over all(battery_full ?r))', either), PROBLEM)

    # It leaves at the start, so that only the battery helps.
    assert robot_plan(task, '(charge leia kitchen)\n(move leia kitchen at)').plan.cost == 33.5
    with Planner() as planner:
        space = BeliefSpace(task.domain, task.problem, (task.goal_text,), ('(battery_full leia)',))
        empty, full = planner.plan(
            space, [Belief(0), Belief(0, frozenset(space.uncertain_facts))]
        ).results
    assert (empty.plans[0].cost, full.plans[0].cost) == (32.0, 26.5)


def test_an_effect_for_all_objects_is_one_for_each() -> None:
    for_all = '(forall (?x - robot) (at end (when (robot_at ?x ?ro) (battery_full ?x))))'
    task = read_task(DOMAIN.replace('(at end (battery_full ?r))', for_all), TWO_ROBOTS)

    plan = '(charge leia kitchen)\n(move luke kitchen at)\n(move leia kitchen at)'

    assert robot_plan(task, plan).plan.cost == 5.5 + 28 + 14


FUSES = """\
(define (domain fuses)
  (:requirements :durative-actions)
  (:predicates (light) (mended) (unused))
  (:durative-action light-match :parameters ()
    :duration (= ?duration 8) :condition (at start (unused))
    :effect (and (at start (light)) (at start (not (unused))) (at end (not (light)))))
  (:durative-action mend-fuse :parameters ()
    :duration (= ?duration 5) :condition (over all (light)) :effect (at end (mended))))
"""
FUSE_PROBLEM = '(define (problem f) (:domain fuses) (:init (unused)) (:goal (mended)))'


@pytest.mark.parametrize(
    ('domain', 'may'),
    [
        (FUSES, True),
        (FUSES.replace('(at end (not (light)))', ''), False),
        (FUSES.replace('(over all (light))', '(over all (not (light)))'), False),
        (FUSES.replace('(over all (light))', '(over all (not (unused)))'), False),
        # The match must be held until the fuse is mended, and cannot be lit afterwards.
        (
            FUSES.replace('(at end (not (light)))', '').replace(
                ':condition (at start (unused))',
                ':condition (and (at start (unused)) (at end (mended)))',
            ),
            True,
        ),
        (DOMAIN, False),
    ],
)
def test_a_task_says_whether_its_actions_may_have_to_overlap(domain: str, may: bool) -> None:
    problem = PROBLEM if domain == DOMAIN else FUSE_PROBLEM

    assert read_task(domain, problem).may_need_overlap == may


def test_a_compiled_action_does_what_the_durative_one_does_when_alone() -> None:
    random, compared = Random(7), 0
    for _ in range(40):
        start_conditions, later, at_start, at_end = (
            [random_literal(random) for _ in range(random.randint(0, 2))] for _ in range(4)
        )
        domain = f"""
        (define (domain d) (:requirements :adl :durative-actions)
          (:predicates (q ?x) (p))
          (:durative-action act :parameters (?x ?y) :duration (= ?duration 1)
            :condition (and {timed('at start', start_conditions)} {timed('over all', later)})
            :effect (and (at end (p)) {timed('at start', at_start)} {timed('at end', at_end)})))
        """
        problem = '(define (problem x) (:domain d) (:objects a b c) (:init (q c)) (:goal (and)))'
        model = read_task(domain, problem).model
        atoms = {item: fluent_expression(model, f'(q {item})') for item in 'ab'}
        for held in [set(), {'a'}, {'b'}, {'a', 'b'}]:
            for item, atom in atoms.items():
                model.set_initial_value(atom, item in held)
            simulator = UPSequentialSimulator(model)
            for x, y in itertools.product('ab', repeat=2):
                named = {'?x': x, '?y': y}
                expected = alone(held, named, start_conditions, later, at_start, at_end)
                if expected == 'left out':
                    continue
                objects = (model.object(x), model.object(y))
                try:
                    after = simulator.apply(
                        simulator.get_initial_state(), model.action('act'), objects
                    )
                except UPInvalidActionError:  # its conditions contradict each other
                    after = None
                found = (
                    None
                    if after is None
                    else {item for item, atom in atoms.items() if after.get_value(atom).is_true()}
                )
                assert found == expected, f'{domain} from {held} with {x} {y}'
                compared += 1
    assert compared > 300


def random_literal(random: Random) -> tuple[str, bool]:
    return random.choice(['?x', '?y']), random.random() < 0.5


def timed(when: str, literals: list[tuple[str, bool]]) -> str:
    return ' '.join(
        f'({when} {ground_text("q", [name]) if value else f"(not (q {name}))"})'
        for name, value in literals
    )


def alone(held, named, start_conditions, later, at_start, at_end) -> set[str] | str | None:
    """Return what holds after the action, None if it cannot be carried out.

    Left out are actions that contradict themselves: what they add and delete at
    the same moment is told apart by nobody. And one that, given the same object
    twice, has opposite effects at both ends need not be there.
    """

    def holds(state, literals):
        return all((named[name] in state) == value for name, value in literals)

    def applied(state, effects):
        added = {named[name] for name, value in effects if value}
        return state - {named[name] for name, value in effects if not value} | added

    for effects in (at_start, at_end):
        values = {(named[name], value) for name, value in effects}
        if len({item for item, _ in values}) < len(values):
            return 'left out'
    if named['?x'] == named['?y'] and (at_start or later):
        raised = {value for _, value in at_start}
        if True in raised and (False in {v for _, v in at_end} or True in {v for _, v in later}):
            return 'left out'
        if False in raised and False in {v for _, v in later}:
            return 'left out'
    middle = applied(held, at_start)
    if not holds(held, start_conditions) or not holds(middle, later):
        return None
    return applied(middle, at_end)
