"""Edits of a task's text with which a search finds the operators of optimal plans.

One more variable is a flag that only operators not seen yet set, and that the
goal demands: a plan no costlier than the optimum has an operator not seen yet,
and where there is no such plan all operators of optimal plans have been seen.
"""

from collections.abc import Collection, Sequence
from dataclasses import replace

from mirror_explainer.planning.ground_task import Fact, GroundTask

_FLAG = 'begin_variable\nflag\n-1\n2\nAtom flag()\nNegatedAtom flag()\nend_variable\n'
_OPERATOR = 'begin_operator\n'
_END = 'end_operator\n'

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
    if not left:
        return task
    _, *blocks = task.tail.split(_OPERATOR)
    last, axioms = blocks[-1].split(_END)
    blocks[-1] = last + _END
    kept = [index for index in range(len(blocks)) if index not in left]
    tail = _OPERATOR.join([f'{len(kept)}\n', *(blocks[index] for index in kept)])
    operators = tuple(task.operators[index] for index in kept)
    return replace(task, operators=operators, tail=tail + axioms)


def flagged(task: GroundTask, variables: int, seen: Collection[str]) -> GroundTask:
    """Return the task with a flag as its last variable, which operators not seen put up."""
    count, rest = task.head.split('\nend_metric\n', 1)
    number, rest = rest.split('\n', 1)
    end = rest.rindex('end_variable\n') + len('end_variable\n')
    head = f'{count}\nend_metric\n{int(number) + 1}\n{rest[:end]}{_FLAG}{rest[end:]}'
    first, *blocks = task.tail.split(_OPERATOR)
    edited = [
        block if operator.name in seen else _with_effect(block, f'0 {variables} -1 {UP}')
        for operator, block in zip(task.operators, blocks, strict=True)
    ]
    return replace(task, head=head, tail=_OPERATOR.join([first, *edited]))


def with_positive_costs(task: GroundTask) -> GroundTask | None:
    """Return the task with no free actions, in which the optimal plans are also the shortest.

    The task itself if it has none; None if the costs get too large for the search.
    """
    if all(operator.cost for operator in task.operators):
        return task
    if sum(operator.cost for operator in task.operators) * _COST_UNIT > _LARGEST_SUM:
        return None
    operators = tuple(
        replace(operator, cost=operator.cost * _COST_UNIT + 1) for operator in task.operators
    )
    first, *blocks = task.tail.split(_OPERATOR)
    edited = [
        _with_cost(block, operator.cost) for operator, block in zip(operators, blocks, strict=True)
    ]
    return replace(task, operators=operators, tail=_OPERATOR.join([first, *edited]))


def _with_effect(block: str, effect: str) -> str:
    """Return an operator's text with one more effect."""
    lines = block.split('\n')
    place = 2 + int(lines[1])  # after the name and the conditions that nothing changes
    lines[place] = str(int(lines[place]) + 1)
    lines.insert(place + 1, effect)
    return '\n'.join(lines)


def _with_cost(block: str, cost: int) -> str:
    """Return an operator's text with another cost."""
    lines = block.split('\n')
    lines[lines.index('end_operator') - 1] = str(cost)
    return '\n'.join(lines)
