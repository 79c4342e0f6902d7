"""What planning and answering may be told, each setting once: type, default, range, meaning.

The node's parameters, the commands' options and the documentation are made from these.
"""

import math
from collections.abc import Iterator
from dataclasses import Field, dataclass, field, fields
from typing import Any

STRATEGIES = ('informative', 'increasing', 'decreasing')
LISTENERS = ('open', 'planner')
FAST = 'fast-downward-opt'  # the planner that is asked the fast way wherever that is right
FURTHER_PLANS = "'kstar-planner>=1.6,<2'"  # what the extra [plans] needs


@dataclass(frozen=True)
class Meaning:
    """What a setting is for, and what it may be.

    `least` and `most` bound a number, both included; `choices` are the texts that are
    taken. `fixed` says that a running node keeps it; `metavar` stands for it in usage texts.
    """

    description: str
    least: float = -math.inf
    most: float = math.inf
    choices: tuple[str, ...] = ()
    fixed: bool = False
    metavar: str = ''


def setting(default: Any, description: str, **limits: Any) -> Any:
    """Return a dataclass's field for one setting; `limits` are those of its Meaning."""
    return field(default=default, metadata={'meaning': Meaning(description, **limits)})


@dataclass(frozen=True)
class PlanningSettings:
    """How the robot plans for what its listener may believe."""

    planner: str = setting(FAST, "a unified-planning engine's name", fixed=True, metavar='ENGINE')
    plans_per_belief: int = setting(
        1, 'optimal plans of a belief, at most', least=1, most=10_000, metavar='K'
    )
    max_beliefs: int = setting(
        1024, 'plan for so many of the most probable beliefs', least=1, most=1_000_000, metavar='M'
    )
    planning_timeout: float = setting(
        10.0, 's, for each belief', least=1e-3, most=1e6, fixed=True, metavar='S'
    )
    deadline: float = setting(
        60.0, 's, for the planning of a whole task', least=1e-3, most=1e6, metavar='S'
    )
    workers: int = setting(
        2, 'planning processes at a time', least=1, most=256, fixed=True, metavar='W'
    )
    planner_memory_limit: int = setting(
        1024, 'MiB, for each search', least=80, most=1 << 24, fixed=True, metavar='MIB'
    )
    downward_binary: str = setting(
        '', "Fast Downward's search, if self-built", fixed=True, metavar='FILE'
    )


@dataclass(frozen=True)
class Question:
    """What an answer to "what are you up to?" is to be like."""

    strategy: str = setting('informative', 'how to choose what to say', choices=STRATEGIES)
    n: int = setting(3, 'sentences of an answer, at most', least=1, most=1000)
    threshold: float = setting(
        0.0,
        'say only as many as bring the doubt below this (nats; 0: no threshold)',
        least=0.0,
        most=1e3,
        metavar='NATS',
    )
    listener: str = setting('', "who listens; empty: the user model's", choices=('', *LISTENERS))
    min_gain: float = setting(
        -1.0,
        "leave out what tells no more than this (nats; -1: the listener's own)",
        least=-1.0,
        most=1e3,
        metavar='NATS',
    )
    selection_budget: float = setting(
        0.5, 's, to look for the best choice', least=1e-3, most=1.0, metavar='S'
    )
    tell_past: bool = setting(True, 'say also what is done already')


def settings_of(kind: type) -> Iterator[tuple[Field[Any], Meaning]]:
    """Yield the fields of one of the above with their meanings."""
    for item in fields(kind):
        yield item, item.metadata['meaning']


def meaning_of(kind: type, name: str) -> Meaning:
    """Return the meaning of one setting."""
    return next(meaning for item, meaning in settings_of(kind) if item.name == name)
