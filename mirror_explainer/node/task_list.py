"""Robots without PDDL: a list of tasks, and how far the robot is, as the explainer's topics.

A behaviour tree or a state machine knows its tasks by name, in order, and which are done. With
the domain of `config/tasks`, where a task is something that gets done, this is a problem and plan.
"""

from collections.abc import Collection, Iterable, Iterator
from contextlib import contextmanager

from rclpy.node import Node

from mirror_explainer.errors import InputError
from mirror_explainer.listener.robot_tasks import (
    DOMAIN,
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
from mirror_explainer.node.task_texts import (
    REASONED,
    ListedTask,
    broken_off,
    checked_task,
    no_task,
    one_after_the_other,
    parsed_tasks,
    reasoned,
    task_texts,
)
from mirror_explainer.text_files import read_text


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
        """Tell the tasks in order, each ahead, running, done, skipped or failed.

        One that was skipped, or failed, may have a reason for people as its third: `('shave
        the ice', 'skipped', 'The blade is not sharp.')`. What failed before a later one began is
        skipped. `reason` is that of those that failed, else of the last that was skipped. `ends`
        are those of them that the others are for; without them all are. No tasks: the robot has
        nothing to do; with a `reason` it had to stop what it was told to be at, which failed.
        """
        with self._faults_told():
            told = one_after_the_other([checked_task(task) for task in tasks])
            if reason and not told:
                told = broken_off(self._list)
                ends = self._ends if told else ends
            self._tell(reasoned(told, reason), ends)
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
                raise no_task(min(not_there), every)
            is_reset = root.status.name == 'INVALID'
            is_given_up = is_reset and root is self._tree
            tasks = [] if is_given_up else tree_tasks(root, leaves, self._tree_tasks)
            self._tree, self._tree_tasks = self._tree if is_reset else root, tasks
            named = {task for task, *_ in tasks}
            told = [checked_task(task) for task in tasks]
            if any(task.standing == 'failed' for task in told):
                told = reasoned(told, failure_reason(root, leaves))
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


def _letters(name: str) -> str:
    return name.lower().replace('_', '')
