"""Tables of the reports, in Markdown."""

import pandas as pd


def markdown_table(table: pd.DataFrame) -> str:
    """Return a table in Markdown: p with four digits, what is missing as a dash."""
    formats = tuple('.4f' if column in ('p', 'p_holm') else '.2f' for column in table.columns)
    told = table.astype(object).where(table.notna(), None)
    return str(told.to_markdown(index=False, floatfmt=formats, missingval='–'))
