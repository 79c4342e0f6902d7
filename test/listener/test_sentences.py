"""What each ground action sounds like."""

import pytest

from mirror_explainer.listener.sentences import (
    Sentences,
    Template,
    action_parameters,
    template_faults,
)
from mirror_explainer.pddl import Task


def test_without_templates_names_are_made_readable() -> None:
    sentences = Sentences({'pick-up': ('what', 'where')})

    assert sentences.of('(pick-up box1 shelf_2)') == 'I will pick up box1 shelf 2.'


def test_an_action_without_arguments_has_a_default_sentence_too() -> None:
    assert Sentences({'re_charge': ()}).of('(re_charge)') == 'I will re charge.'


def test_objects_are_called_what_the_user_model_says() -> None:
    sentences = Sentences({'grab': ('i', 'r')}, objects={'box_1': 'the Big box'})

    assert sentences.of('(grab box_1 room_2)') == 'I will grab the Big box room 2.'


def test_a_template_takes_the_objects_of_the_parameters_that_it_names() -> None:
    sentences = Sentences(
        {'grab': ('i', 'r')},
        {'grab': Template('From {r} I take {i}, yes: {i}.')},
        {'box_1': 'the box'},
    )

    assert sentences.of('(grab box_1 room_2)') == 'From room 2 I take the box, yes: the box.'


def test_the_first_parameter_whose_object_has_a_wording_decides() -> None:
    sentences = Sentences(
        {'move': ('a', 'b')},
        {
            'move': Template(
                'Off to {b}.',
                {
                    'b': {'hall': 'Into the hall from {a}.', 'roof': 'Up.'},
                    'a': {'roof': 'Down to {b}.'},
                },
            )
        },
    )

    assert sentences.of('(move hall cellar)') == 'Off to cellar.'
    assert sentences.of('(move cellar hall)') == 'Into the hall from cellar.'
    assert sentences.of('(move cellar roof)') == 'Up.'
    assert sentences.of('(move roof hall)') == 'Down to hall.'  # "a" comes first in the action


def test_actions_with_the_same_sentence_are_one_observation() -> None:
    sentences = Sentences({'grab': ('i', 'r')}, {'grab': Template('I grab {i}.')})

    assert sentences.of('(grab cup kitchen)') == sentences.of('(grab cup hall)')
    assert sentences.of('(grab cup kitchen)') != sentences.of('(grab pan kitchen)')


def test_a_sentence_is_one_line_and_braces_can_be_written() -> None:
    sentences = Sentences({'a': ('x',)}, {'a': Template('I  do\n {{{x}}}. ')}, {'o': ' an\tO '})

    assert sentences.of('(a o)') == 'I do { an O }.'


def test_the_warehouse_actions_have_their_parameters_in_order(task: Task) -> None:
    assert action_parameters(task) == {
        'move': ('a', 'b'),
        'grab': ('i', 'r'),
        'recharge': ('p',),
        'exit': ('d', 'p'),
    }


@pytest.mark.parametrize(
    ('wording', 'fault'),
    [
        ('{c}', '"{c}": {c} is no parameter of the action (it has a, b)'),
        ('{?a}', '"{?a}": {?a} is no parameter of the action (write {a})'),
        ('{B}', '"{B}": {B} is no parameter of the action (write {b})'),
        ('{}', '"{}": {} is no parameter of the action (it has a, b)'),
        ('{0}', '"{0}": {0} is no parameter of the action (it has a, b)'),
        (
            '{a.__class__}',
            '"{a.__class__}": {a.__class__} is no parameter of the action (it has a, b)',
        ),
        ('{a[0]}', '"{a[0]}": {a[0]} is no parameter of the action (it has a, b)'),
        ('{a!r}', '"{a!r}": write {a} without a format'),
        ('{a:>9}', '"{a:>9}": write {a} without a format'),
        ('{a:{b}}', '"{a:{b}}": write {a} without a format'),
    ],
)
def test_a_template_may_name_nothing_but_the_parameters(wording: str, fault: str) -> None:
    assert template_faults(Template(wording), ('a', 'b')) == [fault]
    assert template_faults(Template('', {'a': {'x': wording}}), ('a', 'b')) == [fault]


def test_unbalanced_braces_and_unknown_parameters_of_when_are_faults() -> None:
    faults = template_faults(Template('{a', {'z': {'x': '}'}, '?A': {}}), ('a',))

    assert faults[0] == 'the action has no parameter "z" (it has a)'
    assert faults[1] == 'the action has no parameter "?A" (write "a")'
    assert faults[2].startswith('"{a": ')
    assert faults[3].startswith('"}": ')
    assert len(faults) == 4


def test_a_good_template_has_no_faults() -> None:
    template = Template('{a} {b} {{c}}', {'b': {'x': 'to {a}'}})

    assert template_faults(template, ('a', 'b')) == []
    assert template_faults(Template('I wait.'), ()) == []
