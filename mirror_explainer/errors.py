"""The package's errors: few, named, and worded for the person who must act on them."""

import difflib
from collections.abc import Iterable, Sequence

# Room for every fault of a long user model, and for no text that was taken for a name.
LONGEST_WORD = 200
LONGEST_MESSAGE = 4000


def one_line(text: str) -> str:
    """Return a message as one line that is safe to log, whatever texts it quotes.

    What a terminal would obey is written as an escape, and what is too long to
    be read is cut.
    """
    words = (
        word if len(word) <= LONGEST_WORD else f'{word[:LONGEST_WORD]}…'
        for word in text[: 2 * LONGEST_MESSAGE].split()
    )
    line = ''.join(
        letter if letter.isprintable() else letter.encode('unicode_escape').decode()
        for letter in ' '.join(words)
    )
    return line if len(line) <= LONGEST_MESSAGE else f'{line[:LONGEST_MESSAGE]} …'


class InputError(ValueError):
    """Something given to the explainer is wrong: a text, a file, a message.

    `source` names the file or topic, `line` is counted from 1 (None where no
    single line is to blame), and `reason` is one plain sentence; both as `one_line`.
    `cure` says what to do about it, where the reason does not make that plain. `brief` is
    what whoever asks is told where the reason is long, '' where it is not.
    """

    def __init__(
        self,
        source: str,
        reason: str,
        line: int | None = None,
        *,
        cure: str = '',
        brief: str = '',
    ) -> None:
        self.source = one_line(source)
        self.reason = one_line(reason)
        self.line = line
        self.cure = cure
        self.brief = brief
        place = self.source if line is None else f'{self.source}, line {line}'
        super().__init__(f'{place}: {self.reason}')


class NoPlanError(InputError):
    """The robot has no current plan, and its goal is not reached either."""


class PlanningError(RuntimeError):
    """Planning as a whole failed: no such engine, unsupported problem, no answer in time.

    `cure` says what to do about it, where the reason does not.
    """

    def __init__(self, reason: str, *, cure: str = '') -> None:
        self.cure = cure
        super().__init__(reason)


class Cancelled(Exception):
    """The work was stopped on request: newer input came, or the program ends."""


def did_you_mean(name: str, names: Iterable[str], *, cutoff: float = 0.6) -> str:
    """Return ' (did you mean "…"?)' with the closest of the names, '' if none is close.

    `cutoff` is how alike two names must be, from 0 to 1 (difflib's ratio).
    """
    close = difflib.get_close_matches(name, names, n=1, cutoff=cutoff)
    return f' (did you mean "{close[0]}"?)' if close else ''


def meant_or_known(name: str, names: Iterable[str]) -> str:
    """Return as `did_you_mean`, and where none of the names is close, all that there are."""
    known = list(names)
    return did_you_mean(name, known) or f' (there are {", ".join(known)})'


def some_of(texts: Sequence[str], most: int = 10) -> str:
    """Return texts as one, "a; b", of many the first: "a; b; and 3 more"."""
    more = [f'and {len(texts) - most} more'] if len(texts) > most else []
    return '; '.join([*texts[:most], *more])


def told(error: Exception) -> str:
    """Return an error as a person at a terminal is told it, with its cure if it has one."""
    return with_cure(str(error), getattr(error, 'cure', ''))


def with_cure(message: str, cure: str) -> str:
    """Return one line that says what is wrong and what to do about it."""
    if not cure:
        return message
    return f'{message}{"" if message.endswith(("?", ".")) else "."} {cure}'
