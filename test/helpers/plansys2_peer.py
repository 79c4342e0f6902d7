"""Running the stand-in for PlanSys2 and its bridge in a test."""

import contextlib
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

from plansys2_messages import environment
from ros_peer import PATIENCE, Peer, running

STAND_IN = Path(__file__).parent / 'plansys2_stand_in.py'


class StandIn:
    """PlanSys2's stand-in as a process, which does what the test says."""

    def __init__(self, popen: subprocess.Popen) -> None:
        self._popen = popen

    def do(self, *commands: str) -> None:
        """Let these happen, one after the other, as the stand-in's `obey` takes them."""
        for command in commands:
            self._popen.stdin.write(f'{command}\n')
            self._popen.stdin.flush()
            # The middleware prints what it notices on stdout too.
            assert 'done\n' in iter(self._popen.stdout.readline, ''), command

    def stop(self) -> None:
        """End it as a launch file does; after a crash DDS would notice only 20 s later."""
        self._popen.terminate()
        self._popen.wait(PATIENCE)


@contextlib.contextmanager
def plansys2(peer: Peer, folder: Path, task: str) -> Iterator[StandIn]:
    """Run the stand-in in the peer's namespace, with a task as JSON."""
    file = folder / 'task.json'
    file.write_text(task)
    namespace = peer.node.get_namespace()
    popen = subprocess.Popen(
        [sys.executable, STAND_IN, file, '--ros-args', '-r', f'__ns:={namespace}'],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        env=os.environ | environment(),
    )
    try:
        yield StandIn(popen)
    finally:
        popen.kill()
        popen.communicate()


def bridge(peer: Peer, folder: Path) -> contextlib.AbstractContextManager:
    """Run the bridge in the peer's namespace."""
    return running('plansys2_bridge', peer.node.get_namespace(), folder, environment=environment())
