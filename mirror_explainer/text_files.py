"""Text files in: one way to read them, and one sentence where they can't be."""

import errno
import os
import stat

from mirror_explainer.errors import InputError


def read_text(path: str) -> str:
    """Read a plain text file; raises InputError that names it.

    What would have to be waited for, such as a named pipe, is refused.
    """
    try:
        with open(path, encoding='utf-8-sig', opener=_open_at_once) as stream:
            if not stat.S_ISREG(os.fstat(stream.fileno()).st_mode):
                raise OSError(errno.EINVAL, 'it is a pipe or a device')
            return stream.read()
    except UnicodeDecodeError as error:
        raise InputError(path, f'this is no UTF-8 text: {error.reason}') from error
    except (OSError, ValueError) as error:  # the latter for a path that no file can have
        reason = getattr(error, 'strerror', None) or error
        raise InputError(path, f'the file cannot be read: {reason}') from error


def _open_at_once(path: str, flags: int) -> int:
    return os.open(path, flags | os.O_NONBLOCK)


class TextFiles:
    """Reads text files, and notices when one that was read has changed.

    Any change counts: of content, permissions, or the file's being there at all.
    """

    def __init__(self) -> None:
        self._seen: dict[str, object] = {}

    def read(self, path: str) -> str:
        """Read a text file as `read_text` does."""
        self._seen[path] = _stamp(path)  # before reading: what is written meanwhile must show
        return read_text(path)

    def changed(self) -> bool:
        """Say whether a file differs from when it was read, or last looked at here."""
        now = {path: _stamp(path) for path in list(self._seen)}
        changed = any(self._seen[path] != stamp for path, stamp in now.items())
        self._seen |= now
        return changed

    @property
    def revision(self) -> object:
        """Something that is another one after each change."""
        return tuple(self._seen.items())


def _stamp(path: str) -> object:
    """Return something that changes whenever the file does, None where it is not there."""
    try:
        found = os.stat(path)
    except (OSError, ValueError):
        return None
    # With the time of the last change of its status: a copy may keep the other times.
    return found.st_dev, found.st_ino, found.st_size, found.st_mtime_ns, found.st_ctime_ns
