"""Plain searches for one belief's problem: each of the portfolio by itself, and other planners'.

All get the task as Fast Downward itself translates it, and are told by their processor time.
"""

import importlib.util
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from mirror_explainer.errors import PlanningError
from mirror_explainer.experiments.planning.cases import problem_of
from mirror_explainer.planning import Belief, BeliefSpace
from mirror_explainer.planning.downward.portfolio import PLAIN
from mirror_explainer.planning.downward.program import find_downward

_WATCHED = 0.005  # seconds between two looks at a search


@dataclass(frozen=True)
class Peer:
    """Another planner's search: its package at PyPI, its `downward` there, how that is called."""

    name: str
    package: str
    program: str
    arguments: tuple[str, ...]

    def found(self) -> str | None:
        """Return the path of its program, None if it is not installed."""
        package = importlib.util.find_spec(self.package.replace('-', '_'))
        folders = (package and package.submodule_search_locations) or ()
        return next((str(Path(folder, self.program)) for folder in folders), None)


# LAMA's first search; symbolic search; and one plan by K*, as its package calls it.
PEERS = (
    Peer(
        'LAMA',
        'up-fast-downward',
        'downward/builds/release/bin/downward',
        ('--search', 'let(h,ff(),lazy_greedy([h],preferred=[h],cost_type=one))'),
    ),
    Peer('SymK', 'up-symk', 'symk/builds/release/bin/downward', ('--search', 'sym_bd()')),
    Peer(
        'K*',
        'kstar-planner',
        'builds/release/bin/downward',
        (
            '--symmetries',
            'sym=structural_symmetries(time_bound=0,search_symmetries=oss,'
            'stabilize_initial_state=false,keep_operator_symmetries=true)',
            '--search',
            'kstar(lmcut(),k=1,dump_plan_files=false,symmetries=sym)',
        ),
    ),
)


def translated(space: BeliefSpace, belief: Belief) -> bytes:
    """Return a belief's own problem as Fast Downward translates it."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / 'domain.pddl').write_text(space.domain)
        (folder / 'problem.pddl').write_text(problem_of(space, belief))
        command = [sys.executable, '-m', 'fast_downward.translate', 'domain.pddl', 'problem.pddl']
        subprocess.run(command, cwd=folder, check=True, stdout=subprocess.DEVNULL)
        return (folder / 'output.sas').read_bytes()


def best_single(tasks: Sequence[bytes], limit: float) -> float | None:
    """Return the seconds of the portfolio's quickest search for each task, summed.

    None if for one of the tasks none ends within the limit. Raises PlanningError if Fast
    Downward is not installed.
    """
    program = find_downward('')
    if program is None:
        raise PlanningError("Fast Downward's search is not installed", cure='Install it.')

    def best(task: bytes) -> float | None:
        quickest = None
        for search in PLAIN:
            most = quickest or limit
            quickest = seconds_of([program, '--search', search], task, most) or quickest
        return quickest

    return _summed(map(best, tasks))


def peer_seconds(peer: Peer, program: str, tasks: Sequence[bytes], limit: float) -> float | None:
    """Return the seconds of a peer for all tasks, None if one of these does not end in time."""
    command = [program, *peer.arguments]
    return _summed(seconds_of(command, task, limit) for task in tasks)


def _summed(each: Iterator[float | None]) -> float | None:
    total = 0.0
    for seconds in each:
        if seconds is None:
            return None
        total += seconds
    return total


def seconds_of(command: Sequence[str], task: bytes, limit: float) -> float | None:
    """Return the processor time of a search, None if it finds nothing within the limit."""
    with tempfile.TemporaryFile() as text:
        text.write(task)
        text.seek(0)
        search = subprocess.Popen(
            [*command, '--internal-plan-file', os.devnull],
            stdin=text,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
    clock = ~search.pid << 3 | 2  # as clock_getcpuclockid(3) makes it of a process's id
    look = os.WEXITED | os.WNOHANG | os.WNOWAIT  # what has ended keeps its clock
    while os.waitid(os.P_PID, search.pid, look) is None and time.clock_gettime(clock) < limit:
        time.sleep(_WATCHED)
    seconds = time.clock_gettime(clock)
    search.kill()
    return seconds if search.wait() == 0 else None
