"""What an update costs that is progress, beside a new task: `scripts/benchmark progress`.

Robots go through their plans under an explainer without ROS: the examples, and ten drawn ones
(experiments/planning/robots.py). Prints what an update takes from its texts to the answer, new and
as progress, in processor time of this process and of the planners. Then two of them publish 50
states a second, while others ask: one that is planned for, and one that has only just begun.
Exit status 1 if progress costs 5 % of a new task or more in the median, or an answer is lost or
about an older state than was heard before the call.
"""

import argparse
import itertools
import json
import statistics
import sys
import tempfile
import threading
import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import psutil
import yaml
from patience import PATIENCE
from tabulate import tabulate
from whole_tasks import CONFIG, EXAMPLES

from mirror_explainer.experiments.planning.cases import problem_of
from mirror_explainer.experiments.planning.robots import Robot, robots
from mirror_explainer.node.inputs import Configuration, NodeSettings, Text
from mirror_explainer.node.live_explainer import LiveExplainer, Reply
from mirror_explainer.pddl import read_task
from mirror_explainer.pddl.plan_text import read_plan
from mirror_explainer.pddl.problem_text import with_state
from mirror_explainer.pddl.simulation import carry_out
from mirror_explainer.planning import Planner

MOST = 0.05
FAMILIES = (
    'map of 50 places',
    'one hand, 2 of 10',
    'hospital, 1 packs',
    '8 parts to mount',
    'drone over 16 places',
)
SEEDS = (0, 1)
RATE, CALLERS = 50, 3


@dataclass(frozen=True)
class Task:
    """What a robot publishes: its domain and plan, and its problem in each state on the way."""

    name: str
    domain: str
    problems: tuple[str, ...]
    plan: str
    user_model: Path


def task_of(name: str, domain: str, problem: str, plan: str, user_model: Path) -> Task:
    """Return a task, carried out."""
    states = carry_out(read_task(domain, problem), read_plan(plan)).states
    problems = tuple(with_state(problem, state) for state in states)
    return Task(name, domain, problems, plan, user_model)


def examples() -> Iterator[Task]:
    """Yield the tasks of the examples' robots."""
    for name in EXAMPLES:
        texts = (
            (CONFIG / name / f).read_text() for f in ('domain.pddl', 'problem.pddl', 'plan.txt')
        )
        yield task_of(name, *texts, CONFIG / name / 'user_model.yaml')


def drawn(folder: Path) -> Iterator[Task]:
    """Yield a task of each family and seed; the listener has all goals and doubts of its."""
    for seed, robot in itertools.product(SEEDS, robots(0)):
        if robot.name in FAMILIES:
            yield drawn_task(next(r for r in robots(seed) if r.name == robot.name), seed, folder)


def drawn_task(robot: Robot, seed: int, folder: Path) -> Task:
    """Return the task of a robot with the first of its beliefs."""
    space, belief = robot.space, robot.beliefs[0]
    with Planner() as planner:
        plans = planner.plan(space, [belief]).results[0].plans
    user_model = folder / f'{robot.name}-{seed}.yaml'
    facts = [{'fact': fact, 'probability': 0.8} for fact in space.uncertain_facts]
    goals = [{'goal': goal} for goal in dict.fromkeys(space.goals)]
    user_model.write_text(yaml.safe_dump({'goals': goals, 'uncertain_facts': facts}))
    plan = '\n'.join(plans[0].actions)
    problem = problem_of(space, belief)
    return task_of(f'{robot.name}, {seed}', space.domain, problem, plan, user_model)


class Operator:
    """Publishes a task's states to an explainer, and asks about them."""

    def __init__(self, task: Task, answer_timeout: float) -> None:
        self.task = task
        self.heard = 0  # steps that are done in the newest state
        self._own = threading.local()
        settings = NodeSettings(
            user_model_file=str(task.user_model), answer_timeout=answer_timeout
        )
        self.explainer = LiveExplainer(Configuration(settings), self._publish)
        time.sleep(1.0)  # its planners are up

    def _publish(self, text: str, report: str) -> None:
        self._own.report = json.loads(report)  # in the thread of the call

    def begin(self) -> None:
        """Publish the task."""
        for name, text in (
            ('domain', self.task.domain),
            ('problem', self.task.problems[0]),
            ('plan', self.task.plan),
        ):
            self.explainer.hear(name, Text(text, f'/{name}'))

    def go(self, done: int, comment: str = '') -> None:
        """Publish the state in which so many steps are done."""
        text = f'{self.task.problems[done]}{comment}'
        self.explainer.hear('problem', Text(text, '/problem'))
        self.heard = done

    def ask(self) -> tuple[Reply, dict[str, object]]:
        """Return the reply to a call, and its report."""
        reply = self.explainer.ask()
        return reply, self._own.report if reply.success else {}

    def done(self) -> int:
        """Ask, and return how many steps are done by the answer."""
        reply, report = self.ask()
        assert reply.success, reply.message
        return steps_done(report)


def steps_done(report: dict[str, object]) -> int:
    """Return how many steps a report calls done."""
    rows = report['plan']
    assert isinstance(rows, list)
    return sum(row['status'] == 'done' for row in rows)


def cpu_seconds() -> float:
    """Return the processor time of this process and of all that it started."""
    own = psutil.Process()
    total = 0.0
    for process in (own, *own.children(recursive=True)):
        times = process.cpu_times()
        total += times.user + times.system + times.children_user + times.children_system
    return total


def costs(task: Task) -> tuple[float, float]:
    """Return the processor time of the new task, and of an update of progress in the mean."""
    operator = Operator(task, PATIENCE)
    before = cpu_seconds()
    operator.begin()
    assert operator.done() == 0
    new = cpu_seconds()
    steps = range(1, len(task.problems))  # together: the kernel counts in hundredths
    for done in steps:
        operator.go(done)
        assert operator.done() == done
    end = cpu_seconds()
    operator.explainer.close()
    return new - before, (end - new) / len(steps)


def burst(task: Task, seconds: float, planned: bool) -> tuple[Counter[str], float]:
    """Publish 50 states a second while others ask; return what came of the calls, and the load."""
    operator = Operator(task, PATIENCE if planned else 1.0)
    operator.begin()
    if planned:
        operator.done()
    ended = threading.Event()

    def call(found: Counter[str]) -> None:
        while not ended.is_set():
            heard = operator.heard
            reply, report = operator.ask()
            if reply.success:
                found['stale' if steps_done(report) < heard else 'right'] += 1
            else:
                found['not ready' if 'ask me again' in reply.message else 'lost'] += 1
            time.sleep(0.02)

    counts = [Counter[str]() for _ in range(CALLERS)]
    callers = [threading.Thread(target=call, args=[own]) for own in counts]
    before, started = cpu_seconds(), time.monotonic()
    for caller in callers:
        caller.start()
    length = len(task.problems) - 1
    for number in range(int(seconds * RATE)):
        operator.go(1 + int(number / (seconds * RATE) * (length - 1)), f'; {number}\n')
        time.sleep(max(0.0, started + (number + 1) / RATE - time.monotonic()))
    share = (cpu_seconds() - before) / (time.monotonic() - started)
    ended.set()
    for caller in callers:
        caller.join()
    operator.go(length)
    found = sum(counts, Counter(stale=int(operator.done() != length)))
    operator.explainer.close()
    return found, share


def main() -> int:
    """Measure, and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--seconds', type=float, default=5.0, help='of each burst')
    options = parser.parse_args()
    rows, bursts = [], []
    costs(next(examples()))  # what is loaded and made once in a process is not counted
    with tempfile.TemporaryDirectory() as folder:
        for task in (*examples(), *drawn(Path(folder))):
            new, progress = costs(task)
            rows.append((task.name, len(task.problems) - 1, new, progress, progress / new))
    first, second, *_ = examples()
    for task, planned in ((first, True), (second, False)):
        found, share = burst(task, options.seconds, planned)
        asked = 'after' if planned else 'during'
        counts = (found[what] for what in ('right', 'not ready', 'lost', 'stale'))
        bursts.append((f'{task.name}, {asked} its planning', *counts, f'{share:.0%}'))
    print(
        tabulate(
            rows,
            ['task', 'steps', 'new, s', 'progress, s', 'share'],
            'pipe',
            floatfmt=('', '', '.2f', '.3f', '.1%'),
        )
    )
    median = statistics.median(row[-1] for row in rows)
    print(f'\nIn the median an update of progress costs {median:.1%} of a new task.\n')
    headers = ['states of', 'right', 'not ready', 'lost', 'stale', 'of a processor']
    print(tabulate(bursts, headers, 'pipe'))
    failed = sum(row[3] + row[4] for row in bursts)
    return int(median >= MOST or failed > 0)


if __name__ == '__main__':
    sys.exit(main())
