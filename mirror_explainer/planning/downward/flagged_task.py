"""Edits of a task with which a search finds the operators of optimal plans.

One more variable is a flag that only operators not seen yet set, and that the
goal demands: a plan no costlier than the optimum has an operator not seen yet,
and where there is no such plan all operators of optimal plans have been seen.
"""

from collections.abc import Collection, Sequence
from dataclasses import replace

from mirror_explainer.planning.downward.ground_task import Fact, GroundTask, Operator

_FLAG = 'begin_variable\nflag\n-1\n2\nAtom flag()\nNegatedAtom flag()\nend_variable\n'

# A flag that is up, and one that is not.
UP, DOWN = 0, 1

# With free actions, a cost counts this much, and an action 1: so the shortest of the cheapest
# plans are the optimal ones, and no plan goes on for nothing.
_COST_UNIT = 1000
_LARGEST_SUM = 1_000_000_000


def useful(task: GroundTask, goal: Sequence[Fact]) -> GroundTask:
    """Return the task without the operators that help nothing towards a goal.

    They are in no optimal plan, as no operator is free.
    """
    needed = set(goal)
    left = set(range(len(task.operators)))
    while helping := {i for i in left if not needed.isdisjoint(task.operators[i].effect)}:
        left -= helping
        needed.update(fact for index in helping for fact in task.operators[index].condition)
    kept = (operator for i, operator in enumerate(task.operators) if i not in left)
    return replace(task, operators=tuple(kept)) if left else task


def flagged(task: GroundTask, variables: int, seen: Collection[str]) -> GroundTask:
    """Return the task with a flag as its last variable, which operators not seen put up."""
    count, rest = task.head.split('\nend_metric\n', 1)
    number, rest = rest.split('\n', 1)
    end = rest.rindex('end_variable\n') + len('end_variable\n')
    head = f'{count}\nend_metric\n{int(number) + 1}\n{rest[:end]}{_FLAG}{rest[end:]}'
    up = (variables, UP)
    operators = (o if o.name in seen else _with_effect(o, up) for o in task.operators)
    return replace(task, head=head, operators=tuple(operators))


def with_positive_costs(task: GroundTask) -> GroundTask | None:
    """Return the task with no free actions, in which the optimal plans are also the shortest.

    The task itself if it has none; None if the costs get too large for the search.
    """
    if all(operator.cost for operator in task.operators):
        return task
    if sum(operator.cost for operator in task.operators) * _COST_UNIT > _LARGEST_SUM:
        return None
    operators = (_with_cost(o, o.cost * _COST_UNIT + 1) for o in task.operators)
    return replace(task, operators=tuple(operators))


def _with_effect(operator: Operator, fact: Fact) -> Operator:
    """Return the operator with one more effect, whatever held before."""
    variable, value = fact
    lines = operator.text.split('\n')
    place = 3 + int(lines[2])  # after its name and the conditions that nothing changes
    lines[place] = str(int(lines[place]) + 1)
    lines.insert(place + 1, f'0 {variable} -1 {value}')
    return replace(operator, effect=(*operator.effect, fact), text='\n'.join(lines))


def _with_cost(operator: Operator, cost: int) -> Operator:
    """Return the operator with another cost."""
    *before, _, end, nothing = operator.text.split('\n')
    return replace(operator, cost=cost, text='\n'.join([*before, str(cost), end, nothing]))
