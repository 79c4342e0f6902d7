"""How far a plan is carried out: each of its steps is done, left out, going on, or ahead."""

import itertools
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import StrEnum
from functools import cached_property

from mirror_explainer.errors import InputError, did_you_mean, one_line
from mirror_explainer.pddl.atoms import ground_text
from mirror_explainer.pddl.happenings import Happening
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


class StepStatus(StrEnum):
    """How far the robot is with a step of its plan."""

    AHEAD = 'ahead'
    RUNNING = 'running'
    DONE = 'done'
    SKIPPED = 'skipped'

    @property
    def is_over(self) -> bool:
        """Whether nothing of the step is left to do: it is done, or was left out."""
        return self in (StepStatus.DONE, StepStatus.SKIPPED)


@dataclass(frozen=True)
class Progress:
    """What has become of each step of a plan. `failed` are those, by position, that went wrong.

    A step that failed is ahead: it is still to be done, if the robot can. `reasons` are why
    steps failed or were left out, by position, in the robot's words, of those where it says.
    """

    steps: tuple[StepStatus, ...]
    failed: tuple[int, ...] = ()
    reasons: Mapping[int, str] = field(default_factory=dict)

    @classmethod
    def none(cls, length: int) -> 'Progress':
        """Return the progress of a plan that has not begun."""
        return cls((StepStatus.AHEAD,) * length)

    @classmethod
    def each(cls, happenings: Sequence[Happening]) -> Iterator['Progress']:
        """Yield the progress of a plan after none, one, two … of the happenings of its run."""
        steps = [StepStatus.AHEAD] * sum(happening.ends for happening in happenings)
        yield cls(tuple(steps))
        for happening in happenings:
            steps[happening.step] = StepStatus.DONE if happening.ends else StepStatus.RUNNING
            yield cls(tuple(steps))

    @classmethod
    def after(cls, happenings: Sequence[Happening], count: int) -> 'Progress':
        """Return the progress when the first `count` of a run's happenings have happened."""
        return next(itertools.islice(cls.each(happenings), count, None))

    @property
    def finished(self) -> bool:
        """Whether every step is done, or was left out."""
        return all(status.is_over for status in self.steps)

    @cached_property
    def done(self) -> int:
        """How many starts and ends there have been."""
        return sum(
            2 if own is StepStatus.DONE else own is StepStatus.RUNNING for own in self.steps
        )

    @property
    def without_failures(self) -> 'Progress':
        """The progress of a robot that tries again what failed."""
        reasons = {p: reason for p, reason in self.reasons.items() if p not in self.failed}
        return replace(self, failed=(), reasons=reasons)

    def undone(self, before: 'Progress') -> tuple[int, ...]:
        """Return the positions of the steps that were done before, and are not any more."""
        done = self.positions(StepStatus.DONE)
        return tuple(p for p in before.positions(StepStatus.DONE) if p not in done)

    def positions(self, *statuses: StepStatus) -> tuple[int, ...]:
        """Return the positions, from 0, of the steps of which one of these is true."""
        return tuple(index for index, own in enumerate(self.steps) if own in statuses)


def read_progress(
    text: str, actions: Sequence[str], known: Progress | None = None, source: str = 'progress'
) -> Progress:
    """Read a progress text: "done: (…)", or skipped, running or failed, one step a line.

    It is about the plan with these `actions`, of which `known` is what was known before. What
    failed or was skipped may have a reason: "failed: (grab cup) because the cup is too hot".
    Steps that are not named are ahead, also before others that are done; the lines may stand
    in any order, and the same action twice counts from its first place in the plan. An empty
    text says that nothing has begun. Raises InputError with the line of what is no such line
    or no step of the plan, and for a step that was done and is not any more.
    """
    places: dict[str, list[int]] = {}
    for position, action in enumerate(actions):
        places.setdefault(action, []).append(position)
    named: dict[str, list[tuple[str, str]]] = {action: [] for action in places}
    for number, line in enumerate(plain_text(text).split('\n'), start=1):
        content = line.split(';')[0].strip()
        if content:
            status, action, reason = _line(content, number, source)
            if action not in places:
                raise InputError(
                    source,
                    f'{action} is no step of the plan{did_you_mean(action, places)}',
                    number,
                    cure='Publish the plan first, and name its steps as they stand there.',
                )
            named[action].append((status, reason))
            count = len(places[action])
            if len(named[action]) > count:
                times = 'once' if count == 1 else f'{count} times'
                fault = f'{action} is in the plan {times}, and is named here once more'
                raise InputError(source, fault, number, cure=_FORM)
    steps = [StepStatus.AHEAD] * len(actions)
    failed, reasons = [], {}
    for action, told in named.items():
        told.sort(key=lambda line: _STATUSES.index(line[0]))
        for position, (status, reason) in zip(places[action], told, strict=False):
            if reason:
                reasons[position] = reason
            if status == 'failed':
                failed.append(position)
            else:
                steps[position] = StepStatus(status)
    failed.sort()
    progress = Progress(tuple(steps), tuple(failed), reasons)
    if known is not None:
        _require_no_way_back(progress, known, actions, source)
    return progress


def is_about(text: str, actions: Sequence[str]) -> bool:
    """Say whether a progress text can be read for the plan with these actions."""
    try:
        read_progress(text, actions)
    except InputError:
        return False
    return True


def _line(content: str, number: int, source: str) -> tuple[str, str, str]:
    """Return a line's status, the action, and the reason, '' if none is given."""
    found = _LINE.fullmatch(content)
    status = found['status'].lower() if found else ''
    if not found or status not in _STATUSES or (found['because'] and status not in _REASONED):
        raise InputError(source, f'this is no progress: "{content[:80]}"', number, cure=_FORM)
    name, *arguments = found['words'].split()
    return status, ground_text(name, arguments), one_line(found['reason'] or '')


def _require_no_way_back(
    progress: Progress, known: Progress, actions: Sequence[str], source: str
) -> None:
    """Raise InputError for a step that was done, and is not any more."""
    undone = [actions[position] for position in progress.undone(known)]
    if undone:
        raise InputError(
            source,
            f'{undone[0]} was done, and is not any more',
            cure='A robot that begins again publishes its plan again; each message is the whole '
            'progress, what is done included.',
        )
