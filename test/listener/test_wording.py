"""The user model's wordings: which of them an action has, and what is wrong with one."""

import pytest

from mirror_explainer.listener.wording import Template, Wording, template_faults


def test_an_objects_own_wording_goes_before_its_types_and_a_near_type_before_a_far_one() -> None:
    template = Template(
        Wording('plain'),
        {
            'b': {
                'type place': Wording('place'),
                'type shelf': Wording('shelf'),
                's1': Wording('s1'),
            }
        },
    )
    types = {'s1': ('shelf', 'place'), 's2': ('shelf', 'place'), 'hall': ('place',)}

    chosen = {o: template.chosen({'b': o}, types).future for o in ('s1', 's2', 'hall', 'cup')}

    assert chosen == {'s1': 's1', 's2': 'shelf', 'hall': 'place', 'cup': 'plain'}


def test_all_tenses_of_a_template_are_looked_at() -> None:
    wording = Wording('I go to {a}.', present='I go {b}.', past='{c')

    faults = template_faults(Template(wording), ('a',))

    assert faults[0] == '"I go {b}.": {b} is no parameter of the action (it has a)'
    assert faults[1].startswith('"{c": ')
    assert len(faults) == 2


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
    assert template_faults(Template(Wording(wording)), ('a', 'b')) == [fault]
    assert template_faults(Template(Wording(''), {'a': {'x': Wording(wording)}}), ('a', 'b')) == [
        fault
    ]


def test_unbalanced_braces_and_unknown_parameters_of_when_are_faults() -> None:
    faults = template_faults(Template(Wording('{a'), {'z': {'x': Wording('}')}, '?A': {}}), ('a',))

    assert faults[0] == 'the action has no parameter "z" (it has a)'
    assert faults[1] == 'the action has no parameter "?A" (write "a")'
    assert faults[2].startswith('"{a": ')
    assert faults[3].startswith('"}": ')
    assert len(faults) == 4


def test_a_good_template_has_no_faults() -> None:
    template = Template(Wording('{a} {b} {{c}}'), {'b': {'x': Wording('to {a}')}})

    assert template_faults(template, ('a', 'b')) == []
    assert template_faults(Template(Wording('I wait.')), ()) == []
