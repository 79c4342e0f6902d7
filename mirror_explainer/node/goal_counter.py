"""Counts the goals that the robot has, in a file that others may edit, or count in, too."""

import os
from collections import Counter
from collections.abc import Mapping
from datetime import UTC, datetime, timedelta

from mirror_explainer.errors import InputError
from mirror_explainer.input_limits import InputLimits
from mirror_explainer.listener.goals_seen import (
    MOST_GOALS,
    GoalsSeen,
    goals_seen_text,
    read_goals_seen,
)
from mirror_explainer.pddl.situation import Situation
from mirror_explainer.text_files import changing_alone, replace_text

# A goal whose text is longer is not counted, so that the file never grows beyond a message.
_LONGEST_GOAL = 2000
# A node that starts, and finds that this goal was taken up no longer ago, was only started anew.
_LATELY = timedelta(hours=1)


class GoalCounter:
    """Counts a goal each time that the robot takes it up, in the file at `path`; "" for none.

    What a node hears first may be the task that it, before it was started anew, had counted: it
    does not count where the file has that this goal was taken up within the last hour.
    What cannot be written is kept, and written with the next goal; `warning` says why it was
    not, "" if all was.
    """

    def __init__(self, path: str) -> None:
        self.warning = ''
        self._path = path
        self._episode = 0
        self._before: Mapping[str, int] = {}
        self._unwritten: Counter[str] = Counter()

    def count(self, situation: Situation, goal: str, limits: InputLimits) -> Mapping[str, int]:
        """Count the goal of the robot's task, and return how often it had each goal before.

        Once an episode: asked again in the same, it returns the same.
        """
        if self._path and situation.number != self._episode:
            is_counted = situation.takes_up_goal and len(goal) <= _LONGEST_GOAL
            self._before = self._count_in_file(goal if is_counted else '', limits)
            self._episode = situation.number
        return self._before

    def _count_in_file(self, goal: str, limits: InputLimits) -> Mapping[str, int]:
        """Count a goal, if one is given, and return what was counted before."""
        before = Counter(self._unwritten)
        now = datetime.now(UTC)
        if goal:
            self._unwritten = Counter(dict(self._unwritten.most_common(MOST_GOALS - 1)))
            self._unwritten[goal] += 1
        self.warning = ''
        try:
            with changing_alone(self._path):
                is_there = os.path.exists(self._path)
                known = read_goals_seen(self._path, limits) if is_there else GoalsSeen()
                before.update(known.counts)
                late = {g: t for g, t in known.taken_up.items() if now - t < _LATELY}
                if goal in late and not self._episode:
                    before[goal] = max(0, before[goal] - 1)
                    self._unwritten.clear()
                if self._unwritten:
                    # The newest goals first: of those that are as rare the oldest are dropped.
                    counts = self._unwritten + Counter(known.counts)
                    late |= {goal: now} if goal else {}
                    replace_text(self._path, goals_seen_text(GoalsSeen(counts, late)))
                    self._unwritten.clear()
        except (InputError, OSError, ValueError) as error:
            reason = (error.strerror if isinstance(error, OSError) else None) or error
            told = error if isinstance(error, InputError) else f'{self._path}: {reason}'
            self.warning = f'the goals seen are only kept in memory until this is mended: {told}'
        return before
