"""Reading PDDL: tasks, goals and atoms, and the place of what is wrong."""

import re

import pytest
from unified_planning import environment

from mirror_explainer.errors import InputError
from mirror_explainer.pddl import (
    Task,
    atom_text,
    conjuncts,
    fluent_expression,
    forget_expressions,
    goal_expression,
    ground_text,
    read_task,
)

DOMAIN = """\
; one lamp
(define (domain lamps)
  (:requirements :strips :typing)
  (:types lamp - thing switch - thing)
  (:predicates (lit ?l - lamp) (wired ?s - switch ?l - lamp) (power))
  (:action press
    :parameters (?s - switch ?l - lamp)
    :precondition (and (wired ?s ?l) (power))
    :effect (lit ?l)))
"""
PROBLEM = """\
; the hall
(define (problem hall)
  (:domain lamps)
  (:objects l1 l2 - lamp s1 - switch)
  (:init (power)
         (wired s1 l1))
  (:goal (lit l1)))
"""


@pytest.fixture(scope='module')
def lamps() -> Task:
    return read_task(DOMAIN, PROBLEM)


def test_a_task_gives_its_initial_facts_and_goal_as_canonical_texts(lamps: Task) -> None:
    assert lamps.initial_facts == {'(power)', '(wired s1 l1)'}
    assert lamps.goal_text == '(lit l1)'
    assert {atom_text(literal) for literal in conjuncts(lamps.goal)} == {'(lit l1)'}


@pytest.mark.parametrize(
    'change',
    [
        str.upper,
        lambda text: text.replace('\n', '\r\n'),
        lambda text: '\ufeff' + text,
        lambda text: re.sub(r'\s+', ' ', re.sub(';.*', '', text)),
        lambda text: text.replace('\n', ' ; a (comment :goal\n'),
    ],
    ids=['capitals', 'CRLF', 'BOM', 'one line', 'comments'],
)
def test_letter_case_line_ends_and_comments_change_nothing(change) -> None:
    task = read_task(change(DOMAIN), change(PROBLEM))

    assert task.initial_facts == {'(power)', '(wired s1 l1)'}
    assert task.goal_text == '(lit l1)'
    assert [action.name for action in task.model.actions] == ['press']


def test_a_nested_goal_is_flattened_to_its_literals() -> None:
    nested = PROBLEM.replace('(lit l1)))', '(and (and (lit l1)) (and) (not (lit l2)))))')

    task = read_task(DOMAIN, nested)

    assert task.goal_text == '(and (and (lit l1)) (and) (not (lit l2)))'
    assert len(conjuncts(task.goal)) == 2
    assert len(task.model.goals) == 2


DOMAIN_FAULTS = {
    'empty': ('', 'domain: the text is empty; a PDDL domain is expected'),
    'blank': (' \n\t', 'domain: the text is empty; a PDDL domain is expected'),
    'no PDDL': (
        'hello',
        'domain, line 1: this is no PDDL domain: it must begin with (define (domain …)',
    ),
    'a problem': (
        PROBLEM,
        'domain, line 2: this is a PDDL problem, but a domain is expected here: '
        'are the two mixed up?',
    ),
    'a plan': ('(press s1 l1)', 'domain, line 1: this is no PDDL domain'),
    'unknown type': (
        DOMAIN.replace('?l - lamp)', '?l - lmp)', 1),
        'domain, line 5: the type "lmp" is not declared (did you mean "lamp"?)',
    ),
    'unknown predicate': (
        DOMAIN.replace('(power))\n    :eff', '(powr))\n    :eff'),
        'domain, line 8: (powr): the domain has no predicate "powr" (did you mean "power"?)',
    ),
    'arguments in the wrong order': (
        DOMAIN.replace('(and (wired ?s ?l)', '(and\n(WIRED ?l  ?s)'),
        'domain, line 9: (wired ?l ?s): ?l is of type lamp, but "wired" takes a switch there',
    ),
    'unknown variable': (DOMAIN.replace('(lit ?l)))', '(lit ?x)))'), 'domain, line 9: '),
    'unknown section': (DOMAIN.replace(':precondition', ':precond'), 'domain, line 8: '),
    'a parenthesis missing': (DOMAIN.rstrip()[:-1], 'domain, line '),
    'a condition without its end': (
        DOMAIN.replace('?l) (power))', '?l) (power)'),
        'domain, line 8: "(and" is not closed before ":effect" begins on line 9',
    ),
    'an action without its end': (
        DOMAIN.replace('(lit ?l)))', '(lit ?l)\n  (:action more :effect (power)))'),
        'domain, line 6: "(:action" is not closed before "(:action" begins on line 10',
    ),
    'a parenthesis too much': (DOMAIN + ')', 'domain, line 10: '),
    'types in a circle': (
        DOMAIN.replace('- thing switch - thing', '- switch switch - lamp'),
        'domain, line 4: the types "lamp", "switch" are declared as subtypes of each other',
    ),
    'an action twice': (
        DOMAIN.rstrip()[:-1] + '\n  (:action press :parameters () :effect (power)))',
        'domain, line 10: the action "press" is there twice, and not the same: on line 6 and on '
        'line 10',
    ),
    'a change by nothing': (
        DOMAIN.replace('(lit ?l)))', '(increase (lit ?l))))'),
        'domain, line 9: "(increase (lit ?l))" is wrong: write (increase (function …) number)',
    ),
    'a choice of effects': (
        DOMAIN.replace('(lit ?l)))', '(or (lit ?l) (power))))'),
        'domain, line 9: "(or (lit ?l) (power))" is no effect: "or" is for conditions only',
    ),
    'a condition of no effect': (
        DOMAIN.replace('(lit ?l)))', '(when (power))))'),
        'domain, line 9: "(when (power))" is no effect: write (when condition effect)',
    ),
    'parameters without their word': (
        DOMAIN.replace(':parameters ', ''),
        'domain, line 7: "(?s - switch ?l - lamp)" of "press" has no keyword before it: it may be '
        ':parameters, :precondition, :effect',
    ),
    'nested deeply': (DOMAIN.replace('(and (wi', '(and ' * 3000 + '(wi'), 'domain'),
}


@pytest.mark.parametrize(('text', 'said'), DOMAIN_FAULTS.values(), ids=DOMAIN_FAULTS)
def test_a_bad_domain_is_refused_with_its_place(text: str, said: str) -> None:
    with pytest.raises(InputError) as refused:
        read_task(text, PROBLEM)

    assert str(refused.value).startswith(said)
    assert '\n' not in str(refused.value)


PROBLEM_FAULTS = {
    'empty': ('', 'problem: the text is empty; a PDDL problem is expected'),
    'a domain': (DOMAIN, 'problem, line 2: this is a PDDL domain, but a problem is expected'),
    'unknown object': (PROBLEM.replace('(wired s1 l1)', '(wired s1 l9)'), 'problem, line 6: '),
    'unknown predicate': (PROBLEM.replace('(power)', '(powr)'), 'problem, line 5: '),
    'unknown predicate in the goal': (
        PROBLEM.replace('(lit l1)', '(and (lit l1) (powr))'),
        'problem, line 7: (powr): the domain has no predicate "powr" (did you mean "power"?)',
    ),
    'unknown object in the goal': (
        PROBLEM.replace('l1', 'lamp1').replace('(lit lamp1)', '(lit lamb1)'),
        'problem, line 7: the problem has no object "lamb1" (did you mean "lamp1"?)',
    ),
    'an object without its type': (
        PROBLEM.replace('- switch', '- s2 - switch'),
        'problem, line 4: the type of s1, or a name after "s1 - s2", is missing',
    ),
    'unknown type': (
        PROBLEM.replace('- switch', '- swich'),
        'problem, line 4: the type "swich" is not declared (did you mean "switch"?)',
    ),
    'wrong type': (
        PROBLEM.replace('(lit l1)', '(lit s1)'),
        'problem, line 7: (lit s1): s1 is of type switch, but "lit" takes a lamp there',
    ),
    'wrong number of arguments': (
        PROBLEM.replace('(lit l1)', '(lit)'),
        'problem, line 7: (lit): "lit" takes 1 argument, not 0',
    ),
    'a condition with a part missing': (
        PROBLEM.replace('(lit l1)', '(imply (power))'),
        'problem, line 7: "(imply (power))" is wrong: write (imply condition condition)',
    ),
    'a quantifier without variables': (
        PROBLEM.replace('(lit l1)', '(exists l1 (lit l1))'),
        'problem, line 7: "(exists l1 (lit l1))" is wrong: write (exists (?x - type) condition)',
    ),
    'a quantifier without condition': (
        PROBLEM.replace('(lit l1)', '(exists (?x - lamp))'),
        'problem, line 7: "(exists (?x - lamp))" is wrong: write (exists (?x - type) condition)',
    ),
    'a number of nothing': (
        PROBLEM.replace('(power)', '(power) (= () 5)'),
        'problem, line 5: "(= () 5)" gives no number',
    ),
    'a variable out of the blue': (
        PROBLEM.replace('(lit l1)', '(lit ?x)'),
        'problem, line 7: the variable ?x is not declared',
    ),
    'no goal': (
        PROBLEM.replace('(:goal (lit l1))', ''),
        'problem: the problem has no (:goal …)',
    ),
    'cut off': (PROBLEM[:-20], 'problem, line 2: the text ends before "(define" is closed'),
    'two goals': (
        PROBLEM.replace('(lit l1)', '(lit l1) (lit l2)'),
        'problem, line 7: (:goal …) takes one condition: join several by (and …)',
    ),
    'two values of a number': (
        PROBLEM.replace('(power)', '(= (watts l1) 5)\n(= (watts l1) 5.0)\n(= (watts l1) 6)'),
        'problem, line 7: the value of (watts l1) is there twice, and not the same: on line 5 and '
        'on line 7',
    ),
    'an object twice on a line': (
        PROBLEM.replace('l2 - lamp', 'l2 - lamp l2 - switch'),
        'problem, line 4: the object "l2" is there twice, and not the same: both on this line, at '
        'characters 16 and 26',
    ),
    'an object twice': (
        PROBLEM.replace('l2 - lamp', 'l2 - lamp\nl2 - switch'),
        'problem, line 5: the object "l2" is there twice, and not the same: on line 4 and on '
        'line 5',
    ),
}


@pytest.mark.parametrize(('text', 'said'), PROBLEM_FAULTS.values(), ids=PROBLEM_FAULTS)
def test_a_bad_problem_is_refused_with_its_place(text: str, said: str) -> None:
    with pytest.raises(InputError) as refused:
        read_task(DOMAIN, text)

    assert str(refused.value).startswith(said)
    assert '\n' not in str(refused.value)


def test_what_stands_before_a_definition_is_told_where_to_end() -> None:
    with pytest.raises(InputError) as refused:
        read_task('(in-package lamps)\n' + DOMAIN, PROBLEM)

    assert refused.value.cure == 'Leave out what stands before the (define …) on line 3.'


def test_errors_name_the_file_or_topic_that_the_text_came_from() -> None:
    with pytest.raises(InputError, match='^/robot/problem: the text is empty'):
        read_task(DOMAIN, '', 'lamps.pddl', '/robot/problem')
    with pytest.raises(InputError, match='^lamps.pddl: the text is empty'):
        read_task('', PROBLEM, 'lamps.pddl', '/robot/problem')


def test_a_problem_of_another_domain_that_does_not_fit_is_told_so() -> None:
    other = PROBLEM.replace('(:domain lamps)', '(:domain doors)').replace('power', 'open')

    with pytest.raises(InputError) as refused:
        read_task(DOMAIN, other)

    assert '(the problem is for domain "doors", and the domain given is "lamps")' in str(
        refused.value
    )


def test_an_unknown_type_in_either_is_named_with_its_line() -> None:
    domain = DOMAIN.replace('(lit ?l - lamp)', '(lit ?l - (either lamp\n bulb))', 1)

    with pytest.raises(InputError, match='^domain, line 6: the type "bulb" is not declared'):
        read_task(domain, PROBLEM)


def test_axioms_in_an_old_form_are_refused_with_their_line() -> None:
    axiom = '  (:axiom :context (lit l1) :implies (power))\n  (:action'

    with pytest.raises(
        InputError, match=r'^domain, line 6: \(:axiom …\) is an old form of axioms'
    ):
        read_task(DOMAIN.replace('  (:action', axiom, 1), PROBLEM)


def test_a_metric_of_a_function_that_is_not_there_is_told_as_that() -> None:
    metric = '(lit l1))\n  (:metric minimize (+ (watts) 1)))'

    task = read_task(DOMAIN, PROBLEM.replace('(lit l1)))', metric))

    assert task.warnings == (
        'problem, line 8: every action counts the same, since the metric names what the domain '
        'has no function for: (watts)',
    )


def test_the_least_total_time_is_no_metric_where_nothing_takes_time() -> None:
    timed = PROBLEM.replace('(lit l1)))', '(lit l1))\n  (:metric MINIMIZE\n ( total-time )))')

    task = read_task(DOMAIN, timed)

    assert task.model.quality_metrics == []
    assert 'total-time' not in task.problem


@pytest.mark.parametrize(
    ('goal', 'expected'),
    [
        ('(lit l1)', 'lit(l1)'),
        ('(LIT  L1)', 'lit(l1)'),
        ('(not (lit l1))', '(not lit(l1))'),
        ('(and (lit l1) (not (power)))', '(lit(l1) and (not power))'),
        ('(or (lit l1) (power))', '(lit(l1) or power)'),
        ('(imply (power) (lit l1))', '(power implies lit(l1))'),
        ('(forall (?l - lamp) (lit ?l))', 'Forall (lamp - thing l) lit(l)'),
        (
            '(exists (?X - LAMP) (and (LIT ?x) (power)))',
            'Exists (lamp - thing x) (lit(x) and power)',
        ),
        (
            '(forall (?s - switch ?a ?b - lamp) (imply (wired ?s ?a) (not (wired ?s ?b))))',
            'Forall (switch - thing s, lamp - thing a, lamp - thing b) '
            '(wired(s, a) implies (not wired(s, b)))',
        ),
        (
            '(exists (?a - lamp) (forall (?b - lamp) (imply (lit ?b) (= ?a ?b))))',
            'Exists (lamp - thing a) Forall (lamp - thing b) (lit(b) implies (a == b))',
        ),
        ('(and)', 'true'),
    ],
)
def test_goal_descriptions_of_every_kind_are_understood(
    lamps: Task, goal: str, expected: str
) -> None:
    # unified-planning puts some pairs of parentheses more around connectives.
    def plain(text):
        return re.sub(r'[()\s]+', ' ', text).split()

    assert plain(str(goal_expression(lamps.model, goal))) == plain(expected)


def test_a_quantified_goal_equals_the_same_goal_of_the_problem() -> None:
    text = '(and (forall (?l - lamp) (or (lit ?l) (power))) (not (lit l2)))'
    task = read_task(DOMAIN, PROBLEM.replace('(lit l1)', text))

    candidate = goal_expression(task.model, f'(and (and {text[5:]})')

    assert set(conjuncts(candidate)) == set(conjuncts(task.goal))


GOAL_FAULTS = {
    '(lit l9)': 'the problem has no object "l9"',
    '(lti l1)': '(lti l1): the domain has no predicate "lti" (did you mean "lit"?)',
    '(lit)': '(lit): "lit" takes 1 argument, not 0',
    '(power l1)': '(power l1): "power" takes 0 arguments, not 1',
    '(lit s1)': '(lit s1): s1 is of type switch, but "lit" takes a lamp there',
    '(lit ?l)': 'the variable ?l is not declared',
    '(forall (?l - lmp) (power))': 'the domain has no type "lmp"',
    '(forall (?s - switch) (lit ?s))': '(lit ?s): ?s is of type switch, but "lit" takes a lamp',
    '(and power)': '"power" is no condition: write (predicate object …)',
    '((lit l1))': '"((lit l1))" is no condition: write (predicate object …)',
    '(lit (l1))': '"(lit (l1))" is no atom such as (predicate object)',
    '(not (lit l1) (power))': '"(not (lit l1) (power))" is wrong: write (not condition)',
    'lit l1': '"lit l1" is not one expression in balanced parentheses',
    '(lit l1': '"(lit l1" is not one expression in balanced parentheses',
    '(lit l1) (power)': '"(lit l1) (power)" is not one expression in balanced parentheses',
    '': '"" is not one expression in balanced parentheses',
}


@pytest.mark.parametrize(('goal', 'said'), GOAL_FAULTS.items(), ids=GOAL_FAULTS)
def test_a_bad_goal_is_refused_in_words(lamps: Task, goal: str, said: str) -> None:
    with pytest.raises(InputError) as refused:
        goal_expression(lamps.model, goal)

    assert refused.value.reason.startswith(said)


def test_all_faults_of_a_goal_are_told_at_once(lamps: Task) -> None:
    with pytest.raises(InputError) as refused:
        goal_expression(lamps.model, '(and (lti l1) (or (lit l9) (not (power s1))))')

    assert refused.value.reason == (
        '(lti l1): the domain has no predicate "lti" (did you mean "lit"?); '
        'the problem has no object "l9"; '
        '(power s1): "power" takes 0 arguments, not 1'
    )


def test_a_goal_nested_too_deeply_is_refused(lamps: Task) -> None:
    with pytest.raises(InputError, match='nested too deeply'):
        goal_expression(lamps.model, '(not ' * 1000 + '(power)' + ')' * 1000)


def test_a_number_is_no_fact() -> None:
    domain = DOMAIN.replace('(:action', '(:functions (watts ?l - lamp) - number)\n  (:action')
    task = read_task(domain, PROBLEM)

    with pytest.raises(InputError, match='"watts" is a number, not a fact'):
        goal_expression(task.model, '(watts l1)')


def test_an_atom_is_understood_and_a_condition_is_no_atom(lamps: Task) -> None:
    assert atom_text(fluent_expression(lamps.model, '( WIRED  s1 l1 )')) == '(wired s1 l1)'
    assert ground_text('Wired', ['S1', 'l1']) == '(wired s1 l1)'
    with pytest.raises(InputError, match='is no atom'):
        fluent_expression(lamps.model, '(not (power))')


def test_a_megabyte_of_noise_is_refused_at_once() -> None:
    for noise in ('x' * 1_000_000, '(' * 1_000_000, ' ' * 1_000_000, ';\n' * 500_000, '\0' * 99):
        with pytest.raises(InputError):
            read_task(noise, PROBLEM)
        with pytest.raises(InputError):
            read_task(DOMAIN, noise)


def test_expressions_are_kept_only_until_they_are_forgotten(warehouse, monkeypatch):
    default = environment.GLOBAL_ENVIRONMENT  # other tests' tasks need it afterwards
    monkeypatch.setattr(environment, 'GLOBAL_ENVIRONMENT', default)
    domain, problem = ((warehouse / f'{name}.pddl').read_text() for name in ('domain', 'problem'))
    counts = []
    for number in range(3):
        forget_expressions()
        task = read_task(domain, problem.replace('red_cube', f'red_cube_{number}'))
        counts.append(len(environment.get_environment().expression_manager.expressions))
    assert counts == counts[:1] * 3
    assert '(item-at red_cube_2 red_room)' in task.initial_facts
