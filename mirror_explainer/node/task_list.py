"""Robots without PDDL: a list of tasks, and how far the robot is, as the explainer's topics.

A behaviour tree or a state machine knows its tasks by name, in order, and which are done. With
the domain of `config/tasks`, where a task is something that gets done, this is a problem and plan.
"""

import re
from collections.abc import Collection, Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import NamedTuple

from rclpy.node import Node

from mirror_explainer.errors import InputError, did_you_mean
from mirror_explainer.listener.robot_tasks import (
    DOMAIN,
    action_text,
    goal_text,
    named_tasks,
    problem_text,
    spelling,
    task_name,
)
from mirror_explainer.node.behaviour_tree import (
    Kinds,
    ToldTask,
    TreeNode,
    all_tasks,
    failure_reason,
    tree_tasks,
)
from mirror_explainer.node.robot_topics import RobotTopics
from mirror_explainer.text_files import read_text

STANDINGS = ('ahead', 'running', 'done', 'skipped', 'failed')
REASONED = ('skipped', 'failed')  # with these may go a reason
_TOLD = re.compile(r'([^\W\d_]+)\s*:\s*(.*)')  # a word before a colon, and the rest
_BECAUSE = re.compile(r'\s+because\b:?\s*', re.IGNORECASE)


class ListedTask(NamedTuple):
    """A task, how it stands, and why it does, '' if that is not told."""

    name: str
    standing: str
    reason: str


class TaskList:
    """Tells the explainer a robot's tasks; publishes `domain`, `problem`, `plan`, `progress`.

    `node` is any node of the robot's; the topics are in its namespace. All tasks that the
    explainer's `user_model_file` speaks of must be known to it: those in the goals of that
    file are, if it is named here, too, and those that `known` names, or that were told once.

        tasks = TaskList(node, user_model_file='user_model.yaml')
        tasks.tell([('drive to the kitchen', 'done'), ('fetch the cup', 'running')])

    Call `tell` or `tell_tree` as often as you like, such as after each tick: what has not
    changed is not published again. Raises InputError for a task or a standing that cannot be
    told, which the explainer then answers with, rather than from the list before; and for a
    file that cannot be read.
    """

    def __init__(self, node: Node, known: Iterable[str] = (), user_model_file: str = '') -> None:
        named = named_tasks(read_text(user_model_file)) if user_model_file else ()
        self._known = spelling([*named, *known])
        self._by_letters = {_letters(name): name for name in self._known.values()}
        self._goal = ''
        self._list: list[ListedTask] = []  # as it was told last, with these ends
        self._ends: Collection[str] = ()
        self._log, self._warned = node.get_logger(), set[str]()
        self._tree: TreeNode | None = None  # that has been ticked
        self._tree_tasks: list[ToldTask] = []  # as they were told last
        self._topics = RobotTopics(node)
        self._topics.tell(domain=DOMAIN)

    def tell(
        self, tasks: Iterable[ToldTask], ends: Collection[str] = (), reason: str = ''
    ) -> None:
        """Tell the tasks in order, each with its standing: one of STANDINGS.

        One that was skipped, or failed, may have a reason for people as its third: `('shave
        the ice', 'skipped', 'The blade is not sharp.')`. What failed before a later one began is
        skipped. `reason` is that of those that failed, else of the last that was skipped. `ends`
        are those of them that the others are for; without them all are. No tasks: the robot has
        nothing to do; with a `reason` it had to stop what it was told to be at, which failed.
        """
        with self._faults_told():
            told = _one_after_the_other([checked_task(task) for task in tasks])
            if reason and not told:
                told = _broken_off(self._list)
                ends = self._ends if told else ends
            self._tell(_reasoned(told, reason), ends)
        if reason and not any(task.standing in REASONED for task in told):
            self._warn(f'nobody hears why: "{reason}", since no task was skipped, or failed')

    def tell_text(self, text: str) -> None:
        """Tell the tasks of a text, as `parsed_tasks` takes it."""
        with self._faults_told():
            tasks = parsed_tasks(text)
        self.tell(tasks)

    def _tell(self, tasks: list[ListedTask], ends: Collection[str]) -> None:
        tasks = [task._replace(name=self._as_known(task.name)) for task in tasks]
        ends = [self._as_known(end) for end in ends]
        texts = task_texts(tasks, ends)
        self._list, self._ends = tasks, ends
        self._known |= texts.names
        self._goal = texts.goal or self._goal
        problem = problem_text(self._known.values(), texts.done, self._goal)
        self._topics.tell(problem=problem, progress=texts.progress, plan=texts.plan)

    def _as_known(self, task: str) -> str:
        """Return the known task that "TakeOut" must be if it is none by that name: "take_out"."""
        name = task_name(task)
        return task if name.lower() in self._known else self._by_letters.get(_letters(name), task)

    def tell_tree(self, root: TreeNode, leaves: Kinds, ends: Collection[str] = ()) -> None:
        """Tell the tasks that a behaviour tree of py_trees means to do (see `tree_tasks`).

        They are the nodes of the class `leaves`, or of one of these classes. `ends` are
        names of nodes anywhere in the tree: those in the branches that it means to run count.
        A tree that was ticked and is INVALID now was given up: it has nothing to do.
        """
        with self._faults_told():
            if not_there := {*ends}.difference(every := [*all_tasks(root, leaves)]):
                raise _no_task(min(not_there), every)
            is_reset = root.status.name == 'INVALID'
            is_given_up = is_reset and root is self._tree
            tasks = [] if is_given_up else tree_tasks(root, leaves, self._tree_tasks)
            self._tree, self._tree_tasks = self._tree if is_reset else root, tasks
            named = {task for task, *_ in tasks}
            told = [checked_task(task) for task in tasks]
            if any(task.standing == 'failed' for task in told):
                told = _reasoned(told, failure_reason(root, leaves))
            self._tell(told, [end for end in ends if end in named])

    @contextmanager
    def _faults_told(self) -> Iterator[None]:
        """Let the explainer, too, hear why there is no new list: the one before is over."""
        try:
            yield
        except InputError as error:
            self._topics.tell_fault(error)
            raise

    def _warn(self, sentence: str) -> None:
        if sentence not in self._warned:
            self._warned.add(sentence)
            self._log.warning(sentence)


class TaskTexts(NamedTuple):
    """What a list of tasks says in PDDL.

    These are the names as they are spelt, by name in lower case, the names of those that are
    done, the goal, the plan and the progress.
    """

    names: dict[str, str]
    done: frozenset[str]
    goal: str
    plan: str
    progress: str


def task_texts(tasks: Sequence[ListedTask], ends: Collection[str] = ()) -> TaskTexts:
    """Return the texts of a list of tasks; raises InputError for a name or an end that is none."""
    names = spelling(task.name for task in tasks)
    named = [task._replace(name=task_name(task.name).lower()) for task in tasks]
    for end in ends:
        if task_name(end).lower() not in names:
            raise _no_task(end, [task.name for task in tasks])
    goals = dict.fromkeys([task_name(end).lower() for end in ends] or names)
    return TaskTexts(
        names=names,
        done=frozenset(task.name for task in named if task.standing == 'done'),
        goal=goal_text(goals) if goals else '',
        plan='\n'.join(action_text(task.name) for task in named),
        progress='\n'.join(
            f'{task.standing}: {action_text(task.name)}{_because(task.reason)}'
            for task in named
            if task.standing != 'ahead'
        ),
    )


def parsed_tasks(text: str) -> list[ToldTask]:
    """Return the tasks that a text names, one a line: `done: fetch the cup`, `wipe the table`.

    A line without a standing is a task that is ahead. What failed, or was skipped, may have a
    reason, as in `failed: wipe the table because the sponge is dry`. Raises InputError for
    another word before a colon, and for a standing without one.
    """
    tasks: list[ToldTask] = []
    for number, line in enumerate(map(str.strip, text.splitlines()), start=1):
        if not line:
            continue
        first, *rest = line.split(maxsplit=1)
        if rest and first.lower() in STANDINGS and not rest[0].startswith(':'):
            fault = f'"{first}" needs a colon (did you mean "{first}: {rest[0]}"?)'
            cure = f'A task that is called so needs its standing before it: "ahead: {line}".'
            raise InputError('tasks', fault, number, cure=cure)
        found = _TOLD.fullmatch(line)
        standing, task = (found[1].lower(), found[2]) if found else ('ahead', line)
        if standing not in STANDINGS:
            cure = f'Before a colon stands {", ".join(STANDINGS)}; what is ahead needs nothing.'
            fault = f'"{standing}" is no standing of a task{did_you_mean(standing, STANDINGS)}'
            raise InputError('tasks', fault, number, cure=cure)
        task, *reason = _BECAUSE.split(task, 1) if standing in REASONED else [task]
        tasks.append((task, standing, reason[0]) if reason else (task, standing))
    return tasks


def checked_task(given: object) -> ListedTask:
    """Return a task with its standing, and a reason if it has one; raises InputError."""
    match given:
        case [str(task), str(standing)]:
            reason = ''
        case [str(task), str(standing), str(reason)]:
            pass
        case _:
            example = "('boil water', 'running')"
            raise InputError(
                'tasks', f'each task goes with its standing, {example}, not {given!r}'
            )
    if standing not in STANDINGS:
        meant = did_you_mean(standing, STANDINGS)
        raise InputError('tasks', f'a task is {", ".join(STANDINGS)}, not "{standing}"{meant}')
    if reason and standing not in REASONED:
        raise InputError('tasks', f'"{task}" is {standing}: it needs no reason')
    return ListedTask(task, standing, reason)


def _one_after_the_other(tasks: list[ListedTask]) -> list[ListedTask]:
    """Return tasks done in this order: what failed before a later one began was skipped."""
    begun = [at for at, task in enumerate(tasks) if task.standing in ('running', 'done')]
    last = max(begun, default=0)
    return [
        task._replace(standing='skipped') if task.standing == 'failed' and at < last else task
        for at, task in enumerate(tasks)
    ]


def _broken_off(tasks: list[ListedTask]) -> list[ListedTask]:
    """Return the tasks of a robot that had to stop: what it was at failed, or was to do next.

    None where nothing was left to do.
    """
    left = [task for task in tasks if task.standing not in ('done', 'skipped')]
    failed = [task for task in left if task.standing == 'running'] or left[:1]
    return [task._replace(standing='failed') if task in failed else task for task in tasks if left]


def _reasoned(tasks: list[ListedTask], reason: str) -> list[ListedTask]:
    """Return tasks with the reason of those that failed, else of the last that was skipped."""
    failed = [at for at, task in enumerate(tasks) if task.standing == 'failed']
    skipped = [at for at, task in enumerate(tasks) if task.standing == 'skipped']
    reasoned = failed or skipped[-1:]
    return [
        task._replace(reason=task.reason or reason) if at in reasoned else task
        for at, task in enumerate(tasks)
    ]


def _because(reason: str) -> str:
    words = reason.replace(';', ',').split()  # a semicolon would begin a comment
    return ' '.join(['', 'because', *words]) if words else ''


def _letters(name: str) -> str:
    return name.lower().replace('_', '')


def _no_task(end: str, tasks: Iterable[str]) -> InputError:
    return InputError('tasks', f'the end "{end}" is none of the tasks{did_you_mean(end, tasks)}')
