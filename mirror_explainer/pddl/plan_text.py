"""Plan texts in: every form that planners on robots write, checked against the task."""

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

import unified_planning.model as up
from unified_planning.exceptions import UPException
from unified_planning.model import FNode
from unified_planning.model.walkers import StateEvaluator
from unified_planning.plans import ActionInstance

from mirror_explainer.errors import InputError, did_you_mean
from mirror_explainer.input_limits import InputLimits
from mirror_explainer.pddl import Task, atom_text, conjuncts, ground_text
from mirror_explainer.pddl.simulation import Run, can_simulate, carry_out
from mirror_explainer.pddl.text.size import instances
from mirror_explainer.text_files import plain_text

_NUMBER = r'\d+(?:\.\d*)?(?:e[+-]?\d+)?'
_WORD = r'[^\s()\[\],;:]+'
# "step 0:" or "0.000:", then the action, then "[duration]" or "[D:1.00; C:0.10]", then a comment.
# No two runs of white space may meet in it: a line of spaces would take quadratic time.
_LINE = re.compile(
    rf'(?:(?:step\s+)?(?P<start>{_NUMBER})\s*:\s*)?'
    rf'(?:\(\s*(?P<lisp>{_WORD}(?:\s+{_WORD})*)\s*\)'
    rf'|(?P<name>{_WORD})\s*\(\s*(?:(?P<arguments>{_WORD}(?:\s*,\s*{_WORD})*)\s*)?\)'
    rf'|(?P<bare>{_WORD}(?:[ \t]+{_WORD})*))'
    r'(?:\s*\[(?P<lasting>[^\]]*)\])?(?:\s*;.*)?',
    re.IGNORECASE,
)
_LASTING = re.compile(rf'\s*(?:d\s*:\s*)?(?P<seconds>{_NUMBER})\s*(?:;.*)?', re.IGNORECASE)
_HEADER = re.compile(r'\s*(?P<header>plan|sequentialplan|timetriggeredplan)\s*:\s*', re.IGNORECASE)

_ANOTHER_TASK = 'Give domain, problem and plan of one task; this plan seems to be for another.'
_MOSTLY_FITS = 'Correct that line, or declare what it names: most of the plan fits the task.'
_NOT_CURRENT = (
    'Give the problem with the state as it is now, and the plan with what is left to do from '
    'there; publish both, one right after the other, whenever either changes.'
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


@dataclass(frozen=True)
class Step:
    """One action of a plan text: the words "name argument …" and the line (from 1).

    `start` and `end` are when it goes on, where the text says so.
    """

    words: tuple[str, ...]
    line: int
    start: float | None = None
    end: float | None = None

    @property
    def action(self) -> str:
        """The ground action as canonical text."""
        return ground_text(self.words[0], self.words[1:])


def read_plan(
    text: str, source: str = 'plan', limits: InputLimits | None = None
) -> tuple[Step, ...]:
    """Read a plan text; timed lines are put in the order of their start times.

    An empty text, or one of comments only, is the empty plan. Raises
    InputError with line and text for anything that is no plan line, and for
    more than the limits allow.
    """
    if limits:
        limits.require_bytes(text, source)
    text = plain_text(text)
    if re.match(r'(?:\s|;[^\n]*(?:\n|$))*\(\s*define\b', text, re.IGNORECASE):
        raise InputError(
            source,
            'this is a PDDL definition, but a plan is expected here: are the two mixed up?',
            1,
            cure='Check which is which: the files, or the names and remappings of the topics.',
        )
    steps = list(_steps(text, source))
    if limits:
        limits.require('max_plan_length', len(steps), 'its actions', source)
    timed = [step for step in steps if step.start is not None]
    if timed and len(timed) < len(steps):
        line = next(step.line for step in steps if step.start is None)
        raise InputError(
            source,
            'this line has no start time, but others have',
            line,
            cure='Give every line a start time, or none.',
        )
    return tuple(sorted(steps, key=lambda step: step.start or 0.0))


def check_plan(
    task: Task,
    steps: tuple[Step, ...],
    source: str = 'plan',
    limits: InputLimits | None = None,
) -> Run:
    """Check that the plan can be carried out and reaches the task's goal; return how it goes.

    Raises InputError that names the first action that fails and the
    condition it lacks, or the goal that the plan does not reach; or says that
    there is more to check than the limits allow.
    """
    plan = _action_instances(task.model, steps, source)
    if limits:
        count = instances(task.model, [instance.action for instance in plan])
        limits.require('max_instances', count, 'the facts to look at to check it', source)
    if not can_simulate(task):
        raise InputError(source, _UNCHECKED, cure=_LEAVE_OUT)
    try:
        run = carry_out(task, plan)
        failure = _failure(task, steps, plan, run, source)
    except (UPException, NotImplementedError) as error:
        missing = re.search(r'does not have a value for the value (.+)', str(error))
        if missing:
            raise InputError(
                source,
                f'the problem gives no value for {missing[1]}, which the plan needs',
                cure='Give it a value in the :init of the problem.',
            ) from error
        raise InputError(source, f'{_UNCHECKED} ({error})', cure=_LEAVE_OUT) from error
    except OverflowError as error:
        raise InputError(source, 'its cost is too large a number') from error
    if failure:
        raise failure
    return run


def without_dummy(task: Task, steps: tuple[Step, ...]) -> tuple[Step, ...]:
    """Return the steps without a trailing (reach-goal) that the domain does not have."""
    if steps and steps[-1].words == ('reach-goal',) and not task.model.has_action('reach-goal'):
        return steps[:-1]
    return steps


def _steps(text: str, source: str) -> Iterator[Step]:
    """Yield the step of every line with an action."""
    in_up_plan = False
    for number, line in enumerate(text.split('\n'), start=1):
        content = line
        header = _HEADER.match(line)
        if header:
            in_up_plan = in_up_plan or header['header'].lower() != 'plan'
            content = line[header.end() :]
        if re.fullmatch(r'\s*(;.*)?', content):
            continue
        found = _LINE.fullmatch(content.strip())
        # A bare word is an action after "0:", or as unified-planning prints one without arguments.
        if not found or (found['bare'] and not found['start'] and not in_up_plan):
            raise InputError(
                source,
                f'this is no action of a plan: "{line.strip()[:80]}"',
                number,
                cure='Write one action a line, such as (move a b) or 0.5: (move a b) [2.0].',
            )
        words = found['lisp'] or found['bare']
        if words is None:
            words = f'{found["name"]} {(found["arguments"] or "").replace(",", " ")}'
        start = None if found['start'] is None else float(found['start'])
        lasting = _LASTING.fullmatch(found['lasting'] or '')
        end = start + float(lasting['seconds']) if start is not None and lasting else None
        yield Step(tuple(words.lower().split()), number, start, end)


def _action_instances(
    model: up.Problem, steps: tuple[Step, ...], source: str
) -> list[ActionInstance]:
    """Return unified-planning's actions for the steps; raise InputError for the first misfit."""
    actions = {action.name: action for action in model.actions}
    objects = {item.name: item for item in model.all_objects}
    misfits = [(misfit, step) for step in steps if (misfit := _misfit(step, actions, objects))]
    if misfits:
        misfit, step = misfits[0]
        raise InputError(
            source,
            misfit.reason + did_you_mean(misfit.unknown, misfit.known),
            step.line,
            cure=_MOSTLY_FITS if 2 * len(misfits) <= len(steps) else _ANOTHER_TASK,
        )
    promoted = model.environment.expression_manager.auto_promote
    return [
        ActionInstance(actions[name], promoted([objects[word] for word in arguments]))
        for name, *arguments in (step.words for step in steps)
    ]


def _misfit(
    step: Step, actions: Mapping[str, up.Action], objects: Mapping[str, up.Object]
) -> _Misfit | None:
    """Return in what a step does not fit the task, None if it does."""
    name, *arguments = step.words
    if name not in actions:
        return _Misfit(f'the domain has no action "{name}"', name, actions)
    parameters = actions[name].parameters
    if len(arguments) != len(parameters):
        return _Misfit(f'{step.action}: "{name}" takes {len(parameters)} arguments')
    for argument, parameter in zip(arguments, parameters, strict=True):
        if argument not in objects:
            reason = f'{step.action}: the problem has no object "{argument}"'
            return _Misfit(reason, argument, objects)
        of_type = objects[argument].type
        if not parameter.type.is_compatible(of_type):
            return _Misfit(
                f'{step.action}: {argument} is of type {of_type.name}, '
                f'but "{name}" takes a {parameter.type.name} there'
            )
    return None


def _failure(
    task: Task, steps: tuple[Step, ...], plan: list[ActionInstance], run: Run, source: str
) -> InputError | None:
    """Say which action fails first and what it lacks, or which goal is not reached."""
    evaluator = StateEvaluator(task.model)
    state = run.states[-1]
    position = len(run.states) - 1
    if position == len(steps):
        missing = [g for g in task.model.goals if not evaluator.evaluate(g, state).is_true()]
        reason = f'the plan does not reach the goal: {_conditions(missing)}'
        return InputError(source, reason, cure=_NOT_CURRENT) if missing else None
    step, instance = steps[position], plan[position]
    bound = dict(zip(instance.action.parameters, instance.actual_parameters, strict=True))
    missing = [
        condition.substitute(bound)
        for precondition in instance.action.preconditions
        for condition in conjuncts(precondition)
        if not evaluator.evaluate(condition.substitute(bound), state).is_true()
    ]
    if any(condition.is_false() for condition in missing):
        lacks = 'its conditions contradict each other'
    else:
        lacks = _conditions(missing) if missing else 'its effects contradict each other'
    return InputError(
        source,
        f'{step.action} cannot be carried out as step {position + 1} of {len(steps)}: {lacks}'
        f'{_concurrency(task, steps, position)}',
        step.line,
        cure=_NOT_CURRENT,
    )


def _concurrency(task: Task, steps: tuple[Step, ...], position: int) -> str:
    """Remark that actions were to go on at the same time, "" if none were up to the position."""
    start = steps[position].start
    if not task.durative or start is None:
        return ''
    meanwhile = [step for step in steps[:position] if step.end is not None and step.end > start]
    if not meanwhile:
        return ''
    return (
        f'; the plan lets it begin while {meanwhile[0].action} still goes on, but actions with '
        'durations can be explained only if they also work one after the other, in the order in '
        'which they begin'
    )


def _conditions(conditions: list[FNode]) -> str:
    """Return "(robot-at left) does not hold" for the conditions that fail."""
    texts = [
        f'{atom_text(condition)} does not hold'
        if condition.is_fluent_exp()
        else f'{atom_text(condition.arg(0))} holds'
        if condition.is_not() and condition.arg(0).is_fluent_exp()
        else f'"{condition}" does not hold'
        for condition in conditions
    ]
    return ', '.join(texts)
