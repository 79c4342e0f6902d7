"""Where the sections of a PDDL text stand, for whoever edits texts without reading them."""

import re
from dataclasses import dataclass


@dataclass(frozen=True)
class Section:
    """One part of a definition: its keyword in lower case, and from where to where it goes."""

    keyword: str
    start: int
    end: int


def without_comments(text: str) -> str:
    """Return the text with blanks for comments: every other character stays in its place."""
    return re.sub(r';[^\n]*', lambda comment: ' ' * len(comment[0]), text)


def sections(text: str) -> list[Section]:
    """Return the parts of a definition, as far as its parentheses are balanced."""
    plain, found, depth, start = without_comments(text), [], 0, 0
    for parenthesis in re.finditer(r'[()]', plain):
        if parenthesis[0] == '(':
            depth += 1
            if depth == 2:
                start = parenthesis.start()
        else:
            depth -= 1
            if depth == 1:
                keyword = re.match(r'\(\s*([^\s()]*)', plain[start : start + 200])
                assert keyword is not None  # it starts with a parenthesis
                found.append(Section(keyword[1].lower(), start, parenthesis.end()))
    return found


def section(text: str, keyword: str) -> Section | None:
    """Return the first section with the keyword, None if there is none."""
    return next((part for part in sections(text) if part.keyword == keyword), None)
