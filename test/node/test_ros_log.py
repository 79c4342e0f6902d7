"""The log of the node: every line once, and repetitions as counts."""

import logging

import pytest

from mirror_explainer.node import ros_log as module
from mirror_explainer.node.ros_log import MOST_LINES, RosLog


class Lines:
    """Stands for a ROS logger, and keeps what it is given."""

    def __init__(self) -> None:
        self.lines: list[tuple[str, str]] = []

    def __getattr__(self, level: str):
        return lambda line: self.lines.append((level, line))


@pytest.fixture
def lines() -> Lines:
    return Lines()


@pytest.fixture
def log(lines: Lines) -> logging.Logger:
    """Return a logger whose records go to `lines`, and nowhere else."""
    log = logging.Logger('of this test')
    log.addHandler(RosLog(lines))
    return log


def test_records_keep_their_level(log: logging.Logger, lines: Lines) -> None:
    for say in (log.debug, log.info, log.warning, log.error, log.critical):
        say('%d beliefs', 30)

    assert [level for level, _ in lines.lines] == ['debug', 'info', 'warning', 'error', 'error']
    assert {line for _, line in lines.lines} == {'30 beliefs'}


def test_the_same_line_is_logged_once_and_another_at_once(
    log: logging.Logger, lines: Lines
) -> None:
    for _ in range(500):
        log.error('bad plan')
    log.error('bad problem')

    assert lines.lines == [('error', 'bad plan'), ('error', 'bad problem')]


def test_debug_lines_are_all_logged(log: logging.Logger, lines: Lines) -> None:
    for _ in range(5):
        log.debug('at work')

    assert len(lines.lines) == 5


def test_many_warnings_hide_no_error(log: logging.Logger, lines: Lines) -> None:
    for number in range(10 * MOST_LINES):
        log.warning('warning %d', number)
    log.error('bad plan')

    assert len(lines.lines) == MOST_LINES + 1
    assert lines.lines[-1] == ('error', 'bad plan')


def test_a_traceback_is_logged_and_what_no_terminal_can_show_is_not(
    log: logging.Logger, lines: Lines
) -> None:
    try:
        raise KeyError('\ud800\x1b[31m')
    except KeyError:
        log.exception('failed\0')

    ((level, line),) = lines.lines
    assert level == 'error'
    assert line.startswith('failed\nTraceback')
    assert line.encode()
    assert '\x1b' not in line


def test_what_keeps_coming_is_counted_and_what_was_silent_is_news_again(
    monkeypatch: pytest.MonkeyPatch, lines: Lines
) -> None:
    handler = RosLog(lines)
    log = logging.Logger('of this test')
    log.addHandler(handler)
    for _ in range(14):
        log.error('bad plan')
    log.error('bad problem')
    handler.tell_counts()  # it is not time yet
    monkeypatch.setattr(module, 'PERIOD', 0.0)
    handler.tell_counts()
    log.error('bad plan')
    log.error('bad problem')
    handler.tell_counts()

    assert [line for _, line in lines.lines] == [
        'bad plan',
        'bad problem',
        'in the last 0 s 13 more: bad plan',
        'bad problem',
        'in the last 0 s 1 more: bad plan',
    ]


def test_of_very_many_different_lines_the_rest_is_counted(
    monkeypatch: pytest.MonkeyPatch, log: logging.Logger, lines: Lines
) -> None:
    for number in range(100):
        log.error('bad plan %d', number)
    monkeypatch.setattr(module, 'PERIOD', 0.0)
    log.handlers[0].tell_counts()  # type: ignore[attr-defined]
    log.error('bad plan 100')

    told = [line for _, line in lines.lines]
    assert told[MOST_LINES - 1 :] == [
        'bad plan 19',
        'in the last 0 s 80 more: others',
        'bad plan 100',
    ]
