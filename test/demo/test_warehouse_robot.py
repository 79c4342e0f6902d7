"""The demo robot as a process, with a domain of one's own."""

from pathlib import Path

import pytest
from patience import PATIENCE, eventually

pytest.importorskip('rclpy', reason='needs ROS 2')

from rcl_interfaces.msg import Parameter as ParameterMessage
from rcl_interfaces.msg import ParameterValue
from rcl_interfaces.srv import SetParameters
from ros_peer import Call, Peer, running
from std_srvs.srv import Trigger

from mirror_explainer.pddl import read_task

pytestmark = pytest.mark.usefixtures('ros')

DOMAIN = """(define (domain lamps)
  (:requirements :durative-actions :typing :derived-predicates)
  (:types lamp)
  (:predicates (lit ?l - lamp) (bright))
  (:derived (bright) (forall (?l - lamp) (lit ?l)))
  (:durative-action light :parameters (?l - lamp) :duration (= ?duration 2)
    :condition () :effect (at end (lit ?l))))
"""
PROBLEM = """(define (problem evening) (:domain lamps)
  (:objects red blue - lamp) (:init) (:goal (bright)))
"""
PLAN = '0.0: (light red) [2.0]\n2.0: (light blue) [2.0]'


def files(folder: Path, plan: str) -> dict[str, Path]:
    """Return the parameters that name the files of a robot with this plan."""
    texts = {'domain': DOMAIN, 'problem': PROBLEM, 'plan': plan}
    for name, text in texts.items():
        (folder / name).write_text(text)
    return {f'{name}_file': folder / name for name in texts}


def test_a_robot_of_ones_own_domain_publishes_its_own_texts_with_each_state(
    peer: Peer, tmp_path: Path
) -> None:
    domains, problems, plans = (peer.hear(name) for name in ('domain', 'problem', 'plan'))
    robot = files(tmp_path, PLAN)
    with running('warehouse_robot', peer.node.get_namespace(), tmp_path, step_period=0.5, **robot):
        eventually(lambda: '' in plans, 'the end of the plan')
        eventually(lambda: '(lit blue)' in problems[-1], 'the last state')
        last = problems[-1]
        restart = peer.client(Trigger, 'warehouse_robot/restart', of='warehouse_robot')
        plans.clear()
        assert Call(restart.call_async(Trigger.Request())).result().success
        eventually(lambda: plans[:1] == [PLAN] and '' in plans, 'the end of it once more')

    assert domains == [DOMAIN]
    assert read_task(DOMAIN, last).initial_facts == {'(lit red)', '(lit blue)'}
    assert '(bright)' not in last.split('(:goal')[0]


def test_a_robot_may_publish_its_plan_once_and_then_only_its_state(
    peer: Peer, tmp_path: Path
) -> None:
    problems, plans = peer.hear('problem'), peer.hear('plan')
    robot = files(tmp_path, PLAN)
    parameters = {'step_period': 0.5, 'plan_once': True, **robot}
    with running('warehouse_robot', peer.node.get_namespace(), tmp_path, **parameters):
        eventually(lambda: problems and '(lit blue)' in problems[-1], 'the last state')

    assert plans == [PLAN]


def test_a_robot_may_tell_its_progress_and_begins_again_wherever_it_is(
    peer: Peer, tmp_path: Path
) -> None:
    progress, plans = peer.hear('progress'), peer.hear('plan')
    told = [
        'running: (light red)',
        'done: (light red)\nrunning: (light blue)',
        'done: (light red)\ndone: (light blue)',
    ]
    robot = files(tmp_path, PLAN)
    parameters = {'step_period': 0.5, 'tell_progress': True, **robot}
    with running('warehouse_robot', peer.node.get_namespace(), tmp_path, **parameters):
        restart = peer.client(Trigger, 'warehouse_robot/restart', of='warehouse_robot')
        eventually(lambda: progress and plans, 'what is latched')  # from now on all is heard
        for end in (told[1:2], told):  # in its midst, and at its end
            heard = len(progress)
            assert Call(restart.call_async(Trigger.Request())).result().success
            eventually(lambda: progress[heard:][-len(end) :] == end, 'this progress')

    assert plans == [PLAN] * 3


@pytest.mark.parametrize(
    ('executable', 'name', 'value', 'fault'),
    [
        ('warehouse_robot', 'step_period', 4, "to '4' of type 'INTEGER', expecting type 'DOUBLE'"),
        ('task_list_robot', 'known_tasks', 4, "expecting type 'STRING_ARRAY'"),
        ('operator_page', 'explainer', 4, "expecting type 'STRING'"),
        ('explainer_node', 'threshold', 1, '(write a decimal with its point, as in 4.0)'),
    ],
)
def test_a_parameter_of_another_type_ends_a_node_with_one_sentence(
    peer: Peer, tmp_path: Path, executable: str, name: str, value: int, fault: str
) -> None:
    given = {name: value}
    with running(executable, peer.node.get_namespace(), tmp_path, **given) as process:
        assert process.popen.wait(PATIENCE) == 2

    assert process.log.splitlines()[-1].startswith(f'{executable}: error: ')
    assert f"'{name}'" in process.log and fault in process.log
    assert 'Traceback' not in process.log


def test_what_rclpy_itself_cannot_take_does_not_end_a_robot(peer: Peer, tmp_path: Path) -> None:
    with running('warehouse_robot', peer.node.get_namespace(), tmp_path) as process:
        setting = peer.client(SetParameters, 'warehouse_robot/set_parameters', 'warehouse_robot')
        restart = peer.client(Trigger, 'warehouse_robot/restart', of='warehouse_robot')
        no_type = ParameterMessage(name='step_period', value=ParameterValue(type=77))
        setting.call_async(SetParameters.Request(parameters=[no_type]))
        eventually(lambda: '77 is not a valid' in process.log, 'the reason in the log')

        assert Call(restart.call_async(Trigger.Request())).result().success


def test_a_plan_that_cannot_be_carried_out_ends_the_robot_with_one_sentence(
    peer: Peer, tmp_path: Path
) -> None:
    robot = files(tmp_path, '(light red)')
    with running('warehouse_robot', peer.node.get_namespace(), tmp_path, **robot) as process:
        status = process.popen.wait(PATIENCE)

    assert status == 2
    assert f'error: {robot["plan_file"]}: the plan does not reach the goal' in process.log
    assert 'Traceback' not in process.log
