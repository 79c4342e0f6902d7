"""What the machine tells about the node: its memory, its version, and how old its files are."""

import contextlib
import os
import time
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from importlib.metadata import PackageNotFoundError, version

from mirror_explainer.node.memory import descendants, resident_memory


@dataclass(frozen=True)
class Surroundings:
    """Resident memory in bytes, seconds since each file was edited, publishers of each topic.

    These are the names of the nodes that publish it; of several nodes of one name each counts.
    `rivals` counts the other servers of the node's service.
    """

    node_memory: int = 0
    planner_memory: int = 0
    file_ages: Mapping[str, float] = field(default_factory=dict)
    publishers: Mapping[str, Sequence[str]] = field(default_factory=dict)
    rivals: int = 0
    version: str = ''


def look_around(
    files: Iterable[str], publishers: Mapping[str, Sequence[str]], rivals: int = 0
) -> Surroundings:
    """Return how things are now, with what the node sees of others in the graph."""
    node, planners = os.getpid(), sum(map(resident_memory, descendants(os.getpid())))
    ages = {}
    for file in files:
        with contextlib.suppress(OSError, ValueError):  # it is not there
            ages[file] = max(0.0, time.time() - os.stat(file).st_mtime)
    return Surroundings(
        resident_memory(node), planners, ages, publishers, rivals, package_version()
    )


@cache
def package_version() -> str:
    """Return the version of this package as installed."""
    try:
        return version('mirror_explainer')
    except PackageNotFoundError:
        return 'not installed'
