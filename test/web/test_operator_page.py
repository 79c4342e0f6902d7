"""The operator's page in a real browser, beside a real explainer and robot, over DDS."""

import http.client
import itertools
import json
import os
import re
import signal
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

pytest.importorskip('rclpy', reason='needs ROS 2')
pytest.importorskip('django', reason='the extra [web] is not installed')
pytest.importorskip('playwright', reason='playwright is not installed (the extra [test])')

import rclpy
from browser import SCREENS, Server, overflow, person, resized, served, violations
from patience import eventually
from playwright.sync_api import Locator, Page, expect
from rcl_interfaces.msg import Parameter as ParameterMessage
from rcl_interfaces.msg import ParameterValue
from rcl_interfaces.srv import ListParameters, SetParameters
from ros_peer import PLAN, USER_MODEL, Call, Peer, Process, running

from mirror_explainer.web.operator.shown import percent

# As they are spoken: two of the three in one breath.
SENTENCES = ['I will grab a blue cube and a red circle.', 'I will exit from the bottom door.']
# After another plan for the same, and of that plan.
OTHER_SENTENCES = [
    'I have changed my plan.',
    'I will grab a red circle and a blue cube.',
    'I will exit from the bottom door.',
]
_namespaces = (f'/page_{os.getpid()}_{number}' for number in itertools.count())


class Stack:
    """A robot's stack under test, in a namespace of its own: the robot is the peer."""

    def __init__(self, folder: Path, own: ExitStack) -> None:
        self._folder, self._own = folder, own
        self.peer = Peer(next(_namespaces))
        own.callback(self.peer.close)
        self._namespace = self.peer.node.get_namespace()
        ros = ['--ros-args', '-r', f'__ns:={self._namespace}']
        command = ['-m', 'mirror_explainer.web.operator.operator_page', '--port', '0', *ros]
        self.page: Server = own.enter_context(served(command))
        self.user_model = folder / 'user_model.yaml'
        self.user_model.write_text(Path(USER_MODEL).read_text())

    def start_explainer(self) -> Process:
        parameters = {'user_model_file': self.user_model, 'answer_timeout': 30.0}
        return self._own.enter_context(
            running('explainer_node', self._namespace, self._folder, **parameters)
        )

    def robot(self, **parameters: object):
        return running('warehouse_robot', self._namespace, self._folder, **parameters)


@pytest.fixture(scope='module', autouse=True)
def ros() -> Iterator[None]:
    rclpy.init()
    yield
    rclpy.try_shutdown()


@pytest.fixture
def stack(tmp_path: Path) -> Iterator[Stack]:
    """A stack without an explainer."""
    with ExitStack() as own:
        yield Stack(tmp_path, own)


@pytest.fixture(scope='module')
def shared(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Stack]:
    """A stack with an explainer, for tests that leave it as it was."""
    with ExitStack() as own:
        shared = Stack(tmp_path_factory.mktemp('stack'), own)
        shared.explainer = shared.start_explainer()
        shared.peer.publish_warehouse()
        shared.peer.answer()
        yield shared


@pytest.fixture
def operator(chromium, shared: Stack) -> Iterator[Page]:
    """A browser at the page of the shared stack, whose settings are the defaults."""
    shared.peer.set_parameters(n=3, strategy='informative', remember=False)
    with person(chromium) as page:
        page.goto(shared.page.url)
        expect(page.locator('#status')).to_have_text(re.compile('Ready|New plan|No answer'))
        yield page


OTHER_WAY = """
(move left center) (move center doors) (move doors red_room) (grab red_circle red_room)
(move red_room doors) (move doors blue_room) (grab blue_cube blue_room) (move blue_room doors)
(move doors right) (exit bottom_door right)
""".replace(') (', ')\n(')


def button(page: Page) -> Locator:
    return page.get_by_role('button', name='What are you up to?')


def press(page: Page) -> None:
    """Press the button, and wait until the page shows what came of it."""
    with page.expect_response('**/ask'):
        button(page).click()
    expect(page.locator('#asking')).not_to_have_class('htmx-request')


def settings(page: Page) -> None:
    """Open the drawer, unless it is."""
    if page.locator('#drawer').get_attribute('open') is None:
        page.get_by_text('Settings', exact=True).click()


def more(page: Page) -> None:
    """Open the tables."""
    page.get_by_text('All goals, the whole plan, and numbers').click()


def choose(page: Page, strategy: str) -> None:
    """Choose a strategy, and wait until it is set."""
    settings(page)
    with page.expect_response('**/adjust'):
        page.get_by_role('radio', name=strategy).check()


def forget(page: Page) -> None:
    """Press the button that makes the robot forget, and wait until it has."""
    settings(page)
    with page.expect_response('**/forget'):
        page.get_by_role('button', name='Forget what was said').click()


def answer(page: Page) -> Locator:
    return page.locator('#said').get_by_role('listitem')


def test_what_rclpy_itself_cannot_take_does_not_cut_the_page_off(operator, shared):
    page = f'{shared.peer.node.get_namespace()}/operator_page'
    setting = shared.peer.node.create_client(SetParameters, f'{page}/set_parameters')
    listing = shared.peer.node.create_client(ListParameters, f'{page}/list_parameters')
    eventually(setting.service_is_ready, 'the service of the page')
    eventually(listing.service_is_ready, 'the service of the page')
    no_type = ParameterMessage(name='explainer', value=ParameterValue(type=77))
    setting.call_async(SetParameters.Request(parameters=[no_type]))

    eventually(
        lambda: Call(listing.call_async(ListParameters.Request())).ends_within(1.0),
        'a reply of the page',
    )
    press(operator)
    expect(answer(operator)).to_have_text(SENTENCES)


def test_the_button_gives_the_answer_and_all_that_it_does_by_keyboard_alone(operator, shared):
    explanations = shared.peer.hear('mirror_explainer/explanation')
    heard = len(explanations)
    with operator.expect_response('**/ask'):
        button(operator).focus()
        operator.keyboard.press('Enter')
    expect(answer(operator)).to_have_text(SENTENCES)
    eventually(lambda: len(explanations) > heard, 'the explanation')
    told = json.loads(explanations[-1])
    before, after = percent(told['understanding_before']), percent(told['understanding'])
    instead = [percent(other['understanding']) for other in told['baselines']]
    assert told['understanding_before'] < 0.1 < 0.6 < told['understanding']
    expect(operator.locator('#belief dd')).to_have_text([before, after, *instead])
    expect(operator.locator('#belief dt')).to_have_text(
        [
            'Before',
            'After this answer',
            'Had it told its first 3 steps',
            'Had it told its last 3 steps',
        ]
    )
    expect(operator.locator('#timeline li.said')).to_have_count(3)
    expect(button(operator)).to_be_focused()
    more(operator)
    said = operator.get_by_role('table', name='The steps of the plan').get_by_role(
        'row', name='told'
    )
    goals = operator.get_by_role('table', name='How likely each goal seems to you')
    true_goal = goals.get_by_role('row', name='true goal')
    understanding = operator.get_by_role('row', name='Understanding: how sure')
    uncertainty = operator.get_by_role('row', name='Uncertainty (cross-entropy')
    expect(said).to_have_count(3)
    expect(true_goal).to_contain_text('a red circle and a blue cube, the bottom door')
    expect(true_goal.get_by_role('cell')).to_have_text([before, after])
    expect(understanding.get_by_role('cell')).to_have_text([before, after])
    expect(uncertainty.get_by_role('cell')).to_have_text(
        [f'{told["cross_entropy_before"]:.2f}', f'{told["cross_entropy_after"]:.2f}']
    )
    assert violations(operator) == []


def test_slider_and_choice_set_the_parameters_and_change_the_answer(operator, shared):
    press(operator)
    expect(answer(operator)).to_have_text(SENTENCES)
    settings(operator)
    operator.get_by_role('slider', name='Steps told, at most (N)').focus()
    operator.keyboard.press('Home')
    expect(answer(operator)).to_have_text(['I will exit from the bottom door.'])
    choose(operator, 'increasing')
    expect(answer(operator)).to_have_text(['I will navigate to the central corridor.'])
    more(operator)
    tried = operator.get_by_role('table').filter(has_text='Strategy').get_by_role('rowheader')
    expect(tried).to_have_text(['increasing shown', 'informative', 'informative'])
    assert violations(operator) == []
    assert shared.peer.call().message == 'I will navigate to the central corridor.'


def test_settings_changed_elsewhere_are_seen(operator, shared):
    shared.peer.set_parameters(n=7, strategy='decreasing')
    settings(operator)
    expect(operator.get_by_role('slider')).to_have_value('7')
    expect(operator.get_by_role('spinbutton')).to_have_value('7')
    expect(operator.get_by_role('radio', name='decreasing')).to_be_checked()


def test_after_a_replan_the_answer_is_called_old_until_the_robot_is_asked_again(operator, shared):
    press(operator)
    expect(operator.locator('#said .old')).to_have_count(0)
    shared.peer.publish('plan', PLAN.replace('(move left center)', '(move LEFT center) ; again'))
    shared.peer.answer()
    expect(operator.locator('#said .old')).to_have_count(0)  # of the same plan
    shared.peer.publish('plan', OTHER_WAY)
    expect(operator.locator('#said .old')).to_have_count(1)
    assert violations(operator) == []
    press(operator)
    expect(operator.locator('#said .old')).to_have_count(0)
    shared.peer.publish('plan', PLAN)
    shared.peer.answer()  # which tells that it is another plan again


def test_a_bad_message_is_told_in_words_and_a_good_one_heals_it(operator, shared):
    press(operator)
    expect(answer(operator)).to_have_text(SENTENCES)
    shared.peer.publish('plan', '(fly left <b>center</b>)')
    reason = f'{shared.peer.node.get_namespace()}/plan, line 1'
    expect(operator.locator('#status')).to_contain_text('Fault. What the robot tells of its task')
    expect(operator.locator('#details-text')).to_contain_text(reason)
    for part in ('#said', '#belief', '#timeline'):
        expect(operator.locator(f'{part} .old')).to_have_count(1)
    press(operator)
    expect(operator.locator('.status:visible')).to_have_count(1)
    expect(operator.locator('#status')).to_contain_text('Fault.')
    operator.get_by_text('Details').click()
    operator.get_by_role('button', name='Copy').click()
    assert violations(operator) == []
    shared.peer.publish('plan', PLAN)
    expect(operator.locator('#status')).to_have_text('✓ Ready. The robot can be asked.')
    expect(operator.locator('#said .old')).to_have_count(0)


def test_what_is_no_explanation_is_told_and_does_not_end_the_page(operator, shared):
    shared.peer.publish('mirror_explainer/explanation', '{"strategy": "<script>"}')
    expect(operator.locator('#details-text')).to_contain_text('this is no explanation')
    press(operator)
    expect(operator.locator('#status')).to_contain_text('Ready.')


def test_with_remember_asking_again_tells_more_and_forgetting_starts_over(operator, shared):
    shared.peer.set_parameters(remember=True, n=2)
    forget(operator)
    press(operator)
    expect(answer(operator)).to_have_text(SENTENCES[:1])
    first = answer(operator).all_text_contents()
    press(operator)
    expect(answer(operator).first).not_to_have_text(first[0])
    second = answer(operator).all_text_contents()
    choose(operator, 'decreasing')
    expect(operator.locator('#controls')).to_contain_text('for the next answer')
    choose(operator, 'informative')
    assert violations(operator) == []
    forget(operator)
    press(operator)
    expect(answer(operator)).to_have_text(first)
    assert not set(first) & set(second)


def test_two_browsers_show_the_same_answer_and_both_can_ask(chromium, operator, shared):
    with person(chromium, 'tablet') as other:
        other.goto(shared.page.url)
        shared.peer.set_parameters(n=1)
        press(other)
        expect(answer(operator)).to_have_text(['I will exit from the bottom door.'])
        shared.peer.set_parameters(n=2)
        press(operator)
        expect(answer(other)).to_have_text(SENTENCES[:1])


def explained(page: Page, shared: Stack) -> dict:
    """Ask on the page, with all the details, and return the explainer's explanation."""
    explanations = shared.peer.hear('mirror_explainer/explanation')
    press(page)
    more(page)
    # Other tests, too, publish on this topic.
    eventually(lambda: any('"plan"' in text for text in explanations[-1:]), 'the explanation')
    return json.loads(explanations[-1])


def test_the_page_fits_every_screen_also_at_200_percent_with_names_of_any_kind(operator, shared):
    told = explained(operator, shared)
    arabic = 'سأحمل الصندوق إلى الغرفة الزرقاء.'
    names = ['箱を青い部屋へ届ける。' * 4, arabic, '<b>b</b>' * 12, 'x' * 90]
    told['spoken'] = '\n'.join(names)
    for step, name in zip(told['plan'], names, strict=False):
        step['sentence'] = step['action'] = name
    for goal, name in zip(told['goals'], names, strict=False):
        goal['name'] = name
    told['true_goal'] = names[-1]
    shared.peer.publish('mirror_explainer/explanation', json.dumps(told))
    expect(answer(operator)).to_have_text(names)
    direction = 'li => getComputedStyle(li).direction'
    directions = [each.evaluate(direction) for each in answer(operator).all()]
    assert directions == ['ltr', 'rtl', 'ltr', 'ltr']
    assert operator.locator('main b').count() == 0
    for _ in resized(operator):
        assert overflow(operator) <= 0
    assert violations(operator) == []
    press(operator)  # which brings the true names back


def test_goals_and_their_parts_are_shown_in_words(operator, shared):
    told = explained(operator, shared)
    told['true_goal'] = told['goals'][0]['name'] = '(and (holding cup) (at home))'
    told['unmentioned'] = ['(at home)', '(lit lamp)']
    told['in_words'] = {told['true_goal']: 'take the cup and go home', '(at home)': 'go home'}
    shared.peer.publish('mirror_explainer/explanation', json.dumps(told))
    expect(operator.locator('#belief .goal-name')).to_have_text('take the cup and go home')
    expect(operator.locator('#more tr.lit th').first).to_contain_text('take the cup and go home')
    unsaid = operator.locator('#more li').filter(has_not=operator.locator('p'))
    expect(unsaid).to_have_text(['go home', '(lit lamp)'])
    press(operator)  # which brings the true names back


def test_at_first_sight_answer_belief_and_plan_are_on_one_screen_and_nothing_jumps(
    chromium, shared
):
    with person(chromium) as page:
        page.add_init_script(SHIFTS)
        page.goto(shared.page.url)
        press(page)
        for what in ('#said', '#belief', '#timeline'):
            box = page.locator(what).bounding_box()
            assert box['y'] + box['height'] <= SCREENS['desktop'][1]
        for _ in range(3):
            press(page)
        shared.peer.publish('plan', '')
        expect(page.locator('#status')).not_to_contain_text('Ready.')
        shared.peer.publish('plan', PLAN)
        press(page)
        assert page.evaluate('window.shifts') < 0.1


SHIFTS = """
window.shifts = 0;
new PerformanceObserver((seen) => {
  for (const shift of seen.getEntries()) window.shifts += shift.value;
}).observe({type: 'layout-shift', buffered: true});
"""


def test_a_display_asks_by_itself_and_shows_nothing_to_set(chromium, shared):
    shared.peer.set_parameters(n=3, strategy='informative', remember=False)
    with person(chromium) as page:
        page.goto(f'{shared.page.url}?display=on')
        shared.peer.publish('plan', OTHER_WAY)
        expect(answer(page)).to_have_text(OTHER_SENTENCES)
        expect(page.locator('#said .old')).to_have_count(0)
        expect(page.locator('.status:visible')).to_have_count(0)  # while all is well
        expect(page.get_by_role('button')).to_have_count(0)
        expect(page.locator('#drawer')).to_have_count(0)
        assert overflow(page) <= 0
        assert violations(page) == []
        shared.peer.publish('plan', PLAN)
        expect(answer(page)).to_have_text(['I have changed my plan.', *SENTENCES])


@pytest.mark.parametrize('media', [{'color_scheme': 'dark'}, {'forced_colors': 'active'}])
def test_it_can_be_read_in_the_dark_and_in_forced_colours(operator, media):
    operator.emulate_media(**media)
    press(operator)
    more(operator)
    settings(operator)
    assert violations(operator) == []


def test_without_scripts_the_button_works_too(chromium, shared):
    with person(chromium, scripts=False) as page:
        page.goto(shared.page.url)
        button(page).click()
        expect(answer(page).first).to_be_visible()


def test_the_demo_from_first_to_last_step_and_again_asks_by_itself_and_nothing_jumps(
    chromium, shared
):
    shared.peer.set_parameters(n=3, strategy='informative', remember=False)
    with person(chromium) as wide, person(chromium, 'small') as narrow:
        again = wide.get_by_role('button', name='Start again')
        for page in (wide, narrow):
            page.add_init_script(SHIFTS)
            page.goto(f'{shared.page.url}?follow=on')
        shared.peer.answer()
        for page in (wide, narrow):
            expect(answer(page)).to_have_text(SENTENCES)
        expect(again).to_have_count(0)
        with shared.robot(step_period=0.5):
            expect(again).to_be_visible()
            expect(wide.locator('#timeline li.done')).to_have_count(10)
            last = wide.locator('#timeline .step > span:visible').last
            expect(last).to_have_text('I have exited from the bottom door.')
            expect(answer(wide)).to_have_text(SENTENCES)  # nobody asked meanwhile
            assert violations(wide) == []
            again.click()
            expect(again).to_have_count(0)
            expect(again).to_be_visible()
            for page in (wide, narrow):
                expect(page.locator('#status')).to_contain_text('Ready.')
                expect(page.locator('#said .old')).to_have_count(0)
                expect(page.locator('#said')).not_to_contain_text('changed')
                assert page.evaluate('window.shifts') < 0.1
                assert overflow(page) <= 0
        expect(again).to_have_count(0)  # the robot is gone
    shared.peer.publish_warehouse()
    shared.peer.answer()


def test_an_explainer_that_hangs_is_missed_until_it_goes_on(operator, shared):
    press(operator)
    expect(operator.locator('#said .old')).to_have_count(0)
    shared.explainer.popen.send_signal(signal.SIGSTOP)
    press(operator)
    expect(operator.locator('#details-text')).to_contain_text('verbalize_plan gave no reply')
    expect(operator.locator('#status')).to_contain_text('Silent. No news')
    expect(operator.locator('#said .old')).to_have_count(1)
    assert violations(operator) == []
    shared.explainer.popen.send_signal(signal.SIGCONT)
    expect(operator.locator('#status')).to_contain_text('Ready')
    press(operator)
    expect(operator.locator('#said .old')).to_have_count(0)
    expect(operator.locator('#status')).not_to_contain_text('gave no reply')


def test_the_answer_of_an_explainer_that_died_is_not_passed_off_as_new(operator, shared):
    press(operator)
    expect(operator.locator('#said .old')).to_have_count(0)
    shared.explainer.stop(signal.SIGKILL)
    with shared.user_model.open('a') as file:
        file.write('# changed while nobody looked\n')
    shared.explainer = shared.start_explainer()
    expect(operator.locator('#status')).to_contain_text('Ready')
    expect(operator.locator('#said .old')).to_have_count(1)
    # It may read the changed file once more after the first answer, which is old then, too.
    eventually(lambda: asked_anew(operator), 'an answer to the newest inputs')
    expect(answer(operator)).to_have_text(SENTENCES)


def asked_anew(page: Page) -> bool:
    """Press the button, and say whether the page then shows an answer that is not old."""
    press(page)
    try:
        expect(page.locator('#said .old')).to_have_count(0, timeout=5_000)
    except AssertionError:
        return False
    return True


def test_what_is_not_there_is_told_an_explainer_and_the_page_itself(chromium, stack):
    with person(chromium) as page:
        page.goto(stack.page.url)
        expect(page.locator('#status')).to_contain_text('Silent. Nothing was heard')
        press(page)
        expect(page.locator('#status')).to_contain_text('Is the explainer running?')
        expect(page.locator('#said')).to_have_text('The robot’s answer comes here.')
        expect(page.get_by_role('alert')).to_have_count(0)
        assert violations(page) == []
        stack.page.kill()
        expect(page.get_by_role('alert')).to_contain_text('lost its program')
        expect(page.locator('.status:visible')).to_have_count(1)
        assert violations(page) == []
        page.errors.clear()  # of the browser, that nobody answers


def http_status(server: Server, method: str, path: str, host: str = 'localhost') -> int:
    connection = http.client.HTTPConnection('127.0.0.1', int(server.port))
    connection.request(method, path, headers={'Host': host})
    response = connection.getresponse()
    response.read()
    connection.close()
    return response.status


@pytest.mark.parametrize('path', ['/ask', '/adjust', '/forget', '/restart'])
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
