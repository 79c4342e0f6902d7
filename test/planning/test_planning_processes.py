"""The processes that plan: they are ended and replaced, and fail, without a wrong answer."""

import importlib.util
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest
from patience import eventually
from pddl_cases import TOOLS, TOOLS_DOMAIN, TOOLS_PROBLEM, TOOLS_SHARP
from processes import HARD, Asking, child_sessions, processes_of, searches_of
from usage import processor_seconds

from mirror_explainer.errors import Cancelled, InputError, PlanningError
from mirror_explainer.planning import Belief, BeliefPlans, BeliefSpace, Planner, Status
from mirror_explainer.planning.downward.program import find_downward


@pytest.fixture(scope='module', params=[True, False], ids=['grounded once', 'one by one'])
def planner(request: pytest.FixtureRequest) -> Iterator[Planner]:
    """A planner for tests that leave it usable, in both ways, with one process."""
    with Planner(workers=1, shortcuts=request.param, planning_timeout=60.0) as planner:
        yield planner


def own_seconds(pids: set[int]) -> float:
    """Return the processor time that processes themselves have taken."""
    return sum(processor_seconds(pid)[0] for pid in pids)


@pytest.mark.parametrize(
    ('engine', 'shortcuts'),
    [('fast-downward-opt', True), ('fast-downward-opt', False), ('pyperplan-opt', False)],
)
def test_cancelling_ends_the_search_and_leaves_none_running(engine: str, shortcuts: bool) -> None:
    before, cancelled = child_sessions(), threading.Event()
    with Planner(engine, shortcuts=shortcuts, planning_timeout=60.0) as planner:
        planner.plan(HARD, [Belief(1)])  # so that its process is up
        sessions = child_sessions() - before
        idle = own_seconds(sessions)
        asking = Asking(planner, HARD, cancelled)
        # pyperplan searches within the worker: that it works is all there is to see.
        eventually(
            lambda: (
                own_seconds(sessions) > idle + 0.2 if 'py' in engine else searches_of(sessions)
            ),
            'a search',
        )
        cancelled.set()
        asking.join(timeout=60.0)

        assert isinstance(asking.error, Cancelled)
        # The kernel takes its time to end it.
        eventually(lambda: not searches_of(sessions), 'the end of the search')
        assert 'py' not in engine or not sessions & child_sessions()
        # The planner is still good for the next question.
        easy = replace(HARD, goals=HARD.goals[1:])
        assert planner.plan(easy, [Belief(0)]).results[0].status is Status.SOLVED
    assert child_sessions() == before


def test_closing_from_another_thread_cancels_and_leaves_no_process_or_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tempfile, 'tempdir', str(tmp_path))
    before = child_sessions()
    planner = Planner('fast-downward-opt', planning_timeout=60.0)
    asking = Asking(planner, HARD, threading.Event())
    eventually(lambda: searches_of(child_sessions() - before), 'a search')
    sessions = child_sessions() - before
    planner.close()
    asking.join(timeout=60.0)

    assert isinstance(asking.error, Cancelled)
    assert child_sessions() == before
    eventually(lambda: not any(map(processes_of, sessions)), 'the end of the processes')
    assert not list(tmp_path.iterdir())


def signalled_workers(before: set[int], number: signal.Signals) -> set[int]:
    """Send a signal to the workers started since; return them."""
    workers = child_sessions() - before
    for worker in workers:
        os.kill(worker, number)
    return workers


@pytest.mark.parametrize(
    ('shortcuts', 'ignored'),
    [(True, False), (True, True), (False, False)],
    ids=['fast', 'SIGCHLD ignored', 'one by one'],
)
def test_a_killed_worker_is_replaced(
    request: pytest.FixtureRequest, shortcuts: bool, ignored: bool
) -> None:
    if ignored:  # as whoever starts the program may have it
        usual = signal.signal(signal.SIGCHLD, signal.SIG_IGN)
        request.addfinalizer(lambda: signal.signal(signal.SIGCHLD, usual))
    before = child_sessions()
    with Planner(workers=1, shortcuts=shortcuts) as planner:
        planner.plan(TOOLS, [Belief(0)])
        workers = signalled_workers(before, signal.SIGKILL)
        eventually(lambda: not any(map(processes_of, workers)), 'the end of the workers')
        report = planner.plan(TOOLS, [Belief(0, TOOLS_SHARP)])

    assert len(workers) == 1
    assert report.results[0].plans[0].cost == 2 + 1


def test_a_worker_that_does_not_even_read_holds_up_nothing() -> None:
    before = child_sessions()
    # More than the buffer of its connection holds.
    long = replace(TOOLS, problem=TOOLS.problem + '\n;' + 'x' * 900_000)
    with Planner('fast-downward-opt') as planner:
        stopped = signalled_workers(before, signal.SIGSTOP)
        report = planner.plan(long, [Belief(0)], deadline=0.2)
        again = planner.plan(TOOLS, [Belief(0)])
        assert not stopped & child_sessions()
        signalled_workers(before, signal.SIGSTOP)
        asking = Asking(planner, long, threading.Event())
        time.sleep(0.1)
    asking.join(timeout=60.0)

    assert report.results[0].status is Status.UNKNOWN
    assert again.results[0].plans[0].cost == 8
    assert isinstance(asking.error, Cancelled)
    assert child_sessions() == before


def test_without_a_folder_for_the_next_worker_that_is_what_is_said(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    before = child_sessions()
    with Planner('fast-downward-opt') as planner:
        signalled_workers(before, signal.SIGSTOP)
        monkeypatch.setattr(tempfile, 'tempdir', '/nowhere')
        report = planner.plan(TOOLS, [Belief(0)], deadline=0.2)

        assert report.results[0].status is Status.UNKNOWN
        with pytest.raises(PlanningError, match='there is no temporary folder to plan in'):
            planner.plan(TOOLS, [Belief(0)])
    assert child_sessions() == before


def test_a_named_downward_program_is_used(tmp_path: Path) -> None:
    asked = tmp_path / 'asked'
    wrapper = tmp_path / 'downward'
    wrapper.write_text(f'#!/bin/sh\n: > {asked}\nexec {find_downward("")} "$@"\n')
    wrapper.chmod(0o755)
    with Planner('fast-downward-opt', downward_binary=str(wrapper)) as planner:
        report = planner.plan(TOOLS, [Belief(0)])

    assert report.results[0].plans[0].cost == 8
    assert asked.exists()


def test_a_translator_that_has_changed_inside_is_told_and_done_without(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    translate = importlib.util.find_spec('fast_downward.translate')
    assert translate is not None and translate.origin is not None
    changed = tmp_path / 'fast_downward' / 'translate'
    shutil.copytree(Path(translate.origin).parent, changed)
    with (changed / 'options.py').open('a') as options:
        options.write(OTHER_OPTIONS)
    monkeypatch.syspath_prepend(tmp_path)
    with Planner('fast-downward-opt', planning_timeout=60.0) as planner:
        report = planner.plan(TOOLS, [Belief(0)])

    assert report.results[0].plans[0].cost == 8
    [warning] = [r.message for r in caplog.records if r.levelname == 'WARNING']
    assert 'TypeError: no more options' in warning


# What fails for the program that sets the options itself, as ours does.
OTHER_OPTIONS = """
_set_options = set_options
def set_options(arguments=None):
    if arguments:
        raise TypeError('no more options')
    _set_options()
"""


def test_what_the_translator_refuses_in_its_own_way_is_no_warning(
    caplog: pytest.LogCaptureFixture,
) -> None:
    space = BeliefSpace(TOOLS_DOMAIN, '(define (problem', ('(polished)',))
    with (
        caplog.at_level('DEBUG', 'mirror_explainer'),
        Planner('fast-downward-opt') as planner,
        pytest.raises(InputError),
    ):
        planner.plan(space, [Belief(0)])

    [record] = caplog.records
    assert record.levelname == 'DEBUG'
    assert 'ParseError' in record.message


def test_a_missing_downward_program_is_told() -> None:
    with pytest.raises(PlanningError, match='/no/such/downward'):
        Planner('fast-downward-opt', downward_binary='/no/such/downward')


def test_a_program_that_always_fails_is_told(tmp_path: Path) -> None:
    wrapper = tmp_path / 'downward'
    wrapper.write_text('#!/bin/sh\nexit 99\n')
    wrapper.chmod(0o755)
    with (
        Planner('fast-downward-opt', downward_binary=str(wrapper)) as planner,
        pytest.raises(PlanningError, match='code 99'),
    ):
        planner.plan(TOOLS, [Belief(0)])


def test_the_workers_end_when_the_program_that_started_them_is_killed() -> None:
    code = (
        'import time; from mirror_explainer.planning import Planner; '
        "planner = Planner('fast-downward-opt'); print('up', flush=True); time.sleep(60)"
    )
    root = str(Path(__file__).parents[2])
    with subprocess.Popen(
        [sys.executable, '-c', code],
        stdout=subprocess.PIPE,
        env=os.environ | {'PYTHONPATH': root},
    ) as program:
        assert program.stdout is not None and program.stdout.readline() == b'up\n'
        sessions = child_sessions(program.pid)
        program.kill()

    assert sessions
    eventually(lambda: not any(map(processes_of, sessions)), 'the end of the processes')


def test_newer_input_is_answered_right_after_older_work_is_cancelled(planner: Planner) -> None:
    cancelled = threading.Event()
    asking = Asking(planner, HARD, cancelled)
    eventually(lambda: searches_of(child_sessions()), 'a search')
    cancelled.set()
    report = planner.plan(TOOLS, [Belief(0), Belief(0, TOOLS_SHARP)])
    asking.join(timeout=60.0)

    assert isinstance(asking.error, Cancelled)
    assert [result.plans[0].cost for result in report.results] == [8, 3]


def test_two_questions_at_once_are_both_answered_right(planner: Planner) -> None:
    changed = replace(TOOLS, problem=TOOLS_PROBLEM.replace('(raw)', '(cut)'))
    costs: dict[str, list[float]] = {'raw': [], 'cut': []}

    def ask(name: str, space: BeliefSpace) -> None:
        for _ in range(3):
            report = planner.plan(space, [Belief(0)])
            costs[name].append(report.results[0].plans[0].cost)

    other = threading.Thread(target=ask, args=('cut', changed))
    other.start()
    ask('raw', TOOLS)
    other.join(timeout=60.0)

    assert costs == {'raw': [8, 8, 8], 'cut': [1, 1, 1]}


def test_a_caller_that_fails_at_a_result_leaves_the_planner_usable(planner: Planner) -> None:
    def fail(belief: Belief, result: BeliefPlans) -> None:
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        planner.plan(TOOLS, [Belief(0), Belief(0, TOOLS_SHARP)], found=fail)
    report = planner.plan(TOOLS, [Belief(0), Belief(0, TOOLS_SHARP)])

    assert [result.plans[0].cost for result in report.results] == [8, 3]


def test_a_search_that_is_killed_is_searched_again() -> None:
    before = child_sessions()
    with Planner('fast-downward-opt', planning_timeout=2.0) as planner:
        asking = Asking(planner, HARD, threading.Event())
        eventually(lambda: searches_of(child_sessions() - before), 'a search')
        time.sleep(0.3)  # beyond the first try
        for search in searches_of(child_sessions() - before):
            os.kill(search, signal.SIGKILL)
        asking.join(timeout=60.0)
        report = planner.plan(HARD, [Belief(0)])

    assert asking.error is None
    assert report.results[0].status is Status.UNKNOWN
    assert report.results[0].reason == 'no optimal plan within 2 s'


def test_a_worker_killed_in_the_middle_of_a_search_is_replaced() -> None:
    before = child_sessions()
    with Planner('fast-downward-opt', planning_timeout=1.0) as planner:
        asking = Asking(planner, HARD, threading.Event())
        eventually(lambda: searches_of(child_sessions() - before), 'a search')
        signalled_workers(before, signal.SIGKILL)
        asking.join(timeout=60.0)
        report = planner.plan(HARD, [Belief(0), Belief(1)])

    assert asking.error is None
    assert report.results[0].reason == 'no optimal plan within 1 s'
    assert report.results[1].plans[0].optimal
    assert child_sessions() == before


def test_a_full_or_missing_temporary_directory_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tempfile, 'tempdir', '/no/such/directory')

    with pytest.raises(PlanningError, match='/no/such/directory'):
        Planner('fast-downward-opt')
