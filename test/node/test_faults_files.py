"""What happens to the user model's files while the node runs."""

import os
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from patience import eventually

pytest.importorskip('rclpy', reason='needs ROS 2')

from faults import FaultTable, injected
from ros_peer import THREE_SENTENCES, USER_MODEL, Peer, explainer, last_diagnostic, new_namespace

pytestmark = pytest.mark.usefixtures('ros')

MODEL = Path(USER_MODEL).read_text()
SENTENCES = MODEL[MODEL.index('\nsentences:') :]
OPERATORS_GOAL = '(holding red_circle),(holding blue_cube),(outside bottom_door)\n'
OTHER_DOOR = '(holding red_circle),(holding blue_cube),(outside top_left_door)\n'
# What tells the two candidates apart.
TELLS_THE_DOOR = 'I will exit from the bottom door.'
OTHER_CIRCLE = '(holding red_triangle),(holding blue_cube),(outside bottom_door)\n'


@pytest.fixture(scope='module')
def model_path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A user model that faults happen to."""
    path = tmp_path_factory.mktemp('files') / 'user_model.yaml'
    path.write_text(MODEL)
    return path


@pytest.fixture(scope='module')
def peer(ros: None, model_path: Path) -> Iterator[Peer]:
    """A peer of one node for all these tests, which has its inputs."""
    peer = Peer(new_namespace())
    with explainer(peer, model_path.parent, user_model_file=model_path):
        peer.publish_warehouse()
        assert peer.answer() == THREE_SENTENCES
        yield peer
    peer.close()


def delete(path: Path) -> None:
    path.unlink()


def half_write(path: Path) -> None:
    path.write_text(path.read_text()[:-20] + '"')


def make_a_directory(path: Path) -> None:
    path.unlink()
    path.mkdir()


def make_a_dangling_link(path: Path) -> None:
    path.unlink()
    path.symlink_to('nowhere.yaml')


def make_a_pipe(path: Path) -> None:
    path.unlink()
    os.mkfifo(path)


def make_no_text(path: Path) -> None:
    path.write_bytes(b'\xff\xfe\0')


def replace(path: Path, text: str) -> None:
    """Put a text in the place of whatever is there, in one step."""
    if path.is_dir():
        path.rmdir()
    new = path.with_suffix('.new')
    new.write_text(text)
    new.rename(path)


FAULTS: dict[str, tuple[Callable[[Path], None], str]] = {
    'deleted': (delete, 'the file cannot be read: No such file or directory'),
    'half-written': (half_write, 'no YAML that can be read'),
    'unreadable (a directory)': (make_a_directory, 'the file cannot be read: Is a directory'),
    'a dangling link': (make_a_dangling_link, 'the file cannot be read: No such file'),
    'a named pipe': (make_a_pipe, 'the file cannot be read: it is a pipe or a device'),
    'overwritten with noise': (make_no_text, 'this is no UTF-8 text'),
}


@pytest.mark.parametrize('fault', FAULTS)
def test_a_broken_user_model_file_fails_calls_until_it_is_put_back(
    peer: Peer, model_path: Path, fault_table: FaultTable, fault: str
) -> None:
    inject, words = FAULTS[fault]

    failure, answer = injected(
        fault_table,
        peer,
        f'user-model file {fault}',
        lambda: inject(model_path),
        words,
        lambda: replace(model_path, MODEL),
    )

    assert failure.startswith(str(model_path))
    assert answer == THREE_SENTENCES


@pytest.fixture
def hyps(peer: Peer, model_path: Path) -> Iterator[Path]:
    """A file of candidates that the user model names while the test runs."""
    path = model_path.parent / 'hyps.dat'
    path.write_text(OPERATORS_GOAL + OTHER_DOOR)
    peer.set_parameters(n=1)
    model_path.write_text(f'hyps_file: hyps.dat\n{SENTENCES}')
    assert peer.call().message == TELLS_THE_DOOR
    yield path
    model_path.write_text(MODEL)
    peer.set_parameters(n=3)
    assert peer.call().message == THREE_SENTENCES


def test_an_edit_is_noticed_although_nobody_calls(peer: Peer, model_path: Path) -> None:
    model_path.unlink()
    eventually(lambda: 'cannot be read' in last_diagnostic(peer)['message'], 'the fault told')
    model_path.write_text(MODEL)
    eventually(lambda: last_diagnostic(peer)['message'] == 'ready', 'that it is mended')


def test_an_edit_of_the_file_of_candidates_is_noticed(peer: Peer, hyps: Path) -> None:
    hyps.write_text(OPERATORS_GOAL + OTHER_CIRCLE)

    answer = peer.call()

    assert answer.message == 'I will grab a red circle.'


@pytest.mark.parametrize('fault', ['deleted', 'a named pipe'])
def test_a_broken_file_of_candidates_fails_calls_until_it_is_put_back(
    peer: Peer, hyps: Path, fault_table: FaultTable, fault: str
) -> None:
    inject, words = FAULTS[fault]

    failure, answer = injected(
        fault_table,
        peer,
        f'`hyps_file` {fault}',
        lambda: inject(hyps),
        words,
        lambda: replace(hyps, OPERATORS_GOAL + OTHER_DOOR),
    )

    assert str(hyps) in failure
    assert answer == TELLS_THE_DOOR


def test_a_call_right_after_an_edit_is_answered_from_the_edited_file(
    peer: Peer, model_path: Path, fault_table: FaultTable
) -> None:
    replace(model_path, MODEL.replace('the bottom door', 'the lower door'))
    edited = time.monotonic()
    answer = peer.call()
    fault_table.add(
        'user-model file replaced in one step',
        'the answer from the new file; a call waits for it',
        'OK',
        time.monotonic() - edited,
    )
    replace(model_path, MODEL)

    assert answer.message == THREE_SENTENCES.replace('bottom', 'lower')
    assert peer.call().message == THREE_SENTENCES


def test_a_file_written_in_two_steps_is_not_answered_from_after_the_first(
    peer: Peer, model_path: Path
) -> None:
    first = MODEL[: MODEL.index('\nsentences:')]  # a good model, with other words

    took = float('inf')
    while took > 0.3:  # a pause of half a second makes it two edits
        began = time.monotonic()
        model_path.write_text(first)
        call = peer.start_call()
        model_path.write_text(MODEL)
        took = time.monotonic() - began
        answer = call.result()

    assert answer.message == THREE_SENTENCES
