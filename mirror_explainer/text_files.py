"""Text files in: one way to read them, and one sentence where they can't be."""

from pathlib import Path

from mirror_explainer.errors import InputError


def read_text(path: str) -> str:
    """Read a text file; raises InputError that names it."""
    try:
        return Path(path).read_text(encoding='utf-8-sig')
    except UnicodeDecodeError as error:
        raise InputError(path, f'this is no UTF-8 text: {error.reason}') from error
    except OSError as error:
        raise InputError(path, f'the file cannot be read: {error.strerror}') from error
