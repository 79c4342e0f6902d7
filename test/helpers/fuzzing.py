"""Texts for fuzzing: real ones that were damaged, noise, and a watch over what reads them."""

import re
import signal
import time
from collections.abc import Callable, Sequence

from hypothesis import strategies as st

from mirror_explainer.errors import InputError

LIMIT = 20.0  # s: far more than any of these texts takes, on a busy machine too
TOKEN = re.compile(r'\s+|[^\s()\[\]{},:;"]+|.')
ODD = ['\0', '\ufeff', '\r', '\u2028', '\x1b[31m', '\ud800', 'é', 'ſ', 'İ', '🤖', '%s', '{0}', '~']
PIECES = st.sampled_from(
    ['', '(', ')', '((', '))', '?', '-', ':', ';', '"', "'", '\n', '\t', ' ', *ODD]
)
NOISE = st.text(max_size=30) | st.text('()\n ;?:-=and01.e[]', max_size=60)

_NUMBER = st.integers(0, 9999)


class Watch:
    """Runs readers one after the other; knows how many texts they took, and the slowest run."""

    def __init__(self) -> None:
        self.cases = 0
        self.taken = 0
        self.slowest = 0.0  # s of processor time
        self.slowest_text = ''

    def over(self, text: str, read: Callable[[], bool]) -> None:
        """Let a text be read; raise TimeoutError in the middle of what takes too long."""
        signal.signal(signal.SIGALRM, _too_long)
        signal.setitimer(signal.ITIMER_REAL, LIMIT)
        started = time.thread_time()
        try:
            self.taken += read()
        finally:
            signal.setitimer(signal.ITIMER_REAL, 0)
        took = time.thread_time() - started
        self.cases += 1
        if took > self.slowest:
            self.slowest, self.slowest_text = took, text

    def __str__(self) -> str:
        return (
            f'{self.cases} texts, {self.taken} taken, '
            f'the slowest in {self.slowest:.3f} s: {self.slowest_text!r}'
        )


def _too_long(*_: object) -> None:
    raise TimeoutError(f'reading took more than {LIMIT} s')


def damaged(texts: Sequence[str], words: Sequence[str]) -> st.SearchStrategy[str]:
    """Return texts made from real ones by a few cuts, swaps, and insertions of words."""
    piece = PIECES | st.sampled_from(list(words)) | st.text(max_size=3)
    change = st.tuples(st.sampled_from(_CHANGES), _NUMBER, _NUMBER, piece)
    return st.builds(_changed, st.sampled_from(list(texts)), st.lists(change, max_size=5))


def _changed(text: str, changes: list[tuple[Callable, int, int, str]]) -> str:
    tokens = TOKEN.findall(text)
    for change, one, other, piece in changes:
        if tokens:
            tokens = change(tokens, one % len(tokens), other % len(tokens), piece)
    return ''.join(tokens)


def _delete(tokens: list[str], one: int, other: int, piece: str) -> list[str]:
    return tokens[:one] + tokens[one + 1 + other % 4 :]


def _duplicate(tokens: list[str], one: int, other: int, piece: str) -> list[str]:
    return tokens[: one + 1 + other % 9] + tokens[one:]


def _swap(tokens: list[str], one: int, other: int, piece: str) -> list[str]:
    tokens[one], tokens[other] = tokens[other], tokens[one]
    return tokens


def _rename(tokens: list[str], one: int, other: int, piece: str) -> list[str]:
    return tokens[:one] + [tokens[other]] + tokens[one + 1 :]


def _insert(tokens: list[str], one: int, other: int, piece: str) -> list[str]:
    return [*tokens[:one], piece, *tokens[one:]]


def _replace(tokens: list[str], one: int, other: int, piece: str) -> list[str]:
    return [*tokens[:one], piece, *tokens[one + 1 :]]


def _change_case(tokens: list[str], one: int, other: int, piece: str) -> list[str]:
    return tokens[:one] + [tokens[one].swapcase()] + tokens[one + 1 :]


def _truncate(tokens: list[str], one: int, other: int, piece: str) -> list[str]:
    return tokens[:one]


def _concatenate(tokens: list[str], one: int, other: int, piece: str) -> list[str]:
    return (tokens + tokens[one:])[:5000]


def _repeat(tokens: list[str], one: int, other: int, piece: str) -> list[str]:
    return tokens[:one] + [tokens[one][:20]] * (other % 60) + tokens[one:]


_CHANGES = [
    *(_delete, _duplicate, _swap, _rename, _insert, _replace) * 3,
    *(_change_case, _truncate, _concatenate, _repeat),
]


def require_told_well(error: InputError, text: str) -> None:
    """Assert that an error has a place, and is one printable line."""
    told = str(error)
    assert error.source
    assert error.reason
    assert told.isprintable(), repr(told)
    assert len(told) < 5000
    breaks = len(re.findall('[\n\r\x85\u2028\u2029]', text))  # YAML knows all of them
    assert error.line is None or 1 <= error.line <= breaks + 1
