"""What people see of the study, and how it is dealt to them: computed, without any page."""

import itertools
import math
from collections import Counter
from dataclasses import replace
from string import Formatter

import pytest

from mirror_explainer.experiments.study.design import (
    BASELINES,
    SPOKEN_TO,
    assignment,
    presentation_order,
    strategies_for,
    verbalizations,
)
from mirror_explainer.experiments.study.participants import Noise, simulate
from mirror_explainer.experiments.study.plans import plan_scenario
from mirror_explainer.experiments.study.scenarios import scenarios
from mirror_explainer.experiments.study.warehouse_floor import read_floor
from mirror_explainer.experiments.study.web_study.design import (
    ATTENTION,
    PRACTICE,
    Choice,
    Design,
    Encounter,
    attention_trial,
    design,
    encounter,
    from_json,
    order_said,
    practice_scenario,
    to_json,
    turns,
)
from mirror_explainer.experiments.study.web_study.drawing import HEIGHT, WIDTH, drawing
from mirror_explainer.experiments.study.web_study.texts import LANGUAGES, words
from mirror_explainer.pddl import read_task
from mirror_explainer.planning import Planner
from mirror_explainer.settings import STRATEGIES


def plain(name):
    choices = tuple(Choice(f'goal {i}') for i in range(3))
    return Encounter(name, '', choices, 'goal 0', ('sentence',), {'increasing': (0,)})


DESIGN = Design(7, 12, 'domain', plain(PRACTICE), tuple(plain(f's{i}') for i in range(12)))


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
        assert first.scenario == PRACTICE
        heard = [turn.strategy for turn in others]
        assert [heard.count(strategy) for strategy in STRATEGIES] == [4, 4, 4]
        assert sorted(turn.scenario for turn in others) == sorted(f's{i}' for i in range(12))


def test_each_three_people_in_turn_hear_every_strategy_on_every_scenario_and_the_practice():
    for three in ([0, 1, 2], [3, 4, 5], [6, 7, 8]):
        dealt = [{t.scenario: t.strategy for t in turns(DESIGN, number)} for number in three]
        for scenario in (PRACTICE, *(f's{i}' for i in range(12))):
            assert {row[scenario] for row in dealt} == set(STRATEGIES)


def test_with_both_listeners_the_informative_words_for_each_are_dealt_like_the_baselines():
    design = replace(DESIGN, listeners=('planner', 'open'))
    assert set(design.strategies) == {'informative', 'informative-open', *BASELINES}
    for number in range(8):
        heard = Counter(turn.strategy for turn in turns(design, number)[1:])
        assert heard == dict.fromkeys(design.strategies, 3)
    for four in ([0, 1, 2, 3], [4, 5, 6, 7]):
        dealt = [{t.scenario: t.strategy for t in turns(design, number)} for number in four]
        for scenario in (PRACTICE, *(f's{i}' for i in range(12))):
            assert {row[scenario] for row in dealt} == set(design.strategies)


def test_the_right_choice_is_at_each_place_for_everybody_sooner_or_later():
    first = Counter(t.choices.index(0) for number in range(60) for t in turns(DESIGN, number))

    assert turns(DESIGN, 3) == turns(DESIGN, 3)
    assert sum(first.values()) == 60 * 13
    assert all(200 < first[place] < 320 for place in range(3))  # 260 on average
    for number in range(60):
        assert len({turn.choices for turn in turns(DESIGN, number)}) >= 3


def test_attention_trials_part_the_study_evenly_and_tell_the_goal(floor):
    trials = tuple(map(attention_trial, scenarios(floor, 2, 5)))
    with_trials = replace(DESIGN, attention=trials)

    met = [turn.scenario for turn in turns(with_trials, 0)]
    assert [met.index(trial.name) for trial in trials] == [5, 10]
    assert [turn for turn in turns(with_trials, 0) if turn.strategy != ATTENTION][1:] != []
    for trial in trials:
        assert trial.goal in trial.sentences[0]
        for language in LANGUAGES:
            said = words(language).said(trial.actions[0], trial.sentences[0])
            assert all(part.split()[-1] in said for part in _parts(trial, words(language)))


def _parts(trial, said):
    return [said.objects.get(name, said.thing(name)) for name in trial.true_choice.things]


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


def test_what_is_said_next_is_what_a_step_adds():
    assert order_said([(4,), (1, 4), (1, 3, 4)]) == (4, 1, 3)


def test_an_encounter_has_what_the_simulated_participants_hear(planned):
    drawn = planned.scenario

    met = encounter(planned, STRATEGIES)

    assert met.sentences == planned.model.sentences
    for order in met.orders.values():
        said = [met.sentences[position] for position in order]
        assert sorted(said) == sorted(set(met.sentences))
        assert len(said) == met.steps
    assert list(met.orders['increasing']) == sorted(met.orders['increasing'])
    assert met.orders['decreasing'][0] == len(met.sentences) - 1
    assert [choice.name for choice in met.choices] == [drawn.goals[i].name for i in drawn.shown]
    assert met.goal in [choice.name for choice in met.choices]


def test_words_for_an_open_listener_are_of_the_same_plan_and_the_baselines_are_nobodys(planned):
    met = encounter(planned, strategies_for(['open', 'planner']))

    assert list(met.orders) == ['informative', 'informative-open', *BASELINES]
    assert sorted(met.orders['informative-open']) == sorted(met.orders['informative'])
    for listener in SPOKEN_TO.values():
        model = planned.mirror_model(planned.scenario.user_model, listener=listener)
        for strategy in BASELINES:
            assert order_said(verbalizations(model, strategy)) == met.orders[strategy]


def test_a_design_says_how_soon_simulated_listeners_are_sure_and_is_kept_as_it_is(planned):
    pytest.importorskip('pandas', reason='the extra [experiments] is not installed')
    from mirror_explainer.experiments.study.statistics import answer_table, earliest_steps

    made = design(3, 1, planned, [planned])

    answers = simulate([planned], 'same', assignment(10, 1, 3), Noise(), 3)
    found = earliest_steps(answer_table(answers)).groupby('strategy')['settled'].mean()
    assert made.sure_after == dict(found)
    assert from_json(to_json(made)) == made


def test_every_catalogue_has_the_same_texts_with_the_same_places_to_put_something_in():
    english = words('en')
    fields = {key: _places(text) for key, text in english.texts.items()}

    assert set(LANGUAGES) == {'de', 'en'}
    for language in LANGUAGES:
        other = words(language)
        assert {key: _places(text) for key, text in other.texts.items()} == fields
        assert [(len(c.options), c.right) for c in other.checks] == [
            (len(c.options), c.right) for c in english.checks
        ]


def _places(text):
    return {field for _, field, _, _ in Formatter().parse(text) if field}


def test_every_sentence_and_name_of_a_scenario_is_said_in_german(planned):
    german, met = words('de'), encounter(planned, STRATEGIES)

    said = [german.said(a, s) for a, s in zip(met.actions, met.sentences, strict=True)]
    assert all(sentence.startswith('Ich ') and '{' not in sentence for sentence in said)
    assert len(set(said)) == len(set(met.sentences))
    for choice in met.choices:
        assert all(name in german.things for name in choice.things)


# What they see


def test_the_picture_shows_all_of_the_initial_state_and_nothing_of_the_goal(floor):
    for drawn in scenarios(floor, 12, 0):
        task = read_task(floor.domain, drawn.problem)
        shown = drawing(task, words('en'))

        assert {item.label for item in shown.items} == {
            name.replace('_', ' ') for name in drawn.all_items
        }
        assert {door.label for door in shown.doors} == {
            'top left door', 'top right door', 'bottom door',
        }  # fmt: skip
        assert shown.charged == drawn.charged
        other = drawn.problem.replace(drawn.goals[drawn.goal].pddl, drawn.goals[0].pddl)
        assert drawing(read_task(floor.domain, other), words('en')) == shown


def test_nothing_is_drawn_over_anything_else(floor):
    for drawn in scenarios(floor, 12, 1):
        shown = drawing(read_task(floor.domain, drawn.problem), words('en'))
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
    shown = drawing(read_task(floor.domain, problem.replace('(charged)', '', 1)), words('en'))

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

    shown = drawing(read_task(floor.domain, problem), words('en'))

    assert [(place.label, place.room) for place in shown.places] == [
        ('hall', False), ('cellar', True), ('attic', False),
    ]  # fmt: skip
    [item] = shown.items
    assert (item.label, item.shape, item.colour) == ('box 1', '', '')
    assert shown.station is None
    assert len(shown.ways) == 2
    assert len({(place.x, place.y) for place in shown.places}) == 3
