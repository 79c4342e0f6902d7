"""Plans put together from pieces of others are optimal, as an exhaustive search says."""

import heapq
import itertools
import socket
from random import Random

from hypothesis import given, settings
from hypothesis import strategies as st

from mirror_explainer.planning import Belief, BeliefSpace, Planner
from mirror_explainer.planning.downward.ground_task import Fact, GroundTask, Operator, State
from mirror_explainer.planning.downward.grounding import translator
from mirror_explainer.planning.downward.independent_parts import independent_parts
from mirror_explainer.planning.downward.pieced_plans import PiecedPlans
from mirror_explainer.planning.downward.program import find_downward
from mirror_explainer.planning.downward.searches import Searches
from mirror_explainer.planning.downward.superset_walk import SupersetWalk
from mirror_explainer.planning.messages import Ask

PATIENCE = 60.0  # s: far more than anything takes
VARIABLES = 6
STATES = list(itertools.product((0, 1), repeat=VARIABLES))

# Two saws, each with one thing to cut: what is known of the one says nothing of the other.
SAWS_DOMAIN = """
(define (domain saws)
  (:requirements :strips :action-costs)
  (:predicates (power) (sharp-a) (sharp-b) (cut-a) (cut-b))
  (:functions (total-cost))
  (:action cut-a-fast :parameters () :precondition (and (power) (sharp-a))
    :effect (and (cut-a) (increase (total-cost) 2)))
  (:action cut-a-slowly :parameters () :precondition (power)
    :effect (and (cut-a) (increase (total-cost) 7)))
  (:action cut-b-fast :parameters () :precondition (and (power) (sharp-b))
    :effect (and (cut-b) (increase (total-cost) 3)))
  (:action cut-b-slowly :parameters () :precondition (power)
    :effect (and (cut-b) (increase (total-cost) 9))))
"""
SAWS_PROBLEM = """
(define (problem both) (:domain saws)
  (:init (power) (= (total-cost) 0)) (:goal (and)) (:metric minimize (total-cost)))
"""


def random_operators(random: Random) -> tuple[Operator, ...]:
    """Return operators that change few variables, and sometimes read one that none changes."""
    return tuple(
        Operator(
            name=f'(act{number})',
            condition=random_facts(random, random.randint(0, 2)),
            effect=random_facts(random, random.randint(1, 2)),
            cost=random.randint(0, 3),
            text='',
        )
        for number in range(random.randint(2, 6))
    )


def random_facts(random: Random, count: int) -> tuple[Fact, ...]:
    return tuple((v, random.randint(0, 1)) for v in random.sample(range(VARIABLES), count))


def cheapest(task: GroundTask, start: State, goal: tuple[Fact, ...]) -> tuple[str, ...] | None:
    """Return an optimal plan, found by looking at every state (Dijkstra), None if none is."""
    waiting: list[tuple[int, tuple[str, ...], State]] = [(0, (), start)]
    done: set[State] = set()
    while waiting:
        cost, plan, state = heapq.heappop(waiting)
        if all(state[variable] == value for variable, value in goal):
            return plan
        if state in done:
            continue
        done.add(state)
        for operator in task.operators:
            if all(state[variable] == value for variable, value in operator.condition):
                values = list(state)
                for variable, value in operator.effect:
                    values[variable] = value
                then = (cost + operator.cost, (*plan, operator.name), tuple(values))
                heapq.heappush(waiting, then)
    return None


@settings(max_examples=150, derandomize=True, deadline=None, database=None)
@given(seed=st.integers(0, 2**32))
def test_a_plan_of_known_pieces_is_as_cheap_as_any(seed: int) -> None:
    random = Random(seed)
    task = GroundTask(random_operators(random), '', '')
    goal = tuple(sorted(random_facts(random, random.randint(1, 4))))
    pieced = PiecedPlans(task)
    for state in random.sample(STATES, 12):
        found = cheapest(task, state, goal)
        if found is not None:
            pieced.learn(state, goal, found)

    for state in STATES:
        plan, expected = pieced.plan(state, goal), cheapest(task, state, goal)
        # Where no operator can change that a goal's fact is false, nobody asks for a plan.
        if plan is not None and expected is not None:
            assert task.leads(plan, state, goal)
            assert task.cost(plan) == task.cost(expected)


def test_operators_are_apart_unless_one_changes_what_another_reads_or_changes() -> None:
    reads_only_what_stays = Operator('(a)', ((9, 0), (0, 0)), ((0, 1),), 1, '')
    reads_it_too = Operator('(b)', ((9, 0),), ((1, 1),), 1, '')
    reads_what_b_changes = Operator('(c)', ((1, 1),), ((2, 1),), 1, '')

    parts = independent_parts([reads_only_what_stays, reads_it_too, reads_what_b_changes])

    assert parts == [[reads_only_what_stays], [reads_it_too, reads_what_b_changes]]


def test_what_two_searches_found_apart_is_not_searched_for_together() -> None:
    goal = '(and (cut-a) (cut-b))'
    space = BeliefSpace(SAWS_DOMAIN, SAWS_PROBLEM, (goal,), ('(sharp-a)', '(sharp-b)'))
    sharp = [['(sharp-a)', '(sharp-b)'], ['(sharp-b)'], ['(sharp-a)'], []]

    beliefs = tuple(Belief(0, frozenset(facts)) for facts in sharp)
    # In this process, where a search that a busy machine holds up is not begun anew.
    lists = translator.parse(space)
    grounding = translator.ground(lists)
    walk = SupersetWalk(grounding, translator.initial_atoms(lists), beliefs, lists.scale, False)
    walk.first_try = PATIENCE
    ask = Ask(space, beliefs, 1, find_downward(''), 2, PATIENCE, 1024, PATIENCE)
    found = {}
    searches = Searches(
        ask, lambda members, attempt: found.update(dict.fromkeys(members, attempt.result))
    )

    nobody, silent = socket.socketpair()
    with nobody, silent:
        assert searches.run([walk], nobody.fileno(), lambda: False)

    costs = [found[belief].plans[0].cost for belief in beliefs]
    assert costs == [2 + 3, 7 + 3, 2 + 9, 7 + 9]
    assert searches.calls == 3  # both sharp, and either one blunt


def test_a_shared_fact_that_nothing_changes_tells_pieces_apart() -> None:
    goal = '(and (cut-a) (cut-b))'
    space = BeliefSpace(SAWS_DOMAIN, SAWS_PROBLEM, (goal,), ('(power)', '(sharp-a)'))

    with Planner() as planner:
        report = planner.plan(space, [Belief(0, frozenset(['(power)'])), Belief(0)])

    powered, dark = report.results
    assert powered.plans[0].cost == 7 + 9
    assert not dark.plans
