"""What PDDL texts and plans may cost, judged before anything slow works on them."""

import math
from collections.abc import Sequence

import unified_planning.model as up

from mirror_explainer.input_limits import InputLimits
from mirror_explainer.pddl.text.definition import Definition
from mirror_explainer.pddl.text.tree import Word, words


def require_few(domain: Definition, problem: Definition, limits: InputLimits) -> None:
    """Raise InputError for more objects or words than the limits allow.

    Facts that hold initially do not count among the words: they cost little to read.
    """
    listed = [*domain.contents(':constants'), *problem.contents(':objects')]
    objects = sum(isinstance(part, Word) for part in listed) - 2 * listed.count('-')  # type: ignore[arg-type]
    limits.require('max_objects', objects, 'its objects', problem.source)
    for definition in (domain, problem):
        others = definition.without(':init').sections.values()
        counted = sum(1 for parts in others for part in parts for _ in words(part))
        limits.require(
            'max_words', counted, 'its words, initial facts left out,', definition.source
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
