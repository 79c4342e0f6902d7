"""The plain facts of a problem's initial state, read in one pass.

They are most of a large problem, and unified-planning's reader takes some twenty
times longer for them. All else in the state is left to that reader.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

import unified_planning.model as up
from unified_planning.exceptions import UPException

from mirror_explainer.errors import InputError
from mirror_explainer.pddl.expressions import Expressions
from mirror_explainer.pddl.text.sections import line_at, section, without_comments

_NAME = r'[a-z][a-z0-9_-]*'
# Not "(= (total-cost) 0)": the reader needs it to recognise action costs.
_PLAIN = re.compile(
    rf'\(\s*(?P<atom>{_NAME}(?:\s+{_NAME})*)\s*\)'
    rf'|\(\s*=\s*\(\s*(?P<function>{_NAME}(?:\s+{_NAME})+)\s*\)'
    r'\s*(?P<number>\d{1,30}(?:\.\d{1,30})?)\s*\)',
    re.IGNORECASE | re.ASCII,
)
# What unified-planning's reader takes for more than a predicate, whatever is declared.
_KEYWORDS = {'and', 'or', 'not', 'imply', 'forall', 'exists', 'oneof', 'unknown'} | {
    'always',
    'sometime',
    'sometime-before',
    'sometime-after',
    'at-most-once',
}


@dataclass(frozen=True)
class PlainFact:
    """An atom that holds, or a function's value; `line` is where it stands, from 1."""

    words: tuple[str, ...]
    value: Fraction | None
    line: int

    def __str__(self) -> str:
        atom = f'({" ".join(self.words)})'
        return atom if self.value is None else f'(= {atom} {self.value})'


def without_plain_facts(problem: str) -> tuple[str, list[PlainFact]]:
    """Return the problem without the plain facts of its initial state, and these facts.

    What remains keeps its lines. A state that is one conjunction remains as it is.
    """
    init = section(problem, ':init')
    if init is None:
        return problem, []
    plain = without_comments(problem)
    opening = re.compile(r'\(\s*:init(?![^\s()])', re.IGNORECASE).match(plain, init.start)
    if opening is None:
        return problem, []
    start, end = opening.end(), init.end - 1
    facts: list[PlainFact] = []
    kept: list[str] = []
    line, position = line_at(problem, start), start
    while position < end:
        found = _PLAIN.match(plain, position, end)
        words = (found['atom'] or found['function']).lower().split() if found else []
        if found and words[0] not in _KEYWORDS:
            value = None if found['number'] is None else Fraction(found['number'])
            facts.append(PlainFact(tuple(words), value, line))
            after, lines = found.end(), plain.count('\n', position, found.end())
            kept.append('\n' * lines)
        else:
            after = _item_end(plain, position, end)
            lines = plain.count('\n', position, after)
            kept.append(plain[position:after])
        line, position = line + lines, after
    rest = ''.join(kept)
    if re.match(r'\s*\(\s*and(?![^\s()])', rest, re.IGNORECASE):
        return problem, []
    return problem[:start] + rest + problem[end:], facts


def add_facts(model: up.Problem, facts: Sequence[PlainFact], source: str) -> None:
    """Put the facts into the problem's initial state.

    Raises InputError with the line of the first that does not fit the declarations.
    """
    manager = model.environment.expression_manager
    fluents = {fluent.name: fluent for fluent in model.fluents}
    objects = {item.name: manager.ObjectExp(item) for item in model.all_objects}
    for fact in facts:
        name, *arguments = fact.words
        if fact.value is None:
            value = manager.TRUE()
        elif fact.value.denominator == 1:
            value = manager.Int(fact.value.numerator)
        else:
            value = manager.Real(fact.value)
        try:
            atom = manager.FluentExp(fluents[name], [objects[word] for word in arguments])
            model.set_initial_value(atom, value)
        except (KeyError, AssertionError, UPException) as error:
            raise InputError(source, _fault(model, fact), fact.line) from error


def _item_end(plain: str, start: int, end: int) -> int:
    """Return where the expression, or what stands before the next one, ends."""
    depth = 0
    for parenthesis in re.compile(r'[()]').finditer(plain, start, end):
        if depth == 0 and parenthesis.start() > start:
            return parenthesis.start()
        depth += 1 if parenthesis[0] == '(' else -1
        if depth == 0:
            return parenthesis.end()
    return end


def _fault(model: up.Problem, fact: PlainFact) -> str:
    """Say in what a fact does not fit the declarations."""
    expressions = Expressions(model)
    if fact.value is None:
        expressions.atom(list(fact.words), {})
    return '; '.join(expressions.faults) or f'{fact} does not fit what the domain declares'
