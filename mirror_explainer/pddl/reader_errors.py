"""What the errors of unified-planning's reader mean: its words are about its own inside."""

import re

import pyparsing
from unified_planning.exceptions import UPException

from mirror_explainer.errors import InputError
from mirror_explainer.pddl.sections import line_of

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


def input_error(error: Exception, text: str, source: str, hint: str) -> InputError:
    """Return the reader's error in plain words, with the line where it can be known."""
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
    return InputError(source, message + hint, line, cure=_UNREADABLE)


def _word(name: str) -> str:
    """Return the regular expression of a whole name."""
    return rf'(?<![\w-]){re.escape(name)}(?![\w-])'
