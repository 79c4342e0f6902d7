"""Tasks that a robot knows by their names alone, as PDDL: something that gets done.

Nothing else of the package is needed for it, so that a robot's own node may do it.
"""

import re
from collections.abc import Collection, Iterable

from mirror_explainer.errors import InputError

DOMAIN = """; Enough for a robot that has no PDDL: it has tasks, and each is done at some time.
(define (domain tasks) (:requirements :strips :typing)
  (:types task) (:predicates (done ?task - task))
  (:action do :parameters (?task - task) :effect (done ?task)))
"""
_NEVER = 'never_told'  # a task that is never done


def spelling(tasks: Iterable[str]) -> dict[str, str]:
    """Return the tasks' names by name in lower case; of several spellings the last."""
    return {name.lower(): name for name in map(task_name, tasks)}


def task_name(task: str) -> str:
    """Return a task's name in PDDL, `Fetch_the_cup`, where capitals do not count."""
    name = re.sub(r'\W+', '_', task).strip('_')
    if not name:
        raise InputError('tasks', f'a task needs a name, which "{task}" is not')
    return name if name[0].isalpha() else f'task_{name}'


def named_tasks(user_model: str) -> list[str]:
    """Return the tasks that a user model's text names, as in `(done boil_water)`."""
    return re.findall(r'\(\s*done\s+([^\s(){}]+)\s*\)', user_model, re.IGNORECASE)


def action_text(task: str) -> str:
    """Return the action that does the task of this name."""
    return f'(do {task})'


def done_text(task: str) -> str:
    """Return the fact that the task of this name is done."""
    return f'(done {task})'


def goal_text(tasks: Iterable[str]) -> str:
    """Return the goal that the tasks of these names are done."""
    return f'(and {" ".join(map(done_text, tasks))})'


def problem_text(known: Collection[str], done: Collection[str], goal: str) -> str:
    """Return the problem in which these tasks are known, and these done.

    A robot that never had a goal has one here that no plan will reach: it is not done.
    """
    if not goal:
        known, goal = [*known, _NEVER], done_text(_NEVER)
    facts = ' '.join(map(done_text, sorted(done)))
    return (
        f'(define (problem tasks) (:domain tasks)\n  (:objects {" ".join(sorted(known))} - task)\n'
        f'  (:init {facts})\n  (:goal {goal}))\n'
    )
