"""Entries of the user model that stand for one for each choice of objects."""

import re
from pathlib import Path

import pytest

from mirror_explainer.errors import InputError
from mirror_explainer.input_limits import InputLimits
from mirror_explainer.listener.user_model import read_user_model
from mirror_explainer.pddl import read_task

DOMAIN = """(define (domain gallery) (:requirements :strips :typing)
  (:types room thing - object painting statue - thing)
  (:predicates (in ?t - thing ?r - room) (lit ?r - room) (shown ?t - thing ?r - room))
  (:action show :parameters (?t - thing ?r - room)
    :precondition (and (in ?t ?r) (lit ?r)) :effect (shown ?t ?r)))"""
PROBLEM = """(define (problem tour) (:domain gallery)
  (:objects east west - room dawn dusk - painting faun - statue)
  (:init (in dawn east) (in dusk west) (in faun west) (lit west))
  (:goal (shown faun west)))"""


@pytest.fixture
def read(model_file):
    task = read_task(DOMAIN, PROBLEM)
    return lambda text, **how: read_user_model(model_file(text), task, **how)


def test_a_pattern_stands_for_a_goal_for_each_choice_of_objects_subtypes_included(read):
    model = read('goals: [{goal: "(shown {t} {r})", for: {t: thing, r: room}, name: "{t}, {r}"}]')
    assert [goal.name for goal in model.goals] == [
        'dawn, east', 'dawn, west', 'dusk, east', 'dusk, west', 'faun, east', 'faun, west',
    ]  # fmt: skip
    assert model.goals[3].goal == '(shown dusk west)'


def test_names_are_worded_as_the_objects_are_called_unless_two_would_sound_alike(read):
    model = read("""goals:
      - {goal: "(shown {s} {r})", for: {s: statue, r: room}, name: "{s} in {r}"}
      - {goal: "(shown {p} west)", for: {p: painting}, name: "{p}"}
objects: {east: the eastern room, dawn: the picture, dusk: the picture}""")
    names = ['faun in the eastern room', 'faun in west', 'dawn', 'dusk']
    assert [goal.name for goal in model.goals] == names


def test_a_name_that_does_not_tell_the_choices_apart_gets_what_it_lacks(read):
    model = read("""goals:
      - {goal: "(shown {p} {r})", for: {p: painting, r: room}, name: "show it in {r}"}
      - {goal: "(and (lit {a}) (lit {b}))", for: {a: room, b: room}, name: light up}
objects: {dawn: the picture, dusk: the picture}""")
    assert [goal.name for goal in model.goals] == [
        'show it in east (dawn)', 'show it in west (dawn)',
        'show it in east (dusk)', 'show it in west (dusk)',
        'light up',  # of whatever order of the two rooms
    ]  # fmt: skip


def test_what_is_wrong_with_patterns_is_told_with_the_rest(read):
    with pytest.raises(InputError) as refused:
        read("""goals:
  - {goal: "(shown {t} west)", for: {t: thin}}
  - {goal: "(shown {s} wset)", for: {s: statue}}
  - {goal: (lti west)}
uncertain_facts:
  - {fact: "(lit {r})", for: {r: room}, probability: 0.5}
  - {fact: (lti west), probability: 0.5}
sentences: {show: "I will show {thing}."}
object: {dawn: the picture}""")
    lines = re.findall(r'line (\d): (\S+):', refused.value.reason)
    assert lines == [
        ('2', 'goals[0].for'), ('3', 'goals[1].goal'), ('4', 'goals[2].goal'),
        ('7', 'uncertain_facts[1].fact'), ('8', 'sentences.show'), ('9', 'object'),
    ]  # fmt: skip


def test_a_patterns_probability_is_shared_equally(read):
    model = read("""goals:
      - {goal: "(shown {p} east)", for: {p: painting}, probability: 3}
      - {goal: (shown faun west), probability: 1}""")
    # 3 of 4 for two goals, 1 of 4 for one
    assert [goal.probability for goal in model.goals] == [0.375, 0.375, 0.25]


def test_variables_are_different_objects_and_equal_goals_count_once(read):
    model = read("""goals:
      - goal: "(and (shown {a} west) (shown {b} west))"
        for: {a: thing, b: thing}""")
    # 3 pairs of 3 things, whichever comes first
    assert len(model.goals) == 3


@pytest.mark.parametrize(
    ('entry', 'place'),
    [
        ('goals: [{goal: "(shown {thing} west)"}]', 'goals[0].goal'),
        ('goals: [{goal: (lit east)}]\none_of: [{facts: "(in {thing} west)"}]', 'one_of[0].facts'),
    ],
)
def test_a_variable_without_a_type_is_told_with_the_key_that_gives_it(model_file, entry, place):
    with pytest.raises(InputError) as refused:
        read_user_model(model_file(entry))
    assert refused.value.reason == (
        f'{place}: {{thing}} needs a type, by for: {{thing: the type}} in the same entry'
    )


def test_where_asks_for_what_holds_initially(read):
    model = read("""goals:
      - goal: "(shown {t} {r})"
        for: {t: thing, r: room}
        where: (and (in {t} {r}) (or (lit {r}) (in dawn {r})) (not (in faun {r})))""")
    assert [goal.goal for goal in model.goals] == ['(shown dawn east)']


def test_what_two_patterns_stand_for_is_one_goal_with_both_shares(read):
    model = read("""goals:
      - {goal: "(shown {t} west)", for: {t: thing}, probability: 3}
      - {goal: "(shown {s} west)", for: {s: statue}, probability: 1}""")
    shares = {goal.goal: goal.probability for goal in model.goals}
    assert shares['(shown faun west)'] == 0.5  # 3/3 of the first and 1 of the second, of 4


def test_a_goal_and_one_of_a_pattern_in_another_order_are_one(read):
    model = read("""goals:
      - {goal: "(and (shown dusk west) (shown faun west))", probability: 1}
      - {goal: "(and (shown faun west) (shown {p} west))", for: {p: painting}, probability: 2}""")
    # Half of the second is the first, the other half a picture of its own, of 3.
    assert [goal.probability for goal in model.goals] == pytest.approx([2 / 3, 1 / 3])


def test_before_the_task_is_known_patterns_of_one_text_are_no_duplicates(model_file):
    text = """goals:
      - {goal: "(shown faun {r})", for: {r: room}, where: "(lit {r})"}
      - {goal: "(shown faun {r})", for: {r: room}, where: "(in faun {r})"}"""
    assert len(read_user_model(model_file(text)).goals) == 2


def test_facts_and_groups_may_have_patterns(read):
    model = read("""goals: [{goal: (shown faun west)}]
uncertain_facts: [{fact: "(lit {r})", for: {r: room}, probability: 0.5}]
one_of: [{facts: "(in faun {r})", for: {r: room}}]""")
    assert model.uncertain_facts == {'(lit east)': 0.5, '(lit west)': 0.5}
    assert model.one_of == ({'(in faun east)': 0.5, '(in faun west)': 0.5},)


@pytest.mark.parametrize(
    ('entry', 'expected'),
    [
        (
            '{goal: "(shown {t} west)", for: {t: thinh}}',
            'line 1: .* no type "thinh" .did you mean',
        ),
        ('{goal: "(shown {s} west)", for: {t: thing}}', '"for" has no variable "s"'),
        ('{goal: "(shown {t} {t})", for: {t: thing}}', 'goal: .*shown'),
        ('{goal: "(shown {t} west)", for: {t: thing}, where: "(dark {t})"}', 'where: .*dark'),
        (
            '{goal: "(shown {t} west)", for: {t: thing}, where: "(lit east)"}',
            r'where: \(lit east\) holds initially for no choice of objects: it names no variable',
        ),
        (
            '{goal: "(and (lit {a}) (lit {b}) (lit {c}))", for: {a: room, b: room, c: room}}',
            'for: the problem has too few objects of these types',
        ),
        ('{goal: "(shown {t} west)", for: [t]}', 'a type for each variable'),
    ],
)
def test_faults_of_a_pattern_are_told(read, entry, expected):
    with pytest.raises(InputError, match=expected):
        read(f'goals: [{entry}]')


def test_more_goals_than_the_limit_are_refused(read):
    with pytest.raises(InputError, match='max_goals'):
        read(
            'goals: [{goal: "(shown {t} {r})", for: {t: thing, r: room}}]',
            limits=InputLimits(max_goals=5),
        )


def test_a_pattern_with_too_many_choices_is_refused(model_file, tmp_path: Path):
    things = ' '.join(f'p{n}' for n in range(60))
    task = read_task(DOMAIN, PROBLEM.replace('dawn dusk', f'dawn dusk {things}'))
    text = """goals:
  - goal: "(and (shown {a} east) (shown {b} east) (shown {c} east))"
    for: {a: thing, b: thing, c: thing}"""
    with pytest.raises(InputError, match='choices: narrow them by "where"'):
        read_user_model(model_file(text), task)
