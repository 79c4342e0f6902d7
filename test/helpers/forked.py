"""Executables of the package as forks of a process that has imported all that they need.

Importing takes a second of a processor, and the tests start hundreds of them.
"""

import multiprocessing
import os
import signal
import subprocess
import sys
from collections.abc import Mapping, Sequence
from importlib.metadata import distribution
from pathlib import Path

_context = multiprocessing.get_context('forkserver')
_context.set_forkserver_preload(
    [
        __name__,
        'mirror_explainer.node.explainer_node',
        'mirror_explainer.demo.warehouse_robot',
        'std_srvs.srv',
    ]
)


class Forked:
    """A running executable, with what the tests use of `subprocess.Popen`.

    What it prints goes to the file `log`.
    """

    def __init__(self, executable: str, arguments: Sequence[str], log: Path) -> None:
        log.touch()
        self._process = _context.Process(
            target=_run, args=(executable, arguments, log, dict(os.environ), os.getcwd())
        )
        self._process.start()
        self.pid = self._process.pid

    def poll(self) -> int | None:
        return self._process.exitcode

    def wait(self, timeout: float | None = None) -> int:
        self._process.join(timeout)
        if self._process.exitcode is None:
            raise subprocess.TimeoutExpired(self._process.name, timeout)
        return self._process.exitcode

    def send_signal(self, number: signal.Signals) -> None:
        if self.poll() is None:
            os.kill(self.pid, number)

    def kill(self) -> None:
        self.send_signal(signal.SIGKILL)


def _run(
    executable: str,
    arguments: Sequence[str],
    log: Path,
    environment: Mapping[str, str],
    folder: str,
) -> None:
    """Become the executable, as the script that pip installs for it does."""
    with log.open('wb') as output:
        os.dup2(output.fileno(), 1)
        os.dup2(output.fileno(), 2)
    signal.signal(signal.SIGINT, signal.default_int_handler)
    os.environ.clear()
    os.environ.update(environment)
    os.chdir(folder)
    sys.argv = [executable, *arguments]
    [script] = distribution('mirror_explainer').entry_points.select(name=executable)
    sys.exit(script.load()())
