"""A child process that plans: started, spoken to, and ended together with all it started.

Each worker leads a session of its own and works in a private directory, so that
ending it leaves neither processes nor files behind.
"""

import contextlib
import os
import queue
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
from multiprocessing import Pipe
from pathlib import Path
from typing import Any

from mirror_explainer.errors import PlanningError
from mirror_explainer.planning.processes.confinement import environment


class Worker:
    """One child process that runs a file of this package (see `child.py` for its side).

    Raises PlanningError when the process cannot be started.
    """

    def __init__(self, program: Path) -> None:
        try:
            self.connection, theirs = Pipe()
        except OSError as error:
            raise _no_start(error) from error
        with theirs:
            try:
                self._directory = Path(tempfile.mkdtemp(prefix='mirror_explainer_'))
            except OSError as error:
                self.connection.close()
                raise PlanningError(
                    f'there is no temporary folder to plan in: {error}',
                    cure='Free space on the disk, or set TMPDIR to a folder that can be written.',
                ) from error
            try:
                self._process = self._start(program, theirs.fileno())
            except OSError as error:
                self.connection.close()
                shutil.rmtree(self._directory, ignore_errors=True)
                raise _no_start(error) from error
        self._outbox: queue.SimpleQueue[Any] = queue.SimpleQueue()
        self._sender = threading.Thread(target=self._send_all, name='to planner', daemon=True)
        self._sender.start()

    def _start(self, program: Path, descriptor: int) -> subprocess.Popen[bytes]:
        python_path = os.pathsep.join(map(os.path.abspath, sys.path))
        with (self._directory / 'stderr').open('wb') as stderr:
            return subprocess.Popen(
                # A path, for beside the program of a process unified-planning looks for an
                # up.ini that names engines; with -m it looks in the folders above the private one.
                [sys.executable, '-P', str(program), str(descriptor)],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=stderr,
                cwd=self._directory,
                env=environment(str(self._directory), python_path),
                pass_fds=[descriptor],
                start_new_session=True,
            )

    @property
    def alive(self) -> bool:
        """Whether the process still runs."""
        # A look that does not reap it: see `kill`.
        peek = os.WEXITED | os.WNOHANG | os.WNOWAIT
        try:
            return os.waitid(os.P_PID, self._process.pid, peek) is None
        except ChildProcessError:  # who started this program has it ignore SIGCHLD
            return False

    def send(self, message: Any) -> None:
        """Send any picklable value, without waiting until the worker takes it.

        That a dead worker misses it shows at `receive`.
        """
        self._outbox.put(message)

    def _send_all(self) -> None:
        with contextlib.suppress(OSError):
            while (message := self._outbox.get()) is not None:
                self.connection.send(message)

    def receive(self) -> Any:
        """Return the next message; raises EOFError when the worker has died."""
        try:
            return self.connection.recv()
        except OSError as error:
            raise EOFError from error

    def last_words(self) -> str:
        """Return the last line the worker wrote to its standard error, if any."""
        try:
            text = (self._directory / 'stderr').read_text(errors='replace')
        except OSError:
            return ''
        lines = text.strip().splitlines()
        return lines[-1].strip()[:200] if lines else ''

    def kill(self) -> None:
        """End the process and its whole group at once, and remove its directory."""
        # Before the leader is reaped, its id cannot have passed to anyone else.
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self._process.pid, signal.SIGKILL)
        self._process.wait()
        self._outbox.put(None)
        self._sender.join()  # nobody is there any more whom it could wait for
        self.connection.close()
        shutil.rmtree(self._directory, ignore_errors=True)


def _no_start(error: OSError) -> PlanningError:
    return PlanningError(
        f'the planning process does not start: {error}',
        cure='Free disk and memory, or allow more processes and open files (ulimit, TasksMax).',
    )
