"""Answers as they are spoken: several steps in one sentence, and the phrases beside them."""

import pytest

from mirror_explainer.listener.phrases import Phrases
from mirror_explainer.listener.sentences import Sentences
from mirror_explainer.listener.speech import reached, spoken, stuck
from mirror_explainer.listener.wording import Template, Wording
from mirror_explainer.pddl.progress import StepStatus

AHEAD, RUNNING, DONE, SKIPPED = StepStatus
PARAMETERS = {'shoot': ('t',), 'bring': ('i', 'r'), 'swap': ('i', 'j'), 'wait': (), 'next': ('i',)}
WORDINGS = {
    'shoot': Wording('I will photograph the {t}.'),
    'bring': Wording('I will bring the {i} to the {r}.'),
    'swap': Wording('I will swap the {i} for {i} and {j}.'),
    'wait': Wording('I will wait.'),
    'next': Wording('{i} is next.'),
}
TEMPLATES = {name: Template(wording) for name, wording in WORDINGS.items()}

TASKS = Sentences({'do': ('task',)}, {'do': Template(Wording('I will {task}.'))})


def sentences(**phrases: str) -> Sentences:
    return Sentences(PARAMETERS, TEMPLATES, phrases=Phrases(**phrases))


def ahead(*actions: str) -> list[tuple[str, StepStatus]]:
    return [(action, AHEAD) for action in actions]


@pytest.mark.parametrize(
    ('steps', 'text'),
    [
        (ahead(), ''),
        (ahead('(wait)'), 'I will wait.'),
        (
            ahead('(shoot mill)', '(shoot bridge)'),
            'I will photograph the mill and the bridge.',
        ),
        (
            ahead('(shoot mill)', '(shoot lock)', '(shoot bridge)', '(wait)'),
            'I will photograph the mill, the lock and the bridge.\nI will wait.',
        ),
        # Order is kept: what is not a neighbour is not drawn to the front.
        (
            ahead('(shoot mill)', '(wait)', '(shoot bridge)'),
            'I will photograph the mill.\nI will wait.\nI will photograph the bridge.',
        ),
        # The cup and the pan go to one room, the jug to another.
        (
            ahead('(bring cup hall)', '(bring pan hall)', '(bring jug lab)', '(bring jug bar)'),
            'I will bring the cup and the pan to the hall.\n'
            'I will bring the jug to the lab and the bar.',
        ),
        # Two objects differ, or one that stands in the sentence twice, or is its subject.
        (
            ahead('(bring cup hall)', '(bring pan lab)'),
            'I will bring the cup to the hall.\nI will bring the pan to the lab.',
        ),
        (
            ahead('(swap a c)', '(swap b c)'),
            'I will swap the a for a and c.\nI will swap the b for b and c.',
        ),
        (ahead('(next a)', '(next b)'), 'a is next.\nb is next.'),
        # Each tense for itself.
        (
            [
                ('(shoot a)', DONE),
                ('(shoot b)', DONE),
                ('(shoot c)', RUNNING),
                ('(shoot d)', AHEAD),
            ],
            'I have photographed the a and the b.\nI am photographing the c.\n'
            'I will photograph the d.',
        ),
    ],
)
def test_neighbours_that_differ_in_one_object_are_one_sentence(
    steps: list[tuple[str, StepStatus]], text: str
) -> None:
    assert spoken(sentences(), steps) == text


@pytest.mark.parametrize(
    ('said', 'unsaid', 'text'),
    [
        (
            '(shoot lock)',
            ['(shoot bridge)', '(shoot tower)'],
            'I will photograph the mill, the lock and others.',
        ),
        (
            '(shoot lock)',
            ['(shoot bridge)', '(shoot bridge)'],
            'I will photograph the mill, the lock and one more.',
        ),
        ('(shoot lock)', ['(bring cup hall)'], 'I will photograph the mill and the lock.'),
        # What is alike may be left out where no list is said.
        ('(wait)', ['(shoot bridge)'], 'I will photograph the mill.\nI will wait.'),
    ],
)
def test_a_list_that_is_not_whole_says_so(said: str, unsaid: list[str], text: str) -> None:
    assert spoken(sentences(), ahead('(shoot mill)', said), ahead(*unsaid)) == text


def test_a_list_of_what_is_done_is_whole_whatever_is_ahead() -> None:
    done = [('(shoot mill)', DONE), ('(shoot lock)', DONE)]
    assert spoken(sentences(), done, ahead('(shoot bridge)')) == (
        'I have photographed the mill and the lock.'
    )


def test_a_robot_that_is_stuck_promises_nothing() -> None:
    steps = [('(shoot mill)', DONE), *ahead('(shoot lock)', '(shoot bridge)', '(next a)')]
    assert spoken(sentences(), steps, is_stuck=True) == (
        'I have photographed the mill.\nI meant to photograph the lock and the bridge.'
    )
    left = ahead('(shoot tower)', '(next b)')
    assert spoken(sentences(), steps, left, is_stuck=True) == (
        'I have photographed the mill.\nI meant to photograph the lock, the bridge and one more.'
    )


def test_the_word_for_the_rest_of_a_list_can_be_set() -> None:
    steps, left = ahead('(shoot mill)', '(shoot lock)'), ahead('(shoot a)', '(shoot b)')
    assert spoken(sentences(others='andere', and_='und'), steps, left) == (
        'I will photograph the mill, the lock und andere.'
    )
    assert spoken(sentences(others=''), steps, left) == 'I will photograph the mill and the lock.'
    assert spoken(sentences(other='another'), steps, left[:1]) == (
        'I will photograph the mill, the lock and another.'
    )


def test_the_word_between_objects_can_be_set() -> None:
    assert spoken(sentences(and_='und'), ahead('(shoot mill)', '(shoot lock)')) == (
        'I will photograph the mill und the lock.'
    )


def test_a_robot_at_its_goal_says_what_it_achieved() -> None:
    steps = [('(bring cup hall)', DONE), ('(shoot mill)', SKIPPED)]
    assert reached(sentences(), steps) == (
        'I have brought the cup to the hall.\nI did not photograph the mill.\nI am done.'
    )
    assert reached(sentences(reached='That is all.'), []) == 'That is all.'


def test_a_robot_at_its_goal_says_where_a_list_of_what_it_did_is_not_whole() -> None:
    mill, lock, *left = [(f'(shoot {x})', DONE) for x in ('mill', 'lock', 'tower', 'bridge')]
    assert reached(sentences(), [mill, lock], left) == (
        'I have photographed the mill, the lock and others.\nI am done.'
    )


def test_a_robot_that_is_stuck_says_with_what() -> None:
    assert stuck(sentences(), {'(shoot mill)': ''}) == 'I am stuck: I cannot photograph the mill.'
    assert stuck(sentences(failed='Help! {step}'), {'(next a)': ''}) == 'Help! a is next.'
    cannot = 'I am stuck: I cannot photograph the mill.'
    assert stuck(sentences(), {'(shoot mill)': 'it is dark'}) == f'{cannot}\nIt is dark.'
    assert stuck(sentences(), {'(shoot mill)': 'Why so dark?'}) == f'{cannot}\nWhy so dark?'
    several = {'(shoot mill)': 'it is dark', '(bring cup hall)': 'it is dark', '(next a)': ''}
    assert stuck(sentences(), several) == (
        f'{cannot}\nI cannot bring the cup to the hall.\nIt is dark.\nI am stuck: a is next.'
    )


@pytest.mark.parametrize(
    ('reason', 'text'),
    [
        (
            'it is dark',
            'I did not photograph the mill.\nI did not photograph the lock.\nIt is dark.\n'
            'I have waited.\nI did not photograph the bridge.\nIt is dark.',
        ),
        (
            'of the fog',
            'I did not photograph the mill because of the fog.\n'
            'I did not photograph the lock because of the fog.\n'
            'I have waited.\nI did not photograph the bridge because of the fog.',
        ),
    ],
)
def test_a_reason_of_several_steps_in_a_row_is_told_after_the_last(reason: str, text: str) -> None:
    steps = [('(shoot mill)', SKIPPED), ('(shoot lock)', SKIPPED)]
    steps += [('(wait)', DONE), ('(shoot bridge)', SKIPPED)]
    reasons = {action: reason for action, status in steps if status is SKIPPED}

    assert spoken(sentences(), steps, reasons=reasons) == text


def test_tasks_that_have_the_verb_are_told_in_one_breath_in_each_tense() -> None:
    names = ['(do boil_water)', '(do drive_to_the_hall)', '(do wait)']

    told = {status: spoken(TASKS, [(name, status) for name in names]) for status in StepStatus}

    assert told == {
        AHEAD: 'I will boil water, drive to the hall and wait.',
        RUNNING: 'I am boiling water, driving to the hall and waiting.',
        DONE: 'I have boiled water, driven to the hall and waited.',
        SKIPPED: 'I did not boil water.\nI did not drive to the hall.\nI did not wait.',
    }
    # "Boil water, drive to the hall and others" would be no English.
    assert spoken(TASKS, ahead(*names[:2]), ahead(names[2])) == (
        'I will boil water and drive to the hall.'
    )
    assert stuck(TASKS, {'(do boil_water)': ''}) == 'I am stuck: I cannot boil water.'


@pytest.mark.parametrize(
    ('names', 'text'),
    [
        ('bring tea to ward 1; bring tea to ward 2', 'bring tea to ward 1 and ward 2'),
        ('bring tea to ward 1; bring milk to ward 1', 'bring tea and milk to ward 1'),
        ('wash the cup; wash the pan; wash a pot', 'wash the cup and the pan; wash a pot'),
        ('wait; boil water; boil an egg; rest', 'wait; boil water and an egg; rest'),
        # What differs is more than a thing, or a task is two.
        ('turn on the light; turn off the light', 'turn on the light and turn off the light'),
        ('go home; go to the hall', 'go home and go to the hall'),
        ('deliver 2 cups; deliver 3 cups', 'deliver 2 cups and deliver 3 cups'),
        ('find Anna and wait; find Bob and wait', 'find Anna and wait and find Bob and wait'),
    ],
)
def test_tasks_that_differ_in_one_thing_are_told_by_that(names: str, text: str) -> None:
    actions = [f'(do {name.replace(" ", "_")})' for name in names.split('; ')]
    expected = [f'I will {sentence}.' for sentence in text.split('; ')]
    assert spoken(TASKS, ahead(*actions)).split('\n') == expected


def test_a_list_of_tasks_that_differ_in_one_thing_says_where_it_is_not_whole() -> None:
    washing = ahead('(do wash_the_cup)', '(do wash_the_pan)')
    left = ahead('(do boil_water)', '(do wash_the_pot)')
    assert spoken(TASKS, washing, left[:1]) == 'I will wash the cup and the pan.'
    assert spoken(TASKS, washing, left) == 'I will wash the cup, the pan and one more.'


def test_an_article_before_a_name_fits_it_and_is_not_said_twice() -> None:
    templates = {
        'fry': Template(Wording('I will fry a {i}.')),
        'ir': Template(Wording('Voy a {i}.')),
    }
    called = {'cup': 'the cup'}
    said = Sentences({'fry': ('i',), 'ir': ('i',)}, templates, called)

    assert spoken(said, ahead('(fry pancake)', '(fry egg)', '(fry cup)')) == (
        'I will fry a pancake, an egg and the cup.'
    )
    assert spoken(said, ahead('(ir oficina)')) == 'Voy a oficina.'
