"""Tables of the reports, in Markdown."""

from collections.abc import Iterable, Sequence

import pandas as pd


def markdown_table(table: pd.DataFrame) -> str:
    """Return a table in Markdown: p with four digits, what is missing as a dash."""
    formats = tuple('.4f' if column in ('p', 'p_holm') else '.2f' for column in table.columns)
    told = table.astype(object).where(table.notna(), None)
    return str(told.to_markdown(index=False, floatfmt=formats, missingval='–'))


def worded_table(headings: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """Return a table in Markdown of cells that are texts already, the first of each row a name."""
    lines = [f'| {" | ".join(map(str, cells))} |' for cells in (headings, *rows)]
    lines.insert(1, '|:--' + '|--:' * (len(headings) - 1) + '|')
    return '\n'.join(lines)
