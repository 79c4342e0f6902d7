"""What the machine tells about the node: its memory, its version, and how old its files are."""

import contextlib
import os
import time
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from mirror_explainer.commands.command_line import package_version
from mirror_explainer.node.memory import descendants, resident_memory


@dataclass(frozen=True)
class Others:
    """What the node sees of other nodes: which publish each input, by name.

    Of several nodes of one name each counts; one whose name is not known yet is called ''.
    `unreliable` are those that publish an input as best effort, which nobody hears who wants all
    of it. Where there is no problem and no plan here, `elsewhere` are the namespaces that have
    both, with a slash at the end. `rivals` counts the other servers of the node's service.
    """

    publishers: Mapping[str, Sequence[str]] = field(default_factory=dict)
    unreliable: Mapping[str, Sequence[str]] = field(default_factory=dict)
    elsewhere: Sequence[str] = ()
    rivals: int = 0


@dataclass(frozen=True)
class Surroundings:
    """Resident memory in bytes, seconds since each file was edited, and other nodes."""

    node_memory: int = 0
    planner_memory: int = 0
    file_ages: Mapping[str, float] = field(default_factory=dict)
    others: Others = field(default_factory=Others)
    version: str = ''


def look_around(files: Iterable[str], others: Others) -> Surroundings:
    """Return how things are now, with what the node sees of others in the graph."""
    node, planners = os.getpid(), sum(map(resident_memory, descendants(os.getpid())))
    ages = {}
    for file in files:
        with contextlib.suppress(OSError, ValueError):  # it is not there
            ages[file] = max(0.0, time.time() - os.stat(file).st_mtime)
    return Surroundings(resident_memory(node), planners, ages, others, package_version())
