"""Where the robot is: in which episode, and how far; made anew by each of its messages."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field, replace
from datetime import datetime
from functools import cached_property

from mirror_explainer.errors import InputError
from mirror_explainer.input_limits import InputLimits
from mirror_explainer.pddl.episode import Episode, begin, goal_of
from mirror_explainer.pddl.following import follow
from mirror_explainer.pddl.plan_check import missing_goals
from mirror_explainer.pddl.plan_text import Step
from mirror_explainer.pddl.problem_text import with_state
from mirror_explainer.pddl.progress import Progress, StepStatus
from mirror_explainer.pddl.progress_text import ProgressText
from mirror_explainer.pddl.states import Evaluator, State, UnknownNumberError
from mirror_explainer.pddl.task import Task

FIRST, NEW_TASK, AGAIN = 'first', 'new task', 'again'
REPLANNED, RESTARTED, RESUMED = 'replanned', 'restarted', 'resumed'


@dataclass(frozen=True)
class Statement:
    """What a robot states: the texts of its task, that task as read, and its plan.

    The plan is from `source`, and within `limits`; `progress` is what the robot tells of it,
    None if that is nothing.
    """

    domain: str
    problem: str
    task: Task
    steps: Sequence[Step]
    source: str = 'plan'
    limits: InputLimits | None = None
    progress: ProgressText | None = None

    @property
    def actions(self) -> tuple[str, ...]:
        """The steps as canonical texts."""
        return tuple(step.action for step in self.steps)

    @cached_property
    def state(self) -> State:
        """The state that the problem tells."""
        return Evaluator(self.task).first_state()


@dataclass(frozen=True)
class Situation:
    """An episode of the robot, the `number`-th, and how far its plan is.

    `domain` and `problem` are the texts of its task, with the state in which it began, `task` is
    that with the state in which it was heard of;
    `reason` is why it began: FIRST, REPLANNED for the same goal, RESTARTED for that and the
    same plan, AGAIN for a goal once it was reached, NEW_TASK, or RESUMED for the goal that was
    `put_off` for a new task before it was reached. A new task is `like_before` where a part of
    its goal was one of the goal before, which was not reached, and was achieved on the way or
    is still to be, or where it is a rest of that. It `is_detour` where the robot put off the goal
    before in the midst of it, also for a rest without what that was for, such as to charge.
    `seen` is the progress that states show, `told` what the robot itself says of it, if it does.
    """

    episode: Episode
    seen: Progress
    domain: str
    problem: str
    task: Task = field(repr=False, compare=False)
    number: int = 1
    reason: str = FIRST
    like_before: bool = False
    began: datetime | None = None
    told: Progress | None = None
    put_off: frozenset[str] | None = None
    is_detour: bool = False

    @property
    def takes_up_goal(self) -> bool:
        """Whether this goal was not taken up before without being reached."""
        return self.reason in (FIRST, NEW_TASK, AGAIN)

    @property
    def progress(self) -> Progress:
        """How far the plan is, as far as is known."""
        return self.seen if self.told is None else self.told

    @property
    def is_under_way(self) -> bool:
        """Whether the plan has begun, and is not at its end."""
        has_begun = self.progress != Progress.none(len(self.progress.steps))
        return has_begun and not self.progress.finished

    def begins_again(self, told: Progress) -> bool:
        """Say whether a robot that was done tells that it is not any more."""
        return self.told is not None and self.told.finished and not told.finished

    def telling(self, told: Progress, source: str) -> 'Situation':
        """Return the situation with the progress that the robot tells, by a text from `source`.

        Raises InputError for a step that was done, and is not any more.
        """
        undone = told.undone(self.told) if self.told else ()
        if undone:
            raise InputError(
                source,
                f'{self.episode.actions[undone[0]]} was done, and is not any more',
                cure='A robot that begins again publishes its plan again; each message is the '
                'whole progress, what is done included.',
            )
        return replace(self, told=told)


def situation_of(stated: Statement) -> Situation:
    """Return the situation in which a robot is first heard of.

    What it tells to be done of its plan belongs to the episode, also where its state has it
    already. Raises InputError for a plan that has nothing to do with the problem's state, and for
    progress that is not about the plan.
    """
    told = stated.progress.of(stated.actions) if stated.progress and stated.steps else None
    done = told.positions(StepStatus.DONE) if told else ()
    episode, progress = begin(stated.task, stated.steps, stated.source, stated.limits, done)
    problem = stated.problem
    if episode.first != stated.state:
        problem = with_state(problem, episode.first)
    began = datetime.now().astimezone()
    return Situation(episode, progress, stated.domain, problem, stated.task, began=began)


def next_situation(
    before: Situation,
    stated: Statement,
    uncertain: Collection[str] = (),
    is_told: bool = False,
    common: Collection[str] = (),
) -> Situation:
    """Return the situation after newer messages: in the same episode if they are progress in it.

    `uncertain` are the facts that the listener is unsure of, `common` the parts of every goal
    that they think of: these make no two goals alike. A robot that tells its progress
    itself (`is_told`) is in the episode as long as its plan is the whole plan of that, whatever
    its state. Raises InputError.
    """
    same_goal = like_before = False
    if stated.domain == before.domain:
        same_goal = goal_of(stated.task) == before.episode.goal
        if same_goal and is_told and stated.actions == before.episode.actions:
            return before
        seen = follow(
            before.episode, stated.state, before.seen, stated.steps, uncertain, stated.task
        )
        if seen is not None:
            return replace(before, seen=seen)
        like_before = not same_goal and _is_like(before, stated, common)
    new = situation_of(stated)
    put_off, is_detour = before.put_off, False
    if same_goal and before.progress.finished:
        reason = AGAIN
    elif same_goal:
        is_same = new.episode.actions == before.episode.actions and not new.seen.happened
        reason, is_detour = RESTARTED if is_same else REPLANNED, before.is_detour
    elif new.episode.goal == put_off:
        reason, put_off, like_before = RESUMED, None, False
    else:
        reason = NEW_TASK
        if like_before and not _is_break(before, stated, common):
            is_detour = before.is_detour
        elif before.is_under_way:
            put_off, is_detour = before.episode.goal, True
    return replace(
        new,
        number=before.number + 1,
        reason=reason,
        like_before=like_before,
        put_off=put_off,
        is_detour=is_detour,
    )


def begun_again(situation: Situation) -> Situation:
    """Return the situation of a robot that carries out the same plan once more, as before."""
    return replace(
        situation,
        seen=Progress.none(len(situation.episode.steps)),
        told=None,
        number=situation.number + 1,
        reason=AGAIN,
        like_before=False,
        is_detour=False,
        began=datetime.now().astimezone(),
    )


def gone_back(situation: Situation, told: Progress, stated: Statement) -> Situation:
    """Return the situation of a robot that does steps of its plan again, from a newer state.

    It is `told`, and the state that was heard agrees; else nothing has changed.
    """
    if situation.told is None or not told.undone(situation.told):
        return situation
    try:
        new = situation_of(stated)
    except InputError:
        return situation
    if new.episode.actions != situation.episode.actions or told.undone(new.seen):
        return situation
    reason, is_detour = AGAIN, False
    if not situation.told.finished:
        reason = REPLANNED if told.positions(StepStatus.DONE) else RESTARTED
        is_detour = situation.is_detour
    number, put_off = situation.number + 1, situation.put_off
    return replace(new, number=number, reason=reason, put_off=put_off, is_detour=is_detour)


def taken_up_again(
    situation: Situation, stated: Statement, uncertain: Collection[str] = ()
) -> Situation:
    """Return the situation of a robot that begins with its plan, and has told nothing since.

    Where the state is that in which the episode began, and nowhere that it is known to be by
    now, it starts again; else it tries again what failed.
    """
    episode, state, told = situation.episode, stated.state, situation.told
    is_begin = episode.agrees(state, 0, uncertain) is not False
    if is_begin and not follow(episode, state, situation.progress, None, uncertain, stated.task):
        return gone_back(situation, Progress.none(len(episode.steps)), stated)
    return replace(situation, told=told and told.without_failures)


def _is_break(before: Situation, stated: Statement, common: Collection[str]) -> bool:
    """Say whether a task has none of what that before was for and still lacks.

    So a robot only goes home and charges in the midst of it.
    """
    missing = _missing(before.task, before.episode.first, stated.state)
    if missing is None:
        return False
    purposes = missing[0].difference(common)
    return purposes.isdisjoint(goal_of(stated.task)) and not purposes.isdisjoint(missing[1])


def _is_like(before: Situation, stated: Statement, common: Collection[str]) -> bool:
    """Say whether a task is for a part of a goal that was not reached, or for a rest of that.

    Not for what always held; nor for what held when the episode began, such as that the robot is
    at its dock, or what is `common` to all goals.
    """
    if before.progress.finished:
        return False
    missing = _missing(stated.task, before.episode.first, stated.state)
    if missing is None:
        return False
    first, now = missing
    goal = before.episode.goal
    is_rest = goal_of(stated.task) <= goal and bool(first | now)
    return is_rest or not goal.isdisjoint(first.difference(common))


def _missing(task: Task, *states: State) -> list[set[str]] | None:
    """Return what a task's goal lacks in each of some states, None where that is unknown."""
    evaluator = Evaluator(task)
    try:
        return [{*map(str, missing_goals(task, state, evaluator))} for state in states]
    except (UnknownNumberError, NotImplementedError):
        return None
