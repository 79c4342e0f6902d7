"""A PDDL text as a tree of words, each of which knows its line and column.

Made once; all that is read of a text is read from here. Letter case, comments,
byte-order marks and line ends are gone: what is left is what PDDL tells apart.
"""

import re
from collections.abc import Callable, Iterable, Iterator
from typing import TypeAlias

from mirror_explainer.errors import InputError
from mirror_explainer.text_files import plain_text

# unified-planning and Python's own stack end some levels deeper.
DEEPEST = 40
_TOKEN = re.compile(r';[^\n]*|[^\s();]+|[()\n]')
_NAME = re.compile(r'\w[-\w.#@/+]*')
# Exact arithmetic would write out all of the zeros.
_HUGE_NUMBER = re.compile(r'[-+]?(?:[\d._]*e[-+]?[\d_]{4,}|[\d._]{1000,})', re.IGNORECASE)


class Word(str):
    """A word in lower case; `written` is it as it was; `line` and `column` count from 1."""

    __slots__ = ('column', 'line', 'written')
    line: int
    column: int
    written: str

    def __new__(cls, text: str, line: int = 1, column: int = 1) -> 'Word':
        """Make a word at a place."""
        made = super().__new__(cls, text.lower())
        made.written = text
        made.line = line
        made.column = column
        return made


class Branch(list['Tree']):
    """What stands between two parentheses; `line` and `column` are those of the first."""

    __slots__ = ('column', 'line')
    line: int
    column: int

    def __init__(self, parts: Iterable['Tree'] = (), line: int = 1, column: int = 1) -> None:
        super().__init__(parts)
        self.line = line
        self.column = column

    @property
    def head(self) -> str:
        """The first word, '' if there is none."""
        return self[0] if self and isinstance(self[0], str) else ''

    def like(self, parts: Iterable['Tree']) -> 'Branch':
        """Return other parts at this place."""
        return Branch(parts, self.line, self.column)


Tree: TypeAlias = Word | Branch


def parse(text: str, source: str, stop: Callable[[], None] | None = None) -> list[Tree]:
    """Return all that stands in a text, one after the other.

    `stop` is called now and then, and may raise. Raises InputError, with the line, for
    parentheses that do not match, and for what is nested too deeply.
    """
    text = plain_text(text)
    found: list[Tree] = []
    parts, open_branches = found, list[Branch]()
    line, line_start = 1, -1
    for count, match in enumerate(_TOKEN.finditer(text)):
        token = match[0]
        if token == '(':
            branch = Branch((), line, match.start() - line_start)
            parts.append(branch)
            open_branches.append(branch)
            parts = branch
            if len(open_branches) > DEEPEST:
                reason = f'the text is nested too deeply: more than {DEEPEST} parentheses in '
                raise InputError(source, f'{reason}each other', line)
        elif token == ')':
            if not open_branches:
                raise InputError(
                    source,
                    'there is a closing parenthesis here too many',
                    line,
                    cure='See whether the parentheses before it match.',
                )
            open_branches.pop()
            parts = open_branches[-1] if open_branches else found
        elif token == '\n':
            line, line_start = line + 1, match.start()
        elif token[0] != ';':
            parts.append(Word(token, line, match.start() - line_start))
        if stop and count % 10_000 == 0:
            stop()
    if open_branches:
        raise _unclosed(open_branches[0], open_branches[-1], source)
    return found


_BALANCE = 'See whether the text was cut off, and its parentheses match.'


def _unclosed(whole: Branch, last: Branch, source: str) -> InputError:
    """Say which parenthesis has no match: the one in which a keyword stands that cannot.

    `whole` and `last` are the first and the last that are still open at the end of the text.
    """
    swallowed = [
        (part, outer)
        for outer in branches(whole)
        for part in outer[1:]
        if outer is not whole and _is_keyword(part, outer)
    ]
    if swallowed:
        part, outer = min(swallowed, key=lambda pair: (pair[0].line, pair[0].column))
        shown = f'({part.head}' if isinstance(part, Branch) else part
        return InputError(
            source,
            f'"({outer.head}" is not closed before "{shown}" begins on line {part.line}',
            outer.line,
        )
    shown = f'"({last.head}"' if last.head else 'a parenthesis'
    return InputError(source, f'the text ends before {shown} is closed', last.line, cure=_BALANCE)


def _is_keyword(part: Tree, outer: Branch) -> bool:
    """Say whether a section begins here, or a part of one outside of every section."""
    if isinstance(part, Branch):
        return part.head.startswith(':')
    return part.startswith(':') and not outer.head.startswith(':')


def expression(text: str, source: str) -> Tree:
    """Return the one expression that a text is. Raises InputError."""
    try:
        found = parse(text, source)
    except InputError as error:
        if 'deeply' in error.reason:
            raise InputError(source, error.reason) from error
        found = []
    if len(found) != 1 or not isinstance(found[0], Branch):
        shown = text.strip()[:80]
        raise InputError(source, f'"{shown}" is not one expression in balanced parentheses')
    return found[0]


def require_usual_numbers(tree: Branch, source: str) -> None:
    """Raise InputError for numbers beyond any use."""
    for word in words(tree):
        if _HUGE_NUMBER.fullmatch(word):
            shown = word[:40]
            raise InputError(source, f'the number {shown} is too large or too small', word.line)


def require_name(name: Word, source: str) -> None:
    """Raise InputError for a name that no text of ours could hold safely, or at all."""
    if not _NAME.fullmatch(name):
        reason = f'"{name[:80]}" is no name: one begins with a letter, digit or _, and may have '
        reason += '- . # @ / + after that'
        if name[0] in '"\'':
            reason = f'{name[:80]} is no name: leave the quotes out'
        raise InputError(source, reason, name.line)


def words(tree: Tree) -> Iterator[Word]:
    """Yield all words, in order."""
    if isinstance(tree, Word):
        yield tree
    else:
        for part in tree:
            yield from words(part)


def has_word(text: str, tree: Tree) -> bool:
    """Say whether a word occurs in a tree."""
    return any(found == text for found in words(tree))


def branches(tree: Tree) -> Iterator[Branch]:
    """Yield every branch, the outer ones first."""
    if isinstance(tree, Branch):
        yield tree
        for part in tree:
            yield from branches(part)


def word(text: str, place: Tree) -> Word:
    """Return a word that stands for what was at the place."""
    return Word(text, place.line, place.column)


def made(text: str, place: Tree) -> Branch:
    """Return "(some (expression))", all of it at one place."""

    def moved(tree: Tree) -> Tree:
        if isinstance(tree, Word):
            return word(tree, place)
        return place_of(map(moved, tree))

    def place_of(parts: Iterable[Tree]) -> Branch:
        return Branch(parts, place.line, place.column)

    moved_tree = moved(expression(text, 'made up'))
    assert isinstance(moved_tree, Branch)
    return moved_tree


def as_text(tree: object) -> str:
    """Return a tree as it stands in PDDL, with single spaces."""
    if isinstance(tree, str):
        return str(tree)
    assert isinstance(tree, list)
    return f'({" ".join(as_text(part) for part in tree)})'


def layout(tree: Branch) -> str:
    """Return a text of the tree: what stood on one line stands on one line again."""
    pieces: list[str] = []
    line = tree.line

    def write(part: Tree) -> None:
        nonlocal line
        if part.line != line:
            pieces.append('\n')
            line = part.line
        elif pieces and pieces[-1] not in ('(', '\n'):
            pieces.append(' ')
        if isinstance(part, Branch):
            pieces.append('(')
            for inner in part:
                write(inner)
            pieces.append(')')
        else:
            pieces.append(part)

    write(tree)
    return ''.join(pieces) + '\n'
