"""Whatever the texts are: they are read, or refused with a place, and never in between.

MIRROR_EXPLAINER_FUZZ sets how many texts of each kind are tried (200 without; of PDDL, which is
slow to read, a fifth). With `pytest -s`, it is told how many were taken, and what took longest.
"""

import os
from collections.abc import Callable, Iterator
from pathlib import Path
from random import Random

import pytest
import yaml
from fuzz_readers import (
    HALL,
    LAMPS,
    MODELS,
    PDDL_WORDS,
    PLAN_WORDS,
    PLANS,
    PROGRESS,
    PROGRESS_WORDS,
    YAML_WORDS,
    damaged_pairs,
    plain_reading,
    try_goal,
    try_plan,
    try_progress,
    try_task,
    try_user_model,
)
from fuzzing import NOISE, Watch, damaged
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from pddl_cases import TOOLS_DOMAIN, TOOLS_PROBLEM, random_space

from mirror_explainer.listener.user_model import read_user_model
from mirror_explainer.pddl import Task, read_task
from mirror_explainer.pddl.plan_text import read_plan

CASES = int(os.environ.get('MIRROR_EXPLAINER_FUZZ', '200'))

fuzz = settings(
    max_examples=CASES,
    deadline=None,
    derandomize=True,
    database=None,
    suppress_health_check=list(HealthCheck),
)


@pytest.fixture
def watch(request: pytest.FixtureRequest) -> Iterator[Watch]:
    """A watch over all cases of one test."""
    watch = Watch()
    yield watch
    print(f'\n{request.node.name}: {watch}')


@pytest.fixture(scope='module')
def tools() -> Task:
    return read_task(TOOLS_DOMAIN, TOOLS_PROBLEM)


@pytest.fixture(scope='module')
def lamps() -> Task:
    return read_task(LAMPS, HALL)


@fuzz
@given(text=damaged(PLANS, PLAN_WORDS) | NOISE)
def test_a_plan_text_is_refused_with_a_place_or_can_really_be_carried_out(
    tools: Task, watch: Watch, text: str
) -> None:
    watch.over(text, lambda: try_plan(tools, text))


@fuzz
@given(text=damaged(PROGRESS, PROGRESS_WORDS) | NOISE)
def test_a_progress_text_is_refused_with_a_place_or_is_about_the_plan(
    watch: Watch, text: str
) -> None:
    watch.over(text, lambda: try_progress(['(cut-slowly)', '(polish)', '(polish)'], text))


# unified-planning's reader takes some hundredths of a second
@settings(fuzz, max_examples=max(CASES // 5, 100))
@given(texts=damaged_pairs())
def test_a_task_is_refused_with_a_place_or_is_what_unified_planning_reads(
    watch: Watch, texts: tuple[str, str]
) -> None:
    watch.over('\n'.join(texts), lambda: try_task(*texts))


@fuzz
@given(goal=damaged(['(and (power) (forall (?l - lamp) (imply (power) (lit ?l))))'], PDDL_WORDS))
def test_a_goal_is_refused_or_taken(lamps: Task, watch: Watch, goal: str) -> None:
    watch.over(goal, lambda: try_goal(lamps, goal))


@fuzz
@given(text=damaged(MODELS, YAML_WORDS) | NOISE, hypotheses=NOISE)
def test_a_user_model_is_refused_with_a_place_or_says_every_action_and_adds_up_to_one(
    task: Task, watch: Watch, tmp_path: Path, text: str, hypotheses: str
) -> None:
    model, goals = text.encode('utf-8', 'surrogatepass'), hypotheses.encode('utf-8', 'replace')
    watch.over(text, lambda: try_user_model(task, tmp_path, model, goals))


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
    said = {str(atom) for atom, value in plain.explicit_initial_values.items() if value.is_true()}
    found = read.model.explicit_initial_values
    assert {str(atom) for atom, value in found.items() if value.is_true()} == said
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
