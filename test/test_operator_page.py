"""The operator's page in a real browser, beside a real explainer and robot, over DDS."""

import http.client
import itertools
import os
import signal
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import pytest

pytest.importorskip('rclpy', reason='needs ROS 2')
pytest.importorskip('django', reason='the extra [web] is not installed')
pytest.importorskip('playwright', reason='playwright is not installed (the extra [test])')

import rclpy
from browser import PATIENCE, SCREENS, Server, overflow, person, served, violations
from playwright.sync_api import Locator, Page, expect
from ros_peer import DOMAIN, PLAN, PROBLEM, THREE_SENTENCES, USER_MODEL, Peer, running

expect.set_options(timeout=PATIENCE)
SENTENCES = THREE_SENTENCES.split('\n')
_namespaces = (f'/page_{os.getpid()}_{number}' for number in itertools.count())


@dataclass
class Stack:
    """A robot's stack under test: the robot is the peer."""

    peer: Peer
    page: Server
    folder: Path

    def explainer(self, **parameters: object):
        parameters = {'user_model_file': USER_MODEL, 'answer_timeout': 30.0} | parameters
        return running('explainer_node', self.peer.node.get_namespace(), self.folder, **parameters)


@contextmanager
def stack(folder: Path, arguments: Sequence[str] = ()) -> Iterator[Stack]:
    """A peer and an operator's page, in a namespace of their own."""
    peer = Peer(next(_namespaces))
    ros = ['--ros-args', '-r', f'__ns:={peer.node.get_namespace()}']
    command = ['-m', 'mirror_explainer.operator_page', '--port', '0', *arguments, *ros]
    try:
        with served(command) as server:
            yield Stack(peer, server, folder)
    finally:
        peer.close()


@pytest.fixture(scope='module', autouse=True)
def ros() -> Iterator[None]:
    rclpy.init()
    yield
    rclpy.try_shutdown()


@pytest.fixture(scope='module')
def shared(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Stack]:
    """A stack with an explainer, for tests that leave it as it was."""
    with stack(tmp_path_factory.mktemp('stack')) as shared, shared.explainer():
        shared.peer.publish_warehouse()
        shared.peer.answer()
        yield shared


@pytest.fixture
def operator(chromium, shared: Stack) -> Iterator[Page]:
    """A browser at the page of the shared stack, whose settings are the defaults."""
    shared.peer.set_parameters(n=3, strategy='informative', remember=False)
    with person(chromium) as page:
        page.goto(shared.page.url)
        expect(page.locator('#condition')).to_have_text('Ready. The robot can be asked.')
        yield page


def button(page: Page) -> Locator:
    return page.get_by_role('button', name='What are you up to?')


def answer(page: Page) -> Locator:
    return page.locator('#said').get_by_role('listitem')


def test_the_button_gives_the_answer_and_all_that_it_does_by_keyboard_alone(operator):
    button(operator).focus()
    operator.keyboard.press('Enter')
    expect(answer(operator)).to_have_text(SENTENCES)
    said = operator.get_by_role('table', name='The steps of the plan').get_by_role(
        'row', name='said'
    )
    goals = operator.get_by_role('table', name='How likely you find each goal')
    true_goal = goals.get_by_role('row', name='true goal')
    understanding = operator.get_by_role('row', name='Understanding: how likely')
    uncertainty = operator.get_by_role('row', name='Uncertainty (cross-entropy')
    expect(said).to_have_count(3)
    expect(true_goal).to_contain_text('red circle and blue cube, bottom door')
    expect(true_goal.get_by_role('cell')).to_have_text(['3 %', '100 %'])
    expect(understanding.get_by_role('cell')).to_have_text(['3 %', '100 %'])
    # log 30 nats before, and one goal with one plan left after (see test_explainer.py).
    expect(uncertainty.get_by_role('cell')).to_have_text(['3.40', '0.00'])
    expect(button(operator)).to_be_focused()
    assert violations(operator) == []


def test_slider_and_choice_set_the_parameters_and_change_the_answer(operator, shared):
    button(operator).click()
    expect(answer(operator)).to_have_text(SENTENCES)
    operator.get_by_role('slider', name='Sentences, at most (N)').focus()
    operator.keyboard.press('ArrowLeft')
    operator.keyboard.press('ArrowLeft')
    expect(answer(operator)).to_have_text(['I will exit from the bottom door.'])
    operator.get_by_role('radio', name='increasing').check()
    expect(answer(operator)).to_have_text(['I will navigate to the central corridor.'])
    tried = operator.get_by_role('table').filter(has_text='Strategy').get_by_role('rowheader')
    expect(tried).to_have_text(['increasing shown', 'informative', 'informative'])
    assert violations(operator) == []
    assert shared.peer.call().message == 'I will navigate to the central corridor.'


def test_settings_changed_elsewhere_are_seen(operator, shared):
    shared.peer.set_parameters(n=7, strategy='decreasing')
    expect(operator.get_by_role('slider')).to_have_value('7')
    expect(operator.get_by_role('radio', name='decreasing')).to_be_checked()


def test_after_a_replan_the_answer_is_called_old_until_the_robot_is_asked_again(operator, shared):
    button(operator).click()
    expect(operator.locator('#currency')).to_have_text('')
    shared.peer.publish('plan', PLAN.replace('(move left center)', '(move LEFT center) ; again'))
    expect(operator.locator('#currency')).to_contain_text('an older plan')
    assert violations(operator) == []
    button(operator).click()
    expect(operator.locator('#currency')).to_have_text('')
    shared.peer.publish('plan', PLAN)


def test_a_bad_message_is_told_in_words_and_a_good_one_heals_it(operator, shared):
    button(operator).click()
    expect(answer(operator)).to_have_text(SENTENCES)
    shared.peer.publish('plan', '(fly left <b>center</b>)')
    reason = f'{shared.peer.node.get_namespace()}/plan, line 1'
    expect(operator.locator('#condition')).to_contain_text(f'Error. {reason}')
    expect(operator.locator('#currency')).to_contain_text('an older plan')
    button(operator).click()
    expect(operator.locator('#said')).to_contain_text(f'there was no answer: {reason}')
    assert violations(operator) == []
    shared.peer.publish('plan', PLAN)
    expect(operator.locator('#condition')).to_have_text('Ready. The robot can be asked.')
    expect(operator.locator('#currency')).to_have_text('')
    expect(operator.locator('#said')).not_to_contain_text('there was no answer')


def test_what_is_no_explanation_is_told_and_does_not_end_the_page(operator, shared):
    shared.peer.publish('mirror_explainer/explanation', '{"strategy": "<script>"}')
    expect(operator.locator('#said')).to_contain_text('this is no explanation')
    button(operator).click()
    expect(operator.locator('#said')).not_to_contain_text('this is no explanation')


def test_with_remember_asking_again_tells_more_and_forgetting_starts_over(operator, shared):
    shared.peer.set_parameters(remember=True, n=2)
    forget = operator.get_by_role('button', name='Forget what was said')
    forget.click()
    button(operator).click()
    expect(answer(operator)).to_have_count(2)
    first = answer(operator).all_text_contents()
    button(operator).click()
    expect(answer(operator).first).not_to_have_text(first[0])
    second = answer(operator).all_text_contents()
    operator.get_by_role('radio', name='decreasing').check()
    expect(operator.locator('#controls')).to_contain_text('for the next answer')
    operator.get_by_role('radio', name='informative').check()
    assert violations(operator) == []
    forget.click()
    button(operator).click()
    expect(answer(operator)).to_have_text(first)
    assert not set(first) & set(second)


def test_two_browsers_show_the_same_answer_and_both_can_ask(chromium, operator, shared):
    with person(chromium, 'tablet') as other:
        other.goto(shared.page.url)
        shared.peer.set_parameters(n=1)
        button(other).click()
        expect(answer(operator)).to_have_text(['I will exit from the bottom door.'])
        shared.peer.set_parameters(n=2)
        button(operator).click()
        expect(answer(other)).to_have_text(SENTENCES[:2])


@pytest.mark.parametrize('screen', SCREENS)
def test_the_page_fits_every_screen_also_at_200_percent(chromium, shared, screen):
    with person(chromium, screen) as page:
        page.goto(shared.page.url)
        button(page).click()
        expect(answer(page).first).to_be_visible()
        page.locator('summary').click()
        assert overflow(page) <= 0
        assert violations(page) == []


def test_without_scripts_the_button_works_too(chromium, shared):
    context = chromium.new_context(java_script_enabled=False)
    page = context.new_page()
    page.goto(shared.page.url)
    button(page).click()
    expect(answer(page).first).to_be_visible()
    context.close()


def test_the_page_asks_by_itself_whenever_the_robot_has_done_something(chromium, tmp_path):
    problem = PROBLEM.replace('(robot-at left)', '(robot-at red_room)')
    files = {
        'problem_file': problem.replace('(item-at blue_cube blue_room)', '(holding blue_cube)'),
        'plan_file': PLAN[PLAN.index('(grab red_circle') :],
    }
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    with stack(tmp_path) as robot, robot.explainer(n=10), person(chromium) as page:
        robot.peer.publish('domain', DOMAIN)
        robot.peer.publish('problem', files['problem_file'])
        robot.peer.publish('plan', files['plan_file'])
        page.goto(f'{robot.page.url}?follow=on')
        expect(page.locator('#condition')).to_contain_text('Ready')
        button(page).click()
        expect(answer(page)).to_have_count(4)
        namespace = robot.peer.node.get_namespace()
        paths = {name: tmp_path / name for name in files}
        with running('warehouse_robot', namespace, tmp_path, step_period=1.0, **paths):
            expect(page.locator('#said')).to_contain_text('Nothing is left to do')
        expect(page.locator('#currency')).to_have_text('')


def test_a_killed_explainer_is_missed_and_its_answer_is_not_passed_off_as_new(chromium, tmp_path):
    user_model = tmp_path / 'user_model.yaml'
    user_model.write_text(Path(USER_MODEL).read_text())
    with stack(tmp_path) as robot, person(chromium) as page:
        page.goto(robot.page.url)
        expect(page.locator('#condition')).to_contain_text('Silent. Nothing was heard')
        button(page).click()
        expect(page.locator('#said')).to_contain_text('Is the explainer running?')
        assert violations(page) == []
        with robot.explainer(user_model_file=user_model) as first:
            robot.peer.publish_warehouse()
            robot.peer.answer()
            expect(answer(page)).to_have_text(SENTENCES)
            expect(page.locator('#currency')).to_have_text('')
            first.stop(signal.SIGKILL)
        expect(page.locator('#condition')).to_contain_text('Silent. No news')
        expect(page.locator('#currency')).to_contain_text('may be old')
        assert violations(page) == []
        with user_model.open('a') as file:
            file.write('# changed while nobody looked\n')
        with robot.explainer(user_model_file=user_model, n=2):
            expect(page.locator('#condition')).to_contain_text('Ready')
            expect(page.locator('#currency')).to_contain_text('an older plan')
            expect(page.get_by_role('slider')).to_have_value('2')
            button(page).click()
            expect(answer(page)).to_have_text(SENTENCES[:2])
            expect(page.locator('#currency')).to_have_text('')


def test_a_page_that_has_lost_its_program_says_so(chromium, tmp_path):
    with stack(tmp_path) as robot, person(chromium) as page:
        page.goto(robot.page.url)
        expect(page.get_by_role('alert')).to_have_count(0)
        robot.page.kill()
        expect(page.get_by_role('alert')).to_contain_text('lost its program')
        assert violations(page) == []
        page.errors.clear()  # of the browser, that nobody answers


def http_status(server: Server, method: str, path: str, host: str = 'localhost') -> int:
    connection = http.client.HTTPConnection('127.0.0.1', int(server.port))
    connection.request(method, path, headers={'Host': host})
    response = connection.getresponse()
    response.read()
    connection.close()
    return response.status


@pytest.mark.parametrize('path', ['/ask', '/adjust', '/forget'])
def test_what_changes_anything_is_refused_without_a_form_of_the_page(shared, path):
    assert http_status(shared.page, 'POST', path) == 403
    assert http_status(shared.page, 'GET', path) == 405


@pytest.mark.parametrize(
    'path', ['/../../etc/passwd', '/static/../site.py', '/%7B%7B7*7%7D%7D', '/news/../ask', '//x']
)
def test_no_path_leads_to_a_file_or_a_template(shared, path):
    assert http_status(shared.page, 'GET', path) == 404


def test_another_host_header_is_refused(shared):
    assert http_status(shared.page, 'GET', '/', host='evil.example') == 400


def test_settings_that_the_page_does_not_offer_are_refused(operator, shared):
    for changes in ({'n': '0'}, {'n': '3', 'strategy': 'random'}, {}):
        token = operator.locator('[name=csrfmiddlewaretoken]').first.input_value()
        form = {'csrfmiddlewaretoken': token, **changes}
        assert operator.request.post(f'{shared.page.url}adjust', form=form).status == 400
