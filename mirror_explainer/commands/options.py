"""Numbers among a command's options: read, or refused in words."""

import math
from argparse import ArgumentTypeError
from collections.abc import Callable


def whole(least: int) -> Callable[[str], int]:
    """Return a reader of whole numbers from `least` up, for argparse."""

    def read(text: str) -> int:
        if not text.isdecimal() or int(text) < least:
            raise ArgumentTypeError(f'"{text}" is no whole number from {least} up')
        return int(text)

    return read


def number(least: float, most: float = math.inf, *, above: bool = False) -> Callable[[str], float]:
    """Return a reader of finite numbers from `least` to `most`, for argparse.

    With `above` the least itself is too little.
    """
    limits = f'{"above" if above else "from"} {least:g}'
    if most < math.inf:
        limits += f' to {most:g}'
    elif not above:
        limits += ' up'

    def read(text: str) -> float:
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        within = least < value if above else least <= value
        if not within or value > most or value == math.inf:
            raise ArgumentTypeError(f'"{text}" is no number {limits}')
        return value

    return read
