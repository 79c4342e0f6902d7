"""The beliefs b = (I, G) that planning is asked about, and what it answers.

Plain values without any planner in them: they cross process borders.
"""

from dataclasses import dataclass
from enum import Enum
from typing import Literal


@dataclass(frozen=True)
class BeliefSpace:
    """Every belief about one problem: its candidate goals and uncertain facts.

    `domain` and `problem` are PDDL texts, `goals` are PDDL goal descriptions,
    `uncertain_facts` are ground atoms such as "(charged)" in lower case. All
    facts not named there hold as in the problem's :init. The problem's own
    :goal plays no part.
    """

    domain: str
    problem: str
    goals: tuple[str, ...]
    uncertain_facts: tuple[str, ...] = ()


@dataclass(frozen=True)
class Belief:
    """One belief of a space: the goal's index, and the uncertain facts that hold."""

    goal: int
    true_facts: frozenset[str] = frozenset()


@dataclass(frozen=True)
class Plan:
    """A plan: ground actions such as "(move left center)" in order, lower case.

    `cost` is in the problem's metric (the number of actions where it has
    none), `optimal` says that the engine proved no plan to be cheaper.
    """

    actions: tuple[str, ...]
    cost: float
    optimal: bool = True


class Status(Enum):
    """What is known about a belief after planning."""

    SOLVED = 'solved'
    UNSOLVABLE = 'unsolvable'  # proved
    UNKNOWN = 'unknown'  # time, memory or the engine gave out


# Why not all further plans that were asked for are known: '' where they are.
Cut = Literal['', 'time', 'number', 'planner']


@dataclass(frozen=True)
class BeliefPlans:
    """What planning found for one belief: plans from the cheapest up, none unless SOLVED.

    `cut` says why there may be more plans than these, where more were asked for: 'time' ended
    their search, there are too many ('number'), or what finds them is not installed or failed
    ('planner'); '' where these are all. `reason` says in a few words why the status is UNKNOWN, or
    what failed at further plans.
    """

    status: Status
    plans: tuple[Plan, ...] = ()
    reason: str = ''
    cut: Cut = ''


@dataclass(frozen=True)
class PlanningReport:
    """The results, in the order of the beliefs asked, and what they cost.

    `planner_calls` engine calls were made; `searching` is how many seconds
    were spent on starting these and waiting for them. `way` says in a few words
    how it was gone about. For `failed` beliefs the engine failed, and another try may
    bring more. `worked` is the processor time of the fast way's searches, in seconds.
    """

    results: tuple[BeliefPlans, ...]
    planner_calls: int
    way: str
    searching: float = 0.0
    failed: int = 0
    worked: float = 0.0
