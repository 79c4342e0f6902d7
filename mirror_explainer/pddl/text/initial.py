"""What a problem says of its initial state, fact by fact."""

from fractions import Fraction

from mirror_explainer.errors import InputError, did_you_mean
from mirror_explainer.pddl.text.definition import Definition, unequal
from mirror_explainer.pddl.text.numerals import number
from mirror_explainer.pddl.text.tree import Branch, Word, as_text


def initial_values(problem: Definition) -> list[tuple[Branch, bool | Fraction]]:
    """Return what :init says: atoms that hold or do not, and functions with their numbers.

    Raises InputError with the line of what is neither, or of another number for a function.
    """
    found: list[tuple[Branch, bool | Fraction]] = []
    numbers: dict[tuple[str, ...], tuple[Fraction, Branch]] = {}
    parts = problem.contents(':init')
    if len(parts) == 1 and isinstance(parts[0], Branch) and parts[0].head == 'and':
        parts = parts[0][1:]
    for part in parts:
        head = part.head if isinstance(part, Branch) else ''
        if isinstance(part, Branch) and head == '=' and len(part) == 3:
            function, value = part[1:]
            amount = number(value) if isinstance(value, Word) else None
            if isinstance(value, Branch) and value.head == '-' and len(value) == 2:
                amount = -(number(str(value[1])) or Fraction(0))
            if isinstance(function, Word):
                function = part.like([function])
            if amount is None or not function.head:
                reason = f'"{as_text(part)[:80]}" gives no number'
                raise InputError(problem.source, reason, part.line)
            first = numbers.setdefault(tuple(map(str, function)), (amount, part))
            if first[0] != amount:
                raise unequal(f'the value of {as_text(function)}', first[1], part, problem.source)
            found.append((function, amount))
        elif (
            isinstance(part, Branch)
            and head == 'not'
            and len(part) == 2
            and isinstance(part[1], Branch)
        ):
            found.append((part[1], False))
        elif isinstance(part, Branch) and head and head not in ('and', 'or', '=', 'not'):
            found.append((part, True))
        else:
            shown = as_text(part)[:80]
            hint = did_you_mean(head, ['and'])
            raise InputError(
                problem.source,
                f'"{shown}" is no fact that can hold initially{hint}',
                part.line,
            )
    return found
