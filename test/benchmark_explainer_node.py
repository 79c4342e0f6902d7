"""A warm call beside an empty Trigger service, in one run.

Kept out of the normal run by its name: `pytest test/benchmark_explainer_node.py`.
"""

import subprocess
import sys
import time
from collections.abc import Iterator

import pytest

pytest.importorskip('rclpy', reason='needs ROS 2')

import numpy as np
import rclpy
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from ros_peer import USER_MODEL, Peer, running
from std_srvs.srv import Trigger

CALLS = 1000


@pytest.fixture
def peer() -> Iterator[Peer]:
    rclpy.init()
    peer = Peer('/benchmark')
    yield peer
    peer.close()
    rclpy.try_shutdown()


def _call_times(peer: Peer, service: str) -> np.ndarray:
    """Return the seconds of each of CALLS calls, one after the other."""
    seconds = []
    for _ in range(CALLS):
        start = time.perf_counter()
        peer.call(service)
        seconds.append(time.perf_counter() - start)
    return np.array(seconds)


def test_a_warm_call_beside_an_empty_service(peer, tmp_path, capsys):
    empty = subprocess.Popen([sys.executable, __file__])
    try:
        with running('explainer_node', '/benchmark', tmp_path, user_model_file=USER_MODEL):
            peer.publish_warehouse()
            peer.answer()
            rounds = [
                (_call_times(peer, 'empty'), _call_times(peer, 'verbalize_plan')) for _ in range(3)
            ]
    finally:
        empty.terminate()
        empty.wait()
    with capsys.disabled():
        print(
            '\nms a call (median / p99)     empty Trigger      verbalize_plan     ratio of medians'
        )
        for nothing, answer in rounds:
            cells = [
                f'{np.median(t) * 1e3:.2f} / {np.percentile(t, 99) * 1e3:.2f}'
                for t in (nothing, answer)
            ]
            ratio = np.median(answer) / np.median(nothing)
            print(f'{"":24}{cells[0]:>18}{cells[1]:>20}{ratio:>20.2f}')


def serve_nothing() -> None:
    """Serve an empty Trigger service with the executor that the explainer uses."""
    rclpy.init()
    node = Node('empty', namespace='/benchmark')
    node.create_service(Trigger, 'empty', lambda request, response: response)
    executor = MultiThreadedExecutor()
    executor.add_node(node)
    executor.spin()


if __name__ == '__main__':
    serve_nothing()
