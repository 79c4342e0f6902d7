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
    MOST_STEPS,
    asks,
    belief,
    controls,
    explained,
    percent,
    progress,
    said,
    status,
    timeline,
)

EXPLANATION = {
    'strategy': 'informative',
    'n': 1,
    'sentences': ['I will exit.'],
    'spoken': 'I will exit.',
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
    parts = said(heard), belief(heard), timeline(heard)
    assert [part and part.old for part in parts] == [False, False, False]
    assert status(heard).kind == 'ready'


@pytest.mark.parametrize('now', [replace(READY, inputs='b'), PLANNING, BAD_PLAN])
def test_an_answer_about_other_inputs_than_the_newest_is_called_old(
    heard: Heard, now: Status
) -> None:
    new = replace(heard, status=now)
    parts = said(new), belief(new), timeline(new)
    assert [part and part.old for part in parts] == [True, True, True]


def test_without_news_it_is_not_claimed_that_the_answer_is_the_newest(heard: Heard) -> None:
    for silent in (replace(heard, silent=True), replace(heard, status=None)):
        assert said(silent).old
        assert status(silent).word == 'Silent'


def test_a_step_that_is_done_makes_no_answer_old_but_another_episode_does(heard: Heard) -> None:
    about = heard.with_answer(answer(episode={'number': 4, 'reason': 'first'}), '12:00:00')
    ticked = replace(about, status=replace(READY, inputs='b', episode=4, done=1, running=1))
    replanned = replace(about, status=replace(READY, inputs='c', episode=5))

    assert (status(ticked).kind, said(ticked).old, asks(ticked, follow=True)) == (
        'ready',
        False,
        '',
    )
    ticks = timeline(ticked)
    assert ticks is not None
    assert [mark.status for mark in ticks.marks] == ['done', 'running']
    assert (status(replanned).kind, said(replanned).old) == ('old', True)
    assert asks(replanned, follow=True) == '5'


@pytest.mark.parametrize(
    ('now', 'settings', 'follow', 'asked'),
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
    heard: Heard, now: Status, settings: Settings | None, follow: bool, asked: bool
) -> None:
    new = replace(heard, status=now, settings=settings)
    assert asks(new, follow) == ('b' if asked else '')


def test_a_browser_that_follows_asks_the_first_time_too() -> None:
    nobody_asked = Heard('/mirror_explainer', status=READY, settings=SETTINGS)
    assert asks(nobody_asked, follow=True) == 'a'
    assert asks(nobody_asked, follow=False) == ''


@pytest.mark.parametrize(
    ('changes', 'kind', 'words', 'details'),
    [
        ({}, 'ready', 'Ready. The robot can be asked.', ''),
        ({'status': PLANNING}, 'working', 'Working. The robot works out what to say.', ''),
        (
            {'status': replace(PLANNING, level=2)},  # until it is known whether an error is cured
            'working',
            'Working. The robot works out what to say.',
            '',
        ),
        (
            {'status': BAD_PLAN},
            'fault',
            'Fault. What the robot tells of its task has a fault: it cannot be explained. '
            'Correct it.',
            BAD_PLAN.message,
        ),
        (
            {'status': Status(1, 'waiting for plan (topic)', 'waiting')},
            'working',
            'Waiting. The robot has not told what it is up to yet.',
            'waiting for plan (topic)',
        ),
        (
            {'status': replace(READY, level=1, message='ready, but …', cure='Look.')},
            'remark',
            'Ready. The robot can be asked, with a reservation. Look.',
            'ready, but …',
        ),
        (
            {'status': replace(READY, inputs='b')},
            'old',
            'New plan. The robot has another plan since: this answer is about the one before. '
            'Ask again.',
            '',
        ),
        (
            {'silent': True},
            'silent',
            'Silent. No news from /mirror_explainer for 5 s, the last at 12:00:01. Is the '
            'explainer running? An answer below may be old.',
            '',
        ),
        (
            {'status': None},
            'silent',
            'Silent. Nothing was heard of /mirror_explainer yet. Is the explainer running?',
            '',
        ),
    ],
)
def test_how_things_stand_is_one_word_one_sentence_and_what_to_do(
    heard: Heard, changes: dict[str, object], kind: str, words: str, details: str
) -> None:
    now = status(replace(heard, **changes))  # type: ignore[arg-type]
    told = f'{now.word}. {now.sentence} {now.cure}'.strip()
    assert (now.kind, told, now.details) == (kind, words, details)


def test_only_the_progress_changes_while_the_explainer_plans(heard: Heard) -> None:
    third = replace(heard, status=PLANNING)
    fourth = replace(heard, status=replace(PLANNING, message='planning 4 of 9'))
    assert status(third) == status(fourth)
    assert (progress(third), progress(fourth)) == ('planning 3 of 9', 'planning 4 of 9')
    assert progress(heard) == ''


def test_a_failed_call_is_told_until_the_next_answer_or_until_the_state_is_another(
    heard: Heard,
) -> None:
    failed = heard.with_failure('verbalize_plan gave no reply in 5 s', '12:00:02')
    assert (status(failed).word, status(failed).sentence, status(failed).details) == (
        'No answer',
        'There was no answer at 12:00:02.',
        'verbalize_plan gave no reply in 5 s',
    )
    assert status(replace(failed, status=PLANNING)).kind == 'working'
    assert status(failed.with_answer(answer(), '12:00:03')).kind == 'ready'


def test_a_failed_call_never_contradicts_what_else_is_known(heard: Heard) -> None:
    failed = replace(heard, status=BAD_PLAN).with_failure('no action "fly"', '12:00:02')
    assert status(failed) == status(replace(heard, status=BAD_PLAN))
    silent = replace(heard, silent=True).with_failure('no reply', '12:00:02')
    assert (status(silent).word, status(silent).details) == ('Silent', 'no reply')


def test_what_is_heard_is_shown_a_sentence_a_line(heard: Heard) -> None:
    told = heard.with_answer(answer(spoken='I take the cup and a plate.\nI leave.'), '12:00:03')
    assert said(told).sentences == ('I take the cup and a plate.', 'I leave.')


def test_the_belief_is_set_beside_what_the_baselines_would_have_told(heard: Heard) -> None:
    others = [
        {'strategy': 'increasing', 'positions': [0], 'understanding': 0.1},
        {'strategy': 'decreasing', 'positions': [1], 'understanding': 0.15},
    ]
    shown = belief(heard.with_answer(answer(baselines=others), '12:00:03'))
    assert shown is not None
    assert (shown.before, shown.after, shown.goal) == (0.1, 0.2, 'the tenth')
    assert shown.instead == (('its first step', 0.1), ('its last step', 0.15))
    words = belief(heard.with_answer(answer(in_words={'the tenth': 'fetch a cup'}), ''))
    assert words is not None
    assert words.goal == 'fetch a cup'
    itself = belief(heard.with_answer(answer(baselines=others, strategy='increasing'), ''))
    assert itself is not None
    assert [name for name, _ in itself.instead] == ['its last step']
    assert belief(replace(heard, answer=None)) is None


def test_the_timeline_tells_what_is_done_now_and_said_and_folds_a_long_plan(
    heard: Heard,
) -> None:
    rows: list[dict[str, object]] = [
        {
            'position': i,
            'action': '(go)',
            'sentence': 'I will go.',
            'information_gain': 0.1,
            'status': standing,
        }
        for i, standing in enumerate(['done', 'running', *['ahead'] * (MOST_STEPS - 2)])
    ]
    short = timeline(heard.with_answer(answer(plan=rows), ''))
    long = timeline(heard.with_answer(answer(plan=[*rows, {**rows[-1], 'position': 12}]), ''))
    assert short is not None
    assert long is not None
    assert [mark.status for mark in short.marks[:3]] == ['done', 'running', 'ahead']
    assert [mark.number for mark in short.marks if mark.said] == [2]
    assert (short.done, short.said, short.long, long.long) == (1, 1, False, True)
    assert timeline(heard.with_answer(answer(plan=[]), '')) is None


def test_a_step_that_is_ticked_off_is_told_in_the_past(heard: Heard) -> None:
    tenses = {'ahead': 'I will go.', 'running': 'I am going.', 'done': 'I have gone.'}
    row = {**EXPLANATION['plan'][0], 'status': 'ahead', 'tenses': tenses}  # type: ignore[index]

    shown = timeline(heard.with_answer(answer(plan=[row], episode={'number': 1}), ''))
    later = replace(heard, status=replace(READY, episode=1, done=1))
    after = timeline(later.with_answer(answer(plan=[row], episode={'number': 1}), ''))

    assert shown is not None
    assert after is not None
    assert (shown.marks[0].sentence, after.marks[0].sentence) == ('I will go.', 'I have gone.')
    assert after.marks[0].others == ('I will go.', 'I am going.')


def test_a_step_that_was_left_out_is_not_ticked_off_for_the_next_one(heard: Heard) -> None:
    row = EXPLANATION['plan'][0]  # type: ignore[index]
    plan = [{**row, 'status': 'skipped'}, {**row, 'status': 'ahead'}]

    later = replace(heard, status=replace(READY, episode=1, done=1))
    shown = timeline(later.with_answer(answer(plan=plan, episode={'number': 1}), ''))

    assert shown is not None
    assert [mark.status for mark in shown.marks] == ['skipped', 'done']


def test_goals_that_lack_a_part_of_each_candidate_are_a_row_without_a_name(heard: Heard) -> None:
    goals = [*EXPLANATION['goals'], {'name': None, 'prior': 0.3, 'posterior': 0.5}]  # type: ignore[misc]
    tables = explained(heard.with_answer(answer(goals=goals), ''))
    assert tables is not None
    assert tables.goals[0].name is None


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
    moving = {'episode': '12, new task', 'progress': '3 done, 1 running, 8 ahead'}
    answered = Status.of(0, 'ready', {**moving, 'calls answered': '2'})
    assert (answered.episode, answered.done, answered.running) == (12, 3, 1)
    # Its numbers begin anew with it: they are not those of an answer that was heard before.
    assert Status.of(0, 'ready', {**moving, 'calls answered': '0'}).episode == 0


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
