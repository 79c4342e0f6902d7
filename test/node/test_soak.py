"""The short form of `benchmarks/soak.py`: what a node holds, before and after much work."""

from dataclasses import replace
from pathlib import Path

import pytest

pytest.importorskip('rclpy', reason='needs ROS 2')
pytest.importorskip('tabulate', reason='the extra [experiments] is not installed')

import rclpy
from soak import WARM_UP, not_flat, soak
from usage import Usage


def test_hundreds_of_updates_and_calls_leave_nothing_behind(tmp_path: Path):
    rclpy.init()
    samples, verdicts = zip(*soak(tmp_path, rounds=WARM_UP + 6), strict=True)
    rclpy.try_shutdown()
    assert sum(verdict.faults for verdict in verdicts) == 0
    assert not_flat(samples) == []


FLAT = [Usage(200.0, 20.0, 79, 25, 1, 1, 0.0)] * (WARM_UP + 10)


@pytest.mark.parametrize(
    'leak',
    [
        lambda number: {'memory': 200.0 + 2 * number},
        lambda number: {'files_size': number / 10},
        lambda number: {'threads': 79 + 2 * number},
        lambda number: {'descriptors': 25 + number},
        lambda number: {'children': 1 + number // 4},
    ],
)
def test_a_leak_is_not_flat(leak):
    leaking = [replace(sample, **leak(number)) for number, sample in enumerate(FLAT)]
    assert not_flat(FLAT) == []
    assert len(not_flat(leaking)) == 1
