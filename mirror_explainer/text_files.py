"""Texts in: one way to read files, and one form of text, wherever it was written."""

import contextlib
import errno
import fcntl
import os
import stat
import time
from collections.abc import Iterator
from pathlib import Path

from mirror_explainer.errors import InputError
from mirror_explainer.input_limits import InputLimits


def plain_text(text: str) -> str:
    """Return the text without a byte-order mark, and with one kind of line end."""
    return text.removeprefix('\ufeff').replace('\r\n', '\n').replace('\r', '\n')


def read_text(path: str, limits: InputLimits | None = None) -> str:
    """Read a plain text file; raises InputError that names it.

    What would have to be waited for, such as a named pipe, is refused; and with
    limits a file that is longer than a message may be.
    """
    try:
        with open(path, 'rb', opener=_open_at_once) as stream:
            if not stat.S_ISREG(os.fstat(stream.fileno()).st_mode):
                raise OSError(errno.EINVAL, 'it is a pipe or a device')
            data = stream.read(limits.max_message_bytes + 1 if limits else -1)
        if data is None:  # some of those that the kernel makes up
            raise OSError(errno.EAGAIN, 'there is nothing in it yet')
        if limits:
            limits.require('max_message_bytes', len(data), 'its bytes', path)
        return plain_text(data.decode())
    except InputError:
        raise
    except UnicodeDecodeError as error:
        line = error.object.count(b'\n', 0, error.start) + 1
        raise InputError(path, f'this is no UTF-8 text: {error.reason}', line) from error
    except (OSError, ValueError) as error:  # the latter for a path that no file can have
        reason = f'the file cannot be read: {getattr(error, "strerror", None) or error}'
        cure = _path_cure(path) if isinstance(error, FileNotFoundError) else ''
        raise InputError(path, reason, cure=cure) from error


def write_text(path: str, text: str) -> None:
    """Write a file; raises InputError that names it if it cannot be written."""
    try:
        Path(path).write_text(text, encoding='utf-8')
    except (OSError, ValueError) as error:
        reason = getattr(error, 'strerror', None) or error
        raise InputError(path, f'the file cannot be written: {reason}') from error


def replace_text(path: str, text: str) -> None:
    """Put a text in a file's place in one step: readers find the old one or the new, whole.

    Raises OSError, and leaves the file as it was.
    """
    path = os.path.realpath(path)
    if os.path.exists(path) and not os.access(path, os.W_OK):
        raise OSError(errno.EACCES, os.strerror(errno.EACCES))
    beside = f'{path}.{os.getpid()}.new'
    try:
        with open(beside, 'w', encoding='utf-8') as stream:
            stream.write(text)
            stream.flush()
            os.fsync(stream.fileno())
        if os.path.exists(path):
            os.chmod(beside, stat.S_IMODE(os.stat(path).st_mode))
        os.replace(beside, path)
    except OSError:
        with contextlib.suppress(OSError):
            os.unlink(beside)
        raise


@contextlib.contextmanager
def changing_alone(path: str, timeout: float = 1.0) -> Iterator[None]:
    """Keep other processes that use this from changing the file meanwhile.

    Raises TimeoutError, an OSError, if another one does so for longer than `timeout` seconds.
    """
    folder = os.open(os.path.dirname(os.path.realpath(path)), os.O_RDONLY | os.O_DIRECTORY)
    try:
        end = time.monotonic() + timeout
        while True:
            try:
                fcntl.flock(folder, fcntl.LOCK_EX | fcntl.LOCK_NB)
                break
            except BlockingIOError as error:
                if time.monotonic() >= end:
                    raise TimeoutError(errno.ETIMEDOUT, 'another process is at it') from error
                time.sleep(0.01)
        yield
    finally:
        os.close(folder)


def _path_cure(path: str) -> str:
    """Say what there is to check about the path of a file that is not there."""
    if path.startswith('~'):
        return 'Write the whole path, from "/" on: "~" is not expanded here.'
    if not os.path.isabs(path):
        return 'Check the path: unless it is absolute, it begins where the program was started.'
    return ''


def _open_at_once(path: str, flags: int) -> int:
    return os.open(path, flags | os.O_NONBLOCK)


class TextFiles:
    """Reads text files, and notices when one that was read has changed.

    Any change counts: of content, permissions, or the file's being there at all.
    """

    def __init__(self) -> None:
        self._seen: dict[str, object] = {}
        self._overtaken = False

    def read(self, path: str, limits: InputLimits | None = None) -> str:
        """Read a text file as `read_text` does."""
        stamp = _stamp(path)  # before reading: what is written meanwhile must show
        self._overtaken |= self._seen.get(path, stamp) != stamp
        self._seen[path] = stamp
        return read_text(path, limits)

    def changed(self) -> bool:
        """Say whether a file differs from when it was first read, or last looked at here."""
        now = {path: _stamp(path) for path in list(self._seen)}
        changed = self._overtaken or any(self._seen[path] != stamp for path, stamp in now.items())
        self._overtaken = False
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
