"""How much memory this process and those it started use, from /proc.

psutil would do, but it reads the whole machine's processes each time, and files that a
sandboxed service does not see.
"""

import contextlib
import os
from collections.abc import Iterator
from pathlib import Path

_PAGE = os.sysconf('SC_PAGE_SIZE')


def resident_memory(pid: int) -> int:
    """Return the bytes of memory that a process occupies, 0 if it has ended."""
    with contextlib.suppress(OSError):
        return int(Path(f'/proc/{pid}/statm').read_text().split()[1]) * _PAGE
    return 0


def descendants(pid: int) -> Iterator[int]:
    """Yield the processes that a process started, and those that they started."""
    threads: list[str] = []
    with contextlib.suppress(OSError):  # the process has just ended
        threads = os.listdir(f'/proc/{pid}/task')
    for thread in threads:
        children = ''
        with contextlib.suppress(OSError):  # the thread has
            children = Path(f'/proc/{pid}/task/{thread}/children').read_text()
        for child in map(int, children.split()):
            yield child
            yield from descendants(child)
