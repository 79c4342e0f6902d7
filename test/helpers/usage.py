"""What a process and all that it started use of the machine."""

from dataclasses import dataclass
from pathlib import Path

import psutil

MEBIBYTE = 1 << 20


def processor_seconds(pid: int) -> tuple[float, float]:
    """Return the seconds of processor time of a process itself, and of all that it started."""
    process = psutil.Process(pid)
    times = process.cpu_times()
    started = times.children_user + times.children_system
    for child in process.children(recursive=True):
        try:
            started += sum(child.cpu_times()[:4])  # its own, and of those that it has reaped
        except psutil.NoSuchProcess:  # it has just ended
            continue
    return times.user + times.system, started


@dataclass(frozen=True)
class Usage:
    """What a process holds: memory in MiB, resident, of itself and of its children."""

    memory: float
    children_memory: float
    threads: int
    descriptors: int
    children: int
    files: int
    files_size: float


def usage(pid: int, temporary: Path) -> Usage:
    """Look at a process at rest, whose temporary files are in a folder of its own."""
    process = psutil.Process(pid)
    children = process.children(recursive=True)
    files = [path for path in temporary.rglob('*') if path.is_file()]
    return Usage(
        memory=process.memory_info().rss / MEBIBYTE,
        children_memory=sum(child.memory_info().rss for child in children) / MEBIBYTE,
        threads=process.num_threads(),
        descriptors=process.num_fds() + sum(child.num_fds() for child in children),
        children=len(children),
        files=len(files),
        files_size=sum(path.stat().st_size for path in files) / MEBIBYTE,
    )
