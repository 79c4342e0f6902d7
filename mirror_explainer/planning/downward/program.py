"""One search by Fast Downward, or by K*: a process that is asked, and can be ended.

Input and plan pass through memory, so that nothing is left on disk.
"""

import contextlib
import importlib.util
import json
import os
import subprocess
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from mirror_explainer.errors import PlanningError
from mirror_explainer.planning.beliefs import Status
from mirror_explainer.planning.downward.ground_task import Actions, canonical
from mirror_explainer.planning.processes.confinement import limit_search

# https://www.fast-downward.org/latest/documentation/exit-codes/
_SOLVED = (0, 1, 2, 3)
_UNSOLVABLE = (10, 11)
_OUT_OF_MEMORY = (20, 22, 24)

# In a search's configuration, where the file for its plans is to be named.
PLAN_FILE = 'PLAN_FILE'


@dataclass(frozen=True)
class Program:
    """A search program: its path, its name in messages, and how it writes plans.

    `plans` reads these from a text, and gives None for one that is not whole.
    """

    path: str
    name: str
    plans: Callable[[str], tuple[Actions, ...] | None]


def downward(path: str) -> Program:
    """Return Fast Downward, whose searches find one plan."""
    return Program(path, 'downward', _one_plan)


def kstar(path: str) -> Program:
    """Return K*, which is Fast Downward with a search that finds many plans."""
    return Program(path, 'K*', _many_plans)


def _one_plan(text: str) -> tuple[Actions, ...] | None:
    """Read a plan, which ends with its cost."""
    lines = text.splitlines()
    if not lines or not lines[-1].startswith('; cost'):
        return None
    return (tuple(canonical(line) for line in lines if line.startswith('(')),)


def _many_plans(text: str) -> tuple[Actions, ...] | None:
    """Read plans as JSON."""
    try:
        return tuple(tuple(map(canonical, plan['actions'])) for plan in json.loads(text)['plans'])
    except (ValueError, LookupError, TypeError, AttributeError):
        return None


@dataclass(frozen=True)
class Outcome:
    """What a search found: `plans` when SOLVED; `reason` when UNKNOWN, which may be a crash.

    It took so many `seconds` of processor time.
    """

    status: Status
    plans: tuple[Actions, ...] = ()
    reason: str = ''
    crashed: bool = False
    seconds: float = 0.0


class Search:
    """A running search. Its `fileno` is readable once it has ended.

    Whoever starts it ends it once it has `used` so many seconds of its processor time; if
    nobody is left to do so, the kernel does, a little later. Raises OSError when it
    does not start.
    """

    def __init__(self, program: Program, task: bytes, configuration: str, seconds: float) -> None:
        self._program = program
        self.since, self.seconds = time.monotonic(), seconds
        with contextlib.ExitStack() as files, open(os.memfd_create('task'), 'w+b') as task_file:
            self._plan = files.enter_context(open(os.memfd_create('plan'), 'rb'))
            ours, theirs = os.pipe()
            self._end = files.enter_context(open(ours, 'rb'))
            with open(theirs, 'wb'):
                task_file.write(task)
                task_file.seek(0)
                plan_file = f'/proc/self/fd/{self._plan.fileno()}'
                self._process = subprocess.Popen(
                    [
                        program.path,
                        *('--search', configuration.replace(PLAN_FILE, plan_file)),
                        *('--internal-plan-file', plan_file),
                    ],
                    stdin=task_file,
                    stdout=subprocess.DEVNULL,
                    stderr=subprocess.DEVNULL,
                    env={},
                    pass_fds=[self._plan.fileno(), theirs],
                )
            self._files = files.pop_all()
        limit_search(self._process.pid, seconds)

    def fileno(self) -> int:
        """Return a descriptor that becomes readable when the process ends."""
        return self._end.fileno()

    def used(self) -> float:
        """Return the seconds of processor time that it has taken."""
        try:
            # The clock of a process, as clock_getcpuclockid(3) makes it of its id.
            return time.clock_gettime(~self._process.pid << 3 | 2)
        except OSError:  # it has ended
            return 0.0

    def outcome(self) -> Outcome:
        """Return what the ended search found."""
        seconds = self.used()
        code = self._process.wait()
        self._plan.seek(0)
        plans = self._program.plans(self._plan.read().decode(errors='replace'))
        self._files.close()
        if code in _SOLVED and plans:
            return Outcome(Status.SOLVED, plans, seconds=seconds)
        if code in _UNSOLVABLE:
            return Outcome(Status.UNSOLVABLE, seconds=seconds)
        if code in _OUT_OF_MEMORY:
            return Outcome(Status.UNKNOWN, reason='the search ran out of memory')
        how = f'was ended by signal {-code}' if code < 0 else f'ended with code {code}'
        if code in _SOLVED:
            how = 'gave no whole plan'
        return Outcome(Status.UNKNOWN, reason=f'{self._program.name} {how}', crashed=True)

    def kill(self) -> None:
        """End the search at once."""
        self._process.kill()
        self._process.wait()
        self._files.close()


def find_downward(named: str) -> str | None:
    """Return the `downward` program named, or the one up-fast-downward brings, None if none.

    Raises PlanningError when the one named is no program, or lacks its translator.
    """
    has_translator = importlib.util.find_spec('fast_downward') is not None
    if named:
        if not has_translator:
            raise PlanningError(
                "Fast Downward's translator is not installed, and the program named as "
                'downward_binary is of no use without it',
                cure="pip install 'fast-downward-translate>=26.6,<27'",
            )
        if not os.access(named, os.X_OK) or Path(named).is_dir():
            raise PlanningError(
                f'there is no program at "{named}", which is named as downward_binary',
                cure="Give the path of Fast Downward's search program, or leave it empty.",
            )
        return str(Path(named).resolve())
    return (has_translator and _built_in('up_fast_downward', 'downward')) or None


def find_kstar() -> str:
    """Return the search program that kstar-planner brings, '' if there is none."""
    return _built_in('kstar_planner')


def _built_in(package: str, *folder: str) -> str:
    """Return the program `downward` that was built in a package's folder, '' if there is none."""
    spec = importlib.util.find_spec(package)
    places: Sequence[str] = (spec and spec.submodule_search_locations) or ()
    programs = (Path(place, *folder, 'builds/release/bin/downward') for place in places)
    return next((str(program) for program in programs if os.access(program, os.X_OK)), '')
