"""What planning finds for beliefs, through real engines in real processes."""

from collections.abc import Iterator
from dataclasses import replace

import pytest
from kstar import needs_kstar
from pddl_cases import (
    TOOLS,
    TOOLS_DOMAIN,
    TOOLS_PROBLEM,
    TOOLS_SHARP,
    WAREHOUSE_DOMAIN,
    WAREHOUSE_PROBLEM,
)

from mirror_explainer.errors import InputError, PlanningError
from mirror_explainer.explainer import robot_plan
from mirror_explainer.pddl import read_task
from mirror_explainer.planning import Belief, BeliefPlans, BeliefSpace, Plan, Planner, Status


@pytest.fixture(scope='module', params=[True, False], ids=['grounded once', 'one by one'])
def planner(request: pytest.FixtureRequest) -> Iterator[Planner]:
    """Let tests plan in both ways, with time for a machine that is busy with other tests."""
    with Planner(workers=1, shortcuts=request.param, planning_timeout=60.0) as planner:
        yield planner


def never_planned(comment: str) -> BeliefSpace:
    """Return the workshop's beliefs as a space that no other test has asked about."""
    return replace(TOOLS, domain=f'{TOOLS.domain}; {comment}\n')


def test_costs_are_in_the_metric_and_actions_in_canonical_text(planner: Planner) -> None:
    report = planner.plan(TOOLS, [Belief(0), Belief(0, TOOLS_SHARP)])

    slow, fast = report.results
    assert slow.plans == (Plan(('(cut-slowly)', '(polish)'), 7 + 1),)
    assert fast.plans == (Plan(('(cut-fast)', '(polish)'), 2 + 1),)


def test_without_a_metric_the_cost_is_the_number_of_actions(planner: Planner) -> None:
    space = BeliefSpace(
        WAREHOUSE_DOMAIN,
        WAREHOUSE_PROBLEM,
        ('(AND (Holding RED_CIRCLE) (outside bottom_door))',),
        ('(charged)',),
    )
    report = planner.plan(space, [Belief(0, frozenset(['(charged)'])), Belief(0)])

    charged, flat = (result.plans[0] for result in report.results)
    # center, doors, red room, grab, doors, right, exit; a recharge at the center on the way
    assert charged.cost == len(charged.actions) == 7
    assert charged.actions[-1] == '(exit bottom_door right)'
    assert flat.cost == len(flat.actions) == 8
    assert '(recharge center)' in flat.actions


def test_no_plan_is_told_apart_from_a_goal_that_holds_already(planner: Planner) -> None:
    space = BeliefSpace(TOOLS_DOMAIN, TOOLS_PROBLEM, ('(lost)', '(raw)', '(and (raw) (cut))'))
    report = planner.plan(space, [Belief(0), Belief(1), Belief(2)])

    lost, raw, both = report.results
    assert lost.status is Status.UNSOLVABLE and lost.plans == ()
    assert raw.plans == (Plan((), 0),)
    assert both.status is Status.UNSOLVABLE


def test_a_satisficing_engine_does_not_claim_optimal_plans() -> None:
    with Planner('fast-downward') as planner:
        report = planner.plan(TOOLS, [Belief(0, TOOLS_SHARP)])

    assert report.results[0].status is Status.SOLVED
    assert not report.results[0].plans[0].optimal


def test_pyperplan_plans_without_fast_downward() -> None:
    space = BeliefSpace(
        WAREHOUSE_DOMAIN,
        WAREHOUSE_PROBLEM,
        ('(holding red_cube)', '(holding blue_cube)'),
        ('(item-at red_cube red_room)',),
    )
    with Planner('pyperplan-opt') as planner:
        report = planner.plan(space, [Belief(0), Belief(1)])

    gone, found = report.results
    assert gone.status is not Status.SOLVED
    assert found.plans[0].actions[-1] == '(grab blue_cube blue_room)'
    # center, doors, blue room, grab
    assert found.plans[0].cost == 4
    assert found.plans[0].optimal


def test_asking_again_costs_no_planner_call(planner: Planner) -> None:
    space = never_planned('asked again')
    first = planner.plan(space, [Belief(0), Belief(0, TOOLS_SHARP)])
    again = planner.plan(space, [Belief(0, TOOLS_SHARP), Belief(0)])

    assert first.planner_calls > 0
    assert again.planner_calls == 0
    assert again.results == first.results[::-1]


def test_a_changed_problem_is_planned_anew(planner: Planner) -> None:
    changed = BeliefSpace(
        TOOLS_DOMAIN, TOOLS_PROBLEM.replace('(raw)', '(cut)'), TOOLS.goals, TOOLS.uncertain_facts
    )
    planner.plan(TOOLS, [Belief(0)])
    report = planner.plan(changed, [Belief(0)])

    assert report.results[0].plans == (Plan(('(polish)',), 1),)


def test_each_result_is_told_as_it_is_found_and_known_ones_at_once(planner: Planner) -> None:
    space = never_planned('for each belief')
    beliefs = [Belief(0), Belief(0, TOOLS_SHARP), Belief(1)]
    told: list[tuple[Belief, BeliefPlans]] = []

    def found(belief: Belief, result: BeliefPlans) -> None:
        told.append((belief, result))

    first = planner.plan(space, beliefs, found=found)
    assert dict(told) == dict(zip(beliefs, first.results, strict=True))
    assert len(told) == 3

    told.clear()
    planner.plan(space, [Belief(1, TOOLS_SHARP), Belief(1)], found=found)
    assert [belief for belief, _ in told] == [Belief(1), Belief(1, TOOLS_SHARP)]


@needs_kstar
def test_the_first_belief_comes_first_then_goals_as_asked_and_all_before_further_plans() -> None:
    space = BeliefSpace(
        WAREHOUSE_DOMAIN,
        WAREHOUSE_PROBLEM,
        ('(holding red_cube)', '(holding blue_cube)', '(or (charged) (robot-at center))'),
        ('(charged)',),
    )
    charged = frozenset(['(charged)'])
    beliefs = [Belief(2), *(Belief(g, f) for g in (1, 0, 2) for f in (frozenset(), charged))]
    told: list[Belief] = []
    cuts: dict[Belief, list[str]] = {}

    def found(belief: Belief, result: BeliefPlans) -> None:
        told.append(belief)
        cuts.setdefault(belief, []).append(result.cut)

    with Planner(workers=1) as planner:
        planner.plan(space, beliefs, plans_per_belief=300, found=found)

    first = list(dict.fromkeys(told))
    assert first == told[: len(first)]
    assert first[0] == Belief(2)
    goals = [belief.goal for belief in first[1:]]
    assert goals.index(1) < goals.index(0)
    # one plan, which is all there are; then the others of a goal that has several
    assert all(each in (['time', ''], ['']) for each in cuts.values())
    assert sum(each == ['time', ''] for each in cuts.values()) >= 4


def test_after_a_space_that_is_refused_the_one_before_is_planned_for_again(
    planner: Planner,
) -> None:
    space = never_planned('before a refusal')
    planner.plan(space, [Belief(0)])
    with pytest.raises(InputError):
        planner.plan(replace(space, goals=('(no-such-predicate)',)), [Belief(0)])

    [result] = planner.plan(space, [Belief(0, TOOLS_SHARP)]).results

    assert result.plans[0].cost == 2 + 1


def test_an_unknown_engine_is_named_together_with_the_installed_ones() -> None:
    with Planner('slow-upward') as planner, pytest.raises(PlanningError) as caught:
        planner.plan(TOOLS, [Belief(0)])

    assert 'slow-upward' in str(caught.value)
    assert 'pyperplan' in str(caught.value)


def test_what_an_engine_does_not_support_is_named() -> None:
    with Planner('pyperplan') as planner, pytest.raises(PlanningError, match='actions cost'):
        planner.plan(TOOLS, [Belief(0)])


def test_an_unreadable_problem_is_an_input_error(planner: Planner) -> None:
    space = BeliefSpace(TOOLS_DOMAIN, '(define (problem', ('(polished)',))
    with pytest.raises(InputError):
        planner.plan(space, [Belief(0)])


def test_a_belief_outside_the_space_is_refused(planner: Planner) -> None:
    with pytest.raises(ValueError, match='no goal 5'):
        planner.plan(TOOLS, [Belief(5)])
    with pytest.raises(ValueError, match='not uncertain'):
        planner.plan(TOOLS, [Belief(0, frozenset(['(raw)']))])


def test_a_step_of_the_robot_keeps_the_grounding() -> None:
    space = BeliefSpace(
        WAREHOUSE_DOMAIN,
        WAREHOUSE_PROBLEM,
        ('(holding red_circle)', '(outside bottom_door)'),
        ('(charged)',),
    )
    at_center = WAREHOUSE_PROBLEM.replace('(robot-at left)', '(robot-at center)')
    moved_station = WAREHOUSE_PROBLEM.replace('(station-at center)', '(station-at left)')
    stepped, moved = replace(space, problem=at_center), replace(space, problem=moved_station)
    beliefs = [Belief(0), Belief(1), Belief(1, frozenset(['(charged)']))]
    with Planner('fast-downward-opt') as planner:
        ways = [planner.plan(each, beliefs) for each in (space, stepped, moved, space)]

    assert [report.way for report in ways] == [
        'grounded once',
        'grounding kept',
        'grounded once',
        'grounded once',
    ]
    # center, doors, red room, grab; recharge, right, exit on the way
    assert [result.plans[0].cost for result in ways[0].results] == [4, 4, 3]
    assert [result.plans[0].cost for result in ways[1].results] == [3, 3, 2]
    # the station is at the left corridor, where the robot is
    assert [result.plans[0].cost for result in ways[2].results] == [4, 4, 3]


def test_decimal_costs_are_exact() -> None:
    domain = TOOLS_DOMAIN.replace('(total-cost) 2)', '(total-cost) 0.1)')
    domain = domain.replace('(total-cost) 1)', '(total-cost) 0.25)')
    space = BeliefSpace(domain, TOOLS_PROBLEM, TOOLS.goals, TOOLS.uncertain_facts)
    with Planner('fast-downward-opt') as planner:
        report = planner.plan(space, [Belief(0, TOOLS_SHARP)])

    assert report.results[0].plans == (Plan(('(cut-fast)', '(polish)'), 0.35),)


def test_only_numbers_that_actions_cost_count() -> None:
    # A battery level, as measured, that no action needs: negative, too many digits, or both.
    domain = TOOLS_DOMAIN.replace('(total-cost) - number', '(total-cost) (level) (speed) - number')
    problem = TOOLS_PROBLEM.replace('(raw)', '(raw) (= (level) 0.123456789) (= (speed) -1.5)')
    unasked = problem.replace('(:metric minimize (total-cost))', '')
    with Planner('fast-downward-opt') as planner:
        reports = [
            planner.plan(
                BeliefSpace(changed, text, TOOLS.goals, TOOLS.uncertain_facts),
                [Belief(0, TOOLS_SHARP)],
            )
            for changed, text in (
                (domain, problem),
                (domain.replace('2)', '0.000123456789)'), unasked),
                (domain.replace('1)', '0.5)'), unasked),
            )
        ]

    # where no metric asks for costs, the last two are the same to the planner
    assert [report.way for report in reports] == ['grounded once'] * 2 + ['grounding kept']
    # cut-fast and polish: 2 + 1; without a metric, two actions
    assert [report.results[0].plans[0].cost for report in reports] == [3, 2, 2]


def test_conditional_effects_are_planned_for_one_belief_at_a_time() -> None:
    domain = TOOLS_DOMAIN.replace('(and (polished)', '(and (when (saw-sharp) (lost)) (polished)')
    space = BeliefSpace(domain, TOOLS_PROBLEM, TOOLS.goals, TOOLS.uncertain_facts)
    with Planner('fast-downward-opt') as planner:
        report = planner.plan(space, [Belief(1), Belief(1, TOOLS_SHARP)])

    assert 'conditional effects' in report.way
    assert report.results[0].status is Status.UNSOLVABLE
    assert report.results[1].plans == (Plan(('(cut-fast)', '(polish)'), 3),)


def test_goals_of_every_shape_are_planned_for() -> None:
    space = BeliefSpace(
        WAREHOUSE_DOMAIN,
        WAREHOUSE_PROBLEM,
        (
            '(or (outside top_left_door) (holding red_cube))',
            '(not (robot-at left))',
            '(exists (?i - item) (holding ?i))',
            '(forall (?d - door) (not (outside ?d)))',
            '(imply (charged) (outside top_left_door))',
        ),
        ('(charged)',),
    )
    beliefs = [Belief(goal, frozenset(['(charged)'])) for goal in range(5)]
    with Planner('fast-downward-opt') as planner:
        report = planner.plan(space, beliefs)

    # exit; move; center, doors, a room, grab; nothing; exit
    assert [result.plans[0].cost for result in report.results] == [1, 1, 4, 0, 1]


def test_a_goal_for_all_objects_takes_no_plans_from_the_others() -> None:
    goals = ('(holding red_cube)', '(outside bottom_door)', '(forall (?i - item) (holding ?i))')
    with Planner('fast-downward-opt') as planner:
        found = [
            planner.plan(
                BeliefSpace(WAREHOUSE_DOMAIN, WAREHOUSE_PROBLEM, named, ()),
                [Belief(goal) for goal in range(len(named))],
                plans_per_belief=300,
            )
            for named in (goals[:2], goals)
        ]

    assert [report.way for report in found] == ['grounded once'] * 2
    assert found[1].results[:2] == found[0].results


def tour(domain: list[tuple[str, str]], problem: list[tuple[str, str]] | None = None):
    """Return a robot's domain and problem with some pieces replaced."""
    texts = [TOUR_DOMAIN, TOUR_PROBLEM]
    for index, changes in enumerate([domain, problem or []]):
        for old, new in changes:
            assert old in texts[index]
            texts[index] = texts[index].replace(old, new)
    return texts


TOUR_DOMAIN = """
(define (domain tour)
  (:requirements :adl :typing :action-costs)
  (:types room robot)
  (:constants hall - room)
  (:predicates (at ?r - room) (door ?x ?y - room) (locked ?y - room) (key) (seen ?t - room))
  (:functions (total-cost))
  (:action go :parameters (?x ?y - room)
    :precondition (and (at ?x) (door ?x ?y) (not (locked ?y)))
    :effect (and (at ?y) (not (at ?x)) (increase (total-cost) 2)))
  (:action unlock :parameters (?y - room)
    :precondition (and (at hall) (key))
    :effect (and (not (locked ?y)) (increase (total-cost) 1)))
  (:action look :parameters (?x - room)
    :precondition (at ?x)
    :effect (and (seen ?x) (increase (total-cost) 1))))
"""
TOUR_PROBLEM = """
(define (problem museum) (:domain tour)
  (:objects gallery cellar - room)
  (:init (at hall) (door hall gallery) (door gallery cellar) (door hall cellar)
         (locked cellar) (= (total-cost) 0))
  (:goal (at gallery))
  (:metric minimize (total-cost)))
"""
NO_METRIC = ('(:metric minimize (total-cost))', '')
COSTS_FROM_A_FUNCTION = (
    [
        ('(total-cost))\n', '(total-cost) - number (far ?x ?y - room) - number)\n'),
        ('(total-cost) 2)', '(total-cost) (far ?x ?y))'),
    ],
    [('(= (total', '(= (far hall cellar) 4.5) (= (far hall gallery) 1) (= (total')],
)
FEATURES = {
    # What is changed in domain and problem; the cost of seeing the cellar without and with a key.
    'constants and negative conditions': (tour([]), None, 4.0),
    'conditional effects': (
        tour([(':effect (and (seen ?x)', ':effect (and (when (not (locked ?x)) (seen ?x))')]),
        None,
        4.0,
    ),
    'disjunctions and quantifiers': (
        tour(
            [
                ('(not (locked ?y)))', '(or (not (locked ?y)) (key)))'),
                (':precondition (at ?x)', ':precondition (exists (?z - room) (and (at ?x)))'),
            ]
        ),
        None,
        3.0,
    ),
    'decimal costs': (tour([('(total-cost) 2)', '(total-cost) 0.125)')]), None, 2.125),
    'costs from a function': (tour(*COSTS_FROM_A_FUNCTION), None, 6.5),
    'no metric': (tour([], [NO_METRIC]), None, 3.0),
    'costs from a function that no metric asks for': (
        tour(COSTS_FROM_A_FUNCTION[0], [*COSTS_FROM_A_FUNCTION[1], NO_METRIC]),
        None,
        3.0,
    ),
    'a cost so far that no metric asks for': (
        tour([], [('(= (total-cost) 0)', '(= (total-cost) 0.5)'), NO_METRIC]),
        None,
        3.0,
    ),
    'total time without durations': (
        tour([], [('(total-cost)))', '(total-time)))')]),
        None,
        3.0,
    ),
    'one of several types in a predicate': (
        tour(
            [('(seen ?t - room)', '(seen ?t - (either room\n robot))')],
            [('- room', '- room r2 - robot'), ('(locked', '(seen r2) (locked')],
        ),
        None,
        4.0,
    ),
}


@pytest.mark.parametrize(('texts', 'without', 'with_key'), FEATURES.values(), ids=FEATURES)
def test_what_robots_send_is_planned_for(
    texts: list[str], without: float | None, with_key: float
) -> None:
    task = read_task(*texts)
    space = BeliefSpace(task.domain, task.problem, ('(seen cellar)',), ('(key)',))

    with Planner() as planner:
        results = planner.plan(space, [Belief(0), Belief(0, frozenset(['(key)']))]).results

    costs = [result.plans[0].cost if result.plans else None for result in results]
    assert costs == [without, with_key]
    assert results[0].status is Status.UNSOLVABLE
    plan = '\n'.join(results[1].plans[0].actions)
    held = read_task(
        task.domain, task.problem.replace(':init', ':init (key)').replace('(at gallery)', '(and)')
    )
    assert robot_plan(held, plan).plan.cost == with_key
