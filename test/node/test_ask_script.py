"""`scripts/ask.py`: asks as a person would, and tells at once what keeps the answer waiting."""

import re
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from patience import PATIENCE, eventually

pytest.importorskip('rclpy', reason='needs ROS 2')

from ros_peer import Peer, explainer

pytestmark = pytest.mark.usefixtures('ros')

SCRIPT = Path(__file__).parents[2] / 'scripts' / 'ask.py'


@contextmanager
def asking(peer: Peer, log: Path, *options: str, beside: str = '') -> Iterator[subprocess.Popen]:
    """Run the script with options in the peer's namespace, or one beside it."""
    namespace = ['--ros-args', '-r', f'__ns:={peer.node.get_namespace()}{beside}']
    words = [sys.executable, SCRIPT, *options, *namespace]
    with log.open('w') as output:
        process = subprocess.Popen(
            words,
            stdout=output,
            stderr=subprocess.STDOUT,
            preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
        )
        try:
            yield process
        finally:
            process.kill()
            process.wait()


def test_a_fault_is_told_while_it_asks_on_and_the_answer_once_it_is_mended(
    peer: Peer, tmp_path: Path
) -> None:
    log = tmp_path / 'asked.txt'
    with explainer(peer, tmp_path), asking(peer, log) as process:
        peer.publish_warehouse()
        peer.publish('plan', '(fly left)')
        eventually(lambda: 'the domain has no action "fly"' in log.read_text(), 'the fault')
        assert process.poll() is None
        peer.publish_warehouse()
        assert process.wait(PATIENCE) == 0

    assert log.read_text().count('"fly"') == 1
    assert 'Robot: "I will exit from the bottom door."' in log.read_text()


def test_asked_once_it_says_no_more_than_the_robot(peer: Peer, tmp_path: Path) -> None:
    before, after = tmp_path / 'before.txt', tmp_path / 'after.txt'
    with explainer(peer, tmp_path):
        with asking(peer, before, '--once', '--timeout', str(PATIENCE)) as process:
            assert process.wait(PATIENCE) == 1
        peer.publish_warehouse()
        said = peer.answer()
        with asking(peer, after, '--once') as process:
            assert process.wait(PATIENCE) == 0

    assert before.read_text() == 'I have no plan yet.\n'
    assert after.read_text() == f'{said}\n'


def test_ctrl_c_ends_it_quietly_while_it_waits_for_a_node_that_is_elsewhere(
    peer: Peer, tmp_path: Path
) -> None:
    log, there = tmp_path / 'asked.txt', peer.node.get_namespace()

    def lines_of_it() -> list[str]:
        # Other tests may have explainers elsewhere, too, which may be known sooner or later.
        return re.findall(rf'^nothing .*: explainers are in .*{there}\b.*$', log.read_text(), re.M)

    with asking(peer, log, beside='_2') as process:
        eventually(lambda: 'nothing offers' in log.read_text(), 'a word of it')
        with explainer(peer, tmp_path):  # comes after that
            eventually(lines_of_it, 'where one is')
            process.send_signal(signal.SIGINT)
            assert process.wait(PATIENCE) == 130

    [line] = lines_of_it()
    assert '(--ros-args -r __ns:=/' in line
    assert 'Traceback' not in log.read_text()
