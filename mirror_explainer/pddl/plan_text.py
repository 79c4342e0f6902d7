"""Plan texts in: every form that planners on robots write."""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field

from mirror_explainer.errors import InputError
from mirror_explainer.input_limits import InputLimits
from mirror_explainer.pddl.atoms import ground_text
from mirror_explainer.pddl.planner_output import plan_in
from mirror_explainer.pddl.task import Task
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
_SEVERAL = re.compile(rf'(?:\(\s*{_WORD}(?:\s+{_WORD})*\s*\)\s*){{2,}}')
_LASTING = re.compile(rf'\s*(?:d\s*:\s*)?(?P<seconds>{_NUMBER})\s*(?:;.*)?', re.IGNORECASE)
_FAULT = re.compile(r'\s*fault:\s*(?P<reason>\S.*)', re.IGNORECASE)
_HEADER = re.compile(r'\s*(?P<header>plan|sequentialplan|timetriggeredplan)\s*:\s*', re.IGNORECASE)
_MEND = 'Correct what the robot is told: the next plan is taken up by itself.'


@dataclass(frozen=True)
class Step:
    """One action of a plan text: the words "name argument …" and the line (from 1).

    `start` and `end` are when it goes on, where the text says so; `written` are the words as
    they stand there, for messages.
    """

    words: tuple[str, ...]
    line: int
    start: float | None = None
    end: float | None = None
    written: tuple[str, ...] = field(default=(), compare=False)

    @property
    def action(self) -> str:
        """The ground action as canonical text."""
        return ground_text(self.words[0], self.words[1:])

    @property
    def as_written(self) -> tuple[str, ...]:
        """The words as they stand in the text, or else in lower case."""
        return self.written or self.words


def read_plan(
    text: str, source: str = 'plan', limits: InputLimits | None = None
) -> tuple[Step, ...]:
    """Read a plan text; timed lines are put in the order of their start times.

    An empty text, or one of comments only, is the empty plan. Raises
    InputError with line and text for anything that is no plan line, for
    more than the limits allow, and for "fault: why", which
    a robot sends in the place of a plan that it cannot tell.
    """
    if limits:
        limits.require_bytes(text, source)
    text = plain_text(text)
    if fault := _FAULT.fullmatch(text):
        raise InputError(source, fault['reason'], cure=_MEND)
    if re.match(r'(?:\s|;[^\n]*(?:\n|$))*\(\s*define\b', text, re.IGNORECASE):
        raise InputError(
            source,
            'this is a PDDL definition, but a plan is expected here: are the two mixed up?',
            1,
            cure='Check which is which: the files, or the names and remappings of the topics.',
        )
    try:
        steps = list(_steps(text, source))
    except InputError:
        inside = plan_in(text)
        if inside is None:
            raise
        steps = list(_steps(inside, source))
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
        if _SEVERAL.fullmatch(content.strip()):
            for action in re.findall(r'\(([^()]*)\)', content):
                yield _step(action, number)
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
        yield _step(words, number, start, end)


def _step(words: str, line: int, start: float | None = None, end: float | None = None) -> Step:
    return Step(tuple(words.lower().split()), line, start, end, tuple(words.split()))
