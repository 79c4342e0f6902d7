"""From inputs to something to answer from: texts are read and checked, nothing is planned."""

import logging
import time
from dataclasses import dataclass, replace
from functools import partial

from mirror_explainer.errors import Cancelled, InputError, NoPlanError
from mirror_explainer.explainer import robot_plan_of
from mirror_explainer.input_limits import InputLimits
from mirror_explainer.listener.goals_seen import with_goals_seen
from mirror_explainer.listener.phrases import Phrases
from mirror_explainer.listener.preparation import Preparation, prepare
from mirror_explainer.listener.user_model import CandidateGoal, UserModel, read_user_model
from mirror_explainer.node.goal_counter import GoalCounter
from mirror_explainer.node.inputs import Inputs, Text
from mirror_explainer.node.readiness import Phase, Readiness, internal_error, planning
from mirror_explainer.node.robot_status import RobotStatus
from mirror_explainer.node.stop_request import StopRequest
from mirror_explainer.pddl import Task, require_definition
from mirror_explainer.pddl.plan_text import read_plan
from mirror_explainer.pddl.situation import Situation
from mirror_explainer.pddl.task_reader import TaskReader
from mirror_explainer.text_files import TextFiles

_log = logging.getLogger(__name__)

_START = (
    "Start what publishes these topics in the node's namespace, or remap them; set the parameters."
)
_NO_USER_MODEL = (
    'no user model is named (parameter user_model_file): answers tell the parts of the '
    "robot's goal, whoever asks"
)
_CORRECT = 'Correct it there: a new message, or the changed file, is taken up by itself.'


@dataclass(frozen=True)
class _Prepared:
    """What was prepared, for which task and settings, from which files."""

    made_for: tuple[object, ...]
    files: object
    preparation: Preparation


class InputReader:
    """Reads inputs, from one thread at a time; what did not change is not read again.

    The robot's goals are counted in `goals_seen_file`, if one is named.
    `files` knows the files that were read, `phrases` are those of the user model read last.
    """

    def __init__(self, goals_seen_file: str = '') -> None:
        self.files = TextFiles()
        self.phrases = Phrases()
        self._reader = TaskReader()
        self._task: tuple[Text, Text, InputLimits, Task] | None = None
        self._robot = RobotStatus()
        self._goals = GoalCounter(goals_seen_file)
        self._prepared: _Prepared | None = None

    def forget_files(self) -> None:
        """Take what is read from now on for what the files are like."""
        self.files = TextFiles()

    def read(self, inputs: Inputs, stop: StopRequest) -> Readiness:
        """Return what there is to answer from, still to be planned for, or why there is nothing.

        As long as the robot does what its plan says, that is of one and the same task. Raises
        Cancelled when it is to stop.
        """
        return replace(self._readiness_for(inputs, stop), inputs=self._as_read(inputs))

    def _readiness_for(self, inputs: Inputs, stop: StopRequest) -> Readiness:
        try:
            if inputs.missing:
                self._check_alone(inputs)
                return Readiness(
                    Phase.WAITING,
                    f'waiting for {", ".join(inputs.missing)}',
                    cure=_START,
                    spoken=self.phrases.not_ready if inputs.plan else self.phrases.no_plan_yet,
                )
            return planning(self._prepare(inputs, stop), done=0)
        except NoPlanError as error:
            phrases = self.phrases
            spoken = phrases.stopped if self._robot.is_under_way else phrases.no_plan
            return Readiness(Phase.WAITING, str(error), cure=error.cure, spoken=spoken)
        except InputError as error:
            cure = error.cure or _CORRECT
            return Readiness(
                Phase.ERROR, str(error), cure=cure, blamed=error.source, spoken=error.brief
            )
        except Cancelled:
            raise
        except Exception as error:  # the node must outlive a fault of ours
            _log.exception('where the internal error came from')
            return internal_error(error)

    def _check_alone(self, inputs: Inputs) -> None:
        """Raise InputError for what is wrong already, whatever is still missing."""
        for text, kind in ((inputs.domain, 'domain'), (inputs.problem, 'problem')):
            if text:
                require_definition(text.text, kind, text.source, inputs.limits)
        if inputs.plan:
            read_plan(inputs.plan.text, inputs.plan.source, inputs.limits)
        if inputs.user_model_file:
            self._user_model(inputs)

    def _prepare(self, inputs: Inputs, stop: StopRequest) -> Preparation:
        """Return what is known once all is read, without any planning.

        As long as the robot does what its plan says, that is what was known before.
        """
        assert inputs.problem and inputs.plan  # nothing is missing
        started, limits = time.perf_counter(), inputs.limits
        domain = self._domain(inputs)
        task = self._read(domain, inputs, stop, inputs.problem.text)
        before = self._prepared
        prior = before.preparation.prior if before else None
        heeded = (prior.facts, prior.common_parts) if prior else ()
        try:
            situation = self._robot.update(domain.text, inputs, task, *heeded)
        except InputError:
            self._user_model(inputs, task)  # it has the words in which to tell of that
            raise
        stop.check()
        made_for = (
            domain,
            situation.number,
            situation.problem,
            inputs.user_model_file,
            inputs.planning,
            limits,
        )
        if before and before.made_for == made_for and self._same_files(before.files, limits):
            preparation = before.preparation
        else:
            task = self._read(domain, inputs, stop, situation.problem)
            preparation = self._prepare_for(situation, task, inputs, stop)
            seconds = replace(preparation.seconds, read=time.perf_counter() - started)
            preparation = replace(preparation, seconds=seconds)
            self._prepared = _Prepared(made_for, self.files.revision, preparation)
        digest = self._as_read(inputs).digest
        return replace(preparation, situation=situation, inputs=digest)

    def _prepare_for(
        self, situation: Situation, task: Task, inputs: Inputs, stop: StopRequest
    ) -> Preparation:
        """Return what is known of an episode that is new, or read anew; `task` is as it began."""
        seen = self._goals.count(situation, task.goal_text, inputs.limits)
        user_model, plan = self._user_model(inputs, task), robot_plan_of(situation)
        stop.check()
        if user_model.goals_seen:
            user_model = with_goals_seen(user_model, task, seen)
        preparation = prepare(task, plan, user_model, inputs.planning)
        warnings = ['' if inputs.user_model_file else _NO_USER_MODEL, self._goals.warning]
        for warning in filter(None, warnings):
            preparation = preparation.warned(warning)
        return preparation

    def _user_model(self, inputs: Inputs, task: Task | None = None) -> UserModel:
        """Return the user model, checked against a task if one is given; keep its phrases."""
        if task and not inputs.user_model_file:
            # This listener knows the goal, but for how much of it the robot will do.
            user_model = UserModel((CandidateGoal(task.goal_text, task.goal_text, 1.0),))
        else:
            read_file = partial(self.files.read, limits=inputs.limits)
            user_model = read_user_model(inputs.user_model_file, task, read_file, inputs.limits)
        self.phrases = user_model.phrases
        return user_model

    def _same_files(self, revision: object, limits: InputLimits) -> bool:
        """Say whether the user model, with the files that it names, is as it was; look at them."""
        assert isinstance(revision, tuple)
        for path, _ in revision:
            self.files.read(path, limits)
        return self.files.revision == revision

    def _as_read(self, inputs: Inputs) -> Inputs:
        """Return the inputs with the revision of the files that were read for them."""
        return replace(inputs, files_revision=self.files.revision)

    def _domain(self, inputs: Inputs) -> Text:
        if inputs.domain:
            return inputs.domain
        return Text(self.files.read(inputs.domain_file, inputs.limits), inputs.domain_file)

    def _read(self, domain: Text, inputs: Inputs, stop: StopRequest, text: str) -> Task:
        """Return the task of a problem, read again only when texts or limits changed."""
        assert inputs.problem  # not missing
        problem, limits = Text(text, inputs.problem.source), inputs.limits
        if self._task is None or self._task[:3] != (domain, problem, limits):
            self._task = None
            task = self._reader.read(
                domain.text, problem.text, domain.source, problem.source, limits, stop.check
            )
            self._task = (domain, problem, limits, task)
        return self._task[3]
