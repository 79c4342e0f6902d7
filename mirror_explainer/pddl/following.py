"""Whether a later state and plan go on with an episode, and how far the plan then is."""

from collections import deque
from collections.abc import Collection, Iterator, Sequence

from mirror_explainer.pddl.episode import Episode, goal_of, outcome
from mirror_explainer.pddl.happenings import GroundStep, Happening, ground
from mirror_explainer.pddl.plan_check import tried
from mirror_explainer.pddl.plan_text import Step
from mirror_explainer.pddl.progress import Progress, StepStatus
from mirror_explainer.pddl.states import ConflictError, Evaluator, State, UnknownNumberError
from mirror_explainer.pddl.task import Task

# With more robots than three or so not all orders are tried, only the next ones.
_MOST_CUTS = 2000


def follow(
    episode: Episode,
    state: State,
    known: Progress,
    remaining: Sequence[Step] | None = None,
    uncertain: Collection[str] = (),
    task: Task | None = None,
) -> Progress | None:
    """Return the progress that a later state shows, None if it is not one of the episode.

    `remaining` is the plan that came with it, if any: what is left of the episode's, or all
    of it. Of several places in the plan that the state fits, the last is taken, and
    none before what was `known`. The `task` with that state tells, where numbers are other
    ones than planned, whether the rest of the plan still works, and whether what remains is
    a plan of its own.
    """
    if task and goal_of(task) != episode.goal:
        return None
    left = None if remaining is None else _left(episode, remaining)
    if remaining is not None and not any(_fits(place, left) for place in episode.places):
        return None
    found = []
    for count, place in enumerate(episode.places):
        if place.happened < known.happened:
            continue
        agrees = episode.agrees(state, count, uncertain)
        if agrees is None:  # but for numbers
            agrees = task is not None and _rest_works(episode, task, count, state)
        if agrees:
            found.append(place)
    fitting = [place for place in found if remaining is None or _fits(place, left)]
    if not fitting and remaining is not None and not remaining:
        return None  # the robot has no plan any more
    if not fitting and task and remaining is not None:
        _, fault = tried(task, remaining)
        if fault is None:
            return None
    if not found and task:
        return _out_of_step(episode, task, state, known, uncertain)
    return next(reversed(fitting or found), None)


def _left(episode: Episode, remaining: Sequence[Step]) -> frozenset[int] | None:
    """Return the positions of the remaining steps, as late as they can be, in the plan.

    None if these are not its steps in its order.
    """
    positions, place = set[int](), len(episode.steps)
    for step in reversed(remaining):
        place = next(
            (p for p in reversed(range(place)) if episode.steps[p].words == step.words), -1
        )
        if place < 0:
            return None
        positions.add(place)
    return frozenset(positions)


def _fits(progress: Progress, left: frozenset[int] | None) -> bool:
    """Say whether what is left is what is not done: what goes on may be named, or not.

    So it is with the whole plan, wherever the robot is in it.
    """
    if left is None:
        return False
    if len(left) == len(progress.steps):
        return True
    return not left & set(progress.positions(StepStatus.DONE)) and left >= set(
        progress.positions(StepStatus.AHEAD)
    )


def _rest_works(episode: Episode, task: Task, count: int, state: State) -> bool:
    """Say whether what is left after so many happenings can be carried out from a state."""
    evaluator = Evaluator(task)
    given = ground(evaluator, episode.steps)
    happenings = episode.run.happenings
    going = Progress.after(happenings, count).positions(StepStatus.RUNNING)
    return outcome(task, given, happenings[count:], state, evaluator, going) is not None


def _out_of_step(
    episode: Episode, task: Task, state: State, known: Progress, uncertain: Collection[str]
) -> Progress | None:
    """Return the progress of steps that overlap, and start or end in another order than planned.

    So it is where several robots work side by side, and one is late.
    """
    evaluator, happenings = Evaluator(task), episode.run.happenings
    given = ground(evaluator, episode.steps)
    in_turn = [happening.step for happening in happenings]
    if in_turn == sorted(in_turn):
        return None  # no steps overlap
    matter = [a for a in (*episode.matters[0], *uncertain) if a not in state.numbers]
    wanted = [evaluator.value_of(atom, state) for atom in matter]
    best: Progress | None = None
    for cut, progress, there in _cuts(episode, given, evaluator):
        if progress.happened < (best or known).happened:
            continue
        if wanted == [evaluator.value_of(atom, there) for atom in matter]:
            rest = [h for k, h in enumerate(happenings) if k not in cut]
            going = progress.positions(StepStatus.RUNNING)
            if outcome(task, given, rest, state, evaluator, going):
                best = progress
    return best


def _cuts(
    episode: Episode, steps: Sequence[GroundStep], evaluator: Evaluator
) -> Iterator[tuple[frozenset[int], Progress, State]]:
    """Yield which happenings may have happened, by their places, the progress and the state then.

    The fewest first, and not all of them where too many robots work.
    """
    happenings = episode.run.happenings
    cuts = {frozenset[int](): episode.first}
    waiting = deque(cuts)
    while waiting and len(cuts) < _MOST_CUTS:
        cut = waiting.popleft()
        there, progress = cuts[cut], _cut(happenings, cut)
        yield cut, progress, there
        for k, happening in enumerate(happenings):
            step = steps[happening.step]
            is_next = k not in cut and (
                happening.starts or progress.steps[happening.step] is StepStatus.RUNNING
            )
            if not is_next or cut | {k} in cuts:
                continue
            try:
                if step.lacking(step.conditions(happening), there, evaluator):
                    continue
                changes = evaluator.changes(step.effects(happening), there, step.binding)
            except (ConflictError, UnknownNumberError):
                continue
            cuts[cut | {k}] = there.after(changes)
            waiting.append(cut | {k})


def _cut(happenings: Sequence[Happening], happened: Collection[int]) -> Progress:
    """Return the progress when some happenings have happened, given by their places."""
    statuses = dict.fromkeys((happening.step for happening in happenings), StepStatus.AHEAD)
    for place in sorted(happened):
        ends = happenings[place].ends
        statuses[happenings[place].step] = StepStatus.DONE if ends else StepStatus.RUNNING
    return Progress(tuple(statuses[step] for step in sorted(statuses)))
