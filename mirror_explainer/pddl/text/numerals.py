"""Words that are numbers."""

import re
from fractions import Fraction

_NUMBER = re.compile(r'[-+]?(?:\d+(?:\.\d*)?|\.\d+)(?:e[-+]?\d{1,3})?', re.IGNORECASE)


def number(text: str) -> Fraction | None:
    """Return the number that a word is, None if it is none."""
    return Fraction(text) if _NUMBER.fullmatch(text) else None
