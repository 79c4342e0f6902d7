"""Derived predicates, from the texts to plans, against brute force and plain Fast Downward."""

import itertools
import re
from collections.abc import Iterator
from pathlib import Path
from random import Random

import pytest
from derived_cases import (
    ATOMS,
    DERIVED,
    OBJECTS,
    Referee,
    State,
    holds,
    random_derived_space,
    words,
)
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from plain_downward import cost_of, plain_costs, problem_of

from mirror_explainer.errors import InputError, PlanningError
from mirror_explainer.experiments.planning.cases import every_belief
from mirror_explainer.explainer import robot_plan
from mirror_explainer.listener.preparation import prepare, refine
from mirror_explainer.listener.user_model import read_user_model
from mirror_explainer.pddl import Task, read_task
from mirror_explainer.pddl.derived.facts import DerivedFacts
from mirror_explainer.planning import Belief, BeliefSpace, Planner

DOMAIN = """
(define (domain Reach)
  (:requirements :typing :derived-predicates)
  (:types room item - object)
  (:constants Dock - room)
  (:predicates (robot-at ?r - room) (door ?a ?b - room) (open ?a ?b - room)
               (in ?i - item ?r - room) (held ?i - item)
               (Reachable ?r - room) (stuck))
  (:derived (REACHABLE ?r - room)
    (or (robot-at ?r) (exists (?s - room) (and (reachable ?s) (open ?s ?r)))))
  (:derived (stuck) (not (reachable Dock)))
  (:action grab
    :parameters (?i - item ?r - room)
    :precondition (and (in ?i ?r) (reachable ?r))
    :effect (and (held ?i) (not (in ?i ?r))))
  (:action unlock
    :parameters (?a ?b - room)
    :precondition (and (door ?a ?b) (reachable ?a))
    :effect (and (open ?a ?b) (open ?b ?a)))
  (:action go-home
    :parameters ()
    :precondition (not (stuck))
    :effect (and (forall (?r - room) (when (not (= ?r dock)) (not (robot-at ?r))))
                 (robot-at dock))))
"""
PROBLEM = """
(define (problem fetch)
  (:domain reach)
  (:objects hall Cellar - room cup - item)
  (:init (robot-at hall) (door hall cellar) (door hall dock) (in cup cellar))
  (:goal (and (held cup) (reachable dock))))
"""
PLAN = '(unlock hall cellar)\n(grab cup cellar)\n(unlock hall dock)\n'


@pytest.fixture(scope='module')
def planner() -> Iterator[Planner]:
    with Planner('fast-downward-opt', planning_timeout=60.0) as planner:
        yield planner


@pytest.fixture(scope='module')
def fetch() -> Task:
    return read_task(DOMAIN, PROBLEM)


@settings(
    max_examples=15,
    derandomize=True,
    deadline=None,
    suppress_health_check=list(HealthCheck),
    database=None,
)
@given(seed=st.integers(0, 2**32))
def test_what_holds_by_random_axioms_is_what_brute_force_finds(seed: int) -> None:
    random = Random(seed)
    space = random_derived_space(random)
    task = read_task(space.domain, f'{space.problem[: space.problem.index("(:goal")]}(:goal '
        '(and (near a b) (busy a) (calm) (wide a))))')  # fmt: skip
    assert task.axioms is not None
    derived = [
        (name, *terms)
        for name, arity in DERIVED.items()
        for terms in itertools.product(OBJECTS, repeat=arity)
    ]
    facts = DerivedFacts(task.axioms)
    for _ in range(10):
        atoms = frozenset(random.sample(ATOMS, random.randint(0, len(ATOMS) // 2)))

        found = {fact for fact in derived if facts.hold(f'({" ".join(fact)})', atoms)}

        given_facts = frozenset(tuple(atom[1:-1].split()) for atom in atoms)
        assert found == Referee(space.domain).closed(given_facts) - given_facts


@settings(
    max_examples=6,
    derandomize=True,
    deadline=None,
    suppress_health_check=list(HealthCheck),
    database=None,
)
@given(seed=st.integers(0, 2**32))
def test_random_derived_beliefs_agree_with_plain_fast_downward_and_with_brute_force(
    planner: Planner, seed: int
) -> None:
    random = Random(seed)
    space = random_derived_space(random)
    beliefs = random.sample(every_belief(space), 4)

    report = planner.plan(space, beliefs)

    assert [cost_of(result) for result in report.results] == plain_costs(
        space, beliefs, 'astar(blind())'
    )
    for belief, result in zip(beliefs, report.results, strict=True):
        task = read_task(space.domain, problem_of(space, belief))
        names = [part[1] for part in words(space.domain) if part[0] == ':action']
        plans = [list(plan.actions) for plan in result.plans] or [[]]
        for plan in [*plans, *(mutated(plans[0], names, random) for _ in range(6))]:
            judgement = judged(task, plan)
            assert judgement == by_brute_force(task, plan), (space, plan)
            if plan is plans[0] and result.plans:
                assert judgement == result.plans[0].cost


def mutated(plan: list[str], names: list[str], random: Random) -> list[str]:
    """Return the plan with a step left out, put in or changed."""
    step = f'({random.choice(names)} {random.choice(list(OBJECTS))})'
    if 'go ' in step:
        step = f'(go {random.choice("ab")} {random.choice("ab")})'
    place = random.randint(0, len(plan))
    return [*plan[:place], *random.choice([[], [step]]), *plan[place + random.randint(0, 1) :]]


def judged(task: Task, plan: list[str]) -> float | str:
    """Return the plan's cost, or where it fails: a step from 1, "goal", "type"."""
    try:
        return robot_plan(task, '\n'.join(plan)).plan.cost
    except InputError as error:
        at = re.search(r'as step (\d+)', error.reason)
        return at[1] if at else 'type' if 'is of type' in error.reason else 'goal'


def by_brute_force(task: Task, plan: list[str]) -> float | str:
    """Return the same, found by trying every object for every variable."""
    referee, cost = Referee(task.domain), 0.0
    actions = {part[1]: part for part in words(task.domain) if part[0] == ':action'}
    steps = [tuple(step[1:-1].split()) for step in plan]
    for name, *objects in steps:
        kind = actions[name][3][-1]
        if any(kind not in ('object', OBJECTS[item]) for item in objects):
            return 'type'
    state: State | None = frozenset(tuple(fact[1:-1].split()) for fact in task.initial_facts)
    for number, step in enumerate(steps, start=1):
        assert state is not None
        state = referee.after(state, step)
        if state is None:
            return str(number)
        costs = [part[2] for part in actions[step[0]][-1] if part[0] == 'increase']
        cost += float(costs[0]) if ':metric' in task.problem else 1.0
    assert state is not None
    reached = holds(words(task.goal_text), {}, referee.closed(state))
    return cost if reached else 'goal'


def test_a_plan_is_checked_with_the_derived_facts_of_every_state(fetch: Task) -> None:
    assert robot_plan(fetch, PLAN).plan.cost == 3.0

    home = read_task(DOMAIN, PROBLEM.replace('(and (held cup) (reachable dock))', '(stuck)'))
    assert robot_plan(home, '; the dock cannot be reached: that is the goal\n').plan.cost == 0.0


FAILURES = {
    '(grab cup cellar)': '(grab cup cellar) cannot be carried out as step 1 of 1: '
    '(reachable cellar) does not hold',
    '(go-home)': '(go-home) cannot be carried out as step 1 of 1: (stuck) holds',
    '(unlock hall cellar)\n(grab cup cellar)': 'the plan does not reach the goal: '
    '(reachable dock) does not hold',
    '(unlock hall dock)\n(go-home)\n(grab cup cellar)': '(grab cup cellar) cannot be carried out '
    'as step 3 of 3: (reachable cellar) does not hold',
}


@pytest.mark.parametrize('plan', FAILURES)
def test_a_failing_plan_is_told_by_its_first_lacking_condition(fetch: Task, plan: str) -> None:
    with pytest.raises(InputError) as refused:
        robot_plan(fetch, plan)

    assert refused.value.reason == FAILURES[plan]


def test_beliefs_with_derived_goals_are_explained(
    fetch: Task, planner: Planner, tmp_path: Path
) -> None:
    file = tmp_path / 'user.yaml'
    file.write_text("""
    goals:
      - {name: cup, goal: (held cup)}
      - {name: cup and way home, goal: (and (held cup) (reachable dock))}
      - name: being locked in
        goal: (forall (?r - room) (imply (reachable ?r) (= ?r hall)))
    uncertain_facts:
      - {fact: (open hall cellar), probability: 0.5}
    """)
    user_model = read_user_model(file, fetch)

    preparation = refine(prepare(fetch, robot_plan(fetch, PLAN), user_model), planner)

    assert preparation.model.complete
    plans = {
        (hypothesis.goal, tuple(hypothesis.belief.true_facts)): hypothesis.plan.cost
        for hypothesis in preparation.model.hypotheses
        if hypothesis.belief and hypothesis.plan
    }
    # With an open door nobody is locked in, and no action closes one: that has no plan.
    open_door = ('(open hall cellar)',)
    assert plans == {
        (0, ()): 2.0,
        (0, open_door): 1.0,
        (1, ()): 3.0,
        (1, open_door): 2.0,
        (2, ()): 0.0,
    }


def test_facts_that_are_derived_cannot_be_uncertain(fetch: Task, tmp_path: Path) -> None:
    file = tmp_path / 'user.yaml'
    file.write_text(
        'goals: [{goal: (held cup)}]\n'
        'uncertain_facts: [{fact: (Reachable hall), probability: 0.5}]\n'
        'one_of: [facts: {(stuck): 1, (held cup): 1}]\n'
    )

    with pytest.raises(InputError) as refused:
        read_user_model(file, fetch)

    said = 'is derived from other facts: name those that are uncertain'
    assert f'line 2: uncertain_facts[0].fact: (Reachable hall) {said}' in refused.value.reason
    assert f'line 3: one_of[0].facts.(stuck): (stuck) {said}' in refused.value.reason


@pytest.mark.parametrize('engine', ['pyperplan', 'fast-downward'])
def test_an_engine_of_unified_planning_refuses_derived_predicates_in_words(
    engine: str, fetch: Task
) -> None:
    space = BeliefSpace(fetch.domain, fetch.problem, ('(held cup)',))

    with Planner(engine, workers=1) as other, pytest.raises(PlanningError) as refused:
        other.plan(space, [Belief(0)])

    assert str(refused.value) == (
        f'the planning engine "{engine}" does not support derived predicates (:derived): '
        'unified-planning has none'
    )
    assert refused.value.cure.startswith('Name fast-downward-opt as the planner')


FAULTS = {
    'undeclared': ('(:derived (stuck)', '(:derived (lost) (held cup))\n  (:derived (stuck)',
        'domain, line 10: the derived predicate "lost" is not declared in :predicates'),
    'arity': ('(:derived (stuck)', '(:derived (stuck ?x - room)', 'domain, line 10: '
        'the derived predicate "stuck" is declared with 0 arguments, not 1'),
    'a constant as argument': ('(REACHABLE ?r - room)', '(reachable dock)', 'domain, line 8: '
        '"dock" stands where a variable is expected, such as ?x'),
    'another type': ('(REACHABLE ?r - room)', '(REACHABLE ?r - item)', 'domain, line 8: '
        'the derived predicate "reachable" is declared with a room, not a item, as ?r'),
    'an unknown type': ('?r - room)\n    (or', '?r - rom)\n    (or', 'domain, line 8: '
        'the domain has no type "rom" (did you mean "room"?)'),
    'an unknown name': ('(robot-at ?r) (exists', '(robot-on ?r) (exists', 'domain, line 8: '
        '(robot-on ?r): the domain has no predicate "robot-on" (did you mean "robot-at"?)'),
    'no condition': ('(:derived (stuck) (not (reachable Dock)))', '(:derived (stuck))',
        'domain, line 10: (:derived …) takes a predicate with its variables, and one condition'),
    'nested too deeply': ('(not (reachable Dock))', '(not ' * 200 + '(held cup)' + ')' * 200,
        'domain, line 10: the text is nested too deeply: more than 40 parentheses in each other'),
    'its own negation': ('(robot-at ?r) (exists', '(not (stuck)) (exists', 'domain, line 8: '
        'derived predicates depend on their own negation, or on (forall …) about themselves: '
        '"reachable", "stuck"'),
    'an effect': (':effect (and (held ?i)', ':effect (and (stuck)', 'domain, line 14: '
        '"stuck" is derived, but the action "grab" changes it'),
}  # fmt: skip


@pytest.mark.parametrize('name', FAULTS)
def test_what_is_wrong_with_a_derived_predicate_is_told_with_its_line(name: str) -> None:
    before, after, said = FAULTS[name]
    assert before in DOMAIN

    with pytest.raises(InputError) as refused:
        read_task(DOMAIN.replace(before, after, 1).strip(), PROBLEM)

    assert str(refused.value) == said


def test_an_initial_fact_that_is_derived_is_refused_with_its_line() -> None:
    with pytest.raises(InputError) as refused:
        read_task(DOMAIN, PROBLEM.replace('(in cup cellar)', '\n(reachable dock)').strip())

    assert str(refused.value) == (
        'problem, line 5: "reachable" is derived, so it cannot be among the initial facts'
    )
    assert read_task(DOMAIN, PROBLEM.replace('(in cup cellar)', '(not (stuck))')).axioms


def test_derived_facts_that_take_too_long_are_refused_in_words() -> None:
    many = ' '.join(f'r{number}' for number in range(60))
    variables = '?a ?b ?c ?d ?e ?f - room'
    domain = DOMAIN.replace('(stuck))\n', f'(stuck) (all {variables}))\n', 1).replace(
        '(:action grab', f'(:derived (all {variables}) (not (stuck)))\n  (:action grab'
    )
    problem = PROBLEM.replace('hall Cellar', f'hall Cellar {many}')
    goal = '(reachable dock) (all dock dock dock dock dock dock)'
    task = read_task(domain, problem.replace('(reachable dock)', goal))

    with pytest.raises(InputError, match='derived predicates hold of too many objects') as refused:
        robot_plan(task, '(unlock hall dock)\n(go-home)')

    assert refused.value.source == 'domain'


DURATIVE = DOMAIN.replace(':derived-predicates', ':derived-predicates :durative-actions').replace(
    """(:action grab
    :parameters (?i - item ?r - room)
    :precondition (and (in ?i ?r) (reachable ?r))
    :effect (and (held ?i) (not (in ?i ?r))))""",
    """(:durative-action grab
    :parameters (?i - item ?r - room)
    :duration (= ?duration 2.5)
    :condition (and (at start (in ?i ?r)) (over all (reachable ?r)))
    :effect (and (at start (not (in ?i ?r))) (at end (held ?i))))""",
)


def test_derived_conditions_of_durative_actions_count_when_they_begin(planner: Planner) -> None:
    task = read_task(DURATIVE, PROBLEM)

    cost = robot_plan(task, '0: (unlock hall cellar)\n0.1: (grab cup cellar) [2.5]\n'
        '3: (unlock hall dock)').plan.cost  # fmt: skip
    space = BeliefSpace(task.domain, task.problem, ('(held cup)',), ('(open hall cellar)',))
    report = planner.plan(space, [Belief(0), Belief(0, frozenset(space.uncertain_facts))])

    assert cost == 2.5
    assert [(r.plans[0].cost, len(r.plans[0].actions)) for r in report.results] == [
        (2.5, 2),
        (2.5, 1),
    ]
    with pytest.raises(InputError, match=r'\(reachable cellar\) does not hold'):
        robot_plan(task, '0: (grab cup cellar) [2.5]')


@pytest.mark.parametrize(
    'condition', ['(over all (stuck))', '(at end (forall (?q - room) (stuck)))']
)
def test_a_durative_action_that_changes_what_it_derives_its_conditions_from_loses_them(
    condition: str,
) -> None:
    domain = DURATIVE.replace('(over all (reachable ?r))', condition).replace(
        '(at start (not (in ?i ?r)))', '(at start (not (in ?i ?r))) (at start (not (robot-at ?r)))'
    )

    task = read_task(domain.strip(), PROBLEM)

    [warning] = task.warnings
    assert warning.startswith(
        'domain, line 14: derived conditions that must hold after the start of an action'
    )
    assert task.relaxed
