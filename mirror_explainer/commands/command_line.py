"""What all commands and nodes are told on the command line: help with examples, and a version."""

import argparse
import textwrap
from functools import cache
from importlib.metadata import PackageNotFoundError, version

_WIDTH = 79  # of the texts in a command's help


def command_parser(
    name: str,
    description: str,
    *examples: str,
    ends: str = 'Exit status: 0, or 2 for bad input.',
) -> argparse.ArgumentParser:
    """Return a command's parser, which takes --version; its help ends with examples.

    `ends` is what it says last.
    """
    shown = '\n'.join(f'  {example}' for example in examples)
    parser = argparse.ArgumentParser(
        prog=name,
        description=textwrap.fill(description, _WIDTH),
        epilog=f'examples:\n{shown}\n\n{textwrap.fill(ends, _WIDTH)}',
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,  # or a part of a name, mistyped, is taken for another option
    )
    parser.add_argument('--version', action='version', version=f'%(prog)s {package_version()}')
    return parser


@cache
def package_version() -> str:
    """Return the version of this package as installed."""
    try:
        return version('mirror_explainer')
    except PackageNotFoundError:  # run from its sources
        return 'unknown'
