"""PDDL texts in: tasks, their atoms and goals, and the states that actions lead to."""

from mirror_explainer.pddl.atoms import (
    atom_text,
    condition_text,
    conjuncts,
    ground_text,
    words_of,
)
from mirror_explainer.pddl.environment import forget_expressions
from mirror_explainer.pddl.task import (
    Task,
    fluent_expression,
    goal_expression,
    read_task,
    require_definition,
)

__all__ = [
    'Task',
    'atom_text',
    'condition_text',
    'conjuncts',
    'fluent_expression',
    'forget_expressions',
    'goal_expression',
    'ground_text',
    'read_task',
    'require_definition',
    'words_of',
]
