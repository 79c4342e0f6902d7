"""A real node under load: a stream of updates and many callers at once, each answer checked.

Prints the tables of docs/reliability.md: `scripts/benchmark load`. Exit status 1 if a call
was lost, wrong or stale, or if a target of time or processor is missed.
"""

import argparse
import contextlib
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import rclpy
from crowd import MANY_CALLS, Crowd, crowd
from parcels import DOMAIN, RightAnswers, right_answers
from patience import eventually
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from robot_stream import RobotStream, Verdict, judge
from ros_peer import USER_MODEL, Peer, Process, last_diagnostic, started
from std_srvs.srv import Trigger
from tabulate import tabulate
from usage import processor_seconds

NAMESPACE = '/load'
SERVICE, EMPTY = 'verbalize_plan', 'empty'
CLIENTS = (1, 10, 50)
PROCESSES = 5

# A warm call may take so many times as long as a call of an empty service (median, p99).
RATIOS = (2.0, 3.0)
# The share of a core that an idle node may take.
IDLE_SHARE = 0.01
BURST_RATE = 50.0  # Hz


@dataclass
class Scene:
    """The node, who speaks to it, and what was found wrong so far."""

    peer: Peer
    node: Process
    callers: Crowd
    robot: RobotStream
    right: RightAnswers
    faults: list[str] = field(default_factory=list)

    def until_fresh(self) -> float:
        """Wait for the answer to the newest update; return how long after its publication."""
        newest = self.robot.newest
        fresh = eventually(
            lambda: next(
                (
                    answer
                    for answer in self.callers.call(SERVICE, 1, 1).answers
                    if self.right.are(answer.message, newest)
                ),
                None,
            ),
            self.right.to(newest),
        )
        return fresh.ended - self.robot.times.published[-1]

    def prepared(self) -> int:
        """Return how many updates the node has worked off, as its next diagnostics tell."""
        seen = len(self.peer.diagnostics)
        eventually(lambda: len(self.peer.diagnostics) > seen + 1, 'diagnostics')
        return int(last_diagnostic(self.peer)['updates'])

    def check(self, what: str, verdict: Verdict) -> None:
        """Note the calls that got what no call may get."""
        if verdict.faults:
            self.faults.append(f'{what}: {verdict}')

    @contextlib.contextmanager
    def processor(self) -> Iterator[list[float]]:
        """Measure the shares of a core that the node and its planner take meanwhile."""
        shares: list[float] = []
        began, before = time.monotonic(), processor_seconds(self.node.popen.pid)
        yield shares
        after, seconds = processor_seconds(self.node.popen.pid), time.monotonic() - began
        shares += [(b - a) / seconds for a, b in zip(before, after, strict=True)]


def main() -> int:
    """Run all measurements and print their tables."""
    options = _options()
    right = right_answers(Path(USER_MODEL))
    rclpy.init()
    with (
        tempfile.TemporaryDirectory() as folder,
        contextlib.closing(Peer(NAMESPACE)) as peer,
        _empty_service(),
        started('explainer_node', NAMESPACE, Path(folder), user_model_file=USER_MODEL) as node,
        crowd(NAMESPACE, max(CLIENTS), PROCESSES) as callers,
    ):
        peer.publish('domain', DOMAIN)
        scene = Scene(peer, node, callers, RobotStream(peer), right)
        scene.robot.send()
        scene.until_fresh()
        _print(warm_calls(scene, options.calls, options.rounds))
        _print(streams(scene, options.rates, options.seconds))
        _print(bursts(scene, options.bursts, options.rounds))
        _print(processor(scene, options.rates, options.seconds))
    rclpy.try_shutdown()
    print(*scene.faults, sep='\n', file=sys.stderr)
    return 1 if scene.faults else 0


Row = dict[str, object]


def warm_calls(scene: Scene, count: int, rounds: int) -> Iterator[Row]:
    """Time calls that find their answer made, in turns with calls of an empty service."""
    for clients in CLIENTS:
        seconds: dict[str, list[float]] = {EMPTY: [], SERVICE: []}
        for _ in range(rounds):
            for service, times in seconds.items():
                calls = scene.callers.call(service, clients, -(-count // clients))
                times += [answer.seconds for answer in calls.answers]
                if service == SERVICE:
                    scene.check(
                        f'{clients} warm clients', judge(calls, scene.robot.times, scene.right)
                    )
                elif calls.lost:
                    scene.faults.append(f'{calls.lost} calls of the empty service were lost')
        empty, warm = (np.percentile(times, (50, 99)) for times in seconds.values())
        ratios = warm / empty
        if any(ratios > RATIOS):
            scene.faults.append(f'{clients} warm clients: {ratios} times an empty service')
        yield {
            'clients': clients,
            'calls of each': len(seconds[SERVICE]),
            'empty Trigger, ms (p50 / p99)': _pair(empty * 1e3),
            'warm call, ms (p50 / p99)': _pair(warm * 1e3),
            'times as long (p50 / p99)': _pair(ratios),
        }


def streams(scene: Scene, rates: Sequence[float], seconds: float) -> Iterator[Row]:
    """Let all clients call again and again while updates stream in, and check every answer."""
    for rate in rates:
        before = scene.prepared()
        scene.callers.start(SERVICE, max(CLIENTS), until=time.monotonic() + seconds)
        sent = scene.robot.newest
        real_rate = scene.robot.send_many(int(seconds * rate), rate)
        calls = scene.callers.finish()
        scene.until_fresh()
        verdict = judge(calls, scene.robot.times, scene.right)
        scene.check(f'{rate} Hz', verdict)
        yield {
            'updates a second': round(real_rate, 1),
            'updates': scene.robot.newest - sent,
            'prepared': scene.prepared() - before,
            'calls': len(calls.answers) + calls.lost,
            'right': verdict.right,
            'not ready': verdict.not_ready,
            'under way': verdict.under_way,
            'lost': verdict.lost,
            'wrong': verdict.wrong,
            'stale': verdict.stale,
            's a call (p50 / p99)': _pair(
                np.percentile([answer.seconds for answer in calls.answers], (50, 99))
            ),
        }


def bursts(scene: Scene, sizes: Sequence[int], rounds: int) -> Iterator[Row]:
    """Time the answer to the last of a burst of updates, the call coming right after it."""
    for size in sizes:
        before, waits = scene.prepared(), []
        for _ in range(rounds):
            scene.robot.send_many(size, BURST_RATE)
            waits.append(scene.until_fresh())
        yield {
            'updates in the burst': size,
            'bursts': rounds,
            'prepared in all': scene.prepared() - before,
            's from the last update to its answer (median / longest)': _pair(
                (np.median(waits), max(waits))
            ),
        }


def processor(scene: Scene, rates: Sequence[float], seconds: float) -> Iterator[Row]:
    """Measure the node's share of a core: idle, and while updates stream without callers."""
    with scene.processor() as shares:
        time.sleep(seconds)
    yield _shares('idle', shares)
    if shares[0] > IDLE_SHARE:
        scene.faults.append(f'idle, the node takes {shares[0]:.1%} of a core')
    for rate in rates:
        with scene.processor() as shares:
            scene.robot.send_many(int(seconds * rate), rate)
        scene.until_fresh()
        yield _shares(f'{rate:g} updates a second', shares)


def _shares(what: str, shares: Sequence[float]) -> Row:
    node, planner = (f'{share:.1%}'.replace('%', ' %') for share in shares)
    return {'': what, 'node, of a core': node, 'its planner processes, of a core': planner}


def _pair(values: Sequence[float]) -> str:
    return ' / '.join(f'{value:.2f}' for value in values)


def _print(rows: Iterator[Row]) -> None:
    print(tabulate(list(rows), headers='keys', tablefmt='pipe'), end='\n\n', flush=True)


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--calls', type=int, default=1000, help='of each kind in a round')
    parser.add_argument('--rounds', type=int, default=5)
    parser.add_argument('--seconds', type=float, default=20.0, help='of each stream, and idle')
    parser.add_argument('--rates', type=float, nargs='+', default=[1, 10, 50], help='updates/s')
    parser.add_argument('--bursts', type=int, nargs='+', default=[1, 10, 100, 500])
    return parser.parse_args()


@contextlib.contextmanager
def _empty_service() -> Iterator[None]:
    process = subprocess.Popen([sys.executable, __file__, EMPTY])
    try:
        yield
    finally:
        process.kill()  # `spin` may miss a milder signal
        process.wait()


def serve_nothing() -> None:
    """Serve an empty Trigger service with an executor such as the explainer's."""
    rclpy.init()
    node = Node(EMPTY, namespace=NAMESPACE)
    node.create_service(
        Trigger,
        EMPTY,
        lambda request, response: response,
        qos_profile=MANY_CALLS,
        callback_group=ReentrantCallbackGroup(),
    )
    executor = MultiThreadedExecutor()
    executor.add_node(node)
    with contextlib.suppress(KeyboardInterrupt, ExternalShutdownException):
        executor.spin()


if __name__ == '__main__':
    if sys.argv[1:] == [EMPTY]:
        serve_nothing()
    else:
        sys.exit(main())
