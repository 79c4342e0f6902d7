"""What PDDL texts and plans may cost, judged before anything slow works on them."""

import math
import re
from collections.abc import Sequence

import unified_planning.model as up
from unified_planning.model.walkers.linear_checker import LinearChecker

from mirror_explainer.errors import InputError
from mirror_explainer.input_limits import InputLimits
from mirror_explainer.pddl.text.sections import line_at, section, without_comments
from mirror_explainer.pddl.text.texts import Texts

# unified-planning's reader and Python's own stack end some levels deeper.
DEEPEST = 40
# A reader that works with exact numbers would write out all of the zeros.
_HUGE_NUMBER = re.compile(r'(?<![^\s()])[-+]?[\d._]*e[-+]?[\d_]{4,}(?![^\s()])', re.IGNORECASE)
_WORD = re.compile(r'[^\s()]+')


def require_shallow(text: str, source: str) -> None:
    """Raise InputError for parentheses nested too deeply, and for numbers beyond any use."""
    plain = without_comments(text)
    depth = 0
    for parenthesis in re.finditer(r'[()]', plain):
        depth += 1 if parenthesis[0] == '(' else -1
        if depth > DEEPEST:
            raise InputError(
                source,
                f'the text is nested too deeply: more than {DEEPEST} parentheses in each other',
                line_at(plain, parenthesis.start()),
            )
    huge = _HUGE_NUMBER.search(plain)
    if huge:
        raise InputError(
            source, f'the number {huge[0]} is too large or too small', line_at(plain, huge.start())
        )


def require_few(texts: Texts, limits: InputLimits) -> None:
    """Raise InputError for more objects or words than the limits allow.

    The problem is to be without its plain facts, which cost little to read.
    """
    objects = _names(texts.domain, ':constants') + _names(texts.problem, ':objects')
    limits.require('max_objects', objects, 'its objects', texts.problem_source)
    for text, source in (
        (texts.domain, texts.domain_source),
        (texts.problem, texts.problem_source),
    ):
        words = len(_WORD.findall(without_comments(text)))
        limits.require('max_words', words, 'its words, plain facts left out,', source)


def require_steady_numbers(model: up.Problem, source: str) -> None:
    """Raise InputError for effects whose numbers could grow beyond all bounds in a short plan."""
    checker = LinearChecker(model)
    for action in model.actions:
        if not isinstance(action, up.InstantaneousAction):
            continue
        for effect in action.effects:
            if not effect.value.type.is_bool_type() and not checker.get_fluents(effect.value)[0]:
                raise InputError(
                    source,
                    f'"{action.name}" multiplies or divides numbers that change: '
                    f'{effect.value} cannot be explained',
                )


def instances(model: up.Problem, actions: Sequence[up.Action]) -> int:
    """Return how many facts and numbers a check of a plan with these actions looks at.

    What stands under a quantifier counts once for each object.
    """
    known: dict[up.FNode | up.Action, int] = {}

    def each(variables: Sequence[up.Variable]) -> int:
        return math.prod(len(list(model.objects(v.type))) for v in variables)

    def size(expression: up.FNode) -> int:
        if expression not in known:
            inside = sum(map(size, expression.args)) if not expression.is_fluent_exp() else 0
            quantified = expression.is_forall() or expression.is_exists()
            times = each(expression.variables()) if quantified else 1
            known[expression] = max(1, inside) * times
        return known[expression]

    def size_of(action: up.InstantaneousAction) -> int:
        if action not in known:
            known[action] = sum(map(size, action.preconditions)) + sum(
                each(effect.forall) * (size(effect.condition) + size(effect.value))
                for effect in action.effects
            )
        return known[action]

    return sum(map(size_of, actions)) + sum(map(size, model.goals))


def _names(text: str, keyword: str) -> int:
    """Return how many names a section declares, types left out."""
    part = section(text, keyword)
    if part is None:
        return 0
    words = _WORD.findall(without_comments(text)[part.start : part.end])[1:]
    return len(words) - 2 * words.count('-')
