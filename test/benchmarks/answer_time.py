"""How soon a real node tells of the newest task: from the robot's last message to the reply.

Prints the table of docs/reliability.md: `scripts/benchmark answer_time`. The times stand beside
what `import unified_planning.shortcuts` takes in a new process in the same run. Exit status 1
if the first answer takes more than half of that in the median.
"""

import argparse
import contextlib
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import rclpy
from parcels import DOMAIN, right_answers
from patience import PATIENCE
from robot_stream import RobotStream
from ros_peer import USER_MODEL, Peer, started
from tabulate import tabulate

NAMESPACE = '/answer_time'
# What is timed, and the answer_timeout that it is timed with, in seconds.
WAITS = {'first answer': 0.0, 'answer by default': 1.0, 'answer once planning is done': PATIENCE}
IMPORT = 'import unified_planning.shortcuts'
# What the first answer may take, as a share of the import.
MOST = 0.5


def main() -> int:
    """Time all, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--rounds', type=int, default=20)
    rounds = parser.parse_args().rounds
    seconds: dict[str, list[float]] = {name: [] for name in [IMPORT, *WAITS]}
    right = right_answers(Path(USER_MODEL))
    rclpy.init()
    with (
        tempfile.TemporaryDirectory() as folder,
        contextlib.closing(Peer(NAMESPACE)) as peer,
        started('explainer_node', NAMESPACE, Path(folder), user_model_file=USER_MODEL),
    ):
        peer.publish('domain', DOMAIN)
        robot = RobotStream(peer)
        robot.send()
        peer.answer()
        for _ in range(rounds):
            seconds[IMPORT].append(import_seconds())
            for name, timeout in WAITS.items():
                peer.set_parameters(answer_timeout=timeout)
                robot.send()
                while not right.are(peer.call().message, robot.newest):
                    pass  # its texts are being read, or it was not heard yet
                seconds[name].append(time.monotonic() - robot.times.published[-1])
    rclpy.try_shutdown()
    medians = {name: float(np.median(times)) for name, times in seconds.items()}
    lines = [
        {
            '': name,
            's (median)': medians[name],
            's (longest)': max(times),
            'of the import': medians[name] / medians[IMPORT],
        }
        for name, times in seconds.items()
    ]
    print(tabulate(lines, headers='keys', tablefmt='pipe', floatfmt='.2f'))
    return int(medians['first answer'] > MOST * medians[IMPORT])


def import_seconds() -> float:
    """Return what a new Python process takes to import unified-planning."""
    began = time.monotonic()
    subprocess.run([sys.executable, '-c', IMPORT], check=True)
    return time.monotonic() - began


if __name__ == '__main__':
    sys.exit(main())
