"""Robots without PDDL: a list of tasks, and how far the robot is, as the explainer's topics.

A behaviour tree or a state machine knows its tasks by name, in order, and which are done. With
the domain of `config/tasks`, where a task is something that gets done, this is a problem and plan.
"""

import re
from collections.abc import Collection, Iterable
from pathlib import Path
from typing import NamedTuple

from ament_index_python.packages import get_package_share_directory
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String

from mirror_explainer.errors import InputError, did_you_mean

STANDINGS = ('ahead', 'running', 'done', 'failed')
TOPICS = ('domain', 'problem', 'progress', 'plan')
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class TaskList:
    """Tells the explainer a robot's tasks; publishes `domain`, `problem`, `plan`, `progress`.

    `node` is any node of the robot's; the topics are in its namespace. `known` names all
    tasks that the robot may ever have, so that the user model may speak of them; those
    that were told once are known, too.

        tasks = TaskList(node, known=['fetch the cup', 'wipe the table'])
        tasks.tell([('drive to the kitchen', 'done'), ('fetch the cup', 'running')])

    Call `tell` as often as you like, such as after each tick: what has not changed is
    not published again. Raises InputError for a task or a standing that cannot be told.
    """

    def __init__(self, node: Node, known: Iterable[str] = ()) -> None:
        self._known = {task_name(task) for task in known}
        self._goal = '(and)'
        self._told: dict[str, str] = {}
        self._outputs = {topic: node.create_publisher(String, topic, LATCHED) for topic in TOPICS}
        share = Path(get_package_share_directory('mirror_explainer'))
        self._publish('domain', (share / 'config' / 'tasks' / 'domain.pddl').read_text())

    def tell(self, tasks: Iterable[tuple[str, str]], ends: Collection[str] = ()) -> None:
        """Tell the tasks in order, each with its standing: ahead, running, done or failed.

        `ends` are those that the others are for; without them all are. No tasks: the
        robot has nothing to do.
        """
        texts = task_texts(tasks, ends)
        self._known |= texts.names
        self._goal = texts.goal or self._goal
        self._publish('problem', problem_text(self._known, texts.done, self._goal))
        self._publish('progress', texts.progress)
        self._publish('plan', texts.plan)

    def _publish(self, topic: str, text: str) -> None:
        if self._told.get(topic) != text:
            self._told[topic] = text
            self._outputs[topic].publish(String(data=text))


class TaskTexts(NamedTuple):
    """What a list of tasks says in PDDL: names, those done, goal, plan and progress."""

    names: frozenset[str]
    done: frozenset[str]
    goal: str
    plan: str
    progress: str


def task_texts(tasks: Iterable[tuple[str, str]], ends: Collection[str] = ()) -> TaskTexts:
    """Return the texts of tasks and their standings; raises InputError as TaskList.tell."""
    named = [(task_name(task), checked_standing(standing)) for task, standing in tasks]
    goals = [task_name(end) for end in ends] or list(dict.fromkeys(name for name, _ in named))
    return TaskTexts(
        names=frozenset(name for name, _ in named) | frozenset(goals),
        done=frozenset(name for name, standing in named if standing == 'done'),
        goal=f'(and {" ".join(f"(done {name})" for name in goals)})' if goals else '',
        plan='\n'.join(f'(do {name})' for name, _ in named),
        progress='\n'.join(
            f'{standing}: (do {name})' for name, standing in named if standing != 'ahead'
        ),
    )


def problem_text(known: Collection[str], done: Collection[str], goal: str) -> str:
    """Return the problem in which these tasks are known, and these done."""
    objects = f'{" ".join(sorted(known))} - task' if known else ''
    facts = ' '.join(f'(done {name})' for name in sorted(done))
    return (
        f'(define (problem tasks) (:domain tasks)\n  (:objects {objects})\n'
        f'  (:init {facts})\n  (:goal {goal}))\n'
    )


def parsed_tasks(text: str) -> list[tuple[str, str]]:
    """Return the tasks that a text names, one a line: `done: fetch the cup`, `wipe the table`.

    A line without a standing is a task that is ahead.
    """
    tasks = []
    for line in filter(None, map(str.strip, text.splitlines())):
        standing, colon, task = line.partition(':')
        found = colon and standing.strip().lower() in STANDINGS
        tasks.append((task.strip(), standing.strip().lower()) if found else (line, 'ahead'))
    return tasks


def task_name(task: str) -> str:
    """Return a task's name in PDDL: "Fetch the cup" is `fetch_the_cup`."""
    name = re.sub(r'\W+', '_', task.lower()).strip('_')
    if not name:
        raise InputError('tasks', f'a task needs a name, which "{task}" is not')
    return name if name[0].isalpha() else f'task_{name}'


def checked_standing(standing: str) -> str:
    """Return the standing; raises InputError if there is no such one."""
    if standing not in STANDINGS:
        meant = did_you_mean(standing, STANDINGS)
        raise InputError('tasks', f'a task is {", ".join(STANDINGS)}, not "{standing}"{meant}')
    return standing
