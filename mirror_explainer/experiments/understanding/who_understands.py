"""Who understands what: `python3 -m mirror_explainer.experiments.understanding.who_understands`.

Two listeners (open, planner) as speakers, each judged by each, at N = 1 … 4, beside the
paper's two orders; on the PUCRS data set and on four robots of ours.
"""

import argparse
import json
import multiprocessing
import os
import sys
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from contextlib import suppress
from dataclasses import asdict
from pathlib import Path

from mirror_explainer.commands.command_line import command_parser
from mirror_explainer.commands.extras import MissingExtras, require_extras
from mirror_explainer.commands.options import number, whole
from mirror_explainer.commands.terminal import tell_error
from mirror_explainer.errors import InputError, PlanningError
from mirror_explainer.experiments.benchmark.pucrs import ENVIRONMENT
from mirror_explainer.experiments.understanding.judged import Judged, judgements, plan_task
from mirror_explainer.experiments.understanding.tasks import DrawnTask, own_tasks, pucrs_tasks
from mirror_explainer.planning import Planner

_TIMEOUT = 30.0  # s, for one plan
_VERSION = 3  # of what is measured: results of another one are measured anew


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure and write; return 0, 1 if nothing could be measured, 2 for bad input."""
    options = _parser().parse_args(arguments)
    try:
        require_extras('experiments')
        tasks = list(_tasks(options))
        require_extras('plans')
        # Not before the extras are known to be there.
        from mirror_explainer.experiments.understanding.report import write_report

        rows = [row for judged in _measured(tasks, options) for row in judged]
        if not rows:
            print('who_understands: nothing could be measured in this time', file=sys.stderr)
            return 1
        write_report(rows, len(tasks), options.output, _command(options))
    except (InputError, PlanningError, MissingExtras, OSError) as error:
        tell_error('who_understands', error)
        return 2
    except KeyboardInterrupt:
        return 130
    print(f'see {options.output / "understanding.md"}')
    return 0


def _tasks(options: argparse.Namespace) -> Iterator[DrawnTask]:
    if options.dataset:
        yield from pucrs_tasks(options.dataset, options.instances, options.seed)
    yield from own_tasks(options.own, options.seed)


def _measured(tasks: Sequence[DrawnTask], options: argparse.Namespace) -> Iterator[list[Judged]]:
    """Yield each task's rows, in the order of the tasks; say which are left out, and why."""
    from tqdm import tqdm

    context = multiprocessing.get_context('spawn')
    with ProcessPoolExecutor(options.jobs, mp_context=context) as executor:
        futures = {
            executor.submit(known_or_measured, task, options.deadline, options.output): task
            for task in tasks
        }
        found = {}
        for future in tqdm(as_completed(futures), total=len(tasks), unit='task', disable=None):
            task = futures[future]
            try:
                found[task.name] = future.result()
            except (InputError, PlanningError) as error:
                print(f'left out: {task.name}: {error}', file=sys.stderr, flush=True)
    for task in tasks:
        if task.name in found:
            yield found[task.name]


def known_or_measured(task: DrawnTask, deadline: float, folder: Path) -> list[Judged]:
    """Return a task's rows, from its file if an earlier run has measured the same."""
    file = folder / 'tasks' / f'{task.name}.json'
    key = [task.seed, deadline, _VERSION]
    with suppress(OSError, ValueError):
        known = json.loads(file.read_text('utf-8'))
        if known['key'] == key:
            return [Judged(**row) for row in known['rows']]
    rows = measure(task, deadline)
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(json.dumps({'key': key, 'rows': [asdict(row) for row in rows]}), 'utf-8')
    return rows


def measure(task: DrawnTask, deadline: float) -> list[Judged]:
    """Plan for one task, and let the judges hear what the speakers say."""
    with Planner(workers=1, planning_timeout=_TIMEOUT) as planner:
        return list(judgements(plan_task(task, planner, deadline)))


def _command(options: argparse.Namespace) -> str:
    """Return the command that regenerates the files."""
    words = ['python3 -m mirror_explainer.experiments.understanding.who_understands']
    words += ['--dataset DIR', f'--instances {options.instances}'] if options.dataset else []
    words += [f'--own {options.own} --seed {options.seed} --deadline {options.deadline:g}']
    return ' '.join(words)


def _parser() -> argparse.ArgumentParser:
    command = 'python3 -m mirror_explainer.experiments.understanding.who_understands'
    parser = command_parser(
        'who_understands',
        'Judge what each listener would have the robot say by each listener.',
        command,
        f'{command} --dataset DIR --instances 3 --output few',
        ends='Exit status: 0; 1 if nothing could be measured; 2 for bad input.',
    )
    parser.add_argument(
        '--dataset', type=Path, default=os.environ.get(ENVIRONMENT), metavar='DIR',
        help=f'the PUCRS data set (default: ${ENVIRONMENT}; without, only our robots)',
    )  # fmt: skip
    parser.add_argument('--instances', type=whole(1), default=10, help='a domain (default 10)')
    parser.add_argument('--own', type=whole(1), default=10, help='tasks a robot (default 10)')
    parser.add_argument(
        '--seed', type=whole(0), default=0, help='of all that is drawn (default 0)'
    )
    parser.add_argument('--jobs', type=whole(1), default=2, help='tasks at a time (default 2)')
    parser.add_argument(
        '--deadline', type=number(0, above=True), default=60.0, metavar='S',
        help='for planning, twice a task: one plan a belief, and all (default 60 s)',
    )  # fmt: skip
    parser.add_argument(
        '--output', type=Path, default=Path('who_understands'), metavar='DIR',
        help='write there (default: who_understands), and resume what was interrupted',
    )  # fmt: skip
    return parser


if __name__ == '__main__':
    sys.exit(main())
