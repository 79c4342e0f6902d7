"""The worker's side of `worker.py`: messages in, and an end when the parent is gone.

Nothing of a worker may outlive the process that started it, however that ends.
"""

import os
import queue
import shutil
import signal
import sys
import threading
from multiprocessing.connection import Connection
from typing import Any

from mirror_explainer.planning.processes.confinement import confine


class Parent:
    """The process that started this one, as seen from here."""

    def __init__(self) -> None:
        confine()
        # Ctrl-C reaches the whole foreground group; what to do then is the parent's decision.
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        self._connection = Connection(int(sys.argv[1]))
        self._inbox: queue.SimpleQueue[Any] = queue.SimpleQueue()
        self._bell, self._rope = os.pipe()
        threading.Thread(target=self._listen, daemon=True).start()

    def _listen(self) -> None:
        while True:
            try:
                message = self._connection.recv()
            except Exception:  # the parent is gone, or there is no memory for its message
                end_group()
            self._inbox.put(message)
            os.write(self._rope, b'.')

    def fileno(self) -> int:
        """Return a descriptor that is readable while there are messages."""
        return self._bell

    def receive(self) -> Any:
        """Return the next message, when there is one."""
        os.read(self._bell, 1)
        return self._inbox.get()

    def send(self, message: Any) -> None:
        """Send any picklable value."""
        self._connection.send(message)


def end_group() -> None:
    """End this worker and all it started, and remove its private directory."""
    try:
        shutil.rmtree(os.environ['TMPDIR'], ignore_errors=True)
    finally:
        os.killpg(0, signal.SIGKILL)
