"""What the errors of unified-planning's reader mean: its words are about its own inside."""

import re
from collections.abc import Iterable

import pyparsing
from unified_planning.exceptions import UPException

from mirror_explainer.errors import InputError, did_you_mean
from mirror_explainer.pddl.text.sections import (
    line_at,
    line_of,
    section,
    sections,
    without_comments,
)

# What unified-planning's reader raises for a text that is no good, besides a bare
# AssertionError or a Python error from deep inside it for the odder ones.
READER_ERRORS = (
    pyparsing.ParseBaseException,
    SyntaxError,
    UPException,
    AssertionError,
    AttributeError,
    IndexError,
    KeyError,
    TypeError,
    ValueError,
    RecursionError,
)

_UNREADABLE = (
    'See whether the text was cut off, its parentheses match, and all its names are declared.'
)
_DECLARING = {':types', ':constants', ':objects', ':predicates', ':functions'}
_UNKNOWN = re.compile(
    r"""unknown name (?:in \(|")([\w-]+)|type: ([\w-]+)|'([\w-]+)' is not decl"""
)
# Each is looked for in the whole text.
_ATOMS_TO_FIND = 10
# What the reader's grammar has.
_REQUIREMENTS = (
    ':strips', ':typing', ':negative-preconditions', ':disjunctive-preconditions', ':equality',
    ':existential-preconditions', ':universal-preconditions', ':quantified-preconditions',
    ':conditional-effects', ':fluents', ':numeric-fluents', ':adl', ':durative-actions',
    ':duration-inequalities', ':timed-initial-literals', ':timed-initial-effects',
    ':action-costs', ':hierarchy', ':method-preconditions', ':constraints', ':contingent',
    ':preferences', ':time', ':continuous-effects',
)  # fmt: skip


def require_known_requirements(domain: str, source: str) -> None:
    """Raise InputError for the first requirement that unified-planning does not know."""
    part = section(domain, ':requirements')
    if part is None:
        return
    after = part.start + 1 + len(part.keyword)
    for found in re.compile(r':[^\s()]+').finditer(without_comments(domain), after, part.end):
        name = found[0].lower()
        if name not in _REQUIREMENTS:
            hint = did_you_mean(name, _REQUIREMENTS)
            raise InputError(
                source,
                f'unified-planning knows no requirement "{name}"{hint}',
                line_at(domain, found.start()),
                cure='' if hint else 'Leave it out, if the domain can do without.',
            )


def declared_names(*texts: str) -> list[str]:
    """Return the names of all types, objects, predicates and functions in some definitions."""
    names = set()
    for text in texts:
        plain = without_comments(text).lower()
        for part in sections(text):
            if part.keyword in _DECLARING:
                words = re.findall(r'[^\s()]+', plain[part.start : part.end])
                names |= {word for word in words if word[0] not in '?:-'}
    return sorted(names)


def input_error(
    error: Exception, text: str, source: str, hint: str, names: Iterable[str] = ()
) -> InputError:
    """Return the reader's error in plain words, with the line where it can be known.

    `names` are those that a misspelt one may mean.
    """
    if isinstance(error, pyparsing.ParseBaseException):
        found = str(error).split('  (at char')[0]
        near = f'in "{error.line.strip()[:60]}"' if error.line.strip() else 'at the end'
        reason = f'no PDDL that can be read: {found} {near}{hint}'
        return InputError(source, reason, error.lineno, cure=_UNREADABLE)
    if isinstance(error, RecursionError):
        return InputError(source, 'the text is nested too deeply')
    if isinstance(error, (AssertionError, AttributeError, IndexError, TypeError)) and not (
        isinstance(error, UPException)
    ):
        # Python's words about the reader's inside; only its assertions may say something.
        reason = (
            'one of its expressions is malformed: are all its parts there, and its names known?'
        )
        detail = f' ({error})' if isinstance(error, AssertionError) and str(error) else ''
        return InputError(source, reason + detail + hint, cure=_UNREADABLE)
    message = str(error).strip() or type(error).__name__
    said = re.search(r'line:? (\d+)', message)
    message = re.split(
        r'[,.\s]*(?:found at|error from|error in expression from|from|\bline:)(?= line| ?\d)',
        message.replace('\\n', '\n'),
        flags=re.IGNORECASE,
    )[0]
    message = re.sub(r'^UP\w+\(["\'](.*?)["\']\)$', r'\1', message.strip())
    message = re.sub(
        r'^(Not able to handle|Found invalid expression): ', 'unknown name in ', message
    )
    message = re.sub(r'^unknown name in ([\w-]+)$', r'unknown name "\1"', message)
    message = re.sub(r'<\S+ object at 0x\w+>', 'one of its expressions', message)
    message = message.split(' Different elements')[0].rstrip('.!').removeprefix('In FluentExp, ')
    message = message.replace(
        'is not well-formed', 'does not fit its declaration: are its arguments of the right types?'
    )
    if isinstance(error, KeyError):
        message = f'{message} is not declared'
    name = re.search(r"'([\w-]+)'|Name ([\w-]+)", message)
    line = int(said[1]) if said else line_of(_word(name[1] or name[2]), text) if name else None
    if line is None:
        line = _line_of_atoms(message, text)
    likely = _likely(message, names)
    return InputError(source, message + likely + hint, line, cure='' if likely else _UNREADABLE)


def _likely(message: str, names: Iterable[str]) -> str:
    """Return which of the names may be meant by the unknown one that an error tells of, or ''."""
    found = _UNKNOWN.search(message)
    if found is None:
        return ''
    unknown = next(filter(None, found.groups())).lower()
    return did_you_mean(unknown, [name for name in names if name != unknown])


def _line_of_atoms(message: str, text: str) -> int | None:
    """Return where an expression "a(x) and b(x, y)" begins, None if that is not sure.

    Sure it is if only one section of the text has its atoms.
    """
    atoms = re.findall(r'([\w-]+)\(([\w-]+(?:, [\w-]+)*)\)', message)[:_ATOMS_TO_FIND]
    words = [map(re.escape, [name, *arguments.split(', ')]) for name, arguments in atoms]
    patterns = [
        re.compile(r'\(\s*' + r'\s+\??'.join(those) + r'\s*\)', re.IGNORECASE) for those in words
    ]
    plain, starts = without_comments(text), []
    for part in sections(text) if patterns else ():
        found = [pattern.search(plain, part.start, part.end) for pattern in patterns]
        places = [match.start() for match in found if match]
        if len(places) == len(patterns):
            starts.append(min(places))
    return line_at(text, starts[0]) if len(starts) == 1 else None


def _word(name: str) -> str:
    """Return the regular expression of a whole name."""
    return rf'(?<![\w-]){re.escape(name)}(?![\w-])'
