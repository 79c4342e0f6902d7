"""Which searches to try on a task, and for how long: no search is quick on every kind of task.

Short tries of each come first, then longer ones. Seconds are the search's own processor time, so
that what is found does not depend on what else the computer does.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from mirror_explainer.planning.downward.ground_task import Operator

_BLIND = 'astar(blind())'
_LMCUT = 'astar(lmcut(),pruning=atom_centric_stubborn_sets())'
_HMAX = 'astar(hmax())'
_LANDMARKS_AND_PATTERNS = (
    'astar(max([landmark_cost_partitioning(lm_rhw(),cost_partitioning=uniform),'
    'cpdbs(systematic(2))]))'
)
_MERGE_AND_SHRINK = (
    'astar(merge_and_shrink(shrink_strategy=shrink_bisimulation(greedy=false),'
    'merge_strategy=merge_sccs(order_of_sccs=topological,merge_selector=score_based_filtering('
    'scoring_functions=[goal_relevance(),dfp(),total_order()])),'
    'label_reduction=exact(before_shrinking=true,before_merging=false),'
    'max_states=50k,threshold_before_merge=1))'
)

# All optimal: for tasks with nothing special, with conditional effects, and with axioms.
PLAIN = (_LANDMARKS_AND_PATTERNS, _LMCUT, _MERGE_AND_SHRINK)
CONDITIONAL = (_HMAX, _MERGE_AND_SHRINK, _BLIND)
AXIOMS = (_BLIND,)

# LM-cut goes through all operators at every state: up to so many, it is the first.
_FEW_OPERATORS = 150

FIRST_TRY = 0.04
_LONGER = 4.0

# What suited another task is tried for so many times as long as the others, and at first for
# so many times as long as it took there.
_FAVOUR = 8.0
_LEEWAY = 2.0


@dataclass(frozen=True)
class Try:
    """A search that may take so many seconds, or took them."""

    configuration: str
    seconds: float


def plain(operators: Sequence[Operator]) -> tuple[tuple[str, ...], Try | None]:
    """Return the searches for a task with nothing special, and what suits it in all likelihood.

    That is LM-cut if several things act, so that no one variable, such as where the robot is, is
    in all operators: the order of many does not matter then, and stubborn sets try one only.
    """
    in_all = {*operators[0].needs, *operators[0].changes} if operators else set()
    for operator in operators:
        in_all = {v for v in in_all if v in operator.needs or v in operator.changes}
    few = (_LMCUT, *(member for member in PLAIN if member != _LMCUT))
    members = few if len(operators) <= _FEW_OPERATORS else PLAIN
    return members, None if in_all else Try(_LMCUT, 0.0)


def next_try(
    members: Sequence[str],
    lesson: Try | None,
    tried: Mapping[str, float],
    left: float,
) -> Try | None:
    """Return which of the searches to try next, None when all is over.

    `lesson` is what suited a task like it. `tried` has the longest time that each search was tried
    for, infinity if it cannot be tried for longer; so many seconds are `left`.
    """
    order = [member for member in members if tried.get(member, 0.0) < math.inf]
    if not order or left <= 0.0:
        return None
    if len(members) == 1:
        return Try(order[0], left)
    suited = lesson.configuration if lesson else ''
    order.sort(key=lambda member: member != suited)
    share = {member: _FAVOUR if member == suited else 1.0 for member in order}
    limits = {m: _LONGER * tried[m] if m in tried else FIRST_TRY * share[m] for m in order}
    chosen = min(order, key=lambda member: limits[member] / share[member])
    seconds = limits[chosen]
    if lesson and chosen == suited and not tried:
        seconds = max(seconds, _LEEWAY * lesson.seconds)
    return Try(chosen, min(seconds, left))
