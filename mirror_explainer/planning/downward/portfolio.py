"""Which searches to try on a task, and for how long: no search is quick on every kind of task.

Short tries of each come first, then longer ones. Seconds are the search's own processor time, so
that what is found does not depend on what else the computer does.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

_BLIND = 'astar(blind())'
_LMCUT = 'astar(lmcut(),pruning=stubborn_sets_simple())'
_HMAX = 'astar(hmax())'
_PATTERNS = 'astar(ipdb(max_time=1))'
_MERGE_AND_SHRINK = (
    'astar(merge_and_shrink(shrink_strategy=shrink_bisimulation(greedy=false),'
    'merge_strategy=merge_sccs(order_of_sccs=topological,merge_selector=score_based_filtering('
    'scoring_functions=[goal_relevance(),dfp(),total_order()])),'
    'label_reduction=exact(before_shrinking=true,before_merging=false),'
    'max_states=50k,threshold_before_merge=1))'
)

# All optimal: for tasks with nothing special, with conditional effects, and with axioms.
PLAIN = (_LMCUT, _PATTERNS, _MERGE_AND_SHRINK, _BLIND)
CONDITIONAL = (_HMAX, _MERGE_AND_SHRINK, _BLIND)
AXIOMS = (_BLIND,)

# So many states are looked at in a tenth of a second, so that nothing else need be tried first.
_FEW_STATES = 50_000

_FIRST_TRY = 0.1
_LONGER = 4.0

# What suited other goals may take so many times as long as it took there.
_LEEWAY = 2.0


@dataclass(frozen=True)
class Try:
    """A search that may take so many seconds."""

    configuration: str
    seconds: float


class Portfolio:
    """The searches for the goals of one task. What suited one goal is tried first on the next.

    `hard` says that the last goal was not done with the first try.
    """

    def __init__(self, members: Sequence[str]) -> None:
        self.members = list(members)
        self._enough: dict[str, float] = {}
        self.hard = False

    def next_try(self, states: float, tried: Mapping[str, float], left: float) -> Try | None:
        """Return what to try next on a task with at most so many states, None when all is over.

        `tried` has the longest time that each search was tried for, infinity if it cannot
        be tried for longer; so many seconds are `left`.
        """
        order = [member for member in self.members if tried.get(member, 0.0) < math.inf]
        if not order or left <= 0.0:
            return None
        if states <= _FEW_STATES:
            order.sort(key=lambda member: member != _BLIND)
        if len(self.members) == 1:
            return Try(order[0], left)
        if order[0] in self._enough and not tried:
            return Try(order[0], min(max(_FIRST_TRY, _LEEWAY * self._enough[order[0]]), left))
        limits = {m: _LONGER * tried[m] if m in tried else _FIRST_TRY for m in order}
        shortest = min(order, key=limits.__getitem__)
        return Try(shortest, min(limits[shortest], left))

    def learn(self, configuration: str, seconds: float, hard: bool) -> None:
        """Take note that a search came to its end in so many seconds, maybe after others."""
        self.hard = hard
        self._enough[configuration] = max(seconds, self._enough.get(configuration, 0.0))
        self.members.sort(key=lambda member: member != configuration)
