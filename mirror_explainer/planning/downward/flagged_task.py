"""Edits of a task with which a search finds the operators of optimal plans.

One more variable is a flag that only operators not seen yet set, and that the
goal demands: a plan no costlier than the optimum has an operator not seen yet,
and where there is no such plan all operators of optimal plans have been seen.
"""

from collections.abc import Collection
from dataclasses import replace

from mirror_explainer.planning.downward.ground_task import GroundTask
from mirror_explainer.planning.downward.search_task import SearchTask

# A flag that is up, and one that is not.
_UP, DOWN = 0, 1

# With free actions, a cost counts this much, and an action 1: so the shortest of the cheapest
# plans are the optimal ones, and no plan goes on for nothing.
_COST_UNIT = 1000
_LARGEST_SUM = 1_000_000_000


def flagged(task: SearchTask, seen: Collection[str]) -> SearchTask:
    """Return the task with a flag as its last variable, which operators not seen put up."""
    up = (len(task.sizes), _UP)
    return SearchTask(
        (*task.sizes, 2),
        (*task.goal, up),
        tuple(o if o.name in seen else replace(o, effect=(*o.effect, up)) for o in task.operators),
    )


def with_positive_costs(task: GroundTask) -> GroundTask | None:
    """Return the task with no free actions, in which the optimal plans are also the shortest.

    The task itself if it has none; None if the costs get too large for the search.
    """
    if all(operator.cost for operator in task.operators):
        return task
    if sum(operator.cost for operator in task.operators) * _COST_UNIT > _LARGEST_SUM:
        return None
    dearer = (replace(o, cost=o.cost * _COST_UNIT + 1) for o in task.operators)
    return replace(task, operators=tuple(dearer))
