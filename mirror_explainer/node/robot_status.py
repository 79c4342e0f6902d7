"""What the robot is doing, from one of its messages to the next."""

from collections.abc import Collection
from dataclasses import replace

from mirror_explainer.errors import InputError, NoPlanError
from mirror_explainer.node.inputs import Inputs, Text
from mirror_explainer.node.moment import Moment
from mirror_explainer.pddl import Task
from mirror_explainer.pddl.plan_text import read_plan, without_dummy
from mirror_explainer.pddl.progress import Progress
from mirror_explainer.pddl.progress_text import ProgressText, read_progress
from mirror_explainer.pddl.situation import (
    Situation,
    Statement,
    begun_again,
    gone_back,
    next_situation,
    situation_of,
    taken_up_again,
)


class RobotStatus:
    """Keeps the situation of the robot; what is wrong with a message leaves it as it was."""

    def __init__(self) -> None:
        self._situation: Situation | None = None
        self._has_stopped = False  # whether it has had no plan since then
        self._stale: Text | None = None
        # The last new progress text, as it came, and the problem it came with.
        self._told: Text | None = None
        self._told_in = ''
        self._began = Moment()  # when the newest text came with which the episode began
        # What was done when problem and plan came again without progress, as if it started again;
        # and whether the next progress was that it had not: it repeats them on its way.
        self._undone: Progress | None = None
        self._repeats = False

    @property
    def is_under_way(self) -> bool:
        """Whether the robot itself told that its last plan had begun, and not that it was over."""
        situation = self._situation
        return situation is not None and situation.told is not None and situation.is_under_way

    def update(
        self,
        domain: str,
        inputs: Inputs,
        task: Task,
        uncertain: Collection[str] = (),
        common: Collection[str] = (),
    ) -> Situation:
        """Return the situation by the newest inputs; `task` is that of their problem and `domain`.

        `uncertain` are the facts that the listener is unsure of, `common` the parts of every goal
        that they think of. Raises InputError, and NoPlanError if there is nothing to do.
        """
        problem, plan, before = inputs.problem, inputs.plan, self._situation
        assert problem and plan  # nothing is missing
        steps = without_dummy(task, read_plan(plan.text, plan.source, inputs.limits))
        stated = Statement(domain, problem.text, task, steps, plan.source, inputs.limits)
        progress = inputs.progress if inputs.progress is not self._stale else None
        text = None
        if progress:
            text = read_progress(progress.text, progress.source, inputs.limits)
        if text and not (inputs.is_progress_old or self._is_of_plan_before(inputs, text, stated)):
            stated = replace(stated, progress=text)
        is_told = bool(text or (before and before.told))
        situation = self._by_state(stated, uncertain, is_told, common)
        is_new = before is None or situation.number != before.number
        is_anew = inputs.begins_anew and self._is_first_time(problem, plan)
        undone = None
        if text and before and is_anew and not is_new:
            situation = taken_up_again(situation, stated, uncertain)
            is_new = situation.number != before.number
            undone = before.told if is_new else None
        if is_new and self._has_stopped:  # it did not go from one task to the other
            situation = replace(situation, is_detour=False)
        if text and stated.progress is None and (is_new or is_anew):
            self._stale, text = progress, None  # it is about the plan before
        elif text and progress == self._stale and not text.is_about(situation.episode.actions):
            text = None  # and is told once more
        if text:
            told = text.of(situation.episode.actions)
            if problem.text != self._told_in or self._is_plan_again(plan, situation, told):
                situation = gone_back(situation, told, stated)
            if situation.begins_again(told):
                situation = begun_again(situation)
            situation = situation.telling(told, text.source)
        if before is None or situation.number != before.number:
            self._began = inputs.newest
            self._undone, self._repeats = undone, False
        elif text and situation.told and self._undone:
            self._repeats = not situation.told.undone(self._undone)
            self._undone = None
        if text and progress != self._told:
            self._told, self._told_in = progress, problem.text
        self._situation, self._has_stopped = situation, False
        return situation

    def _by_state(
        self, stated: Statement, uncertain: Collection[str], is_told: bool, common: Collection[str]
    ) -> Situation:
        """Return the situation by the robot's task and plan; raises as `update`."""
        try:
            if self._situation is None:
                return situation_of(stated)
            return next_situation(self._situation, stated, uncertain, is_told, common)
        except InputError as error:
            if stated.steps:
                raise
            self._has_stopped = True
            raise NoPlanError(
                stated.source,
                'the robot has no current plan',
                cure='Nothing is to be done if it has no task now: its next plan is explained.',
            ) from error

    def _is_of_plan_before(self, inputs: Inputs, text: ProgressText, stated: Statement) -> bool:
        """Say whether progress that came before a plan, or was told before, fits only another."""
        before = self._situation
        return (
            before is not None
            and (inputs.is_plan_newer or inputs.progress == self._told)
            and text.is_about(before.episode.actions)
            and not text.is_about(stated.actions)
        )

    def _is_first_time(self, problem: Text, plan: Text) -> bool:
        """Say whether both came for the first time since the episode began, or it was stopped.

        For many robots repeat them all the time.
        """
        earlier = [text.earlier for text in (problem, plan)]
        is_first = any(at is None or at.seconds_since(self._began) <= 0.0 for at in earlier)
        return self._has_stopped or (is_first and not self._repeats)

    def _is_plan_again(self, plan: Text, situation: Situation, told: Progress) -> bool:
        """Say whether a plan came again after progress was told, and so begins again.

        Where more than that is ahead, a robot that repeats its plan may have forgotten to name
        all that is done.
        """
        since = plan.heard.seconds_since(self._told.heard) if self._told else 0.0
        return since > 0.0 and situation.episode.comes_to(told)
