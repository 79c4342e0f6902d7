"""The tables of docs/results.md, made from the files that the commands wrote.

Between `<!-- table NAME -->` and `<!-- end -->` stands the table of NAME.csv:
`python3 -m mirror_explainer.experiments.documented docs/results.md docs/results`.
"""

import re
import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import pandas as pd

from mirror_explainer.experiments.markdown import markdown_table
from mirror_explainer.experiments.study.speakers import speakers_table
from mirror_explainer.experiments.understanding.report import TABLES

_BLOCK = re.compile(r'(<!-- table (\w+) -->\n)(.*?)(\n<!-- end -->)', re.DOTALL)
# What is shown of a file; of the others, all.
_SHOWN: Mapping[str, Callable[[pd.DataFrame], pd.DataFrame]] = {
    **TABLES,
    'speakers': speakers_table,
    'pucrs_domains': lambda table: table.round(2),
    # Of simulated listeners, who have no p, and hear words for a planner.
    'tests': lambda table: table.drop(columns='strategy').dropna(axis='columns', how='all'),
}


def filled(text: str, folder: Path) -> str:
    """Return a page's text with every table anew from the folder's files."""

    def block(found: re.Match[str]) -> str:
        name = found[2]
        table = pd.read_csv(folder / f'{name}.csv', keep_default_na=False, na_values=[''])
        shown = _SHOWN.get(name, pd.DataFrame)(table)
        return f'{found[1]}\n{_without_padding(markdown_table(shown))}\n{found[4]}'

    return _BLOCK.sub(block, text)


def _without_padding(table: str) -> str:
    """Return a Markdown table without spaces that only line its columns up."""
    return re.sub(r' {2,}', ' ', re.sub(r'-{4,}', '---', table))


def main(arguments: Sequence[str] | None = None) -> int:
    """Fill the tables of a page."""
    page, folder = map(Path, sys.argv[1:] if arguments is None else arguments)
    page.write_text(filled(page.read_text('utf-8'), folder), 'utf-8')
    return 0


if __name__ == '__main__':
    sys.exit(main())
