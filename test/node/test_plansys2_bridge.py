"""The bridge from PlanSys2, over DDS: a stand-in for PlanSys2 on one side, topics on the other."""

import json
import os
import subprocess
from dataclasses import asdict

import pytest
from ament_index_python.packages import get_package_prefix
from patience import eventually
from plansys2_peer import bridge, plansys2
from plansys2_task import GREENHOUSE, fetch, greenhouse, roll

TOPICS = ('domain', 'problem', 'plan', 'progress')
PLAN = (
    '0.000: (roll c1 gate Beans) [6.000]\n6.001: (fetch c1 rake Beans) [2.000]\n'
    '8.002: (roll c1 Beans herbs) [6.000]\n14.003: (fetch c1 hoe herbs) [2.000]'
)


class Heard:
    """What the bridge has told so far."""

    def __init__(self, peer) -> None:
        self._texts = {topic: peer.hear(topic) for topic in TOPICS}

    def __getitem__(self, topic: str) -> list[str]:
        return self._texts[topic]

    def last(self, topic: str) -> str | None:
        texts = self._texts[topic]
        return texts[-1] if texts else None

    def waits_for(self, topic: str, text: str) -> None:
        eventually(lambda: self.last(topic) == text, f'{topic}: {text!r}')

    def waits_for_fact(self, fact: str, there: bool = True) -> None:
        spaced = fact.replace('(', '( ').replace(')', ' )')
        eventually(
            lambda: self.last('problem') and (spaced in self.last('problem')) is there,
            f'{fact} in the problem: {there}',
        )


@pytest.fixture
def heard(peer) -> Heard:
    return Heard(peer)


def test_a_whole_plan_is_told_as_it_is_carried_out(peer, heard, tmp_path):
    with plansys2(peer, tmp_path, greenhouse().json()) as robot, bridge(peer, tmp_path):
        heard.waits_for('domain', GREENHOUSE)
        heard.waits_for_fact('(at_bed c1 gate)')
        robot.do('execute')
        heard.waits_for('plan', PLAN)
        robot.do('start 0')
        heard.waits_for_fact('(at_bed c1 gate)', there=False)
        heard.waits_for('progress', 'running: (roll c1 gate Beans)')
        robot.do('end 0', 'start 1')
        heard.waits_for_fact('(lies_at rake Beans)', there=False)
        heard.waits_for('progress', 'done: (roll c1 gate Beans)\nrunning: (fetch c1 rake Beans)')
        robot.do('end 1', 'start 2', 'end 2', 'start 3', 'end 3', 'finish')
        heard.waits_for('plan', '')
        heard.waits_for_fact('(carries c1 hoe)')
    assert heard['plan'] == [PLAN, '']
    assert heard['domain'] == [GREENHOUSE]


def test_the_final_problem_is_told_before_the_plan_is_over(peer, heard, tmp_path):
    told = []
    peer.hear('problem')
    with plansys2(peer, tmp_path, greenhouse().json()) as robot, bridge(peer, tmp_path):
        robot.do('execute')
        heard.waits_for('plan', PLAN)
        for step in range(4):
            robot.do(f'start {step}', f'end {step}')
        robot.do('finish')
        heard.waits_for('plan', '')
        told = [text for text in heard['problem'] if '( carries c1 hoe )\n' in text]
    assert told


def test_a_bridge_that_starts_late_tells_the_plan_under_way(peer, heard, tmp_path):
    with plansys2(peer, tmp_path, greenhouse().json()) as robot:
        robot.do('execute', 'start 0', 'end 0', 'start 1')
        with bridge(peer, tmp_path):
            heard.waits_for('plan', PLAN)
            heard.waits_for_fact('(at_bed c1 Beans)')
            heard.waits_for(
                'progress', 'done: (roll c1 gate Beans)\nrunning: (fetch c1 rake Beans)'
            )


def test_a_bridge_that_starts_after_a_plan_has_ended_ends_up_without_it(peer, heard, tmp_path):
    with plansys2(peer, tmp_path, greenhouse().json()) as robot:
        robot.do('execute', 'cancel')
        with bridge(peer, tmp_path):
            heard.waits_for_fact('(at_bed c1 gate)')
            heard.waits_for('plan', '')


def test_plansys2_may_start_after_the_bridge_and_be_activated_later(peer, heard, tmp_path):
    with bridge(peer, tmp_path) as process:
        eventually(lambda: 'get_domain is not there' in process.log, 'a line on what is missing')
        with plansys2(peer, tmp_path, greenhouse(active=False).json()) as robot:
            eventually(lambda: 'non-active state' in process.log, "PlanSys2's own reason")
            robot.do('activate')
            heard.waits_for('domain', GREENHOUSE)
            heard.waits_for_fact('(at_bed c1 gate)')


def test_a_plansys2_that_hangs_is_told_and_asked_again(peer, heard, tmp_path):
    with plansys2(peer, tmp_path, greenhouse().json()) as robot, bridge(peer, tmp_path) as process:
        heard.waits_for_fact('(at_bed c1 gate)')
        robot.do('hang 6')
        assert 'get_problem gives no reply' in process.log
        robot.do('add (at_bed c2 herbs)')
        heard.waits_for_fact('(at_bed c2 herbs)')
        eventually(lambda: 'get_problem gives the problem' in process.log, 'that it is well')
        assert 'is not there' not in process.log.split('gives no reply')[1]


def test_a_plan_is_withdrawn_when_plansys2_ends_and_a_new_one_is_told(peer, heard, tmp_path):
    task = greenhouse()
    with bridge(peer, tmp_path):
        with plansys2(peer, tmp_path, task.json()) as robot:
            robot.do('execute', 'start 0')
            heard.waits_for('plan', PLAN)
            robot.stop()
            task.facts[0] = '(at_bed c1 herbs)'
            task.plan = [fetch(0.0, 'c1', 'hoe', 'herbs')]
        with plansys2(peer, tmp_path, task.json()) as robot:
            heard.waits_for('plan', '')
            heard.waits_for_fact('(at_bed c1 herbs)')
            robot.do('execute')
            heard.waits_for('plan', '0.000: (fetch c1 hoe herbs) [2.000]')


def test_a_plan_that_failed_is_told_until_the_robot_gets_another_goal(peer, heard, tmp_path):
    with plansys2(peer, tmp_path, greenhouse().json()) as robot, bridge(peer, tmp_path):
        robot.do('execute', 'start 0', 'end 0', 'start 1', 'states')
        heard.waits_for('progress', 'done: (roll c1 gate Beans)\nrunning: (fetch c1 rake Beans)')
        robot.do('fail 1')
        failed = 'done: (roll c1 gate Beans)\nfailed: (fetch c1 rake Beans)'
        heard.waits_for('progress', failed)
        robot.do('add (lies_at rake gate)')
        heard.waits_for_fact('(lies_at rake gate)')
        assert heard['plan'] == [PLAN]
        robot.do('goal ( and ( carries c1 hoe ) )')
        heard.waits_for('plan', '')


def test_a_cancelled_plan_is_over(peer, heard, tmp_path):
    with plansys2(peer, tmp_path, greenhouse().json()) as robot, bridge(peer, tmp_path):
        robot.do('execute', 'start 0')
        heard.waits_for('plan', PLAN)
        robot.do('cancel')
        heard.waits_for('plan', '')


def test_another_plan_in_the_middle_takes_the_place_of_the_first(peer, heard, tmp_path):
    with plansys2(peer, tmp_path, greenhouse().json()) as robot, bridge(peer, tmp_path):
        robot.do('execute', 'start 0', 'end 0', 'states')
        heard.waits_for('progress', 'done: (roll c1 gate Beans)')
        steps = [fetch(0.0, 'c1', 'rake', 'Beans'), roll(2.001, 'c1', 'Beans', 'herbs')]
        robot.do(f'plan {json.dumps([asdict(step) for step in steps])}', 'execute')
        heard.waits_for(
            'plan', '0.000: (fetch c1 rake Beans) [2.000]\n2.001: (roll c1 Beans herbs) [6.000]'
        )
        assert heard.last('progress') == ''


def test_a_plan_that_is_repeated_all_the_time_is_told_once(peer, heard, tmp_path):
    with plansys2(peer, tmp_path, greenhouse().json()) as robot, bridge(peer, tmp_path):
        robot.do('execute', 'start 0', *['repeat', 'states'] * 50)
        heard.waits_for('progress', 'running: (roll c1 gate Beans)')
        robot.do('end 0', *['repeat', 'states'] * 50)
        heard.waits_for('progress', 'done: (roll c1 gate Beans)')
    assert heard['plan'] == [PLAN]


def test_the_same_plan_carried_out_again_begins_anew(peer, heard, tmp_path):
    with plansys2(peer, tmp_path, greenhouse().json()) as robot, bridge(peer, tmp_path):
        robot.do('execute', 'start 0', 'end 0', 'states')
        heard.waits_for('progress', 'done: (roll c1 gate Beans)')
        robot.do('finish')
        heard.waits_for('plan', '')
        robot.do('execute')
        heard.waits_for('plan', PLAN)
    assert heard.last('progress') == ''


def test_actions_that_overlap_run_at_once(peer, heard, tmp_path):
    task = greenhouse()
    task.objects['cart'].append('c2')
    task.facts.append('(at_bed c2 gate)')
    task.plan = [roll(0.0, 'c1', 'gate', 'Beans'), roll(0.0, 'c2', 'gate', 'herbs')]
    with plansys2(peer, tmp_path, task.json()) as robot, bridge(peer, tmp_path):
        robot.do('execute', 'start 1', 'start 0')
        heard.waits_for('progress', 'running: (roll c1 gate Beans)\nrunning: (roll c2 gate herbs)')


def test_two_robots_are_told_apart_by_their_namespaces(ros, tmp_path):
    from ros_peer import Peer, new_namespace

    one, other = Peer(new_namespace()), Peer(new_namespace())
    first, second = tmp_path / 'one', tmp_path / 'other'
    first.mkdir()
    second.mkdir()
    try:
        far = greenhouse(facts=['(at_bed c1 herbs)'])
        with (
            plansys2(one, first, greenhouse().json()),
            plansys2(other, second, far.json()),
            bridge(one, first),
            bridge(other, second),
        ):
            Heard(one).waits_for_fact('(at_bed c1 gate)')
            Heard(other).waits_for_fact('(at_bed c1 herbs)')
    finally:
        one.close()
        other.close()


def test_without_plansys2s_messages_the_bridge_says_what_to_install(tmp_path):
    (tmp_path / 'plansys2_msgs.py').write_text(
        "raise ModuleNotFoundError('No module', name='plansys2_msgs')"
    )
    done = run_bridge(PYTHONPATH=f'{tmp_path}:{os.environ.get("PYTHONPATH", "")}')
    assert done.returncode == 2
    assert 'sudo apt install ros-jazzy-plansys2-msgs' in done.stderr
    assert 'Traceback' not in done.stderr


def test_messages_that_cannot_be_loaded_are_told_as_that(tmp_path):
    (tmp_path / 'plansys2_msgs.py').write_text(
        "raise ImportError('libplansys2_msgs.so: cannot open shared object file')"
    )
    done = run_bridge(PYTHONPATH=f'{tmp_path}:{os.environ.get("PYTHONPATH", "")}')
    assert done.returncode == 2
    assert 'cannot be loaded: libplansys2_msgs.so' in done.stderr


def run_bridge(**environment: str) -> subprocess.CompletedProcess:
    program = get_package_prefix('mirror_explainer') + '/lib/mirror_explainer/plansys2_bridge'
    return subprocess.run(
        [program], env=os.environ | environment, capture_output=True, text=True, timeout=60
    )
