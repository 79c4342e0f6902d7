"""Weeks of a node's life in minutes: ten thousand updates and calls, and what it holds meanwhile.

Prints the table of docs/reliability.md: `scripts/benchmark soak`. Exit status 1 if a call
was lost, wrong or stale, or if what the node holds is not flat.
"""

import argparse
import contextlib
import os
import sys
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from pathlib import Path
from statistics import median

import rclpy
from crowd import crowd
from parcels import DOMAIN, FEW_GOALS, right_answers
from robot_stream import RobotStream, Verdict, judge
from ros_peer import Peer, started
from scipy.stats import theilslopes
from tabulate import tabulate
from usage import Usage, usage

from mirror_explainer.node.explainer_node import MOST_WAITING_CALLS, THREADS

NAMESPACE = f'/soak_{os.getpid()}'
BURST = 10
RATE = 100.0  # Hz
# The first rounds, in which the node starts its threads, and takes the memory that it needs.
WARM_UP = 10
MANY = 60
# What memory may grow by from the warm-up to the end, as a share of itself.
GROWTH = 0.05
MEMORY = ('memory', 'children_memory', 'files_size')
COUNTS = ('threads', 'descriptors', 'children', 'files')


def soak(folder: Path, rounds: int) -> Iterator[tuple[Usage, Verdict]]:
    """Send BURST updates and BURST calls at once, round after round; look at the node after each.

    Each round ends with the answer to its last update. In the rounds of the warm-up there
    are MANY calls, which start most of the node's threads. rclpy must be initialised.
    """
    user_model = folder / 'user_model.yaml'
    user_model.write_text(FEW_GOALS)
    right = right_answers(user_model)
    temporary = folder / 'temporary'
    temporary.mkdir()
    with (
        contextlib.closing(Peer(NAMESPACE)) as peer,
        _temporary_files_in(temporary),
        started(
            'explainer_node', NAMESPACE, folder, user_model_file=user_model, answer_timeout=30.0
        ) as node,
        crowd(NAMESPACE, MANY, processes=1) as callers,
    ):
        peer.publish('domain', DOMAIN)
        robot = RobotStream(peer)
        robot.send()
        peer.answer()
        for number in range(rounds):
            callers.start('verbalize_plan', MANY if number < WARM_UP else BURST, calls=1)
            robot.send_many(BURST, RATE)
            verdict = judge(callers.finish(), robot.times, right)
            while not right.are(peer.call().message, robot.newest):
                pass  # the peer's own executor does not spin here: it waits for each answer
            yield usage(node.popen.pid, temporary), verdict


@contextlib.contextmanager
def _temporary_files_in(folder: Path) -> Iterator[None]:
    """Let processes that are started here make their temporary files in a folder."""
    before = os.environ.get('TMPDIR')
    os.environ['TMPDIR'] = str(folder)
    try:
        yield
    finally:
        os.environ.pop('TMPDIR')
        if before is not None:
            os.environ['TMPDIR'] = before


def steady(samples: Sequence[Usage], name: str) -> list[float]:
    """Return what the samples say of one thing after the warm-up."""
    return [getattr(sample, name) for sample in samples[WARM_UP:]]


def growth(values: Sequence[float]) -> float:
    """Return by how much values grow from first to last, by the median of all slopes."""
    return float(theilslopes(values).slope) * (len(values) - 1)


def not_flat(samples: Sequence[Usage]) -> list[str]:
    """Return what is not flat after the warm-up, in words.

    Memory is flat if it grows by less than the share GROWTH of its median. A count
    is flat if its median is no higher in the second half than in the first, but for the
    threads that calls do not wait in: the executor starts them when it happens to need them.
    """
    found = []
    for name in MEMORY:
        values = steady(samples, name)
        if growth(values) > GROWTH * max(median(values), 1.0):
            found.append(f'{name} grows by {growth(values):.1f} from {median(values):.1f} MiB')
    for name in COUNTS:
        values = steady(samples, name)
        half = len(values) // 2
        first, second = median(values[:half]), median(values[half:])
        spare = THREADS - MOST_WAITING_CALLS if name == 'threads' else 0
        if second > first + spare:
            found.append(f'{name}: {first} in the first half, {second} in the second')
    return found


def main() -> int:
    """Soak the node, and print what it held."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--updates', type=int, default=10_000, help='and as many calls')
    parser.add_argument('--lines', type=int, default=10, help='of the table')
    options = parser.parse_args()
    rclpy.init()
    rounds = options.updates // BURST
    samples, faults, verdicts, lines = [], [], [], []
    with tempfile.TemporaryDirectory() as folder:
        for number, (sample, verdict) in enumerate(soak(Path(folder), rounds), start=1):
            samples.append(sample)
            verdicts.append(verdict)
            if verdict.faults:
                faults.append(f'round {number}: {verdict}')
            if number % max(1, rounds // options.lines) == 0:
                lines.append({'updates and calls': number * BURST} | asdict(sample))
    rclpy.try_shutdown()
    print(tabulate(lines, headers='keys', tablefmt='pipe', floatfmt='.1f'))
    counts = {
        'updates': len(samples) * BURST,
        'calls': sum(verdict.calls for verdict in verdicts),
        'right': sum(verdict.right for verdict in verdicts),
        'not ready': sum(verdict.not_ready for verdict in verdicts),
        'refused while under way': sum(verdict.under_way for verdict in verdicts),
        'lost, wrong or stale': sum(verdict.faults for verdict in verdicts),
    }
    print('\n' + ', '.join(f'{what}: {count}' for what, count in counts.items()))
    for name in MEMORY:
        print(f'{name}: {growth(steady(samples, name)):+.2f} MiB after the warm-up')
    faults += not_flat(samples)
    print(*faults, sep='\n', file=sys.stderr)
    return 1 if faults else 0


if __name__ == '__main__':
    sys.exit(main())
