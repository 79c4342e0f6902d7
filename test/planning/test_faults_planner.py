"""What happens to the planner while the node runs: it dies, hangs, lies, or is not there."""

import contextlib
import itertools
import os
import shutil
import signal
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from patience import eventually

pytest.importorskip('rclpy', reason='needs ROS 2')

import sliding_tiles
from faults import FaultTable, answered_without, diagnosed
from ros_peer import (
    THREE_SENTENCES,
    Peer,
    Process,
    explainer,
    last_diagnostic,
    name_of,
    new_namespace,
)

from mirror_explainer.planning.downward.program import find_downward

pytestmark = pytest.mark.usefixtures('ros')

REAL = find_downward('')
# The plan file is the last argument.
# The plan goes to the file that the last argument names.
SCRIPTS = {
    'good': f'exec {REAL} "$@"',
    'prints garbage': 'head -c 5000 /dev/urandom > ${@: -1}',
    'breaks off in the middle of its plan': f'{REAL} "$@"; truncate -s -40 ${{@: -1}}',
    'gives a plan for something else': 'printf "(move left center)\\n; cost = 1\\n" > ${@: -1}',
    'ends with an unknown code': 'exit 77',
    'is killed in every search': 'kill -KILL $$',
    'says that nothing can be reached': 'exit 11',
    'is out of memory': 'exit 22',
    'hangs': 'exec sleep 1000',
}
FAILS = 'the planner fails at whatever it is asked: '
TOLD = {
    'prints garbage': f'{FAILS}downward gave no whole plan',
    'breaks off in the middle of its plan': f'{FAILS}downward gave no whole plan',
    'gives a plan for something else': f'{FAILS}downward gave a wrong plan',
    'ends with an unknown code': f'{FAILS}downward ended with code 77',
    'is killed in every search': f'{FAILS}downward was ended by signal 9',
    'says that nothing can be reached': 'the planner is wrong: it says that there is no plan',
}
# What finds nothing, though it does not fail, and why.
FINDS_NOTHING = {
    'is out of memory': 'the search ran out of memory',
    'hangs': 'the deadline passed',
}
# Those that take long, or are much like another one.
FOR_THE_TABLE = {
    'breaks off in the middle of its plan',
    'ends with an unknown code',
    'is out of memory',
}


class Program:
    """A `downward` of our own, which behaves as it is told."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.asked = path.with_suffix('.asked')
        self.does('good')

    def does(self, what: str) -> None:
        new = self.path.with_suffix('.new')
        new.write_text(f'#!/bin/bash\necho >> {self.asked}\n{SCRIPTS[what]}\n')
        new.chmod(0o755)
        new.rename(self.path)

    @property
    def times_asked(self) -> int:
        return len(self.asked.read_text()) if self.asked.exists() else 0


@pytest.fixture(scope='module')
def program(tmp_path_factory: pytest.TempPathFactory) -> Program:
    return Program(tmp_path_factory.mktemp('planner') / 'downward')


@pytest.fixture(scope='module')
def peer(program: Program, ros: None) -> Iterator[Peer]:
    """A peer of one node for the tests with such a program, which has its inputs."""
    peer = Peer(new_namespace())
    with explainer(peer, program.path.parent, downward_binary=program.path, deadline=DEADLINE):
        peer.publish_warehouse()
        assert peer.answer().endswith(THREE_SENTENCES)
        yield peer
    peer.close()


DEADLINE = 60.0  # s
_numbers = itertools.count()


def replan(peer: Peer) -> None:
    """Publish a problem and a plan that must be planned for anew."""
    peer.publish_warehouse(f'unused_{next(_numbers)}')


@pytest.mark.parametrize('what', TOLD)
def test_where_the_planner_is_broken_answers_are_made_without_until_it_works(
    peer: Peer,
    program: Program,
    fault_table: FaultTable,
    what: str,
    request: pytest.FixtureRequest,
) -> None:
    if what in FOR_THE_TABLE and not request.config.getoption('--fault-table'):
        pytest.skip('only with --fault-table')

    def inject() -> None:
        program.does(what)
        replan(peer)

    without, answer = answered_without(
        fault_table, peer, f'planner {what}', inject, TOLD[what], lambda: program.does('good')
    )

    assert without.endswith(THREE_SENTENCES)
    assert answer.endswith(THREE_SENTENCES)


@pytest.mark.parametrize('what', FINDS_NOTHING)
def test_where_planning_finds_nothing_in_time_the_answer_is_made_without_and_that_is_told(
    peer: Peer,
    program: Program,
    fault_table: FaultTable,
    what: str,
    request: pytest.FixtureRequest,
) -> None:
    if what in FOR_THE_TABLE and not request.config.getoption('--fault-table'):
        pytest.skip('only with --fault-table')
    peer.set_parameters(deadline=1.0)
    program.does(what)
    replan(peer)
    level = diagnosed(peer, f'planning gave no result ({FINDS_NOTHING[what]})')
    without = peer.answer()
    program.does('good')
    peer.set_parameters(deadline=DEADLINE)
    replan(peer)
    replanned = time.monotonic()
    eventually(lambda: last_diagnostic(peer)['message'] == 'ready', 'all plans')
    fault_table.add(
        f'planner {what}',
        'the answer, made without planning',
        f'{level}: ready, but not for all beliefs: …',
        time.monotonic() - replanned,
    )

    assert level == 'WARN'
    assert without.endswith(THREE_SENTENCES)
    assert peer.answer().endswith(THREE_SENTENCES)


def delete(path: Path) -> None:
    path.unlink()


def make_not_executable(path: Path) -> None:
    path.chmod(0o644)


@pytest.mark.parametrize('remove', [delete, make_not_executable])
def test_a_planner_that_is_gone_is_told_and_is_found_when_it_is_back(
    peer: Peer, program: Program, fault_table: FaultTable, remove: Callable[[Path], None]
) -> None:
    def inject() -> None:
        remove(program.path)
        replan(peer)

    without, answer = answered_without(
        fault_table,
        peer,
        f'planner program: {remove.__name__.replace("_", " ")}',
        inject,
        str(program.path),
        lambda: program.does('good'),
    )

    assert without.endswith(THREE_SENTENCES)
    assert answer.endswith(THREE_SENTENCES)


def test_a_broken_planner_is_not_asked_again_by_every_call(peer: Peer, program: Program) -> None:
    program.does('ends with an unknown code')
    replan(peer)
    diagnosed(peer, FAILS)
    asked = program.times_asked
    began = time.monotonic()
    for _ in range(100):
        peer.call()
    took = time.monotonic() - began
    again = program.times_asked - asked
    program.does('good')

    # An attempt ends after some ten searches, and another one may begin a second later.
    assert again <= 20 * (1 + took)
    assert peer.answer().endswith(THREE_SENTENCES)


def test_a_program_that_is_not_installed_is_found_once_it_is(
    tmp_path: Path, fault_table: FaultTable
) -> None:
    hidden = tmp_path / 'path' / 'up_fast_downward'
    hidden.mkdir(parents=True)
    (hidden / '__init__.py').write_text("raise ImportError('not installed')")
    python_path = os.pathsep.join([str(hidden.parent), os.environ.get('PYTHONPATH', '')])
    peer = Peer(new_namespace())
    with explainer(peer, tmp_path, environment={'PYTHONPATH': python_path}):
        without, answer = answered_without(
            fault_table,
            peer,
            'planner not installed, then installed',
            peer.publish_warehouse,
            'there is no planning engine "fast-downward-opt" here',
            lambda: shutil.rmtree(hidden),
        )
    peer.close()

    assert without.endswith(THREE_SENTENCES)
    assert answer.endswith(THREE_SENTENCES)


def searches(node: Process) -> set[int]:
    return {pid for pid in node.descendants() if name_of(pid) == 'downward'}


def kill_all(find: Callable[[], set[int]], what: str) -> None:
    for pid in eventually(find, what):
        with contextlib.suppress(ProcessLookupError):
            os.kill(pid, signal.SIGKILL)


def test_killed_searches_and_workers_are_replaced_and_no_wrong_answer_comes(
    tmp_path: Path, fault_table: FaultTable
) -> None:
    user_model = tmp_path / 'tiles.yaml'
    user_model.write_text(sliding_tiles.USER_MODEL)
    hard, easy = sliding_tiles.scrambled(200), sliding_tiles.scrambled(3, seed=1)
    # Each is another plan than the one before.
    right, right_of_hard = (
        {'I have changed my plan.', *sliding_tiles.sentences(plan)} for _, plan in (easy, hard)
    )
    peer = Peer(new_namespace())
    with explainer(
        peer,
        tmp_path,
        user_model_file=user_model,
        planning_timeout=600.0,
        deadline=600.0,
        answer_timeout=2.0,  # what is tried again for the hard one does not end
    ) as node:

        def publish(problem: str, plan: str) -> None:
            peer.publish('domain', sliding_tiles.DOMAIN)
            peer.publish('problem', problem)
            peer.publish('plan', plan)

        def kill_until_told(find: Callable[[], set[int]], message: str) -> Callable[[], None]:
            def kill() -> None:
                publish(*hard)
                while message not in last_diagnostic(peer)['message']:
                    found = find()
                    for pid in found:
                        with contextlib.suppress(ProcessLookupError):
                            os.kill(pid, signal.SIGKILL)
                    time.sleep(0.02)

            return kill

        for fault, find, message in (
            ('search killed in mid-search, again and again', searches, 'ended by signal 9'),
            (
                'planning process killed in mid-work, again and again',
                Process.session_leaders,
                'died more',
            ),
        ):
            without, answer = answered_without(
                fault_table,
                peer,
                fault,
                kill_until_told(lambda find=find: find(node), message),
                message,
                lambda: publish(*easy),
            )
            assert set(without.split('\n')) <= right_of_hard
            assert set(answer.split('\n')) <= right
        kill_all(lambda: node.session_leaders(), 'an idle planning process')
        killed = time.monotonic()
        publish(easy[0] + '; again', easy[1])
        again = peer.answer()
        fault_table.add(
            'planning process killed while idle', 'the answer', 'OK', time.monotonic() - killed
        )
    peer.close()

    assert set(again.split('\n')) <= right
