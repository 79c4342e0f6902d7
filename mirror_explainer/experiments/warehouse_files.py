"""Where the warehouse's files are, from a checkout as from an installed package."""

from pathlib import Path

from mirror_explainer.errors import InputError
from mirror_explainer.listener.user_model import UserModel, read_user_model
from mirror_explainer.pddl import Task, read_task

_FOLDERS = (Path('config/warehouse'), Path('share/mirror_explainer/config/warehouse'))


def warehouse_folder() -> Path:
    """Return config/warehouse of the checkout, or of the prefix that the package lies in."""
    for parent in Path(__file__).resolve().parents:
        for folder in _FOLDERS:
            if (parent / folder / 'domain.pddl').is_file():
                return parent / folder
    raise InputError('config/warehouse', 'the folder is not installed beside the package')


def read_warehouse() -> tuple[Task, UserModel]:
    """Read the demo: the robot's task, and what the listener may believe."""
    folder = warehouse_folder()
    domain, problem = folder / 'domain.pddl', folder / 'problem.pddl'
    task = read_task(
        domain.read_text(encoding='utf-8'),
        problem.read_text(encoding='utf-8'),
        str(domain),
        str(problem),
    )
    return task, read_user_model(folder / 'user_model.yaml', task)
