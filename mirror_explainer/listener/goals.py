"""What goals mean: the parts that each is made of, and when two are the same.

A goal's meaning is its formula with quantifiers expanded over the objects, in negation
normal form, and with conjunctions and disjunctions as sets (method, section 1).
"""

from collections.abc import Hashable
from dataclasses import dataclass, field

import unified_planning.model as up
from unified_planning.model.walkers import ExpressionQuantifiersRemover, Nnf

from mirror_explainer.pddl import condition_text, conjuncts


@dataclass(frozen=True)
class Part:
    """A top conjunct of a goal: a literal, a comparison or a disjunction.

    Parts are equal where they mean the same. `condition` is ground and free of quantifiers.
    """

    meaning: Hashable
    condition: up.FNode = field(compare=False, repr=False)

    def __str__(self) -> str:
        return condition_text(self.condition)


def parts_of(goal: up.FNode, problem: up.Problem) -> tuple[Part, ...]:
    """Return the different parts of a goal, in the order in which they are written.

    Two goals are equal when the sets of their parts are. `problem` has the objects.
    """
    environment = goal.environment
    ground = ExpressionQuantifiersRemover(environment).remove_quantifiers(goal, problem)
    normal = Nnf(environment).get_nnf_expression(environment.simplifier.simplify(ground))
    parts = (Part(_meaning(conjunct), conjunct) for conjunct in conjuncts(normal))
    return tuple(dict.fromkeys(parts))


def _meaning(condition: up.FNode) -> Hashable:
    """Return the same value for conditions that differ in order and nesting only."""
    for connective in ('and', 'or'):
        if _is(connective, condition):
            means: frozenset[Hashable] = frozenset(map(_meaning, _joined(connective, condition)))
            return (connective, means) if len(means) > 1 else next(iter(means))
    meaning: Hashable = condition
    return meaning


def _joined(connective: str, condition: up.FNode) -> list[up.FNode]:
    """Return what one connective joins, nested or not."""
    if not _is(connective, condition):
        return [condition]
    return [joined for argument in condition.args for joined in _joined(connective, argument)]


def _is(connective: str, condition: up.FNode) -> bool:
    return bool(condition.is_and() if connective == 'and' else condition.is_or())
