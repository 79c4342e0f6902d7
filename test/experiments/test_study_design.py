"""What people see of the study, and how it is dealt to them: computed, without any page."""

import itertools
import math

import pytest

from mirror_explainer.experiments.study.design import assignment, presentation_order
from mirror_explainer.experiments.study.participants import Noise, simulate
from mirror_explainer.experiments.study.plans import plan_scenario
from mirror_explainer.experiments.study.scenarios import scenarios
from mirror_explainer.experiments.study.warehouse_floor import read_floor
from mirror_explainer.experiments.study.web_study.design import (
    PRACTICE,
    Choice,
    Design,
    Encounter,
    design,
    encounter,
    from_json,
    in_words,
    order_said,
    practice_scenario,
    to_json,
    turns,
)
from mirror_explainer.experiments.study.web_study.drawing import HEIGHT, WIDTH, drawing
from mirror_explainer.pddl import read_task
from mirror_explainer.planning import Planner
from mirror_explainer.settings import STRATEGIES


def plain(name):
    return Encounter(name, '', (Choice('goal', 'words'),), 'goal', ('sentence',), {})


DESIGN = Design(7, 12, 'domain', plain(PRACTICE), tuple(plain(f's{i}') for i in range(12)), {})


@pytest.fixture(scope='module')
def floor():
    return read_floor()


@pytest.fixture(scope='module')
def planned(floor):
    [drawn] = scenarios(floor, 1, 3)
    with Planner() as planner:
        return plan_scenario(drawn, planner)


# Who meets what


def test_each_person_hears_each_strategy_in_a_third_of_the_scenarios():
    for number in range(9):
        first, *others = turns(DESIGN, number)
        assert first[0] == PRACTICE
        heard = [strategy for _, strategy in others]
        assert [heard.count(strategy) for strategy in STRATEGIES] == [4, 4, 4]
        assert sorted(scenario for scenario, _ in others) == sorted(f's{i}' for i in range(12))


def test_each_three_people_in_turn_hear_every_strategy_on_every_scenario():
    for three in ([0, 1, 2], [3, 4, 5], [6, 7, 8]):
        dealt = [dict(turns(DESIGN, number)) for number in three]
        for scenario in (f's{i}' for i in range(12)):
            assert {row[scenario] for row in dealt} == set(STRATEGIES)


def test_the_order_is_random_and_follows_from_seed_and_number():
    orders = [presentation_order(12, number, 7) for number in range(50)]

    assert all(sorted(order) == list(range(12)) for order in orders)
    assert len(set(orders)) == 50
    assert presentation_order(12, 3, 7) == orders[3] != presentation_order(12, 3, 8)
    assert {order[0] for order in orders} == set(range(12))


@pytest.mark.parametrize('seed', range(20))
def test_the_practice_is_none_of_the_scenarios(floor, seed):
    practice = practice_scenario(floor)
    alike = [
        drawn
        for drawn in scenarios(floor, 12, seed)
        if (drawn.items, drawn.start, drawn.charged, drawn.goals[drawn.goal])
        == (practice.items, practice.start, practice.charged, practice.goals[practice.goal])
    ]

    assert alike == []


# What they read


def test_a_goal_is_told_in_words(floor):
    [drawn] = scenarios(floor, 1, 0)
    goal = drawn.goals[0]
    first, second = (item.replace('_', ' ') for item in goal.items)

    door = goal.door.replace('_', ' ')
    assert in_words(goal) == f'It fetches the {first} and the {second}, and leaves by the {door}.'


def test_what_is_said_next_is_what_a_step_adds():
    assert order_said([(4,), (1, 4), (1, 3, 4)]) == (4, 1, 3)


def test_an_encounter_has_what_the_simulated_participants_hear(planned):
    drawn = planned.scenario

    met = encounter(planned)

    assert met.sentences == planned.model.sentences
    assert met.orders['increasing'] == tuple(range(met.steps))
    assert met.orders['decreasing'] == tuple(reversed(range(met.steps)))
    assert sorted(met.orders['informative']) == list(range(met.steps))
    assert [choice.name for choice in met.choices] == [drawn.goals[i].name for i in drawn.shown]
    assert met.goal in [choice.name for choice in met.choices]


def test_a_design_has_the_hit_ratios_of_the_simulated_study_and_is_kept_as_it_is(planned):
    pytest.importorskip('pandas', reason='the extra [experiments] is not installed')
    from mirror_explainer.experiments.averages import PERCENTS
    from mirror_explainer.experiments.study.statistics import answer_table, curves

    made = design(3, 1, planned, [planned])

    answers = simulate([planned], 'same', assignment(10, 1, 3), Noise(), 3)
    for row in curves(answer_table(answers)).dropna(subset='hit_ratio').to_dict('records'):
        assert made.simulated[row['strategy']][row['percent']] == row['hit_ratio']
    assert set(made.simulated['informative']) <= set(PERCENTS)
    assert from_json(to_json(made)) == made


# What they see


def test_the_picture_shows_all_of_the_initial_state_and_nothing_of_the_goal(floor):
    for drawn in scenarios(floor, 12, 0):
        task = read_task(floor.domain, drawn.problem)
        shown = drawing(task)

        assert {item.label for item in shown.items} == {
            name.replace('_', ' ') for name in drawn.all_items
        }
        assert {door.label for door in shown.doors} == {
            'top left door', 'top right door', 'bottom door',
        }  # fmt: skip
        assert shown.charged == drawn.charged
        other = drawn.problem.replace(drawn.goals[drawn.goal].pddl, drawn.goals[0].pddl)
        assert drawing(read_task(floor.domain, other)) == shown


def test_nothing_is_drawn_over_anything_else(floor):
    for drawn in scenarios(floor, 12, 1):
        shown = drawing(read_task(floor.domain, drawn.problem))
        rooms = {place.label.split()[0]: place for place in shown.places if place.room}
        for item in shown.items:
            room = rooms[item.colour]
            assert room.left < item.x - 28 < item.x + 28 < room.left + room.width
            assert room.top + 30 < item.y - 26 < item.y + 66 < room.top + room.height
        for one, other in itertools.combinations(shown.items, 2):
            assert math.dist((one.x, one.y), (other.x, other.y)) >= 70
        for one, other in itertools.combinations(shown.places, 2):
            apart_x = abs(one.x - other.x) >= (one.width + other.width) / 2
            apart_y = abs(one.y - other.y) >= (one.height + other.height) / 2
            assert apart_x or apart_y
        for point in (*shown.doors, *shown.items, shown.robot, shown.station):
            assert 0 < point.x < WIDTH
            assert 0 < point.y < HEIGHT


def test_the_picture_is_told_in_words_as_well(floor, warehouse):
    problem = (warehouse / 'problem.pddl').read_text()
    shown = drawing(read_task(floor.domain, problem.replace('(charged)', '', 1)))

    assert shown.words[:5] == (
        'The robot is in the left corridor.',
        "The robot's battery is empty: it must recharge.",
        'The recharge station is in the central corridor.',
        'In the blue warehouse: a blue circle and a blue cube.',
        'In the red warehouse: a red circle, a red cube and a red triangle.',
    )
    assert 'The bottom door is reached from the right corridor.' in shown.words
    assert "A way joins the central corridor and the warehouses' doors." in shown.words
    assert len(shown.words) == 5 + 3 + 6


def test_another_map_is_drawn_on_a_ring(floor):
    problem = """
        (define (problem other) (:domain warehouse)
          (:objects hall cellar attic - place box_1 - item hatch - door)
          (:init (robot-at hall) (connected hall cellar) (connected cellar hall)
                 (item-at box_1 cellar) (door-at hatch hall))
          (:goal (holding box_1)))"""

    shown = drawing(read_task(floor.domain, problem))

    assert [(place.label, place.room) for place in shown.places] == [
        ('hall', False), ('cellar', True), ('attic', False),
    ]  # fmt: skip
    [item] = shown.items
    assert (item.label, item.shape, item.colour) == ('box 1', '', '')
    assert shown.station is None
    assert len(shown.ways) == 2
    assert len({(place.x, place.y) for place in shown.places}) == 3
