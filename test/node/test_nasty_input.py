"""What comes in when robots, editors or people do their worst: each by hand, each told well."""

import os
from collections.abc import Callable
from dataclasses import fields, replace
from pathlib import Path

import pytest
from pddl_cases import TOOLS_DOMAIN, TOOLS_PROBLEM, WAREHOUSE_DOMAIN, WAREHOUSE_PROBLEM

from mirror_explainer.errors import LONGEST_MESSAGE, InputError, one_line
from mirror_explainer.input_limits import InputLimits
from mirror_explainer.listener.prior import belief_prior
from mirror_explainer.listener.sentences import sentences_for
from mirror_explainer.listener.user_model import UserModel, read_user_model
from mirror_explainer.pddl import Task, read_task, require_definition
from mirror_explainer.pddl.plan_check import check_plan
from mirror_explainer.pddl.plan_text import read_plan
from mirror_explainer.pddl.text.definition import read_definition
from mirror_explainer.pddl.text.size import require_few
from mirror_explainer.text_files import read_text

LIMITS = InputLimits()
PUCRS = os.environ.get('MIRROR_EXPLAINER_PUCRS', '')
GOAL = 'goals: [{goal: (charged)}]\n'
TWENTY_MEGABYTES = 20_000_000

CHAIN_DOMAIN = """
(define (domain chain) (:requirements :typing) (:types place)
  (:predicates (at ?p - place) (link ?a ?b - place))
  (:action go :parameters (?a ?b - place)
    :precondition (and (at ?a) (link ?a ?b)) :effect (and (at ?b) (not (at ?a)))))
"""


def chain(places: int) -> str:
    """Return a problem whose plan is as long as there are places."""
    names = [f'p{number}' for number in range(places)]
    links = ' '.join(f'(link {a} {b})' for a, b in zip(names, names[1:], strict=False))
    return (
        f'(define (problem chain) (:domain chain) (:objects {" ".join(names)} - place)\n'
        f'(:init (at p0) {links})\n(:goal (at {names[-1]})))'
    )


def chain_plan(places: int) -> str:
    return '\n'.join(f'(go p{number} p{number + 1})' for number in range(places - 1))


def refusal(read: Callable[[], object]) -> InputError:
    """Return the error, which must be one printable line of readable length."""
    with pytest.raises(InputError) as refused:
        read()
    told = str(refused.value)
    assert told.isprintable()
    assert len(told) <= LONGEST_MESSAGE + 200
    return refused.value


@pytest.mark.parametrize('end', ['\r\n', '\r'], ids=['CRLF', 'CR only'])
@pytest.mark.parametrize('mark', ['', '\ufeff'], ids=['', 'BOM'])
def test_line_ends_and_byte_order_marks_of_any_system_change_nothing(
    end: str, mark: str, tmp_path: Path, warehouse: Path
) -> None:
    def foreign(name: str) -> str:
        return mark + (warehouse / name).read_text().replace('\n', end)

    path = tmp_path / 'model.yaml'
    path.write_bytes(foreign('user_model.yaml').encode())

    task = read_task(foreign('domain.pddl'), foreign('problem.pddl'))
    steps = read_plan(foreign('plan.txt'))

    assert task.initial_facts == read_task(WAREHOUSE_DOMAIN, WAREHOUSE_PROBLEM).initial_facts
    assert steps == read_plan((warehouse / 'plan.txt').read_text())
    assert check_plan(task, steps).cost == 10.0
    assert read_user_model(path, task) == read_user_model(warehouse / 'user_model.yaml', task)


@pytest.mark.parametrize('odd', ['é', 'ſ', 'İ', '🤖', '\0', '\ud800', '\x1b[2J', '\u202e'])
def test_a_name_with_letters_that_pddl_does_not_have_is_refused_at_its_line(odd: str) -> None:
    problem = TOOLS_PROBLEM.replace('(raw)', f'(raw) (r{odd}w)')
    of_problem = refusal(lambda: read_task(TOOLS_DOMAIN, problem))
    of_plan = refusal(lambda: read_plan(f'(cut-fast)\n(polish {odd}) no'))

    assert (of_problem.source, of_problem.line) == ('problem', 4)
    assert (of_plan.source, of_plan.line) == ('plan', 2)


def test_a_user_model_with_very_many_names_that_are_not_there_is_read_all_the_same(
    tmp_path: Path,
) -> None:
    path = tmp_path / 'model.yaml'
    names = ', '.join(f'p{number}x: name' for number in range(30_000))
    path.write_text(f'goals: [{{goal: (at p1)}}]\nobjects: {{{names}}}')
    task = read_task(CHAIN_DOMAIN, chain(2000), limits=LIMITS)

    prior = belief_prior(task, read_user_model(path, task, limits=LIMITS))

    assert len(prior.beliefs) == 2


def test_a_user_model_with_very_many_faults_is_refused_all_the_same(tmp_path: Path) -> None:
    path = tmp_path / 'model.yaml'
    path.write_text(GOAL + '\n'.join(f'key{number}: 1' for number in range(30_000)))

    error = refusal(lambda: read_user_model(path, limits=LIMITS))

    assert error.reason.startswith('30000 faults: line 2: key0: unknown key (there are goals, ')


def test_names_in_other_scripts_are_said_as_they_are(read_model, task: Task) -> None:
    model = read_model(
        GOAL + 'sentences: {grab: "我拿{i}。"}\nobjects: {red_cube: "قرمز\u200cرنگ"}\n'
    )

    sentences = sentences_for(task, model)

    assert sentences.of('(grab red_cube red_room)') == '我拿قرمز\u200cرنگ。'


@pytest.mark.parametrize('letter', ['x', '(', ' ', '\n', ';', '\0', '1'])
def test_twenty_megabytes_are_refused_before_anything_looks_at_them(letter: str) -> None:
    text = letter * TWENTY_MEGABYTES

    for read in (
        lambda: read_task(text, TOOLS_PROBLEM, limits=LIMITS),
        lambda: read_task(TOOLS_DOMAIN, text, limits=LIMITS),
        lambda: read_plan(text, limits=LIMITS),
    ):
        error = refusal(read)
        assert 'its bytes (20000000) are more than max_message_bytes allows (now 1000000)' in (
            error.reason
        )
        assert 'max_message_bytes' in error.cure


def test_a_file_of_twenty_megabytes_is_refused_after_its_first(tmp_path: Path) -> None:
    path = tmp_path / 'model.yaml'
    path.write_text('goals: [x' * (TWENTY_MEGABYTES // 9))

    error = refusal(lambda: read_text(str(path), LIMITS))

    assert 'max_message_bytes' in error.reason


def test_ten_thousand_objects_are_refused_with_the_limit_to_raise_and_read_once_it_is() -> None:
    error = refusal(lambda: read_task(CHAIN_DOMAIN, chain(10_000), limits=LIMITS))
    task = read_task(CHAIN_DOMAIN, chain(2001), limits=replace(LIMITS, max_objects=2001))

    assert error.reason == 'its objects (10000) are more than max_objects allows (now 2000)'
    assert len(task.initial_facts) == 2001


def test_a_plan_of_five_thousand_actions_is_refused_with_the_limit_to_raise() -> None:
    error = refusal(lambda: read_plan(chain_plan(5001), limits=LIMITS))

    assert error.reason == 'its actions (5000) are more than max_plan_length allows (now 1000)'
    assert len(read_plan(chain_plan(5001))) == 5000


def test_a_plan_of_a_thousand_actions_through_a_thousand_places_is_within_the_limits() -> None:
    task = read_task(CHAIN_DOMAIN, chain(1001), limits=LIMITS)
    steps = read_plan(chain_plan(1001), limits=LIMITS)

    assert check_plan(task, steps, limits=LIMITS).cost == 1000.0


def test_a_goal_of_very_many_atoms_is_refused_with_the_limit_to_raise() -> None:
    goal = f'(and {"(polished) " * 30_000})'
    problem = TOOLS_PROBLEM.replace('(:goal (polished))', f'(:goal {goal})')

    error = refusal(lambda: read_task(TOOLS_DOMAIN, problem, limits=LIMITS))

    assert error.reason.endswith('are more than max_words allows (now 10000)')


@pytest.mark.parametrize('depth', [60, 1000, 100_000])
def test_deep_nesting_is_refused_with_its_line(depth: int, read_model) -> None:
    goal = '(and ' * depth + '(polished)' + ')' * depth
    problem = TOOLS_PROBLEM.replace('(:goal (polished))', f'(:goal {goal})')
    domain = TOOLS_DOMAIN.replace('(polished)', goal)

    of_problem = refusal(lambda: read_task(TOOLS_DOMAIN, problem))
    of_domain = refusal(lambda: read_task(domain, TOOLS_PROBLEM))
    of_plan = refusal(lambda: read_plan('(' * depth + 'polish' + ')' * depth))

    assert (of_problem.line, of_domain.line, of_plan.line) == (5, 4, 1)
    assert 'nested too deeply' in of_problem.reason


@pytest.mark.parametrize('depth', [1000, 20_000])
def test_deep_nesting_in_a_user_model_is_refused(depth: int, read_model) -> None:
    goal = '(and ' * depth + '(charged)' + ')' * depth

    of_goal = refusal(lambda: read_model(f'goals:\n  - goal: {goal}\n'))
    of_yaml = refusal(lambda: read_model('goals: ' + '[' * depth))

    assert 'nested too deeply' in of_goal.reason
    assert of_yaml.source.endswith('user.yaml')


def test_a_condition_for_every_object_of_very_many_is_refused_before_it_is_checked() -> None:
    domain = """
    (define (domain grid) (:requirements :adl) (:predicates (near ?a ?b ?c ?d) (done))
      (:action look :parameters ()
        :precondition (forall (?a ?b ?c ?d) (not (near ?a ?b ?c ?d))) :effect (done)))
    """
    names = ' '.join(f'o{number}' for number in range(300))
    problem = f'(define (problem g) (:domain grid) (:objects {names}) (:init) (:goal (done)))'
    task = read_task(domain, problem, limits=LIMITS)

    error = refusal(lambda: check_plan(task, read_plan('(look)'), limits=LIMITS))

    # 300^4 conditions, the effect's condition and value, and the goal
    assert f'({300**4 + 3}) are more than max_instances allows (now 30000)' in error.reason


@pytest.mark.parametrize('number', ['1e999999999', '-1.5E-99999', '9' * 5000, '1e1_000_000_000'])
def test_a_number_that_would_take_gigabytes_to_write_out_is_refused_at_its_line(
    number: str,
) -> None:
    problem = TOOLS_PROBLEM.replace('(= (total-cost) 0)', f'\n(= (total-cost) {number})')

    error = refusal(lambda: read_task(TOOLS_DOMAIN, problem))

    assert (error.source, error.line) == ('problem', 5)


def test_numbers_that_are_squared_at_every_step_are_left_out() -> None:
    domain = """
    (define (domain growth) (:requirements :fluents) (:predicates (done)) (:functions (n))
      (:action square :parameters () :precondition ()
        :effect (and (done) (assign (n) (* (n) (n))))))
    """
    problem = '(define (problem g) (:domain growth) (:init (= (n) 3)) (:goal (done)))'

    task = read_task(domain, problem)

    assert task.warnings == (
        'domain, line 4: numbers that multiply or divide what changes are left out; a belief for '
        'which no plan is found then counts as unforeseen, not as impossible',
    )
    assert check_plan(task, read_plan('(square)\n' * 1000)).cost == 1000


def test_a_cost_too_large_for_a_float_is_refused() -> None:
    domain = TOOLS_DOMAIN.replace(
        '(increase (total-cost) 1)', f'(increase (total-cost) 1{"0" * 400})'
    )
    task = read_task(domain, TOOLS_PROBLEM)

    error = refusal(lambda: check_plan(task, read_plan('(cut-slowly)\n(polish)')))

    assert error.reason == 'its cost is too large a number'


BAD_YAML = {
    'aliases of aliases': (
        'a: &a [x, x, x, x, x, x, x, x, x]\n'
        + ''.join(
            f'{new}: &{new} [{", ".join([f"*{old}"] * 9)}]\n'
            for old, new in zip('abcdefgh', 'bcdefghi', strict=True)
        ),
        'its aliases stand for too much',
    ),
    'merges of merges': (
        'a: &a {k: v}\n'
        + ''.join(
            f'{new}: &{new} {{<<: [{", ".join([f"*{old}"] * 9)}]}}\n'
            for old, new in zip('abcdefgh', 'bcdefghi', strict=True)
        ),
        'its aliases stand for too much',
    ),
    'an alias of itself': ('goals: &a [*a]', 'an alias stands inside of what it stands for'),
    'a Python object': ('goals: !!python/object/apply:os.system ["true"]', 'python/object'),
    'a Python name': ('goals: !!python/name:os.system', 'python/name'),
    'a mapping as a key': ('? {a: b}\n: c', 'unhashable'),
    'a list as a key': ('? [a, b]\n: c', 'unhashable'),
    'a key twice': (GOAL + GOAL, 'the key "goals" stands here twice'),
    'a date as a goal': ('goals: [{goal: 2001-01-01}]', 'goals[0].goal: '),
    'a truth value as a name': (GOAL.replace('}', ', name: yes}'), 'goals[0].name: '),
    'a day that there is not': ('goals: [{goal: 2001-02-31}]', 'no YAML that can be read'),
    'a number as a sentence': (GOAL + 'sentences: {grab: 3}', 'sentences.grab: '),
    'a truth value as a probability': ('goals: [{goal: (charged), probability: yes}]', 'probabi'),
    'a huge integer': (f'goals: [{{goal: (charged), probability: {"9" * 5000}}}]', ''),
    'no number': ('goals: [{goal: (charged), probability: .nan}]', 'finite'),
    'infinity': ('goals: [{goal: (charged), probability: .inf}]', 'finite'),
    'a negative weight': ('goals: [{goal: (charged), probability: -1}]', 'greater than or equal'),
    'a probability above 1': (
        GOAL + 'uncertain_facts: [{fact: (charged), probability: 1.1}]',
        'less',
    ),
    'infinite rationality': (GOAL + 'rationality: .inf', 'finite'),
    'an attribute': (GOAL + 'sentences: {move: "{b.__class__}"}', '{b.__class__} is no parameter'),
    'an item': (GOAL + 'sentences: {move: "{b[0]}"}', '{b[0]} is no parameter'),
    'a conversion': (GOAL + 'sentences: {move: "{b!r}"}', 'write {b} without a format'),
    'a width': (GOAL + 'sentences: {move: "{b:>1000000000}"}', 'write {b} without a format'),
    'a field in a field': (GOAL + 'sentences: {move: "{b:{a}}"}', 'write {b} without a format'),
    'an escape in a sentence': (GOAL + 'sentences: {grab: "\\e]0;x\\a"}', 'no text: U+001B'),
    'an escape in a name': (GOAL + 'objects: {red_cube: "\\e[31m"}', 'no text: U+001B'),
    'half of a character': (GOAL + 'objects: {red_cube: "\\ud800"}', 'no text: U+D800'),
    'NUL': (GOAL + 'objects: {red_cube: "\\0"}', 'no text: U+0000'),
}


@pytest.mark.parametrize('what', BAD_YAML)
def test_a_user_model_with_something_nasty_in_it_is_refused(what: str, read_model) -> None:
    text, said = BAD_YAML[what]

    error = refusal(lambda: read_model(text))

    assert said in error.reason


def test_weights_huge_and_tiny_are_normalised(read_model, task: Task) -> None:
    model: UserModel = read_model(
        'goals:\n'
        '  - {goal: (charged), probability: 1.0e+308}\n'
        '  - {goal: (holding red_cube), probability: 1.0e+308}\n'
        '  - {goal: (outside bottom_door), probability: 1.0e-320}\n'
        'one_of: [{facts: {(item-at red_cube red_room): 1.0e-320, (charged): 2.0e-320}}]\n'
        'rationality: 1.0e+308\n'
    )

    prior = belief_prior(task, model)

    assert [goal.probability for goal in model.goals] == [0.5, 0.5, 0.0]
    # 1e-320 is so small that it has few digits left: a third within 1 %
    assert model.one_of[0]['(charged)'] == pytest.approx(2 / 3, rel=1e-2)
    assert prior.covered_mass == pytest.approx(1.0)


def test_a_sentence_is_one_line_whatever_line_ends_the_model_has(read_model, task: Task) -> None:
    model = read_model(
        GOAL + 'sentences: {grab: "one\\ntwo\\r\\n{i}\\L\\N."}\nobjects: {red_cube: "a\\n b"}\n'
    )

    said = sentences_for(task, model)

    assert said.of('(grab red_cube red_room)') == 'one two a b .'


def test_more_goals_and_uncertain_facts_than_can_be_enumerated_name_the_limit(
    model_file: Callable[[str], Path],
) -> None:
    goals = model_file('goals:\n' + ''.join(f'- goal: (g{n})\n' for n in range(1001)))
    of_goals = refusal(lambda: read_user_model(goals, limits=LIMITS))
    facts = ''.join(f'- {{fact: (f{n}), probability: 0.5}}\n' for n in range(101))
    uncertain = model_file(GOAL + 'uncertain_facts:\n' + facts)
    of_facts = refusal(lambda: read_user_model(uncertain, limits=LIMITS))

    assert of_goals.reason == 'its goals (1001) are more than max_goals allows (now 1000)'
    assert 'max_uncertain_facts allows (now 100)' in of_facts.reason


def test_hyps_file_may_be_wherever_the_owner_of_the_user_model_put_it(tmp_path: Path) -> None:
    folder = tmp_path / 'models'
    (folder / 'near').mkdir(parents=True)
    far = tmp_path / 'hyps.dat'
    far.write_text('(charged)')
    (folder / 'near' / 'hyps.dat').write_text('(charged)')
    (folder / 'link.dat').symlink_to(far)
    path = folder / 'model.yaml'

    for name in ('near/hyps.dat', '../hyps.dat', 'link.dat', str(far)):
        path.write_text(f'hyps_file: {name}')
        assert [goal.name for goal in read_user_model(path).goals] == ['(charged)']


@pytest.mark.parametrize('name', ['pipe', '/dev/zero', '/dev/tty', '.', 'loop', 'a\0b', 'x' * 300])
def test_what_is_no_regular_file_is_refused_without_waiting_for_it(
    name: str, tmp_path: Path
) -> None:
    os.mkfifo(tmp_path / 'pipe')
    (tmp_path / 'loop').symlink_to('loop')

    for limits in (None, LIMITS):
        error = refusal(lambda: read_text(str(tmp_path / name), limits))  # noqa: B023
        assert 'the file cannot be read' in error.reason


def test_what_an_error_quotes_can_neither_steer_a_terminal_nor_forge_a_line_nor_flood_a_log() -> (
    None
):
    attack = '(move\x1b]0;owned\x07 a)\u2028[INFO] all is well \x9b31m ' + 'x' * 100_000

    told = str(refusal(lambda: read_plan(attack, 'topic\x1b[2J\n[ERROR]')))

    assert told.startswith(r'topic\x1b[2J [ERROR], line 1: ')
    assert r'(move\x1b]0;owned\x07 a)' in told
    assert len(told) < 400
    assert one_line('a\n\tb  c') == 'a b c'
    assert len(one_line('word ' * 100_000)) < LONGEST_MESSAGE + 9


def test_an_error_says_the_limit_by_the_name_of_a_parameter_and_its_present_value() -> None:
    for field in fields(InputLimits):
        error = refusal(lambda: InputLimits().require(field.name, 1 << 40, 'they', 'topic'))  # noqa: B023
        assert f'more than {field.name} allows (now {field.default})' in error.reason


@pytest.mark.skipif(not PUCRS, reason='MIRROR_EXPLAINER_PUCRS does not name the PUCRS problems')
def test_every_goal_recognition_problem_is_within_the_limits() -> None:
    folders = sorted(Path(PUCRS).glob('*/*/template.pddl'))
    assert len(folders) >= 57
    for template in folders:
        goals = (template.parent / 'hyps.dat').read_text().lower().strip().splitlines()
        problem = template.read_text().lower().replace('<hypothesis>', goals[0].replace(',', ' '))
        domain = (template.parent / 'domain.pddl').read_text()
        require_definition(domain, 'domain', 'domain', LIMITS)
        require_definition(problem, 'problem', 'problem', LIMITS)
        # a tenth of what is allowed would do
        tenth = replace(LIMITS, max_objects=200, max_words=1000)
        require_few(
            read_definition(domain, 'domain', 'domain'),
            read_definition(problem, 'problem', str(template)),
            tenth,
        )
        assert len(goals) <= LIMITS.max_goals / 10
