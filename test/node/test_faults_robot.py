"""What happens around the node: robots and explainers that come, die and clash, and clocks."""

import signal
import threading
import time
from pathlib import Path

import pytest
from patience import eventually

pytest.importorskip('rclpy', reason='needs ROS 2')

from faults import FaultTable, diagnosed
from ros_peer import (
    CONFIG,
    PLAN,
    PROBLEM,
    THREE_SENTENCES,
    USER_MODEL,
    Peer,
    explainer,
    last_diagnostic,
    running,
)

pytestmark = pytest.mark.usefixtures('ros')

LOW_BATTERY = {
    'problem_file': CONFIG / 'low_battery_problem.pddl',
    'plan_file': CONFIG / 'low_battery_plan.txt',
}
NOTHING_LEFT = 'I am done.'


def robot(peer: Peer, folder: Path, **parameters: object):
    return running('warehouse_robot', peer.node.get_namespace(), folder, **parameters)


def test_a_robot_that_dies_and_another_in_its_place_are_both_explained(
    peer: Peer, tmp_path: Path, fault_table: FaultTable
) -> None:
    with explainer(peer, tmp_path, user_model_file=CONFIG / 'visitor.yaml', n=4):
        with robot(peer, tmp_path) as first:
            before = peer.answer()
            first.stop(signal.SIGKILL)
        without = peer.call()
        started = time.monotonic()
        with robot(peer, tmp_path, **LOW_BATTERY):
            recharge = 'I will recharge my battery.'
            eventually(lambda: recharge in peer.answer().split('\n'), 'the new plan')
    fault_table.add(
        'robot node killed, another one started',
        'the answer about the last plan heard, then about the new one',
        'after 20 s WARN: nobody publishes problem and plan any more',
        time.monotonic() - started,
    )

    assert recharge not in before
    assert without.message == before


def test_a_second_explainer_in_the_namespace_is_told_until_it_ends(
    peer: Peer, tmp_path: Path, fault_table: FaultTable
) -> None:
    (tmp_path / 'other').mkdir()
    peer.publish_warehouse(heard=False)
    with explainer(peer, tmp_path) as node:
        peer.answer()
        with explainer(peer, tmp_path / 'other'):
            level = diagnosed(peer, '1 more node serves verbalize_plan here')
            # Either of the two may have said it first; this one is to log it.
            eventually(lambda: '1 more node serves verbalize_plan here' in node.log, 'its log')
            cure = last_diagnostic(peer)['what to do']
            answer = peer.answer()
        ended = time.monotonic()
        peer.diagnostics.clear()
        eventually(lambda: last_diagnostic(peer)['message'] == 'ready', 'ready')
        fault_table.add(
            'another explainer in the same namespace',
            'an answer of either; both hear the same robot',
            f'{level}: 1 more node serves verbalize_plan here',
            time.monotonic() - ended,
        )
        told = node.log.count('1 more node serves verbalize_plan here')

    assert level == 'WARN'
    assert 'a namespace or ROS_DOMAIN_ID of its own' in cure
    assert answer == THREE_SENTENCES
    assert told == 1


def test_an_explainer_that_was_killed_and_started_again_hears_what_was_latched(
    peer: Peer, tmp_path: Path, fault_table: FaultTable
) -> None:
    peer.publish_warehouse(heard=False)
    with explainer(peer, tmp_path) as node:
        peer.answer()
        started = node.descendants()
        node.stop(signal.SIGKILL)
    restarted = time.monotonic()
    with explainer(peer, tmp_path):
        # A call may still go to the dead node, and is lost then.
        call = eventually(
            lambda: (
                (call := peer.start_call()).ends_within(2.0) and call.result().success and call
            ),
            'an answer',
        )
        answer = call.result().message
    fault_table.add(
        'explainer killed and started again',
        'nothing: a call to a dead node is lost, so give calls a time limit',
        'none until it is back',
        time.monotonic() - restarted,
    )

    assert started
    assert answer == THREE_SENTENCES


def test_robots_that_publish_at_once_are_explained_by_the_newest_of_each_topic(
    peer: Peer, tmp_path: Path, fault_table: FaultTable
) -> None:
    low_battery = Peer(peer.node.get_namespace())
    problem, plan = (Path(path).read_text() for path in LOW_BATTERY.values())

    def publish_often(robot: Peer, problem: str, plan: str) -> None:
        for number in range(20):
            robot.publish('problem', f'{problem}; {number}')
            robot.publish('plan', f'{plan}; {number}')

    with explainer(peer, tmp_path):
        peer.publish_warehouse()
        threads = [
            threading.Thread(target=publish_often, args=texts)
            for texts in ((peer, PROBLEM, PLAN), (low_battery, problem, plan))
        ]
        for thread in threads:
            thread.start()
        heard = []
        while any(thread.is_alive() for thread in threads):
            heard.append(peer.call())
        for thread in threads:
            thread.join()
        low_battery.wait_until_heard()  # what DDS sends again would come after the last two
        peer.publish('problem', PROBLEM)
        peer.publish('plan', PLAN)
        ended = time.monotonic()
        eventually(lambda: peer.answer() == THREE_SENTENCES, 'the answer to the last two')
        seconds = time.monotonic() - ended
        told = 'more than one node publishes problem and plan'
        level = diagnosed(peer, told)
        fault_table.add(
            'two robots publish at once, 20 times each',
            'waits for the newest of each topic; "…/plan: …" where the two do not fit',
            f'{level}: {told}; ERROR where the two do not fit',
            seconds,
        )
    low_battery.close()

    assert all('/plan' in answer.message for answer in heard if not answer.success)


FAKETIME = next(Path('/usr/lib').glob('*/faketime/libfaketime.so.1'), None)
needs_faketime = pytest.mark.skipif(FAKETIME is None, reason='needs libfaketime')


@needs_faketime
def test_a_clock_that_is_set_back_keeps_no_message_diagnostic_or_edit_from_being_noticed(
    peer: Peer, tmp_path: Path, fault_table: FaultTable
) -> None:
    clock = tmp_path / 'clock'
    clock.write_text('+0')
    jumping = {
        'LD_PRELOAD': str(FAKETIME),
        'FAKETIME_TIMESTAMP_FILE': str(clock),
        'FAKETIME_CACHE_DURATION': '1',
        'FAKETIME_DONT_FAKE_MONOTONIC': '1',
    }
    user_model = tmp_path / 'user_model.yaml'
    user_model.write_text(Path(USER_MODEL).read_text())
    with (
        explainer(peer, tmp_path, environment=jumping, user_model_file=user_model, n=1),
        robot(peer, tmp_path, environment=jumping, step_period=0.5),
    ):
        peer.answer()
        eventually(lambda: peer.stamps, 'a state told today')
        clock.write_text('-2d')
        eventually(
            lambda: peer.stamps[-1] < peer.stamps[0] - 86_400, 'a state told the day before'
        )
        eventually(lambda: peer.answer().endswith(NOTHING_LEFT), "the plan's end to be heard")
        user_model.unlink()
        failure = peer.failure('the file cannot be read')
        level = diagnosed(peer, failure)
    fault_table.add(
        "node's and robot's clock set back by two days", 'the newest answer', 'OK', None
    )

    assert level == 'ERROR'
