"""Slips in a user model that its schema would puzzle over: the message has the right form."""

from pathlib import Path

import pytest

from mirror_explainer.errors import InputError, told
from mirror_explainer.listener.user_model import read_user_model
from mirror_explainer.pddl import Task

GOALS = 'goals: [{goal: (holding red_circle)}]\n'
SLIPS = {
    'a fact as a key': (
        GOALS + 'uncertain_facts:\n  - (charged): 0.6\n',
        'line 3: uncertain_facts[0]: write {fact: (charged), probability: 0.6} here',
    ),
    'a fact alone': (
        GOALS + 'uncertain_facts: [(charged)]\n',
        'line 2: uncertain_facts[0]: write {fact: (charged), probability: 0.5} here',
    ),
    'a fact without parentheses': (
        GOALS + 'uncertain_facts:\n  - {fact: charged, probability: 0.5}\n',
        'line 3: uncertain_facts[0].fact: write (charged)',
    ),
    'a group without facts': (
        GOALS + 'one_of:\n  - {(charged): 0.3, (item-at red_circle red_room): 0.7}\n',
        'line 3: one_of[0]: "facts:" is missing: write {facts: {(charged): 0.3, '
        '(item-at red_circle red_room): 0.7}} here',
    ),
    'a group as a list': (
        GOALS + 'one_of:\n  - [(charged), (item-at red_circle red_room)]\n',
        'line 3: one_of[0]: write {facts: {(charged): 1, (item-at red_circle red_room): 1}} here',
    ),
    'a goal alone': (
        'goals:\n  - (holding red_circle)\n',
        'line 2: goals[0]: write {goal: "(holding red_circle)"} here',
    ),
    'a comma in a name': (
        'goals:\n  - {name: red, blue, goal: (holding red_circle)}\n',
        'line 2: goals[0].blue: a text with a comma needs quotes here: name: "red, blue"',
    ),
    'a variable in a flow mapping': (
        'goals:\n  - {goal: (forall (?x - item) (holding ?x))}\n',
        "line 2: no YAML that can be read: expected ',' or '}', but got '?'. A text with a ? in "
        'it needs quotes here, such as "(forall (?x - type) …)".',
    ),
}


@pytest.mark.parametrize(('text', 'said'), SLIPS.values(), ids=SLIPS)
def test_a_slip_is_told_with_the_right_form(
    text: str, said: str, task: Task, tmp_path: Path
) -> None:
    path = tmp_path / 'user.yaml'
    path.write_text(text)

    with pytest.raises(InputError) as refused:
        read_user_model(path, task)

    assert told(refused.value) == f'{path}, {said}'


def test_a_file_of_hypotheses_may_have_blanks_for_commas_and_names(
    task: Task, tmp_path: Path
) -> None:
    (tmp_path / 'hyps.dat').write_text(
        '(holding red_circle) (outside bottom_door);circle\n(holding red_cube), (charged)\n'
    )
    path = tmp_path / 'user.yaml'
    path.write_text('hyps_file: hyps.dat\n')

    first, second = read_user_model(path, task).goals

    assert (first.name, first.goal) == (
        'circle',
        '(and (holding red_circle) (outside bottom_door))',
    )
    assert second.name == '(holding red_cube), (charged)'


def test_a_goal_without_a_list_is_told_how_to_be_one(task: Task, tmp_path: Path) -> None:
    path = tmp_path / 'user.yaml'
    path.write_text('goal: (holding red_circle)\n')

    with pytest.raises(InputError, match='goal: write goals: ') as refused:
        read_user_model(path, task)

    _, _, written = refused.value.reason.partition('goal: write ')
    path.write_text(written)
    assert [goal.goal for goal in read_user_model(path, task).goals] == ['(holding red_circle)']
