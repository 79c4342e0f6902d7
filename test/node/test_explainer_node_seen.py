"""What the running node shows of itself: its log, its diagnostics, its command line."""

from collections.abc import Iterator

import pytest
from patience import PATIENCE, eventually

pytest.importorskip('rclpy', reason='needs ROS 2')

from diagnostic_msgs.msg import DiagnosticStatus
from rcl_interfaces.msg import LoggerLevel
from rcl_interfaces.srv import SetLoggerLevels
from rclpy.qos import QoSProfile, ReliabilityPolicy
from ros_peer import (
    DOMAIN,
    PLAN,
    PROBLEM,
    Call,
    Peer,
    Process,
    explainer,
    last_diagnostic,
    new_namespace,
    running,
)
from std_msgs.msg import String

from mirror_explainer.commands.command_line import package_version
from mirror_explainer.node.explainer_node import main

pytestmark = pytest.mark.usefixtures('ros')


@pytest.fixture(scope='module')
def peer(ros: None) -> Iterator[Peer]:
    """A peer of one robot for all these tests."""
    peer = Peer(new_namespace())
    yield peer
    peer.close()


@pytest.fixture(scope='module')
def node(peer: Peer, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Process]:
    """The node, which explains the warehouse's plan when a test begins and when it ends."""
    with explainer(peer, tmp_path_factory.mktemp('seen')) as node:
        peer.publish_warehouse()
        peer.answer()
        yield node


def set_level(peer: Peer, level: int) -> None:
    """Set the level of the node's log while it runs."""
    client = peer.client(SetLoggerLevels, f'{peer.explainer}/set_logger_levels')
    name = peer.explainer.lstrip('/').replace('/', '.')
    request = SetLoggerLevels.Request(levels=[LoggerLevel(name=name, level=level)])
    (result,) = Call(client.call_async(request)).result().results
    assert result.successful, result.reason


def log_lines(node: Process, words: str) -> list[str]:
    return [line for line in node.log.splitlines() if words in line]


def test_bad_messages_without_end_do_not_flood_the_log(peer, node):
    for _ in range(5):
        peer.publish('plan', '(fly away)')
        peer.failure('no action "fly"')
        peer.publish('plan', '(move left mars)')
        peer.failure('no object "mars"')
    peer.publish('plan', PLAN)
    peer.answer()

    errors = log_lines(node, '[ERROR]')
    # Each once, and its count if it took so long; a busy machine may make it news again.
    assert 2 <= len(errors) <= 8, errors
    assert '"fly"' in errors[0]
    assert '"mars"' in errors[1]


def test_a_robot_that_replans_all_the_time_does_not_flood_the_log(peer, node):
    def updates() -> int:
        return int(last_diagnostic(peer)['updates'])

    def told_ready() -> int:
        return sum('like this' not in line for line in log_lines(node, 'ready: '))

    told = told_ready()
    for number in range(10):
        before = updates()
        peer.publish('plan', f'{PLAN}\n; {number}')
        eventually(lambda: updates() > before, 'the next update')  # noqa: B023
    peer.publish('plan', PLAN)
    peer.answer()

    assert told_ready() == told


def test_the_log_level_of_the_running_node_reaches_the_planners_lines(peer, node):
    quiet = log_lines(node, '[DEBUG]')
    set_level(peer, LoggerLevel.LOG_LEVEL_DEBUG)
    peer.publish_warehouse('for_the_log')
    eventually(lambda: log_lines(node, '30 beliefs: '), "the planner's line")
    set_level(peer, LoggerLevel.LOG_LEVEL_INFO)
    peer.publish_warehouse()
    peer.answer()

    assert not quiet


def test_diagnostics_show_calls_memory_version_and_where_the_inputs_came_from(peer, node):
    before = int(last_diagnostic(peer)['calls answered'])
    peer.answer()
    values = eventually(
        lambda: int((found := last_diagnostic(peer))['calls answered']) > before and found,
        'diagnostics after the call',
    )

    assert values['message'] == 'ready'
    assert values['version'] == package_version()
    assert int(values['MiB of node']) > 20
    assert int(values['MiB of planners']) > 5
    assert float(values['seconds of last call']) < PATIENCE
    assert values['plan from'] == f'{peer.node.get_namespace()}/plan'
    assert values['publishers of plan'] == '1'


def test_another_robot_on_the_same_topics_is_seen_and_that_both_die_and_one_returns(tmp_path):
    namespace = new_namespace()
    listener, robot, other = (Peer(namespace) for _ in range(3))
    told = (
        f'more than one node publishes plan (named {namespace}/peer), and what they tell is mixed'
    )
    with explainer(listener, tmp_path) as node:
        robot.publish_warehouse()
        listener.answer()
        other.publish('plan', PLAN)
        mixed = eventually(
            lambda: 'publishes plan' in (found := last_diagnostic(listener))['message'] and found,
            'that two publish the plan',
        )
        eventually(lambda: told in node.log, 'that in its log')
        other.close()
        eventually(lambda: last_diagnostic(listener)['message'] == 'ready', 'that one has gone')
        robot.close()
        # Its publishers go one after the other.
        gone = eventually(
            lambda: (
                (found := last_diagnostic(listener))['message']
                == 'ready, but nobody publishes problem and plan any more'
                and found
            ),
            'that the robot has gone',
        )
        answer = listener.call()
        listener.publish_warehouse()
        eventually(lambda: last_diagnostic(listener)['message'] == 'ready', 'the robot again')
    listener.close()

    assert (mixed['level'], mixed['message']) == (DiagnosticStatus.WARN, f'ready; {told}')
    assert node.log.count(told) == 1
    assert gone['level'] == DiagnosticStatus.WARN
    assert answer.success


def test_a_plan_that_was_published_too_early_and_not_latched_is_told_so(tmp_path):
    peer = Peer(new_namespace())
    peer.publish('domain', DOMAIN, heard=False)
    peer.publish('problem', PROBLEM, heard=False)
    peer.publish('plan', PLAN, latched=False, heard=False)
    with explainer(peer, tmp_path):
        told = eventually(
            lambda: (
                'somebody publishes plan,' in (found := last_diagnostic(peer))['message'] and found
            ),
            'that the plan is published',
        )
        peer.publish('plan', PLAN, latched=False)
        eventually(lambda: last_diagnostic(peer)['message'] == 'ready', 'the plan')
    peer.close()

    assert told['message'].endswith('; somebody publishes plan, but nothing was heard')
    assert told['level'] == DiagnosticStatus.WARN
    assert told['what to do'].startswith('Nothing, if the robot has told none yet. Else ')


def test_the_publishers_of_remapped_inputs_are_seen_and_such_as_it_cannot_hear(tmp_path):
    peer, elsewhere = Peer(new_namespace()), Peer(namespace := new_namespace())
    for topic, text in {'problem': PROBLEM, 'plan': PLAN}.items():
        elsewhere.publish(topic, text, heard=False)
    remapped = ['--ros-args', '-r', 'problem:=my/problem', '-r', 'plan:=my/plan', '--']
    with explainer(peer, tmp_path, options=remapped):
        eventually(
            lambda: f'{namespace}/plan' in last_diagnostic(peer)['what to do'], 'the other plan'
        )
        best_effort = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
        unheard = peer.node.create_publisher(String, 'my/plan', best_effort)
        eventually(
            lambda: 'publishes plan as best effort' in last_diagnostic(peer)['message'],
            'that it cannot be heard',
        )
        peer.node.destroy_publisher(unheard)
        for topic, text in {'domain': DOMAIN, 'my/problem': PROBLEM, 'my/plan': PLAN}.items():
            peer.publish(topic, text)
        peer.answer()
        eventually(lambda: last_diagnostic(peer)['message'] == 'ready', 'ready, and no more')
    elsewhere.close()
    peer.close()


@pytest.mark.parametrize(
    ('parameters', 'told'),
    [
        ({'n': 0}, 'explainer_node: error: Invalid parameter value (0)'),
        ({'strategy': 'informativ'}, 'informative, increasing, decreasing'),
    ],
)
def test_a_wrong_parameter_ends_the_start_with_one_sentence(parameters, told, tmp_path):
    with running('explainer_node', new_namespace(), tmp_path, **parameters) as node:
        assert node.popen.wait(PATIENCE) == 2
        assert told in node.log
        assert 'Traceback' not in node.log


def test_parameters_that_the_node_does_not_have_are_told_with_what_may_be_meant(tmp_path):
    parameters = tmp_path / 'parameters.yaml'
    parameters.write_text(
        '/**: {ros__parameters: {user_model_flie: /a.yaml, robot: {wheels: 4}, n: 2}}\n'
        '/**/another: {ros__parameters: {startegi: increasing}}\n'
    )
    known = {'use_sim_time': False, 'start_type_description_service': True}
    options = ['--ros-args', '--params-file', str(parameters), '--']
    given = {'startegy': 'increasing', **known}
    with running('explainer_node', new_namespace(), tmp_path, options=options, **given) as node:
        eventually(lambda: 'waiting for' in node.log, 'that the node has started')
        told = [line.partition('the parameter ')[2] for line in log_lines(node, '[WARN]')]

    assert told == [
        '"robot.wheels" is not one of this node\'s, and is ignored',
        '"startegy" is not one of this node\'s, and is ignored (did you mean "strategy"?)',
        '"user_model_flie" is not one of this node\'s, and is ignored'
        ' (did you mean "user_model_file"?)',
    ]


@pytest.mark.parametrize(
    ('option', 'status', 'told'),
    [('--log-levle=x', 2, 'unrecognized arguments: --log-levle'), ('--help', 0, '--log-level')],
)
def test_what_is_wrong_with_an_option_is_told_and_so_is_help(option, status, told, capsys):
    with pytest.raises(SystemExit) as ended:
        main(['explainer_node', option])

    assert ended.value.code == status
    assert told in ''.join(capsys.readouterr())
