"""A question that takes long, and what planning processes there are, for tests of them."""

import os
import threading
from pathlib import Path

from pddl_cases import gripper

from mirror_explainer.planning import Belief, BeliefSpace, Planner

HARD = BeliefSpace(*gripper(30)[:2], goals=(gripper(30)[2], '(robot-at there)'))


def processes_of(session: int) -> list[int]:
    """Return the living processes of a session, from /proc."""
    found = []
    for stat in Path('/proc').glob('[0-9]*/stat'):
        try:
            state, _, _, its_session = stat.read_text().rpartition(') ')[2].split()[:4]
        except (FileNotFoundError, ProcessLookupError):
            continue
        if int(its_session) == session and state != 'Z':
            found.append(int(stat.parent.name))
    return found


def child_sessions(of: int = os.getpid()) -> set[int]:
    """Return the sessions that children of a process lead."""
    sessions = set()
    for stat in Path('/proc').glob('[0-9]*/stat'):
        try:
            _, parent, _, session = stat.read_text().rpartition(') ')[2].split()[:4]
        except (FileNotFoundError, ProcessLookupError):
            continue
        if int(parent) == of and session == stat.parent.name:
            sessions.add(int(session))
    return sessions


def searches_of(sessions: set[int]) -> list[int]:
    """Return what runs in the sessions besides their leaders."""
    return [pid for session in sessions for pid in processes_of(session) if pid != session]


class Asking(threading.Thread):
    """Asks for the hard belief, and keeps the error that ends it."""

    def __init__(self, planner: Planner, space: BeliefSpace, cancelled: threading.Event) -> None:
        super().__init__()
        self._question = planner, space, cancelled
        self.error: Exception | None = None
        self.start()

    def run(self) -> None:
        planner, space, cancelled = self._question
        try:
            planner.plan(space, [Belief(0)], cancelled=cancelled)
        except Exception as error:
            self.error = error
