"""How soon there is an answer, of a node and of a command: `scripts/benchmark answer_time`.

Of a real node, from the last message of a warehouse robot's newest task to the reply; and of
`verbalize` in a new process, for a courier among 500 rooms with ten goals and a plan of 94
steps. The times stand beside what `import unified_planning.shortcuts` takes in a new process in
the same run. Exit status 1 if a first answer takes longer than MOST of that in the median.
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
from long_corridors import write_task
from parcels import DOMAIN, right_answers
from patience import PATIENCE
from robot_stream import RobotStream
from ros_peer import USER_MODEL, Peer, started
from tabulate import tabulate

NAMESPACE = '/answer_time'
# What is timed, and the answer_timeout that it is timed with, in seconds.
WAITS = {
    'node: first answer': 0.0,
    'node: answer by default': 1.0,
    'node: answer once planning is done': PATIENCE,
}
# What is added to the command that is timed.
COMMANDS = {
    'verbalize: first answer': ['--deadline', '0.01'],
    'verbalize: answer once planning is done': [],
}
IMPORT = 'import unified_planning.shortcuts'
# What the first answers may take, in multiples of the import.
MOST = {'node: first answer': 0.5, 'verbalize: first answer': 3.5}


def main() -> int:
    """Time all, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--rounds', type=int, default=20)
    rounds = parser.parse_args().rounds
    seconds: dict[str, list[float]] = {name: [] for name in [IMPORT, *WAITS, *COMMANDS]}
    right = right_answers(Path(USER_MODEL))
    rclpy.init()
    with (
        tempfile.TemporaryDirectory() as folder,
        contextlib.closing(Peer(NAMESPACE)) as peer,
        started('explainer_node', NAMESPACE, Path(folder), user_model_file=USER_MODEL),
    ):
        peer.publish('domain', DOMAIN)
        task = write_task(Path(folder))
        robot = RobotStream(peer)
        robot.send()
        peer.answer()
        for _ in range(rounds):
            seconds[IMPORT].append(seconds_of('-c', IMPORT))
            for name, options in COMMANDS.items():
                command = ['-m', 'mirror_explainer.verbalize', *task, *options]
                seconds[name].append(seconds_of(*command))
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
    return int(any(medians[name] > most * medians[IMPORT] for name, most in MOST.items()))


def seconds_of(*arguments: str) -> float:
    """Return what a new Python process takes."""
    began = time.monotonic()
    subprocess.run([sys.executable, *arguments], check=True, capture_output=True)
    return time.monotonic() - began


if __name__ == '__main__':
    sys.exit(main())
