"""What the experiments need beyond the core: the extra [experiments]."""

from importlib.util import find_spec

_NEEDED = ('matplotlib', 'pandas', 'scipy', 'tabulate', 'tqdm')


class MissingExtras(RuntimeError):
    """Some package of the extra [experiments] is not installed; the message says how to."""


def require_extras() -> None:
    """Raise MissingExtras unless everything that draws and tabulates is there."""
    missing = [name for name in _NEEDED if find_spec(name) is None]
    if missing:
        raise MissingExtras(
            f'the experiments need {", ".join(missing)}, of the extra [experiments]: '
            f'pip install {" ".join(_NEEDED)}'
        )
