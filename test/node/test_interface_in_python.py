"""The lines of Python in docs/interface.md: what a robot publishes, and what an operator sets."""

import re
import subprocess
import sys
from pathlib import Path

import pytest
from patience import eventually

pytest.importorskip('rclpy', reason='needs ROS 2')

from ros_peer import Peer, explainer

pytestmark = pytest.mark.usefixtures('ros')

ROOT = Path(__file__).parents[2]
PUBLISH, ASK = re.findall(r'```python\n(.*?)```', (ROOT / 'docs/interface.md').read_text(), re.S)


def command(block: str, peer: Peer) -> list[str]:
    """Return the command that runs a block in the peer's namespace."""
    namespace = f'__ns:={peer.node.get_namespace()}'
    return [sys.executable, '-c', block, '--ros-args', '-r', namespace]


def test_the_docs_lines_tell_progress_and_set_a_parameter(peer: Peer, tmp_path: Path) -> None:
    def asked() -> str:
        try:  # a reply may be lost while the node does not know the client yet
            return subprocess.run(
                command(ASK, peer), cwd=ROOT, capture_output=True, text=True, timeout=30.0
            ).stdout
        except subprocess.TimeoutExpired:
            return ''

    with explainer(peer, tmp_path), subprocess.Popen(command(PUBLISH, peer), cwd=ROOT) as robot:
        try:
            three = peer.answer()
            [is_set, two] = eventually(asked, 'a reply').split('\n', 1)
            told = peer.hear('progress')
            eventually(lambda: told and told[-1].endswith('running: (move center doors)'), 'it')
        finally:
            robot.kill()

    assert is_set == 'set'
    assert len(two.split()) < len(three.split())
