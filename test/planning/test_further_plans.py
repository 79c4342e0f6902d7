"""All optimal plans of a belief, up to their order: beside an exhaustive enumeration."""

import itertools
import math
import re
import threading
import time
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from heapq import heappop, heappush
from pathlib import Path
from random import Random

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from kstar import needs_kstar
from patience import eventually
from pddl_cases import gripper, random_space
from processes import child_sessions, searches_of

from mirror_explainer import pddl
from mirror_explainer.errors import Cancelled
from mirror_explainer.experiments.planning.cases import every_belief
from mirror_explainer.experiments.planning.robots import robots
from mirror_explainer.planning import Belief, BeliefPlans, BeliefSpace, Planner, Status
from mirror_explainer.planning.downward.program import find_downward

pytestmark = needs_kstar

MANY = 3000
MOST_STATES = 800

ERRANDS_DOMAIN = """
(define (domain errands)
  (:requirements :typing :action-costs)
  (:types place way)
  (:predicates (open ?w - way) (at-home) (done ?p - place) (rested))
  (:functions (total-cost) - number)
  (:action run
    :parameters (?p - place ?w - way)
    :precondition (open ?w)
    :effect (and (done ?p) (increase (total-cost) 2)))
  (:action rest
    :parameters ()
    :precondition ()
    :effect (and (rested) (increase (total-cost) 1)))
  (:action run-rested
    :parameters (?p - place)
    :precondition (rested)
    :effect (and (done ?p) (not (rested)) (increase (total-cost) 1))))
"""


def errands(places: int, ways: int) -> BeliefSpace:
    """Return a space with (ways + 1) ** places optimal plans up to order: each place apart."""
    names = [f'p{number}' for number in range(places)]
    open_ways = [f'(open w{number})' for number in range(ways)]
    problem = f"""
    (define (problem some) (:domain errands)
      (:objects {' '.join(names)} - place {' '.join(f'w{i}' for i in range(ways))} - way)
      (:init {' '.join(open_ways)} (= (total-cost) 0))
      (:goal (and))
      (:metric minimize (total-cost)))
    """
    goal = f'(and {" ".join(f"(done {name})" for name in names)})'
    return BeliefSpace(ERRANDS_DOMAIN, problem, (goal,), tuple(open_ways))


@pytest.fixture(scope='module')
def planner() -> Iterator[Planner]:
    with Planner(planning_timeout=60.0) as planner:
        yield planner


@dataclass(frozen=True)
class Act:
    """A ground action of the referee: each of `needs` is (true, false) facts that do.

    Sets of facts, and states, are numbers with a bit for each fact.
    """

    text: str
    needs: tuple[tuple[int, int], ...]
    adds: int
    deletes: int
    cost: int

    def after(self, state: int) -> int | None:
        """Return the next state, None if the action cannot be done."""
        for true, false in self.needs:
            if state & true == true and not state & false:
                return state & ~self.deletes | self.adds
        return None


Clauses = tuple[tuple[frozenset[str], frozenset[str]], ...]


def clauses(expression, names: dict[str, str], objects: Sequence[str], wanted=True) -> Clauses:
    """Return an expression, or its negation, as alternatives of (true, false) facts."""
    if expression.is_not():
        return clauses(expression.arg(0), names, objects, not wanted)
    if expression.is_fluent_exp():
        terms = [str(term) for term in expression.args]
        fact = pddl.ground_text(
            expression.fluent().name, [names.get(term, term) for term in terms]
        )
        one, none = frozenset([fact]), frozenset()
        return ((one, none),) if wanted else ((none, one),)
    if expression.is_bool_constant():
        return ((frozenset(), frozenset()),) if expression.is_true() == wanted else ()
    if expression.is_exists() or expression.is_forall():
        variables = [variable.name for variable in expression.variables()]
        parts = [
            clauses(
                expression.arg(0),
                {**names, **dict(zip(variables, chosen, strict=True))},
                objects,
                wanted,
            )
            for chosen in itertools.product(objects, repeat=len(variables))
        ]
        together = expression.is_forall() == wanted
    else:
        assert expression.is_and() or expression.is_or(), expression
        parts = [clauses(part, names, objects, wanted) for part in expression.args]
        together = expression.is_and() == wanted
    if not together:
        return tuple(itertools.chain(*parts))
    return tuple(
        (
            frozenset().union(*(true for true, _ in chosen)),
            frozenset().union(*(false for _, false in chosen)),
        )
        for chosen in itertools.product(*parts)
    )


class Referee:
    """Enumerates optimal plans of small tasks; shares no code with the planner."""

    def __init__(self, space: BeliefSpace) -> None:
        self._space = space
        task = pddl.read_task(space.domain, space.problem)
        self._model = task.model
        self._initial = task.initial_facts
        self._objects = [item.name for item in self._model.all_objects]
        self._bits: dict[str, int] = {}
        self.acts = list(self._acts())
        self._known: dict[int, list[tuple[Act, int]]] = {}

    def _acts(self) -> Iterator[Act]:
        metrics = self._model.quality_metrics
        for action in self._model.actions:
            cost = int(metrics[0].costs[action].constant_value()) if metrics else 1
            domains = [
                [item.name for item in self._model.objects(parameter.type)]
                for parameter in action.parameters
            ]
            for chosen in itertools.product(*domains):
                names = {p.name: c for p, c in zip(action.parameters, chosen, strict=True)}
                needs: Clauses = ((frozenset(), frozenset()),)
                for condition in action.preconditions:
                    needs = tuple(
                        (true | more, false | less)
                        for true, false in needs
                        for more, less in clauses(condition, names, self._objects)
                    )
                ends: dict[bool, set[str]] = {True: set(), False: set()}
                for effect in action.effects:
                    terms = [names.get(str(term), str(term)) for term in effect.fluent.args]
                    fact = pddl.ground_text(effect.fluent.fluent().name, terms)
                    ends[effect.value.is_true()].add(fact)
                yield Act(
                    pddl.ground_text(action.name, chosen),
                    tuple((self._number(true), self._number(false)) for true, false in needs),
                    self._number(ends[True]),
                    self._number(ends[False]),
                    cost,
                )

    def _number(self, facts: Iterable[str]) -> int:
        return sum(self._bits.setdefault(fact, 1 << len(self._bits)) for fact in {*facts})

    def state(self, belief: Belief) -> int:
        certain = self._initial - frozenset(self._space.uncertain_facts)
        return self._number(certain | belief.true_facts)

    def goal(self, belief: Belief) -> Act:
        """Return an action that can be done where the goal holds."""
        expression = pddl.goal_expression(self._model, self._space.goals[belief.goal])
        needs = clauses(expression, {}, self._objects)
        numbers = tuple((self._number(true), self._number(false)) for true, false in needs)
        return Act('goal', numbers, 0, 0, 0)

    def reaches(self, belief: Belief, plan: Sequence[str]) -> bool:
        """Say whether a plan can be carried out and ends in the goal."""
        named = {act.text: act for act in self.acts}
        state: int | None = self.state(belief)
        for action in plan:
            state = named[action].after(state) if state is not None else None
        return state is not None and self.goal(belief).after(state) is not None

    def following(self, state: int) -> list[tuple[Act, int]]:
        """Return what can be done in a state, and the state after it: the same in all beliefs."""
        if state not in self._known:
            after = ((act, act.after(state)) for act in self.acts)
            self._known[state] = [(act, there) for act, there in after if there is not None]
        return self._known[state]

    def optimal(self, belief: Belief, free_too: bool) -> tuple[int, set[tuple[str, ...]]] | None:
        """Return the optimal cost and plans, each as its sorted actions; None for too many.

        With `free_too` the shortest of the cheapest, otherwise only those without
        free actions. The cost is -1 where there is no plan.
        """
        unit = 1000 if free_too else 1
        goal = self.goal(belief)
        start = self.state(belief)
        least = {start: 0}
        before: dict[int, list[tuple[str, int]]] = defaultdict(list)
        order = itertools.count()
        waiting = [(0, next(order), start)]
        closed: set[int] = set()
        ends: list[int] = []
        best = math.inf
        while waiting and waiting[0][0] <= best:
            spent, _, here = heappop(waiting)
            if here in closed:
                continue
            closed.add(here)
            if len(closed) > MOST_STATES:
                return None
            if goal.after(here) is not None:
                best = spent
                ends.append(here)
                continue
            for act, there in self.following(here):
                if not (free_too or act.cost):
                    continue
                then = spent + act.cost * unit + free_too
                if then < least.get(there, math.inf):
                    least[there] = then
                    before[there] = []
                    heappush(waiting, (then, next(order), there))
                if then == least[there]:
                    before[there].append((act.text, here))
        plans: dict[int, set[tuple[str, ...]]] = {start: {()}}

        def ways(state: int) -> set[tuple[str, ...]]:
            if state not in plans:
                plans[state] = {
                    tuple(sorted([*plan, text]))
                    for text, previous in before[state]
                    for plan in ways(previous)
                }
            return plans[state]

        found = set().union(*(ways(end) for end in ends)) if ends else set()
        if len(found) > MANY:
            return None
        return (int(best) // unit if ends else -1), found


def as_sets(result: BeliefPlans) -> set[tuple[str, ...]]:
    return {tuple(sorted(plan.actions)) for plan in result.plans}


def check(referee: Referee, belief: Belief, result: BeliefPlans) -> int | None:
    """Compare a belief's plans with the referee's; return how many there are, None if unknown."""
    free = any(not act.cost for act in referee.acts)
    expected = referee.optimal(belief, free_too=free)
    if expected is None:
        return None
    cost, all_plans = expected
    if cost < 0:
        assert result.status is Status.UNSOLVABLE
        return 0
    assert result.status is Status.SOLVED
    assert all(plan.optimal and plan.cost == cost for plan in result.plans)
    assert all(referee.reaches(belief, plan.actions) for plan in result.plans)
    assert len(as_sets(result)) == len(result.plans), 'a plan is given twice'
    if free and as_sets(result) != all_plans:
        # The free actions are of no use here: then a plan need not be among the shortest.
        expected = referee.optimal(belief, free_too=False)
        assert expected is not None
        cost_without, all_plans = expected
        assert cost_without == cost
    assert as_sets(result) == all_plans
    return len(result.plans)


def test_all_optimal_plans_are_found(planner: Planner) -> None:
    counts: list[int | None] = []

    @settings(
        max_examples=8,
        derandomize=True,
        deadline=None,
        suppress_health_check=list(HealthCheck),
        database=None,
    )
    @given(seed=st.integers(0, 2**32))
    def in_a_random_space(seed: int) -> None:
        random = Random(seed)
        space = random_space(random)
        # Facts that hold are those without which plans get fewer.
        holding = sorted(pddl.read_task(space.domain, space.problem).initial_facts)
        facts = dict.fromkeys([*space.uncertain_facts, *random.sample(holding, 2)])
        space = replace(space, uncertain_facts=tuple(facts))

        report = planner.plan(space, every_belief(space), plans_per_belief=MANY)

        if report.way.startswith('each belief'):
            assert all(len(result.plans) <= 1 for result in report.results)
            return
        referee = Referee(space)
        for belief, result in zip(every_belief(space), report.results, strict=True):
            if not space.goals[belief.goal].startswith('(or'):
                counts.append(check(referee, belief, result))

    in_a_random_space()

    # Else nothing much was compared.
    assert sum(count is not None and count > 1 for count in counts) >= 50


def test_plans_are_combined_where_parts_of_the_goal_are_apart(planner: Planner) -> None:
    space = errands(3, 3)
    report = planner.plan(space, every_belief(space), plans_per_belief=MANY)

    referee = Referee(space)
    for belief, result in zip(every_belief(space), report.results, strict=True):
        assert check(referee, belief, result) == (len(belief.true_facts) + 1) ** 3


# 3⁴ = 81 optimal plans, in parts, and 6! / (3! 3!) = 20, in one: which ball goes in which hand
@pytest.mark.parametrize(
    'space', [replace(errands(4, 2), uncertain_facts=()), BeliefSpace(*gripper(6)[:2], ())]
)
def test_what_objects_are_called_does_not_decide_which_plans_are_taken(
    planner: Planner, space: BeliefSpace
) -> None:
    space = replace(space, goals=space.goals or (gripper(6)[2],))
    found = re.findall(r'\b(?:[pw]\d|ball\d|here|there|left|right)\b', space.problem)
    objects = list(dict.fromkeys(found))
    names = {name: f'z{99 - number}' for number, name in enumerate(objects)}

    def other(text: str) -> str:
        return re.sub(r'[\w-]+', lambda word: names.get(word[0], word[0]), text)

    renamed = replace(space, problem=other(space.problem), goals=(other(space.goals[0]),))

    [some], [same] = (
        planner.plan(each, [Belief(0)], plans_per_belief=10).results for each in (space, renamed)
    )

    assert len(some.plans) == 10
    expected = {tuple(sorted(map(other, plan))) for plan in as_sets(some)}
    assert as_sets(same) == expected


@pytest.mark.parametrize('count', [1, 2, 7, 30])
def test_no_more_plans_than_asked(planner: Planner, count: int) -> None:
    space = errands(3, 2)
    report = planner.plan(space, every_belief(space), plans_per_belief=count)

    referee = Referee(space)
    for belief, result in zip(every_belief(space), report.results, strict=True):
        existing = (len(belief.true_facts) + 1) ** 3
        assert len(result.plans) == min(count, existing)
        assert result.cut == ('number' if count < existing and count > 1 else '')
        assert len(as_sets(result)) == len(result.plans)
        assert all(referee.reaches(belief, plan.actions) for plan in result.plans)
        assert {plan.cost for plan in result.plans} == {6.0}


def test_a_sample_of_the_plans_of_a_long_way_fits_into_memory() -> None:
    [robot] = [robot for robot in robots() if robot.name == 'map of 500 places']
    belief = Belief(1, robot.beliefs[0].true_facts)

    with Planner(memory_limit=512) as own:
        [result] = own.plan(robot.space, [belief], plans_per_belief=300).results

    assert len({tuple(sorted(plan.actions)) for plan in result.plans}) == 300


def test_the_same_plans_are_found_whichever_of_two_searches_ends_first(tmp_path: Path) -> None:
    space = errands(2, 2)
    found = []
    for late in (0, 1, 0, 1):  # every other search waits before it begins
        program = tmp_path / 'downward'
        count = tmp_path / f'count{len(found)}'
        program.write_text(
            f'#!/bin/sh\necho >> {count}\n'
            f'[ $(($(wc -l < {count}) % 2)) = {late} ] && sleep 0.15\n'
            f'exec {find_downward("")} "$@"\n'
        )
        program.chmod(0o755)
        with Planner(workers=2, downward_binary=str(program)) as planner:
            found.append(planner.plan(space, every_belief(space)).results)

    assert found == [found[0]] * 4


def test_results_are_kept_for_the_same_number_of_plans(planner: Planner) -> None:
    space = errands(2, 2)
    first = planner.plan(space, every_belief(space), plans_per_belief=5)
    again = planner.plan(space, every_belief(space), plans_per_belief=5)
    more = planner.plan(space, every_belief(space), plans_per_belief=6)

    assert first.planner_calls > 0
    assert again.planner_calls == 0
    assert again.results == first.results
    assert more.planner_calls > 0
    assert [len(result.plans) for result in more.results] == [1, 4, 4, 6]


def kstar_is(script: str, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Let another program stand in for K*."""
    program = folder / 'kstar'
    program.write_text(f'#!/bin/sh\n{script}\n')
    program.chmod(0o755)
    monkeypatch.setattr('mirror_explainer.planning.planner.find_kstar', lambda: str(program))


def test_first_plans_stay_known_when_time_ran_out_for_more(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    kstar_is('exec sleep 60', tmp_path, monkeypatch)
    with Planner() as planner:
        first, again = (
            planner.plan(
                errands(2, 0), [Belief(0)], plans_per_belief=5, deadline=deadline
            ).results[0]
            for deadline in (1.0, 0.3)
        )

    assert (first.status, len(first.plans), first.cut) == (Status.SOLVED, 1, 'time')
    assert again == first


def test_what_takes_too_long_under_more_facts_is_tried_shortly_under_fewer(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    limits = tmp_path / 'limits'
    limited = f'while [ $(ulimit -t) = unlimited ]; do :; done; ulimit -t >> {limits}'
    kstar_is(f'{limited}; while :; do :; done', tmp_path, monkeypatch)
    space = errands(1, 2)
    with Planner(planning_timeout=1.05) as planner:
        report = planner.plan(space, every_belief(space), plans_per_belief=5)

    assert {result.cut for result in report.results} == {'time'}
    # Whole seconds, and 10 s of grace: of all facts, of one fact each, of none.
    assert limits.read_text().split() == ['12', '11', '11', '11']


WRITE = 'f=$(echo "$*" | sed "s/.*json_file_to_dump=//; s/,.*//")\necho %s > $f'


@pytest.mark.parametrize(
    ('script', 'reason'),
    [
        ('exit 77', 'K* ended with code 77'),
        ('kill -9 $$', 'K* was ended by signal 9'),
        ('exit 0', 'K* gave no whole plan'),
        (WRITE % '\'{"plans": [{"actions": ["rest\'', 'K* gave no whole plan'),
        (WRITE % '\'{"plans": [{"actions": ["rest"]}]}\'', 'K* gave a wrong plan'),
        (WRITE % '\'{"plans": [{"actions": ["what"]}]}\'', 'K* gave a wrong plan'),
        ('exit 11', 'K* gave a wrong plan'),
    ],
)
def test_where_kstar_fails_each_belief_keeps_its_plan_and_it_is_tried_again(
    script: str, reason: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    kstar_is(script, tmp_path, monkeypatch)
    with Planner() as planner:
        asked = errands(1, 1), [Belief(0)]
        report = planner.plan(*asked, plans_per_belief=5)
        again = planner.plan(*asked, plans_per_belief=5)

    [result] = report.results
    assert (result.status, len(result.plans), result.cut) == (Status.SOLVED, 1, 'planner')
    assert result.reason == reason
    assert report.failed == 1
    assert again.planner_calls > 0


def test_the_deadline_leaves_one_plan_a_belief() -> None:
    domain, problem, goal = gripper(7)
    space = BeliefSpace(domain, problem, (goal, '(robot-at there)'))
    sessions = child_sessions()
    with Planner() as planner:
        mine = child_sessions() - sessions
        began = time.monotonic()
        one = planner.plan(space, every_belief(space)).results
        needed = time.monotonic() - began
        with Planner() as other:
            deadline = 3 * needed + 2.0
            report = other.plan(
                space, every_belief(space), plans_per_belief=MANY, deadline=deadline
            )
        eventually(lambda: not searches_of(mine), 'the end of the searches')
    assert [result.status for result in report.results] == [Status.SOLVED] * 2
    assert [r.plans[0].cost for r in report.results] == [r.plans[0].cost for r in one]


def test_cancelling_while_further_plans_are_searched_leaves_nothing() -> None:
    domain, problem, goal = gripper(7)
    space = BeliefSpace(domain, problem, (goal, '(robot-at there)'))
    sessions = child_sessions()
    cancelled, solved = threading.Event(), threading.Event()
    errors: list[Exception] = []

    told: set[Belief] = set()

    def found(belief: Belief, result: BeliefPlans) -> None:
        told.add(belief)
        if len(told) == 2:
            solved.set()

    def ask(planner: Planner) -> None:
        try:
            planner.plan(
                space,
                every_belief(space),
                plans_per_belief=MANY,
                cancelled=cancelled,
                found=found,
            )
        except Exception as error:
            errors.append(error)

    with Planner() as planner:
        mine = child_sessions() - sessions
        asking = threading.Thread(target=ask, args=(planner,))
        asking.start()
        assert solved.wait(60.0)
        cancelled.set()
        asking.join(60.0)
        assert [type(error) for error in errors] == [Cancelled]
        eventually(lambda: not searches_of(mine), 'the end of the searches')
        # The planner is good for more.
        [result] = planner.plan(errands(2, 1), [Belief(0)], plans_per_belief=2).results
        assert len(result.plans) == 1
    assert not child_sessions() - sessions


def test_an_action_with_several_ways_to_apply_is_one_action(planner: Planner) -> None:
    domain = """
    (define (domain ways)
      (:requirements :adl)
      (:predicates (dry) (warm) (out) (fed) (near ?x))
      (:action leave :parameters () :precondition (or (dry) (warm)) :effect (out))
      (:action feed :parameters () :precondition (exists (?x) (near ?x)) :effect (fed)))
    """
    facts = ('(dry)', '(warm)', '(near cat)', '(near dog)')
    problem = f"""
    (define (problem some) (:domain ways) (:objects cat dog)
      (:init {' '.join(facts)}) (:goal (and)))
    """
    space = BeliefSpace(domain, problem, ('(and (out) (fed))',), facts)
    report = planner.plan(space, every_belief(space), plans_per_belief=MANY)

    for belief, result in zip(every_belief(space), report.results, strict=True):
        leaves = belief.true_facts & {'(dry)', '(warm)'}
        feeds = belief.true_facts & {'(near cat)', '(near dog)'}
        assert len(result.plans) == bool(leaves and feeds)


def test_equal_actions_in_another_order_are_one_plan(planner: Planner) -> None:
    domain, problem, _ = gripper(2)
    space = BeliefSpace(domain, problem, ('(and (at ball0 there) (at ball1 there))',))
    [result] = planner.plan(space, [Belief(0)], plans_per_belief=MANY).results

    assert check(Referee(space), Belief(0), result) == 2
    assert len({frozenset(Counter(plan.actions).items()) for plan in result.plans}) == 2
