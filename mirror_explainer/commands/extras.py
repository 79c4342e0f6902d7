"""What parts of the package need beyond its core: the extras [experiments], [plans], [web]."""

from collections.abc import Mapping
from importlib.util import find_spec

from mirror_explainer.settings import FURTHER_PLANS

# Of each extra, the modules that are imported and the packages that hold them.
_NEEDED: Mapping[str, Mapping[str, str]] = {
    'experiments': {
        'matplotlib': 'matplotlib',
        'pandas': 'pandas',
        'rich': 'rich',
        'scipy': 'scipy',
        'tabulate': 'tabulate',
        'tqdm': 'tqdm',
    },
    'plans': {'kstar_planner': FURTHER_PLANS},
    'web': {
        'django': "'Django>=5.2,<6'",
        'django_htmx': 'django-htmx',
        'markdown_it': 'markdown-it-py',
        'waitress': 'waitress',
        'whitenoise': 'whitenoise',
    },
}
_USERS = {
    'experiments': 'the experiments need',
    'plans': 'further plans of a belief need',
    'web': 'the pages need',
}


class MissingExtras(RuntimeError):
    """Some package of an extra is not installed; the message says how to."""


def require_extras(extra: str) -> None:
    """Raise MissingExtras unless every package of the extra is there."""
    needed = _NEEDED[extra]
    missing = [package for module, package in needed.items() if find_spec(module) is None]
    if missing:
        raise MissingExtras(
            f'{_USERS[extra]} {", ".join(missing)}, of the extra [{extra}]: '
            f'pip install {" ".join(needed.values())}'
        )
