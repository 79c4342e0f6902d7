"""Whatever the texts are: they are read, or refused with a place, and never in between.

MIRROR_EXPLAINER_FUZZ sets how many texts of each kind are tried (500 without; of PDDL, which is
slow to read, a fifth). With `pytest -s`, the slowest text is told.
"""

import os
import re
import unicodedata
from collections.abc import Callable, Iterator
from random import Random

import pytest
import yaml
from fuzzing import NOISE, Watch, damaged, require_told_well
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from pddl_cases import TOOLS_DOMAIN, TOOLS_PROBLEM, random_space
from unified_planning.engines import SequentialPlanValidator, ValidationResultStatus
from unified_planning.io import PDDLReader
from unified_planning.plans import ActionInstance, SequentialPlan

from mirror_explainer.errors import InputError
from mirror_explainer.input_limits import InputLimits
from mirror_explainer.pddl import Task, goal_expression, read_task
from mirror_explainer.plan_text import Step, check_plan, read_plan, without_dummy
from mirror_explainer.prior import belief_prior
from mirror_explainer.sentences import Sentences, action_parameters
from mirror_explainer.text_files import plain_text
from mirror_explainer.user_model import read_user_model

CASES = int(os.environ.get('MIRROR_EXPLAINER_FUZZ', '500'))
LIMITS = InputLimits()
UNSAYABLE = {'Cc', 'Zl', 'Zp'}  # control characters, and ends of lines

LAMPS = """\
; one lamp
(define (domain lamps)
  (:requirements :adl :action-costs)
  (:types lamp - thing switch - thing)
  (:constants main - switch)
  (:predicates (lit ?l - lamp) (wired ?s - switch ?l - lamp) (power)
    (near ?t - thing))
  (:functions (total-cost) - number (watts ?l - lamp) - number)
  (:action press
    :parameters (?s - switch ?l - lamp)
    :precondition (and (wired ?s ?l) (power) (forall (?x - lamp) (or (= ?x ?l) (not (lit ?x)))))
    :effect (and (lit ?l) (when (near ?s) (near ?l)) (increase (total-cost) (watts ?l)))))
"""
HALL = """\
(define (problem hall)
  (:domain lamps)
  (:objects l1 l2 - lamp s1 - switch)
  (:init (power) ; yes
         (wired s1 l1) (wired main l2)
         (= (watts l1) 40.5) (= (watts l2) 3) (= (total-cost) 0))
  (:goal (and (lit l1) (not (lit l2))))
  (:metric minimize (total-cost)))
"""
DURATIVE = """\
(define (domain ovens)
  (:requirements :durative-actions :typing :derived-predicates)
  (:types pie)
  (:predicates (raw ?p - pie) (baked ?p - pie) (free) (edible ?p - pie))
  (:functions (size ?p - pie))
  (:derived (edible ?p - pie) (and (baked ?p) (free)))
  (:durative-action bake
    :parameters (?p - pie)
    :duration (= ?duration (* 2 (size ?p)))
    :condition (and (at start (raw ?p)) (at start (free)))
    :effect (and (at start (not (free))) (at end (free)) (at end (baked ?p)))))
"""
PIES = """\
(define (problem pies) (:domain ovens) (:objects a b - pie)
  (:init (raw a) (raw b) (free) (= (size a) 1.5) (= (size b) 2))
  (:goal (and (edible a) (baked b))))
"""
PAIRS = [(LAMPS, HALL), (DURATIVE, PIES), (TOOLS_DOMAIN, TOOLS_PROBLEM)]
_PDDL_WORDS = """
    and or not when forall exists imply = < * increase assign (:goal (:init (:metric (:constraints
    :requirements :contingent oneof ?l l1 lit (power) object number 0 -1 1e9999999 1.5 (:derived at
    start over all end #t ?duration total-cost total-time
"""
PDDL_WORDS = [
    *_PDDL_WORDS.split(),
    *('- lamp', '(either lamp switch)', '(not (power))', '(at 5 (power))', '(/ 1 0)'),
    '(unknown (power))',
]
PLANS = [
    '; cut, then polish\n(cut-fast)\n(cut-slowly)\n(polish) ; cost = 8 (general cost)\n',
    '0.000: (cut-slowly) [1.0]\n1.5: (polish) [D:1.00; C:0.10]\n(reach-goal)',
    'step 0: CUT-SLOWLY\n     1: POLISH\n',
    'SequentialPlan:\n    cut-slowly\n    polish()\n',
    '(move left center)\n(grab red_circle red_room)\n1e-05: (exit d p) [5]\nplan: move(a, b)',
]
_PLAN_WORDS = """
    (polish) polish cut-slowly 0.5: [1.0] 1e999: -1: nan: plan: SequentialPlan: center , [ ] [[
"""
PLAN_WORDS = [*_PLAN_WORDS.split(), 'step 3: ', '; cost', '(reach-goal)', '9' * 400]
MODELS = [
    """goals:
  - {name: tidy, goal: (and (holding red_cube) (outside bottom_door)), probability: 0.25}
  - goal: (holding blue_cube)
    probability: 3
uncertain_facts:
  - {fact: (charged), probability: 0.5}
one_of:
  - facts: {(item-at red_circle red_room): 0.7, (item-at red_circle blue_room): 0.3}
rationality: 1.0
unlisted_goal_probability: 0.05
sentences:
  grab: "I will grab {i}."
  move: {template: "To {b}.", when: {b: {red_room: "I will enter the red warehouse."}}}
objects: {red_circle: a red circle}
""",
    'hyps_file: hyps.dat\nobjects: {red_cube: "cube \\\\ é"}\nsentences: {move: "{{{a}}}"}\n',
]
_YAML_WORDS = """
    goals: goal: probability: one_of: facts: sentences: hyps_file: /etc/passwd hyps.dat - : ? | >
    --- ... &a *a true null .nan .inf -.inf 1e999 -1 1e-320 0x1F 1:1:1 2001-02-31 2001-01-01
    {b.__class__} {b[0]} {b!r} {b:>1000000000} {b:{c}} {{ }
"""
YAML_WORDS = [
    *_YAML_WORDS.split(),
    *('!!int ', '!!binary ', '!!set ', '!!python/object:os.system ', '%YAML 9.9', '<<: *a'),
    *('"\\e[31m"', '"\\ud800"', '"\\0"', '{a: {b: c}}', '- ', ': ', '9' * 400),
]

fuzz = settings(
    max_examples=CASES,
    deadline=None,
    derandomize=True,
    database=None,
    suppress_health_check=list(HealthCheck),
)


@pytest.fixture(scope='module', autouse=True)
def watch() -> Iterator[Watch]:
    watch = Watch()
    yield watch
    print(f'\n{watch.cases} texts, the slowest took {watch.slowest:.3f} s: {watch.slowest_text!r}')


@pytest.fixture(scope='module')
def tools() -> Task:
    return read_task(TOOLS_DOMAIN, TOOLS_PROBLEM)


def is_valid(task: Task, steps: tuple[Step, ...]) -> bool:
    """Let unified-planning's own validator say whether a plan is one of the task."""
    manager = task.model.environment.expression_manager
    plan = SequentialPlan(
        [
            ActionInstance(
                task.model.action(step.words[0]),
                manager.auto_promote([task.model.object(word) for word in step.words[1:]]),
            )
            for step in steps
        ]
    )
    result = SequentialPlanValidator().validate(task.model, plan)
    return bool(result.status is ValidationResultStatus.VALID)


@fuzz
@given(text=damaged(PLANS, PLAN_WORDS) | NOISE)
def test_a_plan_text_is_refused_with_a_place_or_can_really_be_carried_out(
    tools: Task, watch: Watch, text: str
) -> None:
    try:
        with watch.over(text):
            steps = without_dummy(tools, read_plan(text, 'plan', LIMITS))
            check_plan(tools, steps, 'plan', LIMITS)
    except InputError as error:
        require_told_well(error, text)
    else:
        assert is_valid(tools, steps)


def pddl_pairs() -> st.SearchStrategy[tuple[str, str]]:
    """Return domains and problems, one or both of them damaged."""

    def pair(texts: tuple[str, str]) -> st.SearchStrategy[tuple[str, str]]:
        domain, problem = texts
        bad_domain = damaged([domain], PDDL_WORDS)
        bad_problem = damaged([problem], PDDL_WORDS) | NOISE
        return (
            st.tuples(bad_domain, st.just(problem))
            | st.tuples(st.just(domain), bad_problem)
            | st.tuples(bad_domain, bad_problem)
        )

    return st.sampled_from(PAIRS).flatmap(pair)


def plain_reading(domain: str, problem: str):
    """Return the problem as unified-planning alone reads it, None if it refuses."""
    try:
        return PDDLReader().parse_problem_string(plain_text(domain), plain_text(problem))
    except Exception:
        return None


# unified-planning's reader takes some hundredths of a second
@settings(fuzz, max_examples=max(CASES // 5, 100))
@given(texts=pddl_pairs())
def test_a_task_is_refused_with_a_place_or_is_what_unified_planning_reads(
    watch: Watch, texts: tuple[str, str]
) -> None:
    domain, problem = texts
    try:
        with watch.over('\n'.join(texts)):
            read = read_task(domain, problem, 'domain', 'problem', LIMITS)
            assert read.goal_text.startswith('(')
            goal_expression(read.model, read.goal_text)
    except InputError as error:
        text = {'domain': domain, 'problem': problem}.get(error.source, '')
        require_told_well(error, text)
        return
    if not re.search('derived|durative|either|total-time', domain + problem, re.IGNORECASE):
        plain = plain_reading(domain, problem)
        assert plain is not None
        said = {str(k): str(v) for k, v in plain.explicit_initial_values.items()}
        assert {str(k): str(v) for k, v in read.model.explicit_initial_values.items()} == said


@fuzz
@given(text=damaged(MODELS, YAML_WORDS) | NOISE, hypotheses=NOISE)
def test_a_user_model_is_refused_with_a_place_or_says_every_action_and_adds_up_to_one(
    task: Task, watch: Watch, tmp_path_factory: pytest.TempPathFactory, text: str, hypotheses: str
) -> None:
    folder = tmp_path_factory.getbasetemp()
    (folder / 'hyps.dat').write_text(hypotheses, 'utf-8', 'replace')
    path = folder / 'user.yaml'
    path.write_text(text, 'utf-8', 'surrogatepass')
    try:
        with watch.over(text):
            model = read_user_model(path, task, limits=LIMITS)
            prior = belief_prior(task, model, 64)
    except InputError as error:
        require_told_well(error, text)
        return
    assert sum(goal.probability for goal in model.goals) == pytest.approx(1.0)
    assert 0.0 < prior.covered_mass <= 1.0
    assert all(0.0 < probability <= 1.0 for probability in prior.probabilities)
    sentences = Sentences(action_parameters(task), model.templates, model.objects)
    for action in ('(move left center)', '(exit bottom_door left)', '(grab red_cube red_room)'):
        assert not {unicodedata.category(letter) for letter in sentences.of(action)} & UNSAYABLE


WORDS = st.from_regex(r'[a-z][a-z0-9_-]{0,8}', fullmatch=True)
STEPS = st.lists(st.lists(WORDS, min_size=1, max_size=4).map(tuple), max_size=8)


@fuzz
@given(steps=STEPS, way=st.integers(0, 5), spaces=st.sampled_from([' ', '  ', '\t']))
def test_a_plan_is_understood_in_every_form_that_planners_write(
    steps: list[tuple[str, ...]], way: int, spaces: str
) -> None:
    forms: list[Callable[[int, tuple[str, ...]], str]] = [
        lambda n, words: f'({spaces.join(words)})',
        lambda n, words: f'{n}.000:{spaces}({" ".join(words)}){spaces}[1.0]',
        lambda n, words: f'step {n}: {spaces.join(words).upper()}',
        lambda n, words: f'{words[0]}({f",{spaces}".join(words[1:])})',
        lambda n, words: f'{n}: ({" ".join(words)}) [D:1.00; C:0.10]',
        lambda n, words: f'  ( {spaces.join(words).title()} ) ; (comment',
    ]
    text = '\n'.join(forms[way](number, words) for number, words in enumerate(steps))

    assert [step.words for step in read_plan(text)] == steps


@settings(fuzz, max_examples=max(CASES // 50, 20))
@given(seed=st.integers(0, 2**32))
def test_a_task_built_by_a_grammar_has_the_facts_that_unified_planning_reads(seed: int) -> None:
    space = random_space(Random(seed))

    read = read_task(space.domain, space.problem)

    plain = plain_reading(space.domain, space.problem)
    assert read.model.explicit_initial_values == plain.explicit_initial_values
    assert read.model.goals == plain.goals or not read.model.goals


PROBABILITY = st.floats(0, 1, allow_nan=False)
MODEL_VALUES = st.fixed_dictionaries(
    {
        'goals': st.lists(
            st.fixed_dictionaries(
                {
                    'goal': st.sampled_from(
                        ['(holding red_cube)', '(outside bottom_door)', '(and)']
                    ),
                    'name': st.text('abc é"\'\n:{}#-', min_size=1).filter(str.strip),
                    'probability': st.floats(1e-300, 1e300),
                }
            ),
            min_size=1,
            max_size=4,
            unique_by=lambda goal: goal['name'],
        ),
    },
    optional={
        'uncertain_facts': PROBABILITY.map(lambda p: [{'fact': '(charged)', 'probability': p}]),
        'rationality': st.floats(0, 1e300),
        'unlisted_goal_probability': st.floats(0, 0.99),
        'sentences': st.just({'grab': 'Ich nehme {i}: "{{so}}".'}),
        'objects': st.just({'red_cube': 'der rote Würfel'}),
    },
)


@fuzz
@given(values=MODEL_VALUES)
def test_a_user_model_built_by_a_grammar_is_read_as_it_was_written(
    tmp_path_factory: pytest.TempPathFactory, values: dict
) -> None:
    path = tmp_path_factory.getbasetemp() / 'built.yaml'
    path.write_text(yaml.safe_dump(values, allow_unicode=True), 'utf-8')

    model = read_user_model(path)

    total = sum(goal['probability'] for goal in values['goals'])
    assert [goal.name for goal in model.goals] == [goal['name'] for goal in values['goals']]
    for read, written in zip(model.goals, values['goals'], strict=True):
        assert read.probability == pytest.approx(written['probability'] / total, rel=1e-6)
    assert model.rationality == values.get('rationality', 1.0)
    assert len(model.uncertain_facts) == len(values.get('uncertain_facts', []))
