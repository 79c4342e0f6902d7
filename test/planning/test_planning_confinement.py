"""What planning processes see and use of the computer, looked at in /proc while they run."""

import contextlib
import os
import stat
import subprocess
import sys
import tempfile
import threading
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest
from patience import eventually
from pddl_cases import WAREHOUSE_DOMAIN, WAREHOUSE_PROBLEM, gripper
from processes import HARD, Asking, child_sessions, processes_of, searches_of

from mirror_explainer.errors import PlanningError
from mirror_explainer.planning import Belief, BeliefSpace, Planner

EASY = BeliefSpace(WAREHOUSE_DOMAIN, WAREHOUSE_PROBLEM, ('(holding red_cube)',))

# All that may pass from the program that plans to the processes that it starts.
ALLOWED = {
    'HOME', 'JAVA_HOME', 'LANG', 'LC_ALL', 'LD_LIBRARY_PATH', 'OMP_NUM_THREADS', 'PATH',
    'PYTHONHASHSEED', 'PYTHONPATH', 'TMPDIR', '_ROS_WHEELS_BOOTSTRAP_COMPLETE',
}  # fmt: skip


@dataclass
class Seen:
    """What /proc says of a process: limits are the hard ones, by name."""

    variables: set[str]
    folder: Path
    mode: int
    limits: dict[str, str]
    niceness: int


def look_at(pid: int) -> Seen:
    process = Path(f'/proc/{pid}')
    words = (process / 'environ').read_text().split('\0')
    folder = Path(os.readlink(process / 'cwd'))
    lines = (process / 'limits').read_text().splitlines()[1:]
    return Seen(
        variables={word.split('=')[0] for word in words if word},
        folder=folder,
        mode=stat.S_IMODE(folder.stat().st_mode),
        limits={line[:26].strip(): line[47:68].strip() for line in lines},
        niceness=int((process / 'stat').read_text().rpartition(') ')[2].split()[16]),
    )


@pytest.fixture(scope='module')
def worker_and_search() -> Iterator[tuple[Seen, Seen]]:
    """Look at a worker and at one of its searches in the middle of their work."""
    found: list[tuple[Seen, Seen]] = []
    before, cancelled = child_sessions(), threading.Event()

    def look() -> bool:
        (worker,) = child_sessions() - before
        with contextlib.suppress(FileNotFoundError):  # a search may end while it is looked at
            found.extend((look_at(worker), look_at(pid)) for pid in searches_of({worker}))
        # A search is limited in its time once it runs.
        return bool(found) and found[-1][1].limits['Max cpu time'] != 'unlimited'

    os.environ['ROBOT_PASSWORD'] = 'secret'
    with Planner(planning_timeout=60.0, memory_limit=512) as planner:
        del os.environ['ROBOT_PASSWORD']
        asking = Asking(planner, HARD, cancelled)
        eventually(look, 'a search that is limited')
        cancelled.set()
        asking.join()
    yield found[-1]


def test_the_worker_sees_a_few_variables_and_a_search_none(
    worker_and_search: tuple[Seen, Seen],
) -> None:
    worker, search = worker_and_search

    assert worker.variables <= ALLOWED
    assert search.variables == set()


def test_an_engine_of_the_general_way_sees_the_same_few_variables(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv('ROBOT_PASSWORD', 'secret')
    before = child_sessions()
    with Planner('pyperplan') as planner:
        planner.plan(EASY, [Belief(0)])
        (worker,) = child_sessions() - before
        seen = look_at(worker)

    assert seen.variables <= ALLOWED


def test_processes_work_in_a_folder_of_their_own_that_others_cannot_enter(
    worker_and_search: tuple[Seen, Seen],
) -> None:
    worker, search = worker_and_search

    assert worker.folder == search.folder
    assert worker.folder.parent == Path(tempfile.gettempdir())
    assert worker.mode == 0o700
    assert not worker.folder.exists()  # the planner is closed by now


def test_a_search_has_limits_of_memory_time_and_files(
    worker_and_search: tuple[Seen, Seen],
) -> None:
    _, search = worker_and_search

    assert search.limits['Max data size'] == search.limits['Max file size'] == str(512 << 20)
    assert search.limits['Max core file size'] == '0'
    assert int(search.limits['Max open files']) <= 4096
    assert int(search.limits['Max cpu time']) == 1 + 10  # a first try, and 10 s of grace


def test_planning_stands_back_behind_what_started_it(
    worker_and_search: tuple[Seen, Seen],
) -> None:
    lower = min(os.nice(0) + 5, 19)

    assert [seen.niceness for seen in worker_and_search] == [lower, lower]


@pytest.mark.parametrize('engine', ['fast-downward-opt', 'pyperplan-opt'])
def test_a_program_killed_in_mid_search_leaves_neither_process_nor_file(
    engine: str, tmp_path: Path
) -> None:
    domain, problem, goal = gripper(30)
    code = (
        'from mirror_explainer.planning import *\n'
        f'space = BeliefSpace({domain!r}, {problem!r}, ({goal!r},))\n'
        f"with Planner('{engine}', planning_timeout=60) as planner:\n"
        '    planner.plan(space, [Belief(0)], found=print)\n'
    )
    with subprocess.Popen(
        [sys.executable, '-c', code],
        env=os.environ | {'PYTHONPATH': str(Path(__file__).parents[2]), 'TMPDIR': str(tmp_path)},
    ) as program:
        # pyperplan searches within the worker: then there is no more to see than the worker.
        sessions = eventually(
            lambda: (
                (found := child_sessions(program.pid))
                and list(tmp_path.iterdir())
                and ('py' in engine or searches_of(found))
                and found
            ),
            'a search',
        )
        program.kill()

    eventually(lambda: not any(map(processes_of, sessions)), 'the end of the processes')
    eventually(lambda: not list(tmp_path.iterdir()), 'the end of the files')


def test_a_file_in_the_folder_of_temporary_files_adds_no_engine(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # unified-planning obeys an up.ini in the folders above a program; anyone may write to /tmp.
    (tmp_path / 'up.ini').write_text(
        '[engine planted]\nmodule_name: up_pyperplan.engine\nclass_name: EngineImpl\n'
    )
    monkeypatch.setattr(tempfile, 'tempdir', str(tmp_path))
    with Planner('planted') as planner, pytest.raises(PlanningError, match='no planning engine'):
        planner.plan(EASY, [Belief(0)])
