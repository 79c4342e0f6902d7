"""English verbs in the tenses of a robot's steps."""

import pytest

from mirror_explainer.listener.english import (
    as_verb_phrase,
    before_name,
    begins_with_verb,
    infinitive,
    is_verb,
    omission,
    other_tenses,
)

# Verbs of robots, regular and not, with those that a word list may lack.
VERBS = {
    'grab': ('grabbing', 'grabbed'),
    'bring': ('bringing', 'brought'),
    'take': ('taking', 'taken'),
    'put': ('putting', 'put'),
    'drive': ('driving', 'driven'),
    'fly': ('flying', 'flown'),
    'go': ('going', 'gone'),
    'give': ('giving', 'given'),
    'hold': ('holding', 'held'),
    'get': ('getting', 'got'),
    'leave': ('leaving', 'left'),
    'sweep': ('sweeping', 'swept'),
    'mop': ('mopping', 'mopped'),
    'lie': ('lying', 'lain'),
    'light': ('lighting', 'lit'),
    'refuel': ('refuelling', 'refuelled'),
    'photograph': ('photographing', 'photographed'),
    'dock': ('docking', 'docked'),
    'undock': ('undocking', 'undocked'),
    'unstack': ('unstacking', 'unstacked'),
    'teleport': ('teleporting', 'teleported'),
    'blend': ('blending', 'blended'),
    'glue': ('gluing', 'glued'),
    'tie': ('tying', 'tied'),
    'wake': ('waking', 'woken'),
    'strike': ('striking', 'struck'),
    'program': ('programming', 'programmed'),
    're-charge': ('re-charging', 're-charged'),
}


@pytest.mark.parametrize(('verb', 'forms'), VERBS.items())
def test_a_verb_is_said_while_it_is_done_and_afterwards(verb: str, forms: tuple[str, str]) -> None:
    present, past = forms

    assert other_tenses(f'I will {verb} {{i}}.') == (
        f'I am {present} {{i}}.',
        f'I have {past} {{i}}.',
    )


@pytest.mark.parametrize(
    ('future', 'present', 'past'),
    [
        ("I'll wait.", "I'm waiting.", "I've waited."),
        ('I will be in {r}.', 'I am in {r}.', 'I have been in {r}.'),
        ('I will then clean {r}.', 'I am then cleaning {r}.', 'I have then cleaned {r}.'),
        (
            'I will slowly lift {i} and put it down.',
            'I am slowly lifting {i} and putting it down.',
            'I have slowly lifted {i} and put it down.',
        ),
        (
            'I will fetch {i}, open {d} and leave.',
            'I am fetching {i}, opening {d} and leaving.',
            'I have fetched {i}, opened {d} and left.',
        ),
        (
            'I will turn left and go on, then wait.',
            'I am turning left and going on, then waiting.',
            'I have turned left and gone on, then waited.',
        ),
        (
            'I will photograph {i} then upload it.',
            'I am photographing {i} then uploading it.',
            'I have photographed {i} then uploaded it.',
        ),
        (
            'I will wait for the cup and the plate.',
            'I am waiting for the cup and the plate.',
            'I have waited for the cup and the plate.',
        ),
    ],
)
def test_a_sentence_with_i_will_has_other_tenses(future: str, present: str, past: str) -> None:
    assert other_tenses(future) == (present, past)


@pytest.mark.parametrize(
    'sentence',
    [
        'Ich hole {i}.',
        'The robot will grab {i}.',
        'I will {a}.',
        'I will not move.',
        'I will',
        # Is the plate taken, or is something plated?
        'I will take the cup and plate to {r}.',
    ],
)
def test_what_is_not_surely_understood_has_no_other_tenses(sentence: str) -> None:
    assert other_tenses(sentence) is None


def test_verbs_and_their_ing_forms_are_known() -> None:
    assert [word for word in ('open', 'undock', 'gripper', 'lobby?') if is_verb(word)] == [
        'open',
        'undock',
    ]
    assert [infinitive(word) for word in ('gathering', 'moving', 'bring', 'door')] == [
        'gather',
        'move',
        '',
        '',
    ]


@pytest.mark.parametrize(
    ('name', 'phrase'),
    [
        ('boil water', 'boil water'),
        ('Boil water', 'boil water'),
        ('Drive To Dock 3', 'drive to dock 3'),
        ('Treat The Hive With Oxalic Acid', 'treat the hive with oxalic acid'),
        ('Visit Berlin', 'visit Berlin'),
        ('Greet Mary at the door', 'greet Mary at the door'),
        ('CHECK ALL', 'check all'),
        ('Charging the battery', 'charge the battery'),
        ('Bring the ring', 'bring the ring'),
        ('Öffne Beute 3', 'öffne Beute 3'),
    ],
)
def test_a_tasks_name_is_said_as_what_the_robot_will_do(name: str, phrase: str) -> None:
    assert as_verb_phrase(name) == phrase


@pytest.mark.parametrize(
    ('future', 'left_out'),
    [
        ('I will grab the {i}.', 'I did not grab the {i}.'),
        ("I'll now quickly wave.", 'I did not wave.'),
        ('I will be at the dock.', 'I was not at the dock.'),
        ('I will not move.', None),
        ('Ich gehe.', None),
    ],
)
def test_what_was_left_out_is_denied(future: str, left_out: str | None) -> None:
    assert omission(future) == left_out


@pytest.mark.parametrize(
    ('phrase', 'is_one'),
    [
        ('boil water', True),
        ('then undock', True),
        ('teleport', True),
        ('palletize boxes', True),
        ('tür öffnen', False),
        ('kitchen cleaning', False),
        ('state return', False),
        ('and', False),
        ('', False),
    ],
)
def test_a_phrase_may_begin_with_a_verb(phrase: str, is_one: bool) -> None:
    assert begins_with_verb(phrase) is is_one


@pytest.mark.parametrize(
    ('text', 'name', 'together'),
    [
        ('I will fry a ', 'egg', 'I will fry an egg'),
        ('I will fry an ', 'pancake', 'I will fry a pancake'),
        ('I will call a ', 'user', 'I will call a user'),
        ('I will wait an ', 'hour', 'I will wait an hour'),
        ('I will take the ', 'egg', 'I will take the egg'),
        ('I will take the ', 'the red egg', 'I will take the red egg'),
        ('I will take a ', 'my cup', 'I will take my cup'),
        ('I will take ', 'the cup', 'I will take the cup'),
        ('I will go to ', 'home', 'I will go home'),
        ('I will go to ', 'home and the hall', 'I will go home and the hall'),
        ('I will go to ', 'home 2', 'I will go to home 2'),
    ],
)
def test_a_name_has_one_article_and_the_right_one(text: str, name: str, together: str) -> None:
    assert before_name(text, name) + name == together
