"""A list of tasks, each with how it stands, as what it says in PDDL."""

import re
from collections.abc import Collection, Iterable, Sequence
from typing import NamedTuple

from mirror_explainer.errors import InputError, did_you_mean
from mirror_explainer.listener.robot_tasks import action_text, goal_text, spelling, task_name
from mirror_explainer.node.behaviour_tree import ToldTask

STANDINGS = ('ahead', 'running', 'done', 'skipped', 'failed')
REASONED = ('skipped', 'failed')  # with these may go a reason
_TOLD = re.compile(r'([^\W\d_]+)\s*:\s*(.*)')  # a word before a colon, and the rest
_BECAUSE = re.compile(r'\s+because\b:?\s*', re.IGNORECASE)


class ListedTask(NamedTuple):
    """A task, how it stands, and why it does, '' if that is not told."""

    name: str
    standing: str
    reason: str


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
            raise no_task(end, [task.name for task in tasks])
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


def one_after_the_other(tasks: list[ListedTask]) -> list[ListedTask]:
    """Return tasks done in this order: what failed before a later one began was skipped."""
    begun = [at for at, task in enumerate(tasks) if task.standing in ('running', 'done')]
    last = max(begun, default=0)
    return [
        task._replace(standing='skipped') if task.standing == 'failed' and at < last else task
        for at, task in enumerate(tasks)
    ]


def broken_off(tasks: list[ListedTask]) -> list[ListedTask]:
    """Return the tasks of a robot that had to stop: what it was at failed, or was to do next.

    An empty list where nothing was left to do.
    """
    left = [task for task in tasks if task.standing not in ('done', 'skipped')]
    failed = [task for task in left if task.standing == 'running'] or left[:1]
    return [task._replace(standing='failed') if task in failed else task for task in tasks if left]


def reasoned(tasks: list[ListedTask], reason: str) -> list[ListedTask]:
    """Return tasks with the reason of those that failed, else of the last that was skipped."""
    failed = [at for at, task in enumerate(tasks) if task.standing == 'failed']
    skipped = [at for at, task in enumerate(tasks) if task.standing == 'skipped']
    places = failed or skipped[-1:]
    return [
        task._replace(reason=task.reason or reason) if at in places else task
        for at, task in enumerate(tasks)
    ]


def no_task(end: str, tasks: Iterable[str]) -> InputError:
    """Return what is wrong with an end that is none of the tasks."""
    return InputError('tasks', f'the end "{end}" is none of the tasks{did_you_mean(end, tasks)}')


def _because(reason: str) -> str:
    words = reason.replace(';', ',').split()  # a semicolon would begin a comment
    return ' '.join(['', 'because', *words]) if words else ''
