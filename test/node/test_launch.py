"""The launch files, launched: needs ROS's own launch, which has no wheels."""

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from patience import PATIENCE

pytest.importorskip('rclpy', reason='needs ROS 2')
pytest.importorskip('launch_ros', reason="needs ROS's launch")

from ros_peer import DOMAIN, PLAN, PROBLEM, THREE_SENTENCES, USER_MODEL, Peer

pytestmark = pytest.mark.usefixtures('ros')

# Includes a launch file of this package with arguments, after what it is given to set.
_INCLUDE = """
import sys
from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription, LaunchService
from launch.actions import IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch_ros.actions import PushROSNamespace, SetParameter

name, namespace, *words = sys.argv[1:]
share = get_package_share_directory('mirror_explainer')
arguments = [word.split(':=') for word in words if ':=' in word]
settings = [SetParameter(*word.split('=')) for word in words if ':=' not in word]
source = PythonLaunchDescriptionSource(f'{share}/launch/{name}')
include = IncludeLaunchDescription(source, launch_arguments=arguments)
service = LaunchService()
service.include_launch_description(
    LaunchDescription([PushROSNamespace(namespace), *settings, include])
)
sys.exit(service.run())
"""


@contextmanager
def launched(peer: Peer, name: str, folder: Path, *words: str) -> Iterator[None]:
    """Include a launch file in the peer's namespace, with name:=argument or parameter=value."""
    command = [sys.executable, '-c', _INCLUDE, name, peer.node.get_namespace(), *words]
    process = subprocess.Popen(command, env=os.environ | {'ROS_LOG_DIR': str(folder)})
    try:
        yield
    finally:
        process.send_signal(signal.SIGINT)
        process.wait(PATIENCE)


def test_what_an_including_launch_file_sets_stays_and_the_nodes_defaults_hold(
    peer: Peer, tmp_path: Path
) -> None:
    given = ['n=1', 'answer_timeout=30.0']
    with launched(peer, 'explainer.launch.py', tmp_path, *given, f'user_model_file={USER_MODEL}'):
        peer.publish('domain', DOMAIN)
        peer.publish('problem', PROBLEM)
        peer.publish('plan', PLAN)
        answer = peer.answer()

    assert answer == 'I will exit from the bottom door.'


def test_files_that_are_given_as_arguments_win_over_a_file_of_parameters(
    peer: Peer, tmp_path: Path
) -> None:
    parameters = tmp_path / 'parameters.yaml'
    parameters.write_text(
        '/**: {ros__parameters: {user_model_file: /nowhere, n: 1, answer_timeout: 30.0}}'
    )
    given = [
        f'params_file:={parameters}',
        f'user_model_file:={USER_MODEL}',
        f'domain_file:={Path(USER_MODEL).parent / "domain.pddl"}',
        'log_level:=debug',
    ]
    with launched(peer, 'explainer.launch.py', tmp_path, *given):
        peer.publish('problem', PROBLEM)
        peer.publish('plan', PLAN)
        answer = peer.answer()

    assert answer == 'I will exit from the bottom door.'


def test_the_demo_starts_robot_and_explainer_together(peer: Peer, tmp_path: Path) -> None:
    given = ['step_period:=0.0', 'answer_timeout=30.0']
    with launched(peer, 'demo.launch.py', tmp_path, *given):
        answer = peer.answer()

    assert answer == THREE_SENTENCES
