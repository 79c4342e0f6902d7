"""Progress texts in: how far a robot says that it is with its plan, one step a line."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

from mirror_explainer.errors import InputError, did_you_mean, one_line
from mirror_explainer.input_limits import InputLimits
from mirror_explainer.pddl.atoms import ground_text
from mirror_explainer.pddl.progress import Progress, StepStatus
from mirror_explainer.text_files import plain_text

_LINE = re.compile(
    r'(?P<status>[a-z]+)\s*:?\s*\(\s*(?P<words>[^\s()]+(?:\s+[^\s()]+)*)\s*\)'
    r'(?P<because>\s*because\s+(?P<reason>.+))?',
    re.IGNORECASE,
)
# Of the same action twice, the first is the one that is further.
_STATUSES = ('done', 'skipped', 'running', 'failed', 'ahead')
_REASONED = ('failed', 'skipped')
_FORM = 'Write one step a line, as in "done: (move a b)", with done, skipped, running or failed.'


class _Line(NamedTuple):
    """What a line, counted from 1, says of an action; `reason` is '' if it gives none."""

    number: int
    status: str
    action: str
    reason: str


@dataclass(frozen=True)
class ProgressText:
    """What a robot tells of its progress, from `source`, whichever plan it is about.

    `fault` is what is wrong behind these lines, None if nothing is.
    """

    source: str
    lines: tuple[_Line, ...]
    fault: InputError | None = None

    def of(self, actions: Sequence[str]) -> Progress:
        """Return the progress of the plan with these actions.

        Steps that are not named are ahead, also before others that are done; the lines may stand
        in any order, and the same action twice counts from its first place in the plan. Raises
        InputError with the line of what is no progress, or no step of the plan.
        """
        places: dict[str, list[int]] = {}
        for position, action in enumerate(actions):
            places.setdefault(action, []).append(position)
        named: dict[str, list[_Line]] = {action: [] for action in places}
        for line in self.lines:
            if line.action not in places:
                raise InputError(
                    self.source,
                    f'{line.action} is no step of the plan{did_you_mean(line.action, places)}',
                    line.number,
                    cure='Publish the plan first, and name its steps as they stand there.',
                )
            named[line.action].append(line)
            count = len(places[line.action])
            if len(named[line.action]) > count:
                times = 'once' if count == 1 else f'{count} times'
                fault = f'{line.action} is in the plan {times}, and is named here once more'
                raise InputError(self.source, fault, line.number, cure=_FORM)
        if self.fault:
            raise self.fault
        steps = [StepStatus.AHEAD] * len(actions)
        failed, reasons = [], {}
        for action, told in named.items():
            told.sort(key=lambda line: _STATUSES.index(line.status))
            for position, line in zip(places[action], told, strict=False):
                if line.reason:
                    reasons[position] = line.reason
                if line.status == 'failed':
                    failed.append(position)
                else:
                    steps[position] = StepStatus(line.status)
        return Progress(tuple(steps), tuple(sorted(failed)), reasons)

    def is_about(self, actions: Sequence[str]) -> bool:
        """Say whether it can be told of the plan with these actions."""
        try:
            self.of(actions)
        except InputError:
            return False
        return True


def read_progress(
    text: str, source: str = 'progress', limits: InputLimits | None = None
) -> ProgressText:
    """Read a progress text: "done: (…)", or skipped, running or failed, one step a line.

    What failed or was skipped may have a reason: "failed: (grab cup) because the cup is too hot".
    An empty text says that nothing has begun. What is wrong is told of a plan, by `of`.
    """
    lines: list[_Line] = []
    try:
        if limits:
            limits.require_bytes(text, source)
        for number, line in enumerate(plain_text(text).split('\n'), start=1):
            content = line.split(';')[0].strip()
            if content:
                lines.append(_line(content, number, source))
    except InputError as error:
        return ProgressText(source, tuple(lines), error)
    return ProgressText(source, tuple(lines))


def _line(content: str, number: int, source: str) -> _Line:
    found = _LINE.fullmatch(content)
    status = found['status'].lower() if found else ''
    if not found or status not in _STATUSES or (found['because'] and status not in _REASONED):
        raise InputError(source, f'this is no progress: "{content[:80]}"', number, cure=_FORM)
    name, *arguments = found['words'].split()
    return _Line(number, status, ground_text(name, arguments), one_line(found['reason'] or ''))
