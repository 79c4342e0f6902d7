"""Say the few actions of a robot's plan that tell the listener most.

After Persiani and Hellström, *Informative Communication of Robot Plans*. What a notebook
or a program of one's own needs is here:

    import mirror_explainer as me

    told = me.explain_files(domain, problem, plan, user_model=user_model, n=3)
    print(told.spoken, told.understanding)

"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from mirror_explainer.commands.offline import explain_files
    from mirror_explainer.errors import InputError, NoPlanError, PlanningError
    from mirror_explainer.explainer import explain, robot_plan
    from mirror_explainer.listener.explanation import Explanation
    from mirror_explainer.listener.preparation import Preparation, prepare, refine
    from mirror_explainer.listener.user_model import UserModel, read_user_model
    from mirror_explainer.pddl import Task, read_task
    from mirror_explainer.planning import Planner
    from mirror_explainer.settings import PlanningSettings, Question

# Where each is: what a process does not use, such as a web page's, is not imported.
_PLACES = {
    'explain_files': 'commands.offline',
    'InputError': 'errors',
    'NoPlanError': 'errors',
    'PlanningError': 'errors',
    'Explanation': 'listener.explanation',
    'explain': 'explainer',
    'robot_plan': 'explainer',
    'Preparation': 'listener.preparation',
    'prepare': 'listener.preparation',
    'refine': 'listener.preparation',
    'UserModel': 'listener.user_model',
    'read_user_model': 'listener.user_model',
    'Task': 'pddl',
    'read_task': 'pddl',
    'Planner': 'planning',
    'PlanningSettings': 'settings',
    'Question': 'settings',
}

__all__ = [  # noqa: PLE0604
    'Explanation',
    'InputError',
    'NoPlanError',
    'Planner',
    'PlanningError',
    'PlanningSettings',
    'Preparation',
    'Question',
    'Task',
    'UserModel',
    'explain',
    'explain_files',
    'prepare',
    'read_task',
    'read_user_model',
    'refine',
    'robot_plan',
]


def __getattr__(name: str) -> Any:
    if name in _PLACES:
        return getattr(import_module(f'{__name__}.{_PLACES[name]}'), name)
    raise AttributeError(f'module {__name__!r} has no attribute {name!r}')
