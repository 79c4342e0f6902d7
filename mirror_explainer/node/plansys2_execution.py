"""A plan that PlanSys2 carries out, and how far it is, as the explainer's `plan` and `progress`.

PlanSys2 tells the plan once, and of each action where it stands under a full name made of the
action and the millisecond of its start: `(go b dock lab):6001` begins after 6.001 s.
"""

import re
from collections.abc import Iterable
from dataclasses import dataclass, replace

AHEAD, RUNNING, DONE, FAILED = 'ahead', 'running', 'done', 'failed'
_FACT = re.compile(r'\(([^()]+)\)')


@dataclass(frozen=True)
class PlannedAction:
    """An action of a plan: its start in s, its text as `(go b dock lab)`, its duration in s."""

    start: float
    text: str
    duration: float


@dataclass(frozen=True)
class Execution:
    """A plan, and of each of its actions whether it is ahead, running, done or failed."""

    actions: tuple[PlannedAction, ...]
    standing: tuple[str, ...]

    @classmethod
    def of(cls, actions: Iterable[PlannedAction]) -> 'Execution':
        """Return the execution of a plan of which nothing is known to have begun."""
        planned = tuple(actions)
        return cls(planned, (AHEAD,) * len(planned))

    def after(self, full_name: str, standing: str) -> 'Execution':
        """Return this execution once PlanSys2 has said where an action stands.

        What is no action of this plan changes nothing: PlanSys2 tells of a first
        action ":0" that stands for the plan's beginning.
        """
        text, _, start = full_name.rpartition(':')
        named = [i for i, action in enumerate(self.actions) if action.text == text]
        if not named or not start.lstrip('-').isdigit():
            return self
        seconds = int(start) / 1000
        position = min(named, key=lambda i: abs(self.actions[i].start - seconds))
        found = (*self.standing[:position], standing, *self.standing[position + 1 :])
        return replace(self, standing=found)

    def finished(self) -> 'Execution':
        """Return this execution once all of it is done."""
        return replace(self, standing=(DONE,) * len(self.actions))

    @property
    def failed(self) -> bool:
        """Whether an action failed: PlanSys2 then gives the plan up."""
        return FAILED in self.standing

    @property
    def plan(self) -> str:
        """The plan's text: `6.001: (go b dock lab) [5.000]`, an action a line."""
        return '\n'.join(
            f'{action.start:.3f}: {action.text} [{action.duration:.3f}]' for action in self.actions
        )

    @property
    def progress(self) -> str:
        """The progress' text: `done: (go b dock lab)`, a line for each action that has begun."""
        return '\n'.join(
            f'{standing}: {action.text}'
            for action, standing in zip(self.actions, self.standing, strict=True)
            if standing != AHEAD
        )


def goal_of(problem: str) -> str:
    """Return the part of PlanSys2's problem that is its goal."""
    return problem.partition(':goal')[2].partition(':metric')[0]


def goal_holds(problem: str) -> bool:
    """Say whether all facts that PlanSys2's problem has as its goal hold in it.

    False for a goal that is no conjunction of facts: of that only the explainer can tell.
    """
    goal = goal_of(problem)
    wanted = _facts(goal)
    rest = _FACT.sub('', goal).replace('(', ' ').replace(')', ' ').lower().split()
    return bool(wanted) and set(rest) <= {'and'} and wanted <= _facts(problem.split(':goal')[0])


def _facts(text: str) -> set[tuple[str, ...]]:
    return {tuple(words.lower().split()) for words in _FACT.findall(text)}
