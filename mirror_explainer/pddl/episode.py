"""One task of the robot from beginning to end: its plan, and how far it is.

An episode is (I_0, G, π) as they were when the plan began. A later message continues
it if its state is one that the plan leads through, in all that matters: what the rest of
the plan needs or changes, what the goal names, and what the listener is unsure of.
"""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property

from mirror_explainer.input_limits import InputLimits
from mirror_explainer.pddl.derived.facts import DerivedFacts
from mirror_explainer.pddl.happenings import GroundStep, Happening, ground, orders
from mirror_explainer.pddl.plan_check import missing_goals, tried
from mirror_explainer.pddl.plan_text import Step
from mirror_explainer.pddl.progress import Progress, StepStatus
from mirror_explainer.pddl.simulation import Run, happen
from mirror_explainer.pddl.states import Evaluator, State, UnknownNumberError
from mirror_explainer.pddl.taken_back import is_plausible, taken_back
from mirror_explainer.pddl.task import Task


@dataclass(frozen=True)
class Episode:
    """The plan π, carried out from I_0; plain values that outlive unified-planning's.

    `left_out` steps before the first were left out, since it cannot be told what they changed.
    `matters` has the atoms that matter when k happenings have happened, k = 0, 1, …
    """

    steps: tuple[Step, ...]
    run: Run
    goal: frozenset[str]
    matters: tuple[frozenset[str], ...] = field(repr=False)
    derived: DerivedFacts = field(repr=False, compare=False)
    left_out: int = 0

    @property
    def actions(self) -> tuple[str, ...]:
        """The steps as canonical texts."""
        return tuple(step.action for step in self.steps)

    @property
    def first(self) -> State:
        """I_0."""
        return self.run.passed[0]

    @cached_property
    def places(self) -> tuple[Progress, ...]:
        """The progress after each number of happenings."""
        return tuple(Progress.each(self.run.happenings))

    def comes_to(self, progress: Progress) -> bool:
        """Say whether nothing has begun before what was to end first was over."""
        over = progress.positions(StepStatus.DONE, StepStatus.SKIPPED)
        begun = {*over, *progress.positions(StepStatus.RUNNING)}
        is_over = True  # whatever was to end so far
        for happening in self.run.happenings:
            if happening.starts and happening.step in begun and not is_over:
                return False
            if happening.ends:
                is_over = is_over and happening.step in over
        return True

    def agrees(self, state: State, count: int, uncertain: Collection[str] = ()) -> bool | None:
        """Say whether a state is the one after so many happenings, in all that matters.

        None where it is but for numbers.
        """
        expected, exactly = self.run.passed[count], True
        for atom in (*self.matters[count], *uncertain):
            if atom in expected.numbers:
                exactly = exactly and state.numbers.get(atom) == expected.numbers[atom]
            elif self._holds(atom, state) != self._holds(atom, expected):
                return False
        return exactly or None

    def _holds(self, atom: str, state: State) -> bool:
        return atom in state.facts or self.derived.hold(atom, state.facts)


def begin(
    task: Task,
    steps: Sequence[Step],
    source: str = 'plan',
    limits: InputLimits | None = None,
    done: Collection[int] = (),
) -> tuple[Episode, Progress]:
    """Return the episode that a task and a plan begin, or are in the middle of.

    What the steps changed that are `done`, by position, is taken back, as far as the task's
    state has it. Where the plan cannot be carried out from that state, something of it may
    have happened: what its steps changed is taken back. Where that cannot be, the longest rest
    of the plan that can be carried out from the state is the episode. Raises InputError as
    `check_plan` does.
    """
    run, fault = tried(task, steps, source, limits)
    evaluator = Evaluator(task)
    if fault is None:
        if done:
            run = _whole(task, steps, run, done, evaluator) or run
        return _episode(task, steps, run, evaluator), Progress.none(len(steps))
    joined = _joined(task, steps, evaluator) or _rest(task, steps, evaluator)
    if joined is None:
        raise fault
    return joined


def _episode(
    task: Task, steps: Sequence[Step], run: Run, evaluator: Evaluator, left_out: int = 0
) -> Episode:
    """Return the episode of a plan that has been carried out."""
    given = ground(evaluator, steps)
    return Episode(
        tuple(steps),
        run,
        goal_of(task),
        _matters(task, given, run.happenings, evaluator),
        evaluator.derived,
        left_out,
    )


def goal_of(task: Task) -> frozenset[str]:
    """Return the parts of a task's goal as texts that can be compared."""
    return frozenset(map(str, task.model.goals))


def _matters(
    task: Task,
    steps: Sequence[GroundStep],
    happenings: Sequence[Happening],
    evaluator: Evaluator,
) -> tuple[frozenset[str], ...]:
    """Return what the rest of the plan needs or changes after each happening.

    With it goes what the goal names, and what the start of a step changed that goes on.
    Of numbers only what is needed matters.
    """
    matters = frozenset(atom for goal in task.model.goals for atom in evaluator.atoms(goal))
    found = [matters]
    begun = {
        h.step: frozenset(_changed(steps[h.step], h, evaluator)) for h in happenings if h.starts
    }
    going: set[int] = set()
    for happening in reversed(happenings):
        step = steps[happening.step]
        if happening.ends:
            going.add(happening.step)
        if happening.starts:
            going.remove(happening.step)
        needed = [*step.conditions(happening), *(step.invariants if happening.ends else ())]
        atoms = {atom for part in needed for atom in evaluator.atoms(part, step.binding)}
        for effect in step.effects(happening):
            for own in evaluator.bindings(effect.forall, step.binding):
                atoms.update(evaluator.atoms(effect.condition, own))
        atoms.update(_changed(step, happening, evaluator))
        matters = matters if atoms <= matters else matters | atoms
        found.append(matters.union(*(begun[position] for position in going)))
    return tuple(reversed(found))


def _changed(step: GroundStep, happening: Happening, evaluator: Evaluator) -> Iterator[str]:
    """Yield the atoms, numbers left out, that a step's start or end may change."""
    for effect in step.effects(happening):
        if effect.fluent.fluent().type.is_bool_type():
            for own in evaluator.bindings(effect.forall, step.binding):
                yield evaluator.atom(effect.fluent, own)


def _whole(
    task: Task, steps: Sequence[Step], run: Run, done: Collection[int], evaluator: Evaluator
) -> Run | None:
    """Return the run from the state before the steps that are done; None if that cannot be."""
    given, state = ground(evaluator, steps), evaluator.first_state()
    happened = [happening for happening in run.happenings if happening.step in done]
    first = taken_back(state, happened, given, evaluator)
    if first is None or not is_plausible(first, evaluator.model):
        return None
    return outcome(task, given, run.happenings, first, evaluator)


def _joined(
    task: Task, steps: Sequence[Step], evaluator: Evaluator
) -> tuple[Episode, Progress] | None:
    """Return the episode that the task's state is in the middle of, as late as can be."""
    given, state = ground(evaluator, steps), evaluator.first_state()
    for happenings in orders(steps, given):
        for count in reversed(range(1, len(happenings) + 1)):
            first = taken_back(state, happenings[:count], given, evaluator)
            if first is None or not is_plausible(first, evaluator.model):
                continue
            run = outcome(task, given, happenings, first, evaluator)
            if run:
                episode = _episode(task, steps, run, evaluator)
                if episode.agrees(state, count):
                    return episode, Progress.after(happenings, count)
    return None


def _rest(
    task: Task, steps: Sequence[Step], evaluator: Evaluator
) -> tuple[Episode, Progress] | None:
    """Return the episode of the longest rest of the plan that can be carried out."""
    given, state = ground(evaluator, steps), evaluator.first_state()
    for left_out in range(1, len(steps)):
        for happenings in orders(steps[left_out:], given[left_out:]):
            run = outcome(task, given[left_out:], happenings, state, evaluator)
            if run:
                rest = _episode(task, steps[left_out:], run, evaluator, left_out)
                return rest, Progress.none(len(rest.steps))
    return None


def outcome(
    task: Task,
    steps: Sequence[GroundStep],
    happenings: Sequence[Happening],
    state: State,
    evaluator: Evaluator,
    going: Collection[int] = (),
) -> Run | None:
    """Return how it goes from a state on, None where that fails or does not reach the goal."""
    try:
        run = happen(task, steps, happenings, state, evaluator, going)
        reached = not run.failure and not missing_goals(task, run.passed[-1], evaluator)
    except UnknownNumberError:
        return None
    return run if reached else None
