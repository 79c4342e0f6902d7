"""What a command says on a terminal: errors and numbers in colour, and never in a pipe."""

import argparse
import sys
from collections.abc import Iterable, Sequence
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec

from mirror_explainer.errors import told


def add_version(parser: argparse.ArgumentParser) -> None:
    """Let a command take --version."""
    try:
        number = version('mirror_explainer')
    except PackageNotFoundError:  # run from its sources
        number = 'unknown'
    parser.add_argument('--version', action='version', version=f'%(prog)s {number}')


def tell_error(program: str, error: Exception) -> None:
    """Tell an error on stderr; on a terminal in red, where rich is there to do so."""
    line = f'{program}: {told(error)}'
    if find_spec('rich') is None or not sys.stderr.isatty():
        print(line, file=sys.stderr)
        return
    from rich.console import Console
    from rich.text import Text

    Console(stderr=True).print(Text(line, 'bold red'))


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
