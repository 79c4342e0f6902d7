"""What an update costs that is progress, beside a new task: `scripts/benchmark progress`.

The demo's robot goes through its plan under an explainer without ROS. Prints what an update
takes from its texts to the answer, cold and as progress, in processor time of this process and
of the planners; and what 50 updates of progress a second cost. Exit status 1 if progress costs
5 % of a cold update or more in the median, or an answer is lost or about an older state.
"""

import argparse
import json
import statistics
import sys
import time
from pathlib import Path

import psutil
from patience import PATIENCE

from mirror_explainer.node.inputs import Configuration, NodeSettings, Text
from mirror_explainer.node.live_explainer import LiveExplainer
from mirror_explainer.pddl import read_task
from mirror_explainer.pddl.plan_text import read_plan
from mirror_explainer.pddl.problem_text import with_state
from mirror_explainer.pddl.simulation import carry_out

WAREHOUSE = Path(__file__).parents[2] / 'config' / 'warehouse'
DOMAIN, PROBLEM, PLAN = (
    (WAREHOUSE / name).read_text() for name in ('domain.pddl', 'problem.pddl', 'plan.txt')
)
MOST = 0.05


class Robot:
    """Publishes states of the demo's task to an explainer, and asks about them."""

    def __init__(self) -> None:
        states = carry_out(read_task(DOMAIN, PROBLEM), read_plan(PLAN)).states
        self.problems = [with_state(PROBLEM, state) for state in states]
        self.reports: list[dict[str, object]] = []
        settings = NodeSettings(
            user_model_file=str(WAREHOUSE / 'user_model.yaml'), answer_timeout=PATIENCE
        )
        self.explainer = LiveExplainer(Configuration(settings), self._publish)
        self.explainer.hear('domain', Text(DOMAIN, '/domain'))

    def _publish(self, text: str, report: str) -> None:
        self.reports.append(json.loads(report))

    def seconds_of(self, done: int, plan: str = '') -> float:
        """Publish a state, ask, and return the processor time that it took."""
        before = cpu_seconds()
        self.explainer.hear('problem', Text(self.problems[done], '/problem'))
        if plan:
            self.explainer.hear('plan', Text(plan, '/plan'))
        reply = self.explainer.ask()
        assert reply.success, reply.message
        rows = self.reports[-1]['plan']
        assert isinstance(rows, list)
        assert sum(row['status'] == 'done' for row in rows) == done
        return cpu_seconds() - before


def cpu_seconds() -> float:
    """Return the processor time of this process and of all that it started."""
    own = psutil.Process()
    total = 0.0
    for process in (own, *own.children(recursive=True)):
        times = process.cpu_times()
        total += times.user + times.system + times.children_user + times.children_system
    return total


def main() -> int:
    """Measure, and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--rounds', type=int, default=5)
    parser.add_argument('--seconds', type=float, default=4.0, help='of 50 updates a second')
    options = parser.parse_args()
    cold, progress = [], []
    for _ in range(options.rounds):
        robot = Robot()
        time.sleep(1.0)  # its planners are up
        cold.append(robot.seconds_of(0, PLAN))
        steps = range(1, len(robot.problems))  # together: the kernel counts in hundredths
        progress.append(sum(map(robot.seconds_of, steps)) / len(steps))
        robot.explainer.close()
    robot = Robot()
    robot.seconds_of(0, PLAN)
    before, started, updates = cpu_seconds(), time.monotonic(), 0
    while time.monotonic() - started < options.seconds:
        done = 1 + int((time.monotonic() - started) / options.seconds * 9)
        problem = f'{robot.problems[done]}; {updates}\n'
        robot.explainer.hear('problem', Text(problem, '/problem'))
        updates += 1
        time.sleep(max(0.0, started + updates / 50 - time.monotonic()))
    share = (cpu_seconds() - before) / (time.monotonic() - started)
    robot.seconds_of(10)
    robot.explainer.close()
    ratio = statistics.median(progress) / statistics.median(cold)
    print(
        f'cold {statistics.median(cold):.3f} s, progress {statistics.median(progress):.3f} s of '
        f'processor time in the median: {ratio:.1%}\n{updates} updates of progress in '
        f'{options.seconds:g} s: {share:.0%} of a processor; the last state is answered about'
    )
    return int(ratio >= MOST)


if __name__ == '__main__':
    sys.exit(main())
