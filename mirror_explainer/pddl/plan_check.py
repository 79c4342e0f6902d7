"""A plan checked against its task: every step fits, can be carried out, and reaches the goal."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import unified_planning.model as up
from unified_planning.model import FNode

from mirror_explainer.errors import InputError, did_you_mean
from mirror_explainer.input_limits import InputLimits
from mirror_explainer.pddl.atoms import atom_text, condition_text
from mirror_explainer.pddl.expressions import arguments
from mirror_explainer.pddl.plan_text import Step
from mirror_explainer.pddl.simulation import Failure, Run, carry_out
from mirror_explainer.pddl.states import Evaluator, State, UnknownNumberError
from mirror_explainer.pddl.task import Task
from mirror_explainer.pddl.text.size import instances

_ANOTHER_TASK = 'Give domain, problem and plan of one task; this plan seems to be for another.'
_MOSTLY_FITS = 'Correct that line, or declare what it names.'
_PUBLISH_BOTH = (
    '(A robot must publish problem and plan one right after the other, whenever either changes.)'
)
_STEP_MISSING = (
    'See whether a step before it is missing or out of order, or the :init of the problem is not '
    f'the state in which the plan starts. {_PUBLISH_BOTH}'
)
_END_MISSING = (
    'See whether the last steps are missing, or the plan is one for another goal or another :init '
    f'than those of the problem. {_PUBLISH_BOTH}'
)
_LEAVE_OUT = 'Leave that out of the PDDL; the README says what is not read.'
_UNCHECKED = (
    'the plan cannot be checked: the problem may use more of PDDL than actions without duration, '
    'or leave numbers without a first value'
)


@dataclass(frozen=True)
class _Misfit:
    """Why a step is no action of the task; and the unknown name in it, with those there are."""

    reason: str
    unknown: str = ''
    known: Iterable[str] = ()


def check_plan(
    task: Task,
    steps: Sequence[Step],
    source: str = 'plan',
    limits: InputLimits | None = None,
) -> Run:
    """Check that the plan can be carried out and reaches the task's goal; return how it goes.

    Raises InputError that names the first action that fails and the condition it
    lacks, or the goal that the plan does not reach; or says that there is more to
    check than the limits allow.
    """
    run, fault = tried(task, steps, source, limits)
    if fault:
        raise fault
    return run


def tried(
    task: Task,
    steps: Sequence[Step],
    source: str = 'plan',
    limits: InputLimits | None = None,
) -> tuple[Run, InputError | None]:
    """Carry out the plan; return how it goes, and what is wrong if it does not reach the goal.

    Raises InputError for a plan that cannot even be tried.
    """
    require_fitting(task.model, steps, source)
    if limits:
        count = instances(task.model, [task.model.action(step.words[0]) for step in steps])
        limits.require('max_instances', count, 'the facts to look at to check it', source)
    model = task.timed or task.model
    if model.trajectory_constraints or model.timed_goals or model.timed_effects:
        raise InputError(source, _UNCHECKED, cure=_LEAVE_OUT)
    evaluator = Evaluator(task)
    try:
        run = carry_out(task, steps, evaluator=evaluator)
        if run.failure:
            return run, _refusal(steps, run.failure, run.passed[-1], source)
        missing = missing_goals(task, run.passed[-1], evaluator)
    except UnknownNumberError as error:
        raise InputError(
            source,
            f'the problem gives no value for {error.atom}, which the plan needs',
            cure='Give it a value in the :init of the problem.',
        ) from error
    except NotImplementedError as error:
        raise InputError(source, f'{_UNCHECKED} ({error})', cure=_LEAVE_OUT) from error
    except OverflowError as error:
        raise InputError(source, 'its cost is too large a number') from error
    if missing:
        reason = f'the plan does not reach the goal: {_conditions(missing, run.passed[-1])}'
        return run, InputError(source, reason, cure=_END_MISSING)
    return run, None


def missing_goals(task: Task, state: State, evaluator: Evaluator) -> list[FNode]:
    """Return the parts of the task's goal that do not hold in a state."""
    return [goal for goal in task.model.goals if not evaluator.holds(goal, state)]


def require_fitting(model: up.Problem, steps: Sequence[Step], source: str) -> None:
    """Raise InputError for the first step that is no action of the task."""
    actions = {action.name: action for action in model.actions}
    objects = {item.name: item for item in model.all_objects}
    misfits = [(misfit, step) for step in steps if (misfit := _misfit(step, actions, objects))]
    if misfits:
        misfit, step = misfits[0]
        strange = sum(1 for other, _ in misfits if other.unknown)
        raise InputError(
            source,
            misfit.reason + did_you_mean(misfit.unknown, misfit.known),
            step.line,
            cure=_MOSTLY_FITS if 2 * strange <= len(steps) else _ANOTHER_TASK,
        )


def _misfit(
    step: Step, actions: Mapping[str, up.Action], objects: Mapping[str, up.Object]
) -> _Misfit | None:
    """Return in what a step does not fit the task, None if it does."""
    name, *given = step.words
    written_name, *written = step.as_written
    shown = f'({" ".join(step.as_written)})'
    if name not in actions:
        return _Misfit(f'the domain has no action "{written_name}"', name, actions)
    parameters = actions[name].parameters
    if len(given) != len(parameters):
        count = arguments(len(parameters))
        return _Misfit(
            f'{shown}: "{name}" takes {count}, {_signature(parameters)}, not {len(given)}'
        )
    for argument, as_written, parameter in zip(given, written, parameters, strict=True):
        if argument not in objects:
            reason = f'{shown}: the problem has no object "{as_written}"'
            return _Misfit(reason, argument, objects)
        of_type = objects[argument].type
        if not parameter.type.is_compatible(of_type):
            return _Misfit(
                f'{shown}: {as_written} is of type {of_type.name}, '
                f'but "{name}" takes a {parameter.type.name} there: {_signature(parameters)}'
            )
    return None


def _signature(parameters: Iterable[up.Parameter]) -> str:
    """Return "(?from - place ?to - place)"."""
    return f'({" ".join(f"?{p.name} - {p.type.name}" for p in parameters)})'


def _refusal(steps: Sequence[Step], failure: Failure, state: State, source: str) -> InputError:
    """Say which action fails first, when, and what it lacks in the state."""
    step = steps[failure.step]
    if failure.lacking:
        lacks = f'{_conditions(failure.lacking, state)}{failure.when}'
    else:
        lacks = f'its effects contradict each other{failure.when}'
    return InputError(
        source,
        f'{step.action} cannot be carried out as step {failure.step + 1} of {len(steps)}: {lacks}',
        step.line,
        cure=_STEP_MISSING,
    )


def _conditions(conditions: Sequence[FNode], state: State) -> str:
    """Return "(robot-at left) does not hold" for the conditions that fail in the state."""
    return ', '.join(
        f'{condition_text(condition.arg(0))} holds'
        if condition.is_not()
        else f'{condition_text(condition)} does not hold{_numbers(condition, state)}'
        for condition in conditions
    )


def _numbers(condition: FNode, state: State) -> str:
    """Return " where (battery) is 5" for the numbers in a condition."""
    atoms = map(atom_text, condition.environment.free_vars_extractor.get(condition))
    known = [f'{a} is {float(state.numbers[a]):g}' for a in sorted(atoms) if a in state.numbers]
    return f' where {" and ".join(known)}' if known else ''
