"""The sections of a PDDL text, found without reading it, and edits that keep its lines.

For what unified-planning's reader refuses, or would misread, or names no line for.
"""

import re
from dataclasses import dataclass

_TOTAL_TIME = re.compile(r':metric\s+minimize\s*\(?\s*total-time\s*\)?\s*\)', re.IGNORECASE)
_COST_EFFECT = re.compile(r'\(\s*increase\s*\(\s*total-cost\s*\)', re.IGNORECASE)


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


def line_at(text: str, position: int) -> int:
    """Return the line, from 1, of a position in the text."""
    return text.count('\n', 0, position) + 1


def line_of(pattern: str, text: str) -> int | None:
    """Return the first line outside comments, from 1, that a regular expression fits, or None."""
    found = re.search(pattern, without_comments(text), re.IGNORECASE)
    return line_at(text, found.start()) if found else None


def blanked(text: str, start: int, end: int, instead: str = '') -> str:
    """Return the text with something shorter instead of a piece, and its lines where they were."""
    blanks = re.sub(r'\S', ' ', text[start:end])
    if '\n' in blanks[: len(instead)] or len(instead) > len(blanks):
        return text[:start] + instead + blanks + text[end:]
    return text[:start] + instead + blanks[len(instead) :] + text[end:]


def without_total_time(problem: str) -> str:
    """Return the problem without a metric that asks for the least total time."""
    metric = section(problem, ':metric')
    if metric and _TOTAL_TIME.search(without_comments(problem)[metric.start : metric.end]):
        return blanked(problem, metric.start, metric.end)
    return problem


def without_costs(domain: str) -> str:
    """Return the domain with an empty effect for every one that raises the total cost."""
    plain = without_comments(domain)
    for found in _COST_EFFECT.finditer(plain):
        depth = 0
        for parenthesis in re.compile(r'[()]').finditer(plain, found.start()):
            depth += 1 if parenthesis[0] == '(' else -1
            if depth == 0:
                domain = blanked(domain, found.start(), parenthesis.end(), '(and)')
                break
    return domain


def without_values(problem: str, function: str) -> str:
    """Return the problem without the initial values of a function."""
    value = rf'\(\s*=\s*\(\s*{re.escape(function)}(?![^\s()])[^()]*\)[^()]*\)'
    for found in re.finditer(value, without_comments(problem), re.IGNORECASE):
        problem = blanked(problem, found.start(), found.end())
    return problem
