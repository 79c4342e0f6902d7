"""Reading user models, and telling all their faults at once."""

import os
from collections.abc import Callable
from pathlib import Path

import pytest

from mirror_explainer.errors import InputError
from mirror_explainer.listener.phrases import Phrases
from mirror_explainer.listener.user_model import read_user_model
from mirror_explainer.listener.wording import Template, Wording
from mirror_explainer.pddl import Task

GOOD = """\
goals:
  - name: a circle
    goal: (and (holding red_circle) (outside bottom_door))
    probability: 3
  - goal: (outside top_left_door)
    probability: 1.0
uncertain_facts:
  - {fact: (charged), probability: 0.25}
one_of:
  - facts: {(item-at blue_cube red_room): 2, (item-at  Blue_Cube blue_room): 6}
rationality: 2.0
unlisted_goal_probability: 0.1
sentences:
  grab: "I will grab {i}."
  Move: {template: "I will go to {b}.", when: {b: {DOORS: "I will reach the doors."}}}
objects: {Red_Circle: a red circle}
"""


def test_a_good_file_gives_normalised_canonical_values(read_model) -> None:
    model = read_model(GOOD)

    circle, door = model.goals
    assert (circle.name, circle.probability) == ('a circle', 0.75)  # 3 / (3 + 1)
    assert (door.name, door.probability) == ('(outside top_left_door)', 0.25)  # 1 / (3 + 1)
    assert circle.goal == '(and (holding red_circle) (outside bottom_door))'
    assert model.uncertain_facts == {'(charged)': 0.25}
    assert model.one_of == (
        # 2 / (2 + 6) and 6 / (2 + 6)
        {'(item-at blue_cube red_room)': 0.25, '(item-at blue_cube blue_room)': 0.75},
    )
    assert (model.rationality, model.unlisted_goal_probability) == (2.0, 0.1)
    assert model.templates == {
        'grab': Template(Wording('I will grab {i}.')),
        'move': Template(
            Wording('I will go to {b}.'), {'b': {'doors': Wording('I will reach the doors.')}}
        ),
    }
    assert model.objects == {'red_circle': 'a red circle'}


def test_what_is_left_out_has_its_default(read_model) -> None:
    model = read_model('goals: [{goal: (charged)}]')

    assert (model.rationality, model.unlisted_goal_probability) == (1.0, 0.05)
    assert (model.uncertain_facts, model.one_of) == ({}, ())
    assert (model.templates, model.objects) == ({}, {})


def test_goals_without_probabilities_are_equally_likely(read_model) -> None:
    model = read_model('goals: [{goal: (charged)}, {goal: (outside bottom_door)}, {goal: (and)}]')

    assert [goal.probability for goal in model.goals] == [1 / 3, 1 / 3, 1 / 3]


@pytest.mark.parametrize('weight', [1e308, 1.0, 1e-300, 5e-324])
def test_weights_of_any_size_are_normalised(read_model, weight: float) -> None:
    text = f'{weight:e}'  # with a point, as YAML wants it

    model = read_model(
        f'goals: [{{goal: (charged), probability: {text}}}, '
        f'{{goal: (outside bottom_door), probability: {text}}}]\n'
        f'one_of: [{{facts: {{(item-at blue_cube red_room): {text}, '
        f'(item-at blue_cube blue_room): {text}}}}}]'
    )

    assert [goal.probability for goal in model.goals] == [0.5, 0.5]
    assert [*model.one_of[0].values()] == [0.5, 0.5]


def test_a_zero_weight_among_others_is_kept(read_model) -> None:
    model = read_model(
        'goals: [{goal: (charged), probability: 0}, {goal: (and), probability: 0.1}]\n'
        'one_of: [{facts: {(item-at blue_cube red_room): 0, (item-at blue_cube doors): 2}}]'
    )

    assert [goal.probability for goal in model.goals] == [0.0, 1.0]
    assert [*model.one_of[0].values()] == [0.0, 1.0]


def test_a_byte_order_mark_and_crlf_change_nothing(read_model) -> None:
    assert read_model('\ufeff' + GOOD.replace('\n', '\r\n')) == read_model(GOOD)


def test_the_shipped_user_models_are_without_fault(warehouse: Path, task: Task) -> None:
    operator = read_user_model(warehouse / 'user_model.yaml', task)
    visitor = read_user_model(warehouse / 'visitor.yaml', task)

    assert len(operator.goals) == 30  # 10 pairs of 5 objects × 3 doors
    assert [goal.probability for goal in visitor.goals] == pytest.approx([0.4, 0.2, 0.2, 0.2])


def test_ten_different_faults_are_told_in_one_error_with_their_lines(
    model_file: Callable[[str], Path], task: Task
) -> None:
    path = model_file(
        """\
goals:
  - goal: (and (holdin red_circle) (outside bottom_door))
    probabilty: 0.5
  - goal: (holding green_cube)
uncertain_facts:
  - {fact: (charged 1), probability: 0.5}
  - {fact: (station-at left), probability: 1.5}
one_of:
  - facts: {(item-at blue_cube doors): 0}
rationality: often
sentences:
  fly: "I will fly."
  grab: "I will grab {item}."
objects: {red_circle: 3}
"""
    )

    with pytest.raises(InputError) as refused:
        read_user_model(path, task)

    assert refused.value.source == str(path)
    assert refused.value.reason == '; '.join(
        [
            '10 faults: line 2: goals[0].goal: (holdin red_circle): '
            'the domain has no predicate "holdin" (did you mean "holding"?)',
            'line 3: goals[0].probabilty: unknown key (did you mean "probability"?)',
            'line 4: goals[1].goal: the problem has no object "green_cube" '
            '(did you mean "red_cube"?)',
            'line 6: uncertain_facts[0].fact: (charged 1): "charged" takes 0 arguments, not 1',
            'line 7: uncertain_facts[1].probability: this should be less than or equal to 1',
            'line 9: one_of[0]: every fact of the group has probability 0',
            'line 10: rationality: "often" is a text, not a number',
            'line 12: sentences.fly: the domain has no action "fly"',
            'line 13: sentences.grab: "I will grab {item}.": {item} is no parameter of the '
            'action (it has i, r)',
            'line 14: objects.red_circle: this should be a valid string',
        ]
    )


GOAL = 'goals: [{goal: (charged)}]\n'
FAULTS = {
    'an empty file': ('', 1, 'the user model must be a mapping with "goals" or "hyps_file"'),
    'a list': ('- a', 1, 'the user model must be a mapping with "goals" or "hyps_file"'),
    'no goals': ('rationality: 1.0', 1, 'give the candidate goals either as "goals" or as'),
    'goals twice': (GOAL + 'hyps_file: x', 1, 'give the candidate goals either as "goals" or as'),
    'goals left blank': ('goals:', 1, 'goals: this should be a list'),
    'an empty list of goals': ('goals: []', 1, 'goals: there is nothing in it'),
    'a text for goals': ('goals: (charged)', 1, 'goals: this should be a list'),
    'a text for a goal': ('goals: [(charged)]', 1, 'goals[0]: write {goal: "(charged)"} here'),
    'a goal without goal': ('goals: [{name: x}]', 1, 'goals[0].goal: this key is missing'),
    'a blank goal': ('goals: [{goal: " "}]', 1, 'goals[0].goal: this text is blank'),
    'hyps_file left blank': ('hyps_file:', 1, 'hyps_file: this should be a valid string'),
    'no hyps_file': (
        '\nhyps_file: no.dat',
        2,
        'hyps_file: {folder}/no.dat: the file cannot be read: No such file or directory',
    ),
    'an unknown key': (
        GOAL + 'names: {}',
        2,
        'names: unknown key (there are goals, hyps_file, uncertain_facts, one_of, rationality, '
        'unlisted_goal_probability, goals_seen, sentences, objects, phrases, listener)',
    ),
    'a misspelt key': (
        GOAL + 'rationalty: 1.0',
        2,
        'rationalty: unknown key (did you mean "rationality"?)',
    ),
    'a misspelt key of a goal': (
        'goals: [{goal: (charged), nme: x}]',
        1,
        'goals[0].nme: unknown key (did you mean "name"?)',
    ),
    'a misspelt key of a fact': (
        GOAL + 'uncertain_facts: [{fact: (charged), probability: 0.5, fakt: x}]',
        2,
        'uncertain_facts[0].fakt: unknown key (did you mean "fact"?)',
    ),
    'a misspelt key of a group': (
        GOAL + 'one_of: [{facts: {(charged): 1}, facst: {}}]',
        2,
        'one_of[0].facst: unknown key (did you mean "facts"?)',
    ),
    'a misspelt key of a wording': (
        GOAL + 'sentences:\n  grab:\n    template: x\n    whn: {}',
        5,
        'sentences.grab.whn: unknown key (did you mean "when"?)',
    ),
    'a decimal comma in braces': (
        GOAL + 'uncertain_facts:\n- {fact: (charged), probability: 0,6}',
        3,
        'uncertain_facts[0].6: a number stands here as a key; decimals have a point: 0.5, not 0,5',
    ),
    'decimal commas in a group': (
        GOAL + 'one_of: [{facts: {(charged): 1,5}}]',
        None,
        '2 faults: line 2: one_of[0].facts.5: a number stands here as a key; decimals have a poi',
    ),
    'a decimal comma': (
        GOAL + 'rationality: 0,8',
        2,
        'rationality: "0,8" is a text, not a number (a decimal has a point: 0.8)',
    ),
    'a key that is no text to YAML': (
        GOAL + 'objects: {on: the switch}',
        2,
        'objects.True: to YAML this key is no text: put it in quotes',
    ),
    'a key twice': (
        GOAL + 'rationality: 1.0\nrationality: 2.0',
        3,
        'rationality: the key "rationality" stands here twice',
    ),
    'a fault in the first of two lists with one key': (
        'goals:\n- {goal: (charged)}\n- {goal: "\\e[1m"}\ngoals: [{goal: (charged)}]',
        None,
        '2 faults: line 3: goals[1].goal: this text has a character that is no text: U+001B; '
        'line 4: goals: the key "goals" stands here twice',
    ),
    'a fact twice': (
        GOAL + 'uncertain_facts:\n- {fact: (charged), probability: 0.5}\n'
        'one_of:\n- facts:\n    ( CHARGED ): 1\n    (item-at blue_cube doors): 1',
        6,
        'one_of[0].facts.( CHARGED ): ( CHARGED ) is named more than once',
    ),
    'a name twice': (
        'goals:\n- {goal: (charged), name: x}\n- {goal: (and), name: x}',
        3,
        'goals[1]: another candidate is named "x" too',
    ),
    'probabilities for some goals': (
        'goals:\n- {goal: (charged), probability: 1}\n- {goal: (and)}\n- {goal: (or)}',
        None,
        '2 faults: line 3: goals[1]: it has no probability: give every goal one, or none; line ',
    ),
    'a probability for all goals but one': (
        'goals:\n- {goal: (charged), probability: 1}\n- {goal: (and)}',
        3,
        'goals[1]: it has no probability: give every goal one, or none',
    ),
    'no goal likely': (
        'goals: [{goal: (charged), probability: 0}]',
        1,
        'goals: every goal has probability 0',
    ),
    'a negative weight': (
        'goals: [{goal: (charged), probability: -1}]',
        1,
        'goals[0].probability: this should be greater than or equal to 0',
    ),
    'an infinite weight': (
        'goals: [{goal: (charged), probability: .inf}]',
        1,
        'goals[0].probability: this should be a finite number',
    ),
    'not a number': (GOAL + 'rationality: .nan', 2, 'rationality: this should be a finite number'),
    'yes for a number': (GOAL + 'rationality: yes', 2, 'rationality: this should be a valid num'),
    'a number in quotes': (GOAL + 'rationality: "1"', 2, 'rationality: "1" is a text, not a num'),
    'an exponent without a point': (
        GOAL + 'rationality: 1e-3',
        2,
        'rationality: "1e-3" is a text, not a number (YAML wants a point in 1.0e-3)',
    ),
    'a huge number': (GOAL + f'rationality: 1{"0" * 400}', 2, 'rationality: this should be a val'),
    'all that is unlisted': (
        GOAL + 'unlisted_goal_probability: 1.0',
        2,
        'unlisted_goal_probability: this should be less than 1',
    ),
    'a fact that is no atom': (
        GOAL + 'uncertain_facts: [{fact: (not (charged)), probability: 0.5}]',
        2,
        'uncertain_facts[0].fact: "(not (charged))" is no atom such as (predicate object)',
    ),
    'a fact of another type': (
        GOAL + 'one_of: [{facts: {(holding left): 1}}]',
        2,
        'one_of[0].facts.(holding left): (holding left): left is of type place, but',
    ),
    'an empty group': (GOAL + 'one_of: [{facts: {}}]', 2, 'one_of[0].facts: there is nothing'),
    'facts left blank': (GOAL + 'uncertain_facts:', 2, 'uncertain_facts: this should be a list'),
    'a sentence for a misspelt action': (
        GOAL + 'sentences: {Gab: "I will grab {i}."}',
        2,
        'sentences.Gab: the domain has no action "Gab" (did you mean "grab"?)',
    ),
    'a template that is none': (
        GOAL + 'sentences: {grab: 5}',
        2,
        'sentences.grab: this should be the sentence as a text, or a mapping with "template" and ',
    ),
    'a sentence left blank': (
        GOAL + 'sentences: {grab: }',
        2,
        'sentences.grab: this should be the sentence as a text, or a mapping with "template" and ',
    ),
    'a misspelt tense': (
        GOAL + 'sentences:\n  grab: {future: x, psat: y}',
        3,
        'sentences.grab.psat: unknown key (did you mean "past"?)',
    ),
    'a misspelt tense of a wording': (
        GOAL + 'sentences:\n  grab:\n    template: {futur: x}',
        None,
        '2 faults: line 4: sentences.grab.template.futur: unknown key (did you mean "future"?)',
    ),
    'a past alone': (
        GOAL + 'sentences:\n  grab: {past: x}',
        3,
        'sentences.grab: give either "template", or "future" here',
    ),
    'two sentences': (
        GOAL + 'sentences:\n  grab: {template: x, future: y}',
        3,
        'sentences.grab: give either "template", or "future" here',
    ),
    'a wording for a type that there is not': (
        GOAL + 'sentences:\n  grab:\n    template: x\n    when: {i: {type items: y}}',
        5,
        'sentences.grab.when.i.type items: the domain has no type "items" (did you mean "item"?)',
    ),
    'a past that names no parameter': (
        GOAL + 'sentences: {grab: {future: x, past: "{item}"}}',
        2,
        'sentences.grab: "{item}": {item} is no parameter of the action (it has i, r)',
    ),
    'a misspelt phrase': (
        GOAL + 'phrases:\n  reched: Done.',
        3,
        'phrases.reched: unknown phrase (did you mean "reached"?)',
    ),
    'a phrase that there is not': (
        GOAL + 'phrases:\n  bye: Done.',
        3,
        f'phrases.bye: unknown phrase (there are {", ".join(Phrases.names())})',
    ),
    'a phrase that is no text': (
        GOAL + 'phrases: {no_plan: [x]}',
        2,
        'phrases.no_plan: this should be a valid string',
    ),
    'a blank phrase': (GOAL + 'phrases: {no_plan: " "}', 2, 'phrases.no_plan: this text is blank'),
    'a phrase that lacks what it is about': (
        GOAL + 'phrases: {failed: Oops.}',
        2,
        'phrases.failed: "Oops." lacks {step}',
    ),
    'a phrase with half a place': (
        GOAL + 'phrases: {already: "{sentence} } done"}',
        2,
        'phrases.already: "{sentence} } done": Single',
    ),
    'a phrase with a place that it has not': (
        GOAL + 'phrases: {reached: "{goal} is done."}',
        2,
        'phrases.reached: "{goal} is done.": {goal} has no place here',
    ),
    'a blank template': (
        GOAL + 'sentences: {grab: {template: ""}}',
        2,
        'sentences.grab.template: this text is blank',
    ),
    'a template that reaches into objects': (
        GOAL + 'sentences: {grab: "{i.__class__.__mro__}"}',
        2,
        'sentences.grab: "{i.__class__.__mro__}": {i.__class__.__mro__} is no parameter of the',
    ),
    'a template with a format': (
        GOAL + 'sentences:\n  exit: "Bye."\n  grab: "{i:>999999999}"',
        4,
        'sentences.grab: "{i:>999999999}": write {i} without a format',
    ),
    'a template that names a parameter as PDDL does': (
        GOAL + 'sentences: {grab: "{?i}"}',
        2,
        'sentences.grab: "{?i}": {?i} is no parameter of the action (write {i})',
    ),
    'when for no text': (
        GOAL + 'sentences: {grab: {template: x, when: {yes: {left: y}}}}',
        2,
        'sentences.grab.when.True: to YAML this key is no text: put it in quotes',
    ),
    'when for another parameter': (
        GOAL + 'sentences: {grab: {template: x, when: {b: {left: y}}}}',
        2,
        'sentences.grab: the action has no parameter "b" (it has i, r)',
    ),
    'a tab': ('goals:\n\t- x', 2, 'no YAML that can be read: found character'),
    'an open bracket': ('goals: [\n', 2, 'no YAML that can be read: '),
    'two documents': (GOAL + '---\na: 1', 2, 'no YAML that can be read: '),
    'a Python object': (
        GOAL + 'rationality: !!python/object/apply:os.getcwd []',
        2,
        'no YAML that can be read: could not determine a constructor for the tag',
    ),
    'an impossible date': (GOAL + 'rationality: 2001-99-99', None, 'no YAML that can be read: '),
    'an impossible bool': (GOAL + 'rationality: !!bool x', None, 'no YAML that can be read: '),
    'an impossible int': (GOAL + 'rationality: !!int ""', None, 'no YAML that can be read: '),
    'an impossible time': (GOAL + 'rationality: !!timestamp x', None, 'no YAML that can be read'),
    'a control character': (GOAL + '\x07', None, 'no YAML that can be read: unacceptable'),
    'deep nesting': ('goals: ' + '[' * 3000, None, 'no YAML that can be read: maximum recursion'),
}


@pytest.mark.parametrize(('text', 'line', 'said'), FAULTS.values(), ids=FAULTS)
def test_a_fault_is_told_with_its_line(
    model_file: Callable[[str], Path], task: Task, text: str, line: int | None, said: str
) -> None:
    path = model_file(text)

    with pytest.raises(InputError) as refused:
        read_user_model(path, task)

    assert refused.value.reason.startswith(said.replace('{folder}', str(path.parent)))
    assert refused.value.line == line
    assert refused.value.source == str(path)


@pytest.mark.parametrize(
    ('text', 'cure'),
    [
        ('goals:\n  - name: x\n\tgoal: (charged)', 'Indent with spaces'),
        ('goals:\n  \t- goal: (charged)', 'Indent with spaces'),
        (GOAL + 'sentences: {grab:\tNow: x}', 'Put texts with {'),
    ],
)
def test_a_tab_at_the_beginning_of_a_line_has_a_cure_of_its_own(
    model_file: Callable[[str], Path], text: str, cure: str
) -> None:
    with pytest.raises(InputError) as refused:
        read_user_model(model_file(text))

    assert refused.value.cure.startswith(cure)


def test_faults_inside_an_entry_with_another_fault_are_told_too(read_model) -> None:
    with pytest.raises(InputError) as refused:
        read_model(
            'goals: [{goal: (holdin x), nmae: y}]\n'
            'sentences: {grab: {template: "{x}", whne: {}, when: {q: {left: 5}}}}'
        )

    assert refused.value.reason.startswith('6 faults: ')
    for said in ('"holdin"', 'nmae: unknown', '{x} is no', 'whne: unknown', '"q"', 'sentence as'):
        assert said in refused.value.reason


def test_a_file_that_is_missing_or_no_text_is_refused(tmp_path: Path, task: Task) -> None:
    (tmp_path / 'latin.yaml').write_bytes(b'goals: \xe9')

    with pytest.raises(InputError, match='none.yaml: the file cannot be read: No such file'):
        read_user_model(tmp_path / 'none.yaml', task)
    with pytest.raises(InputError, match='the file cannot be read: Is a directory'):
        read_user_model(tmp_path, task)
    with pytest.raises(InputError, match='latin.yaml, line 1: this is no UTF-8 text'):
        read_user_model(tmp_path / 'latin.yaml', task)


def test_a_pipe_in_place_of_a_file_is_refused_at_once(tmp_path: Path, task: Task) -> None:
    os.mkfifo(tmp_path / 'user.yaml')
    os.mkfifo(tmp_path / 'hyps.dat')
    (tmp_path / 'names_a_pipe.yaml').write_text('hyps_file: hyps.dat')

    for name in ('user.yaml', 'names_a_pipe.yaml'):
        with pytest.raises(InputError, match='the file cannot be read: it is a pipe'):
            read_user_model(tmp_path / name, task)


def test_candidates_are_read_from_a_file_of_goals(
    tmp_path: Path, model_file: Callable[[str], Path], task: Task
) -> None:
    (tmp_path / 'hyps.dat').write_bytes(
        b'\xef\xbb\xbf(holding red_circle),(outside bottom_door)\r\n\r\n( CHARGED )\n'
        b'(holding blue_cube), (holding red_cube)'
    )

    model = read_user_model(model_file('hyps_file: hyps.dat'), task)

    assert [goal.name for goal in model.goals] == [
        '(holding red_circle),(outside bottom_door)',
        '( CHARGED )',
        '(holding blue_cube), (holding red_cube)',
    ]
    assert model.goals[0].goal == '(and (holding red_circle) (outside bottom_door))'
    assert [goal.probability for goal in model.goals] == [1 / 3, 1 / 3, 1 / 3]


def test_faults_of_the_file_of_goals_have_their_lines_in_that_file(
    tmp_path: Path, model_file: Callable[[str], Path], task: Task
) -> None:
    (tmp_path / 'hyps.dat').write_text(
        '(charged)\n\n(holdin red_circle)\n(charged)\n(outside bottom_door\n'
    )

    with pytest.raises(InputError) as refused:
        read_user_model(model_file('# candidates\nhyps_file: hyps.dat'), task)

    assert refused.value.reason == '; '.join(
        [
            '3 faults: line 2: hyps_file: hyps.dat, line 3: (holdin red_circle): the domain has '
            'no predicate "holdin" (did you mean "holding"?)',
            'line 2: hyps_file: hyps.dat, line 4: another candidate is named "(charged)" too',
            'line 2: hyps_file: hyps.dat, line 5: "(and (outside bottom_door)" is not one '
            'expression in balanced parentheses',
        ]
    )


def test_a_file_of_goals_without_goals_is_refused(
    tmp_path: Path, model_file: Callable[[str], Path], task: Task
) -> None:
    (tmp_path / 'hyps.dat').write_text('\n \n')

    with pytest.raises(InputError, match='line 1: hyps_file: .*/hyps.dat has no goals'):
        read_user_model(model_file('hyps_file: hyps.dat'), task)


def test_without_a_task_the_file_alone_is_checked(model_file: Callable[[str], Path]) -> None:
    model = read_user_model(model_file('goals: [{goal: (anything)}]'))

    assert model.goals[0].goal == '(anything)'
    with pytest.raises(InputError, match='unknown key'):
        read_user_model(model_file('goals: [{goal: (anything), x: 1}]'))


def test_aliases_that_would_explode_are_refused(read_model) -> None:
    bomb = 'a: &a [x, x, x, x, x, x, x, x, x]\n' + ''.join(
        f'{new}: &{new} [{", ".join([f"*{old}"] * 9)}]\n'
        for old, new in zip('abcdefgh', 'bcdefghi', strict=True)
    )

    with pytest.raises(InputError, match='line 6: its aliases stand for too much'):
        read_model(bomb + 'goals: *i\nsentences: *i\n')


def test_sentences_in_tenses_types_and_phrases_are_read(read_model) -> None:
    model = read_model(
        GOAL
        + """
sentences:
  exit: {future: "Ich gehe.", past: "Ich bin gegangen.", when: {d: {type Door: "Raus!"}}}
  move: {template: {future: "Los nach {b}.", present: "Unterwegs nach {b}."}}
phrases: {reached: "Fertig.", and: und, new_task: "", already: "Schon: {sentence}"}
"""
    )

    assert model.templates == {
        'exit': Template(
            Wording('Ich gehe.', past='Ich bin gegangen.'), {'d': {'type door': Wording('Raus!')}}
        ),
        'move': Template(Wording('Los nach {b}.', present='Unterwegs nach {b}.')),
    }
    phrases = Phrases(reached='Fertig.', and_='und', new_task='', already='Schon: {sentence}')
    assert model.phrases == phrases
