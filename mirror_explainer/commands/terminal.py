"""How all commands speak: on a terminal, never in a pipe, in colour."""

import sys
from collections.abc import Iterable, Sequence
from importlib.util import find_spec
from typing import TextIO

from mirror_explainer.errors import told


def tell(text: str, style: str = '') -> None:
    """Print a text on stdout; on a terminal in this style, where rich is there to do so."""
    _print(text, style, sys.stdout)


def tell_warning(program: str, warning: str) -> None:
    """Tell a warning on stderr; on a terminal in yellow, likewise."""
    _print(f'{program}: warning: {warning}', 'yellow', sys.stderr)


def tell_error(program: str, error: Exception) -> None:
    """Tell an error on stderr; on a terminal in red, likewise."""
    _print(f'{program}: {told(error)}', 'bold red', sys.stderr)


def _print(text: str, style: str, file: TextIO) -> None:
    if not style or not file.isatty() or find_spec('rich') is None:
        print(text, file=file, flush=True)
        return
    from rich.console import Console
    from rich.text import Text

    Console(file=file).print(Text(text, style), soft_wrap=True)


def tell_table(
    title: str, columns: Sequence[str], rows: Iterable[tuple[Sequence[str], bool]]
) -> None:
    """Print a table on stdout; each row says whether it is to stand out. Needs rich."""
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    table = Table(title=title, title_justify='left', box=None, pad_edge=False)
    for index, column in enumerate(columns):
        table.add_column(column, justify='left' if index == 0 else 'right')
    for cells, stands_out in rows:
        table.add_row(*(Text(cell, 'bold green' if stands_out else '') for cell in cells))
    Console().print(table)
