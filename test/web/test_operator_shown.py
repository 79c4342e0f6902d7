"""What the operator's page says of what was heard of an explainer; neither ROS nor a browser."""

import json
import subprocess
import sys
from dataclasses import replace

import pytest

from mirror_explainer.errors import InputError
from mirror_explainer.web.operator.heard import Answer, Heard, Settings, Status, read_answer
from mirror_explainer.web.operator.shown import (
    MOST_GOALS,
    condition,
    controls,
    currency,
    explained,
    percent,
    progress,
    said,
)

EXPLANATION = {
    'strategy': 'informative',
    'n': 1,
    'sentences': ['I will exit.'],
    'positions': [1],
    'actions': ['(exit door)'],
    'information_gain': 0.7,
    'cross_entropy_before': 1.5,
    'cross_entropy_after': 0.8,
    'understanding_before': 0.1,
    'understanding': 0.2,
    'true_goal': 'the tenth',
    'optimal': True,
    'complete': True,
    'goals': [
        *({'name': f'goal {i}', 'prior': 0.1, 'posterior': 0.1 - i / 1000} for i in range(9)),
        {'name': 'the tenth', 'prior': 0.1, 'posterior': 0.01},
    ],
    'plan': [
        {'position': 0, 'action': '(go)', 'sentence': 'I will go.', 'information_gain': 0.1},
        {'position': 1, 'action': '(exit)', 'sentence': 'I will exit.', 'information_gain': 0.7},
    ],
    'inputs': 'a',
}
SETTINGS = Settings(n=3, strategy='informative', threshold=0.0, remember=False, answer_timeout=5.0)
READY = Status(0, 'ready', 'ready', 'a')
PLANNING = Status(0, 'planning 3 of 9', 'planning', 'b')
BAD_PLAN = Status(2, '/plan, line 1: the domain has no action "fly"', 'error', 'b', 'Correct it.')
PAGE = """
import sys
from mirror_explainer.web.operator.site import operator_site
from mirror_explainer.web.site import configure
configure(operator_site(None, '/'))
from django.core.wsgi import get_wsgi_application
from django.urls import resolve
get_wsgi_application()
resolve('/')  # imports the views
print(*sys.modules)
"""


def answer(**changes: object) -> Answer:
    return read_answer(json.dumps({**EXPLANATION, **changes}), '/explanation')


@pytest.fixture
def heard() -> Heard:
    """An explainer that is ready and has answered about its newest inputs."""
    heard = Heard('/mirror_explainer', status=READY, status_at='12:00:01', settings=SETTINGS)
    return heard.with_answer(answer(), '12:00:00')


def test_an_answer_about_the_newest_inputs_is_shown_without_a_warning(heard: Heard) -> None:
    assert said(heard).sentences == ('I will exit.',)
    assert currency(heard, follow=True).words == ''


@pytest.mark.parametrize('status', [replace(READY, inputs='b'), PLANNING, BAD_PLAN])
def test_an_answer_about_other_inputs_than_the_newest_is_called_old(
    heard: Heard, status: Status
) -> None:
    assert 'an older plan' in currency(replace(heard, status=status), follow=False).words


def test_without_news_it_is_not_claimed_that_the_answer_is_the_newest(heard: Heard) -> None:
    for silent in (replace(heard, silent=True), replace(heard, status=None)):
        assert 'may be old' in currency(silent, follow=True).words


@pytest.mark.parametrize(
    ('status', 'settings', 'follow', 'asks'),
    [
        (replace(READY, inputs='b'), SETTINGS, True, True),
        (replace(READY, inputs='b'), SETTINGS, False, False),
        (replace(READY, inputs='b'), replace(SETTINGS, remember=True), True, False),
        (replace(READY, inputs='b'), None, True, False),
        (READY, SETTINGS, True, False),
        (PLANNING, SETTINGS, True, False),
        (BAD_PLAN, SETTINGS, True, False),
    ],
)
def test_a_browser_that_follows_asks_once_the_robot_is_ready_with_something_new(
    heard: Heard, status: Status, settings: Settings | None, follow: bool, asks: bool
) -> None:
    now = replace(heard, status=status, settings=settings)
    assert currency(now, follow).ask == ('b' if asks else '')


@pytest.mark.parametrize(
    ('changes', 'kind', 'words'),
    [
        ({}, 'ready', 'The robot can be asked.'),
        ({'status': PLANNING}, 'working', 'The robot works out what to say.'),
        (
            {'status': replace(PLANNING, level=2)},  # until it is known whether an error is cured
            'working',
            'The robot works out what to say.',
        ),
        (
            {'status': BAD_PLAN},
            'error',
            '/plan, line 1: the domain has no action "fly". Correct it.',
        ),
        (
            {'status': Status(1, 'waiting for plan (topic)', 'waiting')},
            'warning',
            'Waiting for plan (topic).',
        ),
        (
            {'silent': True},
            'silent',
            'No news from /mirror_explainer for 5 s, the last at 12:00:01.',
        ),
        (
            {'status': None},
            'silent',
            'Nothing was heard of /mirror_explainer on /diagnostics yet. Is it running?',
        ),
    ],
)
def test_how_the_explainer_is_gets_a_word_and_a_sentence(
    heard: Heard, changes: dict[str, object], kind: str, words: str
) -> None:
    now = condition(replace(heard, **changes))  # type: ignore[arg-type]
    assert (now.kind, now.words) == (kind, words)


def test_only_the_progress_changes_while_the_explainer_plans(heard: Heard) -> None:
    third = replace(heard, status=PLANNING)
    fourth = replace(heard, status=replace(PLANNING, message='planning 4 of 9'))
    assert condition(third) == condition(fourth)
    assert (progress(third), progress(fourth)) == ('planning 3 of 9', 'planning 4 of 9')
    assert progress(heard) == ''


def test_a_failed_call_is_told_until_the_next_answer_or_until_the_state_is_another(
    heard: Heard,
) -> None:
    failed = replace(heard, status=BAD_PLAN).with_failure('no action "fly"', '12:00:02')
    assert said(failed).failure == 'At 12:00:02 there was no answer: No action "fly".'
    assert said(replace(failed, status=READY)).failure == ''
    assert said(failed.with_answer(answer(), '12:00:03')).failure == ''


@pytest.mark.parametrize(
    ('explanation', 'note'),
    [
        ({'sentences': [], 'positions': []}, 'There is nothing more to say about this plan.'),
        (
            {'sentences': [], 'positions': [], 'plan': []},
            "Nothing is left to do: the robot's goal is reached.",
        ),
    ],
)
def test_an_answer_without_sentences_says_why(
    heard: Heard, explanation: dict[str, object], note: str
) -> None:
    assert said(heard.with_answer(answer(**explanation), '12:00:03')).note == note


def test_the_steps_that_were_said_are_marked(heard: Heard) -> None:
    tables = explained(heard)
    assert tables is not None
    assert [(step.sentence, told) for step, told in tables.steps] == [
        ('I will go.', False),
        ('I will exit.', True),
    ]


def test_the_likeliest_goals_come_first_and_the_true_one_is_among_them(heard: Heard) -> None:
    tables = explained(heard)
    assert tables is not None
    names = [goal.name for goal in tables.goals]
    assert names == [*(f'goal {i}' for i in range(MOST_GOALS)), 'the tenth']
    assert len(tables.goals) + len(tables.other_goals) == 10


def test_answers_about_one_plan_are_set_side_by_side_and_a_new_plan_starts_anew(
    heard: Heard,
) -> None:
    both = heard.with_answer(answer(strategy='increasing'), '12:00:01')
    again = both.with_answer(answer(), '12:00:02')
    other_plan = again.with_answer(answer(inputs='b'), '12:00:03')
    other_memory = again.with_answer(answer(cross_entropy_before=0.8), '12:00:03')
    assert [other.strategy for other in again.tried] == ['increasing', 'informative']
    assert len(other_plan.tried) == 1
    assert len(other_memory.tried) == 1


def test_the_slider_ends_at_the_plans_length_but_never_below_its_own_value(heard: Heard) -> None:
    assert controls(replace(heard, answer=None)).most == 10
    assert controls(heard).most == 3
    assert controls(replace(heard, settings=replace(SETTINGS, n=1))).most == 2
    assert controls(replace(heard, settings=None)).n is None


@pytest.mark.parametrize(
    ('probability', 'words'),
    [
        (0.0, '0 %'),
        (1e-6, 'under 1 %'),
        (0.01, '1 %'),
        (1 / 3, '33 %'),
        (0.99, '99 %'),
        (0.9999, 'over 99 %'),
        (1.0, '100 %'),
    ],
)
def test_only_what_is_certain_is_0_or_100_percent(probability: float, words: str) -> None:
    assert percent(probability).replace('\u00a0', ' ') == words


def test_a_status_is_read_by_the_keys_of_the_diagnostics() -> None:
    values = {'state': 'error', 'inputs': 'b', 'what to do': 'Correct it.', 'workers': '2'}
    assert Status.of(2, BAD_PLAN.message, values) == BAD_PLAN
    assert Status.of(0, 'ready', {'what to do': 'nothing'}) == Status(0, 'ready')


def test_settings_are_read_in_the_order_of_their_names() -> None:
    assert Settings.of([3, 'informative', 0.0, False, 5.0]) == SETTINGS
    assert Settings.of([3, 'informative', 0.0, False, None]) is None
    assert Settings.of([]) is None


@pytest.mark.parametrize('text', ['', 'no JSON', '[]', '{"strategy": 3}'])
def test_what_is_no_explanation_is_named_with_its_topic(text: str) -> None:
    with pytest.raises(InputError, match='^/robot/explanation: this is no explanation'):
        read_answer(text, '/robot/explanation')


def test_the_page_needs_neither_numbers_nor_pddl() -> None:
    pytest.importorskip('django', reason='the extra [web] is not installed')
    done = subprocess.run([sys.executable, '-c', PAGE], capture_output=True, text=True, check=True)

    assert 'mirror_explainer.web.operator.views' in done.stdout.split()
    assert not {'numpy', 'unified_planning', 'mirror_explainer.pddl'} & set(done.stdout.split())
