"""What happens when the disk is full: on a small one of the test's own."""

import contextlib
import itertools
import os
import shutil
import signal
import subprocess
from pathlib import Path

import pytest

pytest.importorskip('rclpy', reason='needs ROS 2')

from faults import FaultTable, answered_without
from patience import eventually
from ros_peer import THREE_SENTENCES, Peer, Process, explainer, last_diagnostic

pytestmark = pytest.mark.usefixtures('ros')
needs_disk = pytest.mark.skipif(
    subprocess.run(['unshare', '-rm', 'true'], capture_output=True).returncode != 0,
    reason='needs a mount namespace of its own',
)


class Disk:
    """A disk of 64 KiB that only one process and its children have."""

    def __init__(self, folder: Path) -> None:
        self.path = folder / 'disk'
        self.path.mkdir()
        self.environment = {'TMPDIR': str(self.path), 'ROS_LOG_DIR': str(self.path / 'log')}

    def within(self, first: str = 'true') -> list[str]:
        """Return the command that runs another one with this disk, after a first one."""
        mount = f'mount -t tmpfs -o size=64k,nr_inodes=64 none {self.path} && cd {self.path}'
        return ['unshare', '-rm', 'sh', '-c', f'{mount} && {first}; exec "$0" "$@"']

    def seen_by(self, node: Process) -> Path:
        """Return the disk as others than the node get to it."""
        return Path(f'/proc/{node.popen.pid}/root{self.path}')

    def fill(self, node: Process) -> None:
        """Use up all space, and all names."""
        folder = self.seen_by(node)
        with (
            contextlib.suppress(OSError),
            (folder / 'full').open('wb', buffering=0) as file,
        ):
            while True:
                file.write(bytes(4096))
        with contextlib.suppress(OSError):
            for number in itertools.count():
                (folder / str(number)).touch()


def kill_planning_processes(node: Process) -> None:
    for pid in node.session_leaders():
        os.kill(pid, signal.SIGKILL)


@needs_disk
def test_a_disk_that_fills_up_keeps_nobody_from_an_answer(
    peer: Peer, tmp_path: Path, fault_table: FaultTable
) -> None:
    disk = Disk(tmp_path)
    with explainer(
        peer,
        tmp_path,
        environment=disk.environment,
        within=disk.within(),
        goals_seen_file=disk.path / 'seen.yaml',
    ) as node:
        seen = disk.seen_by(node) / 'seen.yaml'
        peer.publish_warehouse()
        peer.answer()
        counted = seen.read_text()
        disk.fill(node)
        peer.publish('plan', 'nonsense')
        failure = peer.failure('nonsense')
        kill_planning_processes(node)
        peer.publish_warehouse('another')
        answer = peer.answer()
        warnings = eventually(lambda: last_diagnostic(peer).get('warnings'), 'the warning')
        still_counted = seen.read_text()
    fault_table.add('disk full: temporary files, log', 'the answer', 'OK', None)

    assert failure
    assert '(outside bottom_door)): 1' in counted
    assert f'{disk.path}/seen.yaml: No space left on device' in warnings
    assert still_counted == counted
    assert answer.endswith(THREE_SENTENCES)


def test_a_temporary_folder_that_is_gone_is_told_when_a_process_has_to_be_started(
    peer: Peer, tmp_path: Path, fault_table: FaultTable
) -> None:
    folder = tmp_path / 'temporary'
    folder.mkdir()
    with explainer(peer, tmp_path, environment={'TMPDIR': str(folder)}) as node:
        peer.publish_warehouse()
        peer.answer()

        def inject() -> None:
            shutil.rmtree(folder)
            kill_planning_processes(node)
            peer.publish_warehouse('another')

        without, answer = answered_without(
            fault_table,
            peer,
            'temporary folder gone, planning process killed',
            inject,
            'there is no temporary folder to plan in: [Errno 2] No such file or directory',
            folder.mkdir,
        )

    assert without.endswith(THREE_SENTENCES)
    assert answer.endswith(THREE_SENTENCES)


@needs_disk
def test_the_node_starts_on_a_full_disk_without_a_log_file(
    peer: Peer, tmp_path: Path, fault_table: FaultTable
) -> None:
    disk = Disk(tmp_path)
    full = 'head -c 1M /dev/zero > full; seq 99 | xargs touch'
    with explainer(
        peer,
        tmp_path,
        environment=disk.environment,
        within=disk.within(f'{{ {full}; }} 2>/dev/null'),
    ) as node:
        peer.publish_warehouse()
        answer = peer.answer()
        log = node.log
    fault_table.add('disk full at the start', 'the answer', 'OK; no log file', None)

    assert answer.endswith(THREE_SENTENCES)
    assert 'there is no log file' in log
