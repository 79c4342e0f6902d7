"""What is read of a folder of tasks, and what is answered: one line each.

Run `MIRROR_EXPLAINER_IPC=FOLDER scripts/benchmark ipc [SECONDS] [NAME …]`. The folder has
tasks in folders, `NAME/domain.pddl` and `NAME/problem.pddl`. Each task is read; a greedy search of
Fast Downward looks for a plan for SECONDS (default 20); the listener, who thinks that
the robot may want any part of its goal, is told two steps of it.
"""

import os
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from mirror_explainer.errors import InputError, PlanningError
from mirror_explainer.explainer import explain, robot_plan
from mirror_explainer.listener.preparation import prepare
from mirror_explainer.listener.user_model import CandidateGoal, UserModel
from mirror_explainer.pddl import Task, forget_expressions, read_task
from mirror_explainer.pddl.expressions import as_text, nested_words
from mirror_explainer.planning.downward.program import find_downward
from mirror_explainer.settings import Question
from mirror_explainer.text_files import read_text

MOST_PARTS = 8
SEARCH = 'let(h,ff(),lazy_greedy([h],preferred=[h]))'


def main() -> int:
    """Print the table; return 1 if a task was read and planned for, but not explained."""
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 20.0
    names = sys.argv[2:]
    counts = {'tasks': 0, 'read': 0, 'planned': 0, 'answered': 0}
    print('| task | read s | warnings | plan | answer |')
    print('|---|---|---|---|---|')
    for folder in sorted(Path(os.environ['MIRROR_EXPLAINER_IPC']).iterdir()):
        if folder.is_dir() and (not names or folder.name in names):
            cells, reached = _row(folder, seconds)
            for stage in list(counts)[: reached + 1]:
                counts[stage] += 1
            print(f'| {folder.name} | {" | ".join(map(str, cells))} |', flush=True)
    print(f'\n{counts}')
    return int(counts['answered'] < counts['planned'])


def _row(folder: Path, seconds: float) -> tuple[list[object], int]:
    """Return the cells of a task, and how many stages it has passed."""
    forget_expressions()
    started = time.process_time()
    try:
        task = read_task(
            read_text(str(folder / 'domain.pddl')), read_text(str(folder / 'problem.pddl'))
        )
    except InputError as error:
        return ['-', f'refused: {error}', '', ''], 0
    cells: list[object] = [
        f'{time.process_time() - started:.2f}',
        '; '.join(warning.split('; a belief')[0] for warning in task.warnings),
    ]
    plan = _plan(task, seconds)
    if plan is None:
        return [*cells, 'none found', ''], 1
    try:
        preparation = prepare(task, robot_plan(task, plan), UserModel(_goals(task)))
        said = explain(preparation, Question(n=2)).spoken
    except (InputError, PlanningError) as error:
        return [*cells, len(plan.splitlines()), f'none: {error}'], 2
    return [*cells, len(plan.splitlines()), said.replace('\n', ' ')], 3


def _plan(task: Task, seconds: float) -> str | None:
    """Return a plan of the task, None if none was found in time."""
    with tempfile.TemporaryDirectory() as folder:
        texts = {'domain.pddl': task.domain, 'problem.pddl': task.problem}
        for name, text in texts.items():
            # The translator takes whole costs only, and here any plan will do.
            (Path(folder) / name).write_text(re.sub(r'(?<=\d)\.\d+', '', text))
        translate = [sys.executable, '-m', 'fast_downward.translate', *texts]
        search = [
            find_downward('') or 'downward',
            '--search',
            SEARCH,
            '--internal-plan-file',
            'plan',
        ]
        try:
            subprocess.run(translate, cwd=folder, timeout=seconds, capture_output=True, check=True)
            with (Path(folder) / 'output.sas').open() as sas:
                subprocess.run(
                    search, cwd=folder, timeout=seconds, capture_output=True, stdin=sas, check=True
                )
        except (subprocess.TimeoutExpired, subprocess.CalledProcessError):
            return None
        return (Path(folder) / 'plan').read_text()


def _goals(task: Task) -> tuple[CandidateGoal, ...]:
    """Return the robot's goal, and each part of it, as candidates."""
    tree = nested_words(task.goal_text, 'goal')
    parts = tree[1:] if tree and tree[0] == 'and' else []
    texts = dict.fromkeys([task.goal_text, *map(as_text, parts[:MOST_PARTS])])
    return tuple(CandidateGoal(text, text, 1 / len(texts)) for text in texts)


if __name__ == '__main__':
    sys.exit(main())
