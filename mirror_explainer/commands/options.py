"""A command's options: from the settings that they give, and numbers read or refused in words."""

import argparse
import math
from argparse import ArgumentTypeError, BooleanOptionalAction
from collections.abc import Callable
from typing import Any, TypeVar

from mirror_explainer.settings import Meaning, settings_of

Kind = TypeVar('Kind')


def whole(least: int, most: float = math.inf) -> Callable[[str], int]:
    """Return a reader of whole numbers from `least` to `most`, for argparse."""
    limits = f'from {least} up' if most == math.inf else f'from {least} to {most}'

    def read(text: str) -> int:
        if not text.isdecimal() or not least <= int(text) <= most:
            raise ArgumentTypeError(f'"{text}" is no whole number {limits}')
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


def add_settings(group: argparse._ActionsContainer, kind: type, *left_out: str) -> None:
    """Add an option for each setting of a kind (`settings.py`), but those left out."""
    for item, meaning in settings_of(kind):
        if item.name in left_out:
            continue
        option = f'--{item.name.replace("_", "-")}'
        shown = (
            f'{meaning.description} (default %(default)s)'
            if item.default != ''
            else meaning.description
        )
        if isinstance(item.default, bool):
            group.add_argument(
                option, action=BooleanOptionalAction, default=item.default, help=shown
            )
        else:
            group.add_argument(
                option,
                type=_reader(item.default, meaning),
                default=item.default,
                choices=meaning.choices or None,
                metavar=meaning.metavar or None,
                help=shown,
            )


def settings_from(kind: type[Kind], options: argparse.Namespace, **given: Any) -> Kind:
    """Return settings of a kind, each as given, or else as the options have it, or its default."""
    names = [item.name for item, _ in settings_of(kind)]
    read = {name: getattr(options, name) for name in names if hasattr(options, name)}
    return kind(**read | given)


def _reader(default: object, meaning: Meaning) -> Callable[[str], Any]:
    if isinstance(default, int):
        return whole(int(meaning.least), meaning.most)
    return number(meaning.least, meaning.most) if isinstance(default, float) else str
