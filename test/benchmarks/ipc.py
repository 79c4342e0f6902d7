"""What is read of a folder of tasks, and what is answered: one line each.

Run `MIRROR_EXPLAINER_IPC=FOLDER scripts/benchmark ipc [NAME …]`. The folder has tasks in
folders, `NAME/domain.pddl` and `NAME/problem.pddl`. Each is read; planners look for a plan of
the robot, each for `--seconds` of their own processor time: LAMA's first search and an eager one
of Fast Downward on the texts that the reader makes for planners, and LPG, if `pip install up-lpg`
brought it, on the texts as they are, of which it keeps time and numbers. Where all soft goals can
be reached together, that is planned for, so that there is something to explain. The listener, who
thinks that the robot may want any part of its goal, is told two steps of the first plan that is
one: at once, and again after `--planning` seconds of planning for what they may believe.
"""

import argparse
import importlib.util
import math
import os
import re
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path

from mirror_explainer.errors import InputError, PlanningError
from mirror_explainer.explainer import explain, robot_plan
from mirror_explainer.listener.preparation import RobotPlan, prepare, refine
from mirror_explainer.listener.user_model import CandidateGoal, UserModel
from mirror_explainer.pddl import Task, forget_expressions, read_task
from mirror_explainer.pddl.expressions import as_text, nested_words
from mirror_explainer.planning import Planner
from mirror_explainer.planning.downward.program import find_downward
from mirror_explainer.settings import PlanningSettings, Question
from mirror_explainer.text_files import read_text

MOST_PARTS = 8
MEMORY = 4 << 30  # bytes, of a planner
PATIENCE = 15.0  # times its processor time a planner may take on a busy computer

LAMA = (
    'let(hlm,eval_modify_costs(landmark_sum(lm_factory=lm_reasonable_orders_hps(lm_rhw()),'
    'pref=false),cost_type=one),let(hff,eval_modify_costs(ff(),cost_type=one),'
    'lazy_greedy([hff,hlm],preferred=[hff,hlm],cost_type=one,reopen_closed=false)))'
)
EAGER = (
    'let(h,eval_modify_costs(ff(),cost_type=one),eager_greedy([h],preferred=[h],cost_type=one))'
)
WRONG_USAGE = 33  # the exit status of a search that does not understand what it is told

FILES = ('domain.pddl', 'problem.pddl')
STAGES = ('read', 'planned', 'answered')
Texts = tuple[str, str]


@dataclass
class Row:
    """What became of one task."""

    name: str
    read: str = '-'
    warnings: str = ''
    plan: str = ''
    answer: str = ''
    planned: str = ''
    said: str = ''
    reached: set[str] = field(default_factory=set)

    def __str__(self) -> str:
        """Return the row of the table."""
        cells = (self.read, self.warnings, self.plan, self.answer, self.planned, self.said)
        return f'| {self.name} | {" | ".join(cells)} |'


def main() -> int:
    """Print the table; return 1 if a task was read and planned for, but not explained."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('names', nargs='*', help='of tasks; all of them without')
    parser.add_argument('--seconds', type=float, default=20.0)
    parser.add_argument('--planning', type=float, default=5.0)
    options = parser.parse_args()
    rows: list[Row] = []
    print('| task | read s | warnings | plan: steps | answer s | planned for | said |')
    print('|---|---|---|---|---|---|---|')
    with Planner() as planner:
        for folder in sorted(Path(os.environ['MIRROR_EXPLAINER_IPC']).iterdir()):
            if folder.is_dir() and (not options.names or folder.name in options.names):
                rows.append(_row(folder, options.seconds, options.planning, planner))
                print(rows[-1], flush=True)
    counts = {stage: sum(stage in row.reached for row in rows) for stage in STAGES}
    print(f'\n{len(rows)} tasks: ' + ', '.join(f'{n} {stage}' for stage, n in counts.items()))
    for row in rows:
        if 'answered' not in row.reached:
            print(f'- {row.name}: {row.said or row.plan or row.warnings}')
    return int(counts['answered'] < counts['planned'])


def _row(folder: Path, seconds: float, planning: float, planner: Planner) -> Row:
    row = Row(folder.name)
    domain, problem = (read_text(str(folder / file)) for file in FILES)
    forget_expressions()
    started = time.process_time()
    try:
        task = read_task(domain, problem)
    except InputError as error:
        row.warnings = f'refused: {error}'
        return row
    row.read = f'{time.process_time() - started:.2f}'
    row.warnings = '; '.join(warning.split('; a belief')[0] for warning in task.warnings)
    row.reached.add('read')
    wanted = read_task(domain, hardened(problem))
    plan = _plan(task, wanted, (domain, problem), seconds, row)
    if plan is None:
        return row
    settings = PlanningSettings(deadline=planning)
    started = time.process_time()
    try:
        preparation = prepare(task, plan, UserModel(_goals(wanted)), settings)
        row.said = explain(preparation, Question(n=2)).spoken.replace('\n', ' ')
    except InputError as error:
        row.said = f'no answer: {error}'
        return row
    row.answer = f'{time.process_time() - started:.2f}'
    row.reached.add('answered')
    try:
        preparation = refine(preparation, planner)
    except PlanningError as error:
        row.planned = str(error)
    else:
        row.planned = f'{preparation.planned:.0%}'
        row.said = explain(preparation, Question(n=2)).spoken.replace('\n', ' ')
    return row


def hardened(problem: str) -> str:
    """Return a problem whose soft goals are hard."""
    return re.sub(r'\(\s*preference\b(\s+[^\s()]+)?', '(and', problem, flags=re.IGNORECASE)


def _plan(task: Task, wanted: Task, texts: Texts, seconds: float, row: Row) -> RobotPlan | None:
    """Return a plan of the task, None if none was found in time; the row says which."""
    tried: list[str] = []
    kept = dict.fromkeys((one.domain, one.problem) for one in (wanted, task))
    tries = [(downward, each) for each in kept]
    tries.insert(0 if task.timed or wanted.relaxed else 1, (lpg, texts))
    for planner, given in tries:
        plan = planner(given, seconds)
        if plan is None:
            continue
        try:
            found = robot_plan(task, plan)
        except InputError as error:
            tried.append(f'{planner.__name__}: {error}')
            # A plan of what the reader keeps for planners need not respect what it leaves out.
            if planner is lpg or not task.relaxed:
                row.reached.add('planned')
            continue
        row.reached.add('planned')
        row.plan = f'{planner.__name__}: {len(found.plan.actions)}'
        return found
    row.plan = '; '.join(tried) or 'none found'
    return None


def downward(texts: Texts, seconds: float) -> str | None:
    """Return a plan by Fast Downward, None if it finds none."""
    with _in_folder(texts) as folder:
        for file in FILES:
            # The translator takes whole costs only, and here any plan will do.
            text = (folder / file).read_text()
            (folder / file).write_text(re.sub(r'(?<=\d)\.\d+', '', text))
        translate = (sys.executable, '-m', 'fast_downward.translate', *FILES)
        seconds -= _run(translate, folder, seconds)
        task, plan = folder / 'output.sas', folder / 'plan'
        for search in (LAMA, EAGER) if task.exists() else ():
            program = find_downward('') or 'downward'
            command = (program, '--search', search, '--internal-plan-file', plan.name)
            _run(command, folder, seconds, task)
            if plan.exists():
                return plan.read_text()
    return None


def lpg(texts: Texts, seconds: float) -> str | None:
    """Return what LPG prints of a plan, None if it finds none or is not there."""
    package = importlib.util.find_spec('up_lpg')
    if package is None or package.origin is None:
        return None
    program = str(Path(package.origin).with_name('lpg'))
    with _in_folder(texts) as folder:
        command = (program, '-o', FILES[0], '-f', FILES[1], '-n', '1', '-seed', '1', '-noout')
        _run(command, folder, seconds)
        printed = (folder / 'printed').read_text(errors='replace')
    return printed if 'Solution number' in printed else None


@contextmanager
def _in_folder(texts: Texts) -> Iterator[Path]:
    with tempfile.TemporaryDirectory() as folder:
        for name, text in zip(FILES, texts, strict=True):
            (Path(folder) / name).write_text(text)
        yield Path(folder)


def _run(command: Sequence[str], folder: Path, seconds: float, task: Path | None = None) -> float:
    """Run a program on a task for so long, and return its processor time.

    What it prints is in the file `printed`.
    """

    def limit() -> None:
        resource.setrlimit(resource.RLIMIT_CPU, (math.ceil(seconds), math.ceil(seconds)))
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))

    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    with (
        (folder / 'printed').open('w') as printed,
        (task or Path(os.devnull)).open() as given,
        suppress(subprocess.TimeoutExpired),
    ):
        ended = subprocess.run(
            command,
            cwd=folder,
            stdin=given,
            stdout=printed,
            stderr=subprocess.STDOUT,
            preexec_fn=limit,
            timeout=PATIENCE * seconds,
        )
        assert ended.returncode != WRONG_USAGE, (folder / 'printed').read_text()
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def _goals(task: Task) -> tuple[CandidateGoal, ...]:
    """Return the robot's goal, and each part of it, as candidates."""
    tree = nested_words(task.goal_text, 'goal')
    parts = tree[1:] if tree and tree[0] == 'and' else []
    texts = dict.fromkeys([task.goal_text, *map(as_text, parts[:MOST_PARTS])])
    return tuple(CandidateGoal(text, text, 1 / len(texts)) for text in texts)


if __name__ == '__main__':
    sys.exit(main())
