"""The node as users meet it: a real process, spoken to over DDS."""

import json
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from patience import PATIENCE, eventually

pytest.importorskip('rclpy', reason='needs ROS 2')

import sliding_tiles
from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticStatus
from rcl_interfaces.msg import Parameter as ParameterMessage
from rcl_interfaces.msg import ParameterValue
from rcl_interfaces.srv import SetParameters
from rclpy.parameter import Parameter
from ros_peer import (
    CONFIG,
    DOMAIN,
    PLAN,
    PROBLEM,
    THREE_SENTENCES,
    USER_MODEL,
    Peer,
    alive,
    explainer,
    last_diagnostic,
    name_of,
    new_namespace,
    running,
)
from rosgraph_msgs.msg import Clock
from std_srvs.srv import Trigger

from mirror_explainer.node.explainer_node import ExplainerNode
from mirror_explainer.node.live_explainer import LiveExplainer

pytestmark = pytest.mark.usefixtures('ros')


@pytest.fixture(scope='module')
def long_running(ros: None, tmp_path_factory: pytest.TempPathFactory) -> Iterator[object]:
    """A robot that latched its plan, and a node started after it, for all that can share them."""
    peer = Peer(new_namespace())
    peer.publish_warehouse(latched=True, heard=False)
    with explainer(peer, tmp_path_factory.mktemp('node')) as node:
        yield peer, node
    peer.close()


@pytest.fixture
def served(long_running) -> Iterator[Peer]:
    """The peer of the node that is shared, which is as it was before when a test has ended."""
    peer, _ = long_running
    yield peer
    peer.set_parameters(user_model_file=USER_MODEL, n=3, threshold=0.0, remember=False)
    peer.set_parameters(strategy='informative')
    peer.publish_warehouse()
    assert peer.answer() == THREE_SENTENCES


def latched(peer: Peer, topic: str) -> str:
    """Return what somebody hears who comes late."""
    late = Peer(peer.node.get_namespace())
    texts = late.hear(topic)
    eventually(lambda: texts, 'the latched message')
    late.close()
    return texts[-1]


def test_a_call_is_about_what_came_before_it_even_if_the_executor_comes_to_it_first(
    peer: Peer, caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level('DEBUG', 'mirror_explainer')  # as the node does, but until the test has ended
    given = {'user_model_file': USER_MODEL, 'answer_timeout': 30.0}
    node = ExplainerNode(
        namespace=peer.node.get_namespace(),
        parameter_overrides=[Parameter(name, value=value) for name, value in given.items()],
    )
    peer.publish_warehouse()
    peer.wait_until_heard()

    response = node._verbalize(Trigger.Request(), Trigger.Response())  # no executor spins it
    node.destroy_node()

    assert response.message == THREE_SENTENCES


def test_a_robot_that_latched_its_plan_before_the_node_started_is_explained(served):
    assert served.answer() == THREE_SENTENCES


def test_what_is_missing_is_said_until_all_has_been_heard_even_if_nothing_is_latched(
    peer, tmp_path
):
    def say(topic: str, text: str) -> None:
        peer.publish(topic, text, latched=False)

    with explainer(peer, tmp_path, user_model_file='') as node:
        peer.failure('I have no plan yet.')
        say('plan', PROBLEM)
        mixed_up = peer.failure('a plan is expected here')
        say('domain', DOMAIN)
        say('plan', PLAN)
        peer.failure('I do not know yet.')
        say('problem', PROBLEM)
        without_user_model = peer.answer()
        peer.set_parameters(user_model_file=USER_MODEL)
        answer = peer.answer()
    assert 'waiting for domain (topic, or parameter domain_file), problem (topic)' in node.log
    assert '/plan, line' in mixed_up
    assert 'waiting for problem (topic). ' in node.log
    assert 'no user model is named (parameter user_model_file)' in node.log
    assert without_user_model.endswith('I will exit through the bottom door.')
    assert answer == THREE_SENTENCES


def test_a_latched_message_is_heard_once_though_by_both_subscriptions_and_again_if_told_again(
    peer: Peer, monkeypatch: pytest.MonkeyPatch
) -> None:
    heard: list[tuple[str, str]] = []
    monkeypatch.setattr(
        LiveExplainer, 'hear', lambda _, name, text: heard.append((name, text.text))
    )
    node = ExplainerNode(namespace=peer.node.get_namespace())
    for _ in range(2):
        peer.publish('plan', PLAN, latched=True)
        peer.wait_until_heard()
        node._hear_what_waits()
    node.destroy_node()

    assert heard == [('plan', PLAN)] * 2


def test_the_answer_is_published_for_speech_and_dashboards_and_stays_latched(served):
    answer = served.answer()

    explanation = json.loads(latched(served, 'mirror_explainer/explanation'))

    assert latched(served, 'mirror_explainer/verbalization') == answer
    assert explanation['spoken'] == answer
    assert 'hypotheses' not in explanation


def test_whoever_reads_an_explanation_can_tell_that_the_inputs_have_changed(served):
    def inputs() -> str:
        return last_diagnostic(served)['inputs']

    served.answer()
    explained = json.loads(latched(served, 'mirror_explainer/explanation'))['inputs']
    eventually(lambda: inputs() == explained, 'the inputs of the answer')
    served.publish('plan', '(fly away)')
    eventually(lambda: inputs() != explained, 'other inputs')
    served.publish('plan', PLAN)
    eventually(lambda: inputs() == explained, 'the same inputs again')


def test_the_answer_over_ros_is_the_answer_of_verbalize(served):
    command = [sys.executable, '-m', 'mirror_explainer.verbalize', '--json']
    for name, file in (
        ('domain', 'domain.pddl'),
        ('problem', 'problem.pddl'),
        ('plan', 'plan.txt'),
    ):
        command += [f'--{name}', str(CONFIG / file)]
    visitor = str(CONFIG / 'visitor.yaml')
    offline = json.loads(
        subprocess.run([*command, '--user-model', visitor], check=True, capture_output=True).stdout
    )
    served.set_parameters(user_model_file=visitor)
    served.answer()
    online = json.loads(latched(served, 'mirror_explainer/explanation'))
    for key in ('seconds', 'planner_calls', 'hypotheses', 'inputs'):
        offline.pop(key, None)
        online.pop(key, None)
    for answer in (offline, online):
        answer['episode'].pop('began')
    assert online == offline


def test_two_clients_at_once_both_get_the_answer(served):
    other = Peer(served.node.get_namespace())
    calls = [client.start_call() for client in (served, other, served, other)]
    responses = [call.result() for call in calls]
    other.close()
    assert [response.message for response in responses] == [THREE_SENTENCES] * 4


def test_parameters_act_at_once(served, tmp_path):
    served.publish_warehouse()
    served.answer()
    served.set_parameters(n=1)
    one = served.call().message
    served.set_parameters(n=2, strategy='decreasing')
    last_two = served.call().message
    served.set_parameters(user_model_file=str(tmp_path / 'nowhere.yaml'))
    without_model = served.call()
    served.set_parameters(user_model_file=USER_MODEL, strategy='informative', n=3)
    again = served.call()
    assert one == 'I will exit from the bottom door.'
    assert last_two == 'I will navigate to the right corridor.\nI will exit from the bottom door.'
    assert not without_model.success
    assert 'nowhere.yaml' in without_model.message
    assert again.message == THREE_SENTENCES


def test_values_out_of_range_and_read_only_parameters_are_refused_with_a_reason(served):
    (strategy,) = served.set_parameters(strategy='random')
    (too_few,) = served.set_parameters(n=-1)
    (planner,) = served.set_parameters(planner='pyperplan')
    assert not strategy[0]
    assert 'informative, increasing, decreasing' in strategy[1]
    assert not too_few[0]
    assert not planner[0]


def test_with_remember_asking_again_tells_more_until_all_is_told(served):
    served.set_parameters(remember=True, n=2)
    first, second = served.answer(), served.call().message
    last = served.call().message
    forgotten = served.call('mirror_explainer/forget')
    assert first == 'I will grab a blue cube and a red circle.'
    assert second == 'I will exit from the bottom door.'
    assert last == 'The rest is only details.'
    assert forgotten.success
    assert served.call().message == first


def test_bad_input_is_named_in_answer_log_and_diagnostics_and_good_input_heals_it(
    served, long_running
):
    peer, node = long_running
    for text, expected in (
        ('(fly a b)', '/plan, line 1: the domain has no action'),
        ('x y\n' * 5_000_000, '/plan: its bytes (20000000) are more than max_'),
    ):
        peer.publish('plan', text)
        reason = peer.failure(expected)
        eventually(lambda: reason in node.log, 'the reason in the log')  # noqa: B023
        eventually(
            lambda: last_diagnostic(peer)['message'] == reason,  # noqa: B023
            'the reason in the diagnostics',
        )
        peer.publish('plan', PLAN)
        assert peer.answer() == THREE_SENTENCES
    eventually(lambda: last_diagnostic(peer)['message'] == 'ready', 'ready')
    assert last_diagnostic(peer)['level'] == DiagnosticStatus.OK
    assert node.popen.poll() is None


def test_what_rclpy_itself_cannot_take_does_not_end_the_node(served, long_running):
    _, node = long_running
    client = served.node.create_client(SetParameters, f'{served.explainer}/set_parameters')
    assert client.wait_for_service(PATIENCE)
    no_type = ParameterMessage(name='n', value=ParameterValue(type=77))
    client.call_async(SetParameters.Request(parameters=[no_type]))
    eventually(lambda: '77 is not a valid' in node.log, 'the reason in the log')
    clock = served.node.create_publisher(Clock, '/clock', 1)
    served.set_parameters(use_sim_time=True)
    eventually(clock.get_subscription_count, 'a subscriber of the clock')
    clock.publish(Clock(clock=Time(sec=-1)))
    eventually(lambda: 'Seconds value must not be negative' in node.log, 'the reason in the log')
    served.set_parameters(use_sim_time=False)

    assert served.answer() == THREE_SENTENCES
    assert node.popen.poll() is None


def test_a_user_model_that_no_log_can_print_does_not_end_the_node(served, tmp_path):
    user_model = tmp_path / 'user_model.yaml'
    user_model.write_text('goals:\n  - goal: "(holding \\ud800)"\n')
    served.set_parameters(user_model_file=str(user_model))
    reason = served.failure('user_model.yaml')
    served.set_parameters(user_model_file=USER_MODEL)
    mended = served.answer()
    assert 'line 2' in reason
    assert mended == THREE_SENTENCES


def tiles_explainer(peer: Peer, folder: Path, **parameters: object):
    """An explainer for the 15-puzzle, patient enough to plan for the whole test."""
    user_model = folder / 'tiles.yaml'
    user_model.write_text(sliding_tiles.USER_MODEL)
    return explainer(
        peer, folder, user_model_file=user_model, planning_timeout=600.0, **parameters
    )


def publish_tiles(peer: Peer, moves: int) -> None:
    problem, plan = sliding_tiles.scrambled(moves, seed=moves)
    peer.publish('domain', sliding_tiles.DOMAIN)
    peer.publish('problem', problem)
    peer.publish('plan', plan)


def test_a_call_during_the_planning_is_answered_and_one_that_waits_is_told_of_a_replan(
    peer, tmp_path
):
    with tiles_explainer(peer, tmp_path, answer_timeout=0.2):
        publish_tiles(peer, moves=200)
        unplanned = peer.answer()
        peer.set_parameters(answer_timeout=30.0)
        waiting = peer.start_call()
        peer.set_parameters(n=1)  # answered although a call waits
        still_waiting = not waiting.done
        publish_tiles(peer, moves=3)
        answer = waiting.result()

    hard, easy = (sliding_tiles.sentences(sliding_tiles.scrambled(n, seed=n)[1]) for n in (200, 3))
    assert set(unplanned.split('\n')) <= set(hard)
    assert still_waiting
    assert answer.success, answer.message
    assert answer.message.removeprefix('I have changed my plan.\n') in easy


@pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGTERM])
def test_a_signal_in_the_middle_of_planning_ends_node_and_planners(peer, tmp_path, number):
    with tiles_explainer(peer, tmp_path) as node:
        publish_tiles(peer, moves=200)
        eventually(lambda: 'downward' in map(name_of, node.descendants()), 'a running search')
        peer.start_call()
        started = node.descendants()
        status = node.stop(number)
        eventually(lambda: not alive(started), 'the end of the planners')
    assert status == 0
    assert 'Traceback' not in node.log


def test_the_demo_robot_is_explained_at_every_step_until_nothing_is_left(peer, tmp_path):
    with explainer(peer, tmp_path, n=1):
        peer.failure('I have no plan yet.')  # it is ready before the robot's first step
        with running('warehouse_robot', peer.node.get_namespace(), tmp_path, step_period=1.2):
            answers = [peer.answer()]
            while not answers[-1].endswith('I am done.'):
                response = peer.call()
                if response.success and response.message != answers[-1]:
                    answers.append(response.message)
                assert len(answers) < 20, answers
                time.sleep(0.1)
    assert answers[0] == 'I will exit from the bottom door.'
    assert len(answers) >= 2
