"""A researcher's study.yaml: what it may say, and all that is wrong with one, with lines."""

import pytest

pytest.importorskip('django', reason='the extra [web] is not installed')

from mirror_explainer.errors import InputError
from mirror_explainer.experiments.study.web_study.study_file import read_study_file

GOOD = """\
title: {en: "What is it up to?", de: "Was hat er vor?"}
purpose: "We ask how a robot should **tell its plan**."
researcher: Ada Example
contact: ada@example.org
minutes: 15
minimum_age: 18
languages: [de, en]
questions:
  - {name: age, question: {en: Age, de: Alter}, kind: number}
  - {name: robots, question: "Robots?", kind: choice, options: [never, {en: often, de: oft}]}
closing_comment: true
keep_parameters: [PID]
completion: {code: C0FFEE, return_to: "https://example.org/back?pid={PID}"}
scenarios: 3
seed: 7
"""


@pytest.fixture
def read(tmp_path):
    def read(text):
        file = tmp_path / 'study.yaml'
        file.write_text(text)
        return read_study_file(file)

    return read


def test_a_study_is_read_with_its_texts_in_each_language(read):
    study = read(GOOD)

    assert study.text(study.title, 'de') == 'Was hat er vor?'
    assert study.text(study.purpose, 'de') == study.text(study.purpose, 'en')
    assert study.text(study.consent, 'en') == ''
    assert [study.text(o, 'de') for o in study.questions[1].options] == ['never', 'oft']
    assert (study.scenarios, study.seed, study.keep_parameters) == (3, 7, ['PID'])


def test_nothing_has_to_be_said(read):
    assert read('title: Robots').languages == ['en']
    assert read('listeners: [open, planner]').listeners == ['open', 'planner']


@pytest.mark.parametrize(
    ('line', 'reason'),
    [
        ('minuts: 3', 'line 1: minuts: unknown key (did you mean "minutes"?)'),
        ('minutes: many', 'line 1: minutes: '),
        ('minutes: 0', 'line 1: minutes: '),
        ('languages: [en, xx]', 'languages[1]: there are no texts in "xx", but in de, en'),
        ('title: {de: Roboter}', 'line 1: title: it lacks the text in en'),
        ('title: ""', 'line 1: title: this text is blank'),
        ('title: [a]', 'title: this should be a text, or one for each language'),
        ('keep_parameters: ["a b"]', 'keep_parameters[0]: "a b" is no name'),
        ('completion: {return_to: "javascript:alert(1)"}', 'begins with https:// or http://'),
        ('completion: {kode: a}', 'completion.kode: unknown key (did you mean "code"?)'),
        ('questions: [{name: a, question: b, kind: choice}]', 'a choice needs "options"'),
        ('questions: [{name: a, question: b, options: [c, d]}]', 'of a question'),
        ('questions: [{name: a, question: b}, {name: a, question: c}]', 'is named "a" too'),
        ('questions: [{name: a}]', 'questions[0].question: this key is missing'),
        ('scenarios: 2', 'line 1: scenarios: '),
        ('listeners: [people]', 'line 1: listeners[0]: '),
        ('listeners: []', 'line 1: listeners: '),
        ('title: a\ntitle: b', 'line 2: title: the key "title" stands here twice'),
        ('just words', 'the study must be a mapping'),
    ],
)
def test_a_fault_is_told_with_its_line_in_words(read, line, reason):
    with pytest.raises(InputError) as caught:
        read(line)

    reason = reason.replace('of a question', 'options are for a question of "kind: choice" only')
    assert reason in str(caught.value).replace('study.yaml, line', 'study.yaml: line')


def test_all_faults_are_told_at_once(read):
    with pytest.raises(InputError, match='3 faults: line 1: .*; line 3: .*; line 4: ') as caught:
        read('minuts: 3\ntitle: a\nlanguages: [xx]\nseed: -1\n')

    assert 'languages[0]' in caught.value.reason
