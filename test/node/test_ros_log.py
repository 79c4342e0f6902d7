"""The log of the node: every line once, and repetitions as counts."""

import logging

import pytest

from mirror_explainer.node.ros_log import MOST_NEWS, NEWS_PERIOD, QUIET, Repetitions, RosLog


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
    for number in range(10 * MOST_NEWS):
        log.warning('warning %d', number)
    log.error('bad plan')

    assert len(lines.lines) == MOST_NEWS + 1
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


def test_repetitions_are_counted_at_intervals_that_double() -> None:
    repetitions = Repetitions()
    told = []
    assert repetitions.is_news('bad plan', 0.0)
    for tick in range(1, 351):  # ten a second
        assert not repetitions.is_news('bad plan', tick / 10)
        told += [(tick / 10, line) for line in repetitions.due(tick / 10)]

    # After 10 s, and then after 20 s more; the next would be due at 70 s.
    assert told == [
        (10.0, 'in the last 10 s 100 more like this: bad plan'),
        (30.0, 'in the last 20 s 200 more like this: bad plan'),
    ]


def test_a_line_that_was_silent_is_news_again_and_what_was_counted_is_told() -> None:
    repetitions = Repetitions()
    repetitions.is_news('bad plan', 0.0)
    repetitions.is_news('bad plan', 1.0)

    told = [*repetitions.due(1.0 + QUIET + 1.0)]

    assert told == ['in the last 12 s 1 more like this: bad plan']
    assert repetitions.is_news('bad plan', 20.0)
    assert not list(repetitions.due(100.0))


def test_of_very_many_different_lines_the_rest_is_counted_and_the_last_one_told() -> None:
    repetitions = Repetitions()
    logged = [n for n in range(100) if repetitions.is_news(f'bad plan {n}', n / 100)]

    # The first that was left out came at 0.2 s, the last at 0.99 s.
    assert len(logged) == MOST_NEWS == 20
    assert list(repetitions.due(10.2)) == [
        'in the last 10 s 80 more of other kinds, the last one: bad plan 99'
    ]
    assert repetitions.is_news('bad plan 100', 1.0 + NEWS_PERIOD)
