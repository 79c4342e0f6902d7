"""What a robot says from the first step of its plan to the last, asked before and during each."""

import itertools
import json
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from patience import PATIENCE

from mirror_explainer.node.inputs import Configuration, NodeSettings, Text
from mirror_explainer.node.live_explainer import LiveExplainer

CONFIG = Path(__file__).parents[2] / 'config'
# The examples of this package with a plan to go through.
EXAMPLES = ('warehouse', 'hospital', 'packing')


@dataclass(frozen=True)
class Moment:
    """A question while `done` steps are done, and the next one is going on or not."""

    done: int
    running: bool
    spoken: str
    understanding: float


def transcript(folder: Path) -> Iterator[Moment]:
    """Ask while the robot of an example does its plan, and tells so by `progress`."""
    reports: list[str] = []
    settings = NodeSettings(
        user_model_file=str(folder / 'user_model.yaml'), answer_timeout=PATIENCE
    )
    explainer = LiveExplainer(Configuration(settings), lambda text, report: reports.append(report))
    domain, problem, plan = (
        (folder / name).read_text() for name in ('domain.pddl', 'problem.pddl', 'plan.txt')
    )
    steps = [line for line in plan.split('\n') if line.startswith('(')]
    try:
        for name, text in (('domain', domain), ('problem', problem), ('plan', plan)):
            explainer.hear(name, Text(text, f'/{name}'))
        for done in range(len(steps) + 1):
            for running in (False, True)[: 2 if done < len(steps) else 1]:
                lines = [f'done: {step}' for step in steps[:done]]
                lines += [f'running: {steps[done]}'] if running else []
                explainer.hear('progress', Text('\n'.join(lines), '/progress'))
                yield _asked(explainer, reports, done, running)
    finally:
        explainer.close()


def _asked(explainer: LiveExplainer, reports: list[str], done: int, running: bool) -> Moment:
    reply = explainer.ask()
    assert reply.success, reply.message
    report = json.loads(reports[-1])
    assert report['complete'], 'all is planned for'
    statuses = [row['status'] for row in report['plan']]
    assert (statuses.count('done'), statuses.count('running')) == (done, int(running))
    return Moment(done, running, reply.message, report['understanding'])


def table(moments: Iterable[Moment]) -> str:
    """Return as Markdown what is said before the first step, during each, and after the last.

    What is said of steps one after the other stands in one row.
    """
    first, *between, last = moments
    lines = ['| step | answer |', '|---|---|', _row('before', first.spoken)]
    during = [moment for moment in between if moment.running]
    for spoken, same in itertools.groupby(during, lambda moment: moment.spoken):
        steps = [str(moment.done + 1) for moment in same]
        lines.append(_row(' – '.join(dict.fromkeys([steps[0], steps[-1]])), spoken))
    return '\n'.join([*lines, _row('after', last.spoken)])


def _row(when: str, spoken: str) -> str:
    return f'| {when} | {" ".join(spoken.splitlines())} |'
