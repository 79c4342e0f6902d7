"""Where the robot is: in which episode, and how far; made anew by each of its messages."""

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace
from datetime import datetime

from mirror_explainer.errors import InputError
from mirror_explainer.input_limits import InputLimits
from mirror_explainer.pddl.episode import Episode, begin, goal_of
from mirror_explainer.pddl.following import follow
from mirror_explainer.pddl.plan_check import missing_goals
from mirror_explainer.pddl.plan_text import Step
from mirror_explainer.pddl.problem_text import with_state
from mirror_explainer.pddl.progress import Progress, StepStatus, read_progress
from mirror_explainer.pddl.states import Evaluator, UnknownNumberError
from mirror_explainer.pddl.task import Task

FIRST, NEW_TASK, AGAIN = 'first', 'new task', 'again'
REPLANNED, RESTARTED, RESUMED = 'replanned', 'restarted', 'resumed'

# Returns the progress that the robot tells of a plan with these actions.
Tells = Callable[[Sequence[str]], Progress]


@dataclass(frozen=True)
class Situation:
    """An episode of the robot, the `number`-th, and how far its plan is.

    `domain` and `problem` are the texts of its task, with the state in which it began;
    `reason` is why it began: FIRST, REPLANNED for the same goal, RESTARTED for that and the
    same plan, AGAIN for a goal once it was reached, NEW_TASK, or RESUMED for the goal that was
    `put_off` for a new task before it was reached. A new task is `like_before` where a part of
    its goal was one of the goal before, which was not reached, and was achieved on the way or
    is still to be, or where it is a rest of that. It `is_detour` where the robot put off the goal
    before in the midst of it.
    `seen` is the progress that states show, `told` what the robot itself says of it, if it does.
    """

    episode: Episode
    seen: Progress
    domain: str
    problem: str
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

    def telling(self, text: str, source: str = 'progress') -> 'Situation':
        """Return the situation with the progress that the robot tells. Raises InputError."""
        told = read_progress(text, self.episode.actions, self.told, source)
        return replace(self, told=told)


def situation_of(
    domain: str,
    problem: str,
    steps: Sequence[Step],
    read: Callable[[str], Task],
    source: str = 'plan',
    limits: InputLimits | None = None,
    tells: Tells | None = None,
) -> Situation:
    """Return the situation in which a robot is first heard of.

    `read` reads a problem's text, together with the domain. What the robot `tells` to be done
    of its plan belongs to the episode, also where its state has it already. Raises InputError
    for a plan that has nothing to do with the problem's state, and as `tells` does.
    """
    task = read(problem)
    told = tells([step.action for step in steps]) if tells and steps else Progress.none(0)
    done = told.positions(StepStatus.DONE)
    episode, progress = begin(task, steps, source, limits, done)
    if episode.first != Evaluator(task).first_state():
        problem = with_state(problem, episode.first)
    began = datetime.now().astimezone()
    return Situation(episode, progress, domain, problem, began=began)


def next_situation(
    before: Situation,
    domain: str,
    problem: str,
    steps: Sequence[Step],
    read: Callable[[str], Task],
    source: str = 'plan',
    limits: InputLimits | None = None,
    tells: Tells | None = None,
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
    if domain == before.domain:
        task = read(problem)
        same_goal = goal_of(task) == before.episode.goal
        if same_goal and is_told and tuple(s.action for s in steps) == before.episode.actions:
            return before
        state = Evaluator(task).first_state()
        seen = follow(before.episode, state, before.seen, steps, uncertain, task)
        if seen is not None:
            return replace(before, seen=seen)
        like_before = not same_goal and _is_like(before, task, common)
    new = situation_of(domain, problem, steps, read, source, limits, tells)
    put_off, is_detour = before.put_off, False
    if same_goal and before.progress.finished:
        reason = AGAIN
    elif same_goal:
        is_same = new.episode.actions == before.episode.actions and not new.seen.done
        reason, is_detour = RESTARTED if is_same else REPLANNED, before.is_detour
    elif new.episode.goal == put_off:
        reason, put_off, like_before = RESUMED, None, False
    else:
        reason = NEW_TASK
        if like_before:
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


def gone_back(situation: Situation, told: Progress, first: Callable[[], Situation]) -> Situation:
    """Return the situation of a robot that does steps of its plan again, from a newer state.

    It is `told`, and the state agrees; else nothing has changed. `first` returns its situation
    by its newest messages, were they the first, as `situation_of` does.
    """
    if situation.told is None or not told.undone(situation.told):
        return situation
    try:
        new = first()
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
    situation: Situation,
    task: Task,
    first: Callable[[], Situation],
    uncertain: Collection[str] = (),
) -> Situation:
    """Return the situation of a robot that begins with its plan, and has told nothing since.

    Where the state is that in which the episode began, and nowhere that it is known to be by
    now, it starts again; else it tries again what failed.
    """
    episode, state, told = situation.episode, Evaluator(task).first_state(), situation.told
    is_begin = episode.agrees(state, 0, uncertain) is not False
    if is_begin and not follow(episode, state, situation.progress, None, uncertain, task):
        return gone_back(situation, Progress.none(len(episode.steps)), first)
    return replace(situation, told=told and told.without_failures)


def _is_like(before: Situation, task: Task, common: Collection[str]) -> bool:
    """Say whether a task is for a part of a goal that was not reached, or for a rest of that.

    Not for what always held; nor for what held when the episode began, such as that the robot is
    at its dock, or what is `common` to all goals.
    """
    if before.progress.finished:
        return False
    evaluator = Evaluator(task)
    states = before.episode.first, evaluator.first_state()
    try:
        first, now = ({*map(str, missing_goals(task, state, evaluator))} for state in states)
    except (UnknownNumberError, NotImplementedError):
        return False
    goal = before.episode.goal
    is_rest = goal_of(task) <= goal and bool(first | now)
    return is_rest or not goal.isdisjoint(first.difference(common))
