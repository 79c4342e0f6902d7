"""The benchmark (Section 5): `python3 -m mirror_explainer.experiments.benchmark.pucrs --help`.

Runs the instances side by side, each one's result in a file of its own, so that
an interrupted run takes up where it stopped; then writes tables, figure and report.
"""

import argparse
import hashlib
import json
import multiprocessing
import os
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Executor, Future, ProcessPoolExecutor, as_completed
from dataclasses import asdict, dataclass
from pathlib import Path
from random import Random
from typing import Any

from mirror_explainer.commands.command_line import command_parser
from mirror_explainer.commands.extras import MissingExtras, require_extras
from mirror_explainer.commands.options import number, whole
from mirror_explainer.commands.terminal import tell_error
from mirror_explainer.errors import InputError, PlanningError
from mirror_explainer.experiments.benchmark.dataset import (
    Location,
    RecognitionProblem,
    find_instances,
    read_instance,
)
from mirror_explainer.experiments.benchmark.protocol import Settings, run_instance

# In the order of the paper's figure, by the names of the data set's folders.
PAPER_DOMAINS = (
    'logistics',
    'intrusion-detection',
    'rovers',
    'satellite',
    'blocks-world',
    'miconic',
)
ENVIRONMENT = 'MIRROR_EXPLAINER_PUCRS'
_VERSION = 6  # of the protocol's code: results of another one are not resumed


_REPORTED = (
    'instances',
    'seed',
    'plans_per_belief',
    'planning_timeout',
    'deadline',
    'selection_budget',
)


@dataclass(frozen=True)
class Job:
    """One instance to run, and the file that keeps its result."""

    location: Location
    settings: Settings
    dataset: Path
    file: Path


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the benchmark; return 0, 1 if nothing could be measured, 2 for bad input."""
    options = _parser().parse_args(arguments)
    try:
        require_extras('experiments')
        if options.plans_per_belief > 1:
            require_extras('plans')
        if not options.dataset:
            raise InputError('--dataset', f'give the data set, here or in {ENVIRONMENT}')
        jobs = _jobs(options)
        records = list(_run(jobs, options.jobs))
        # Not before the extras are known to be there.
        from mirror_explainer.experiments.benchmark.report import write_report

        measured = write_report(records, options.output, _command(options))
    except (InputError, PlanningError, MissingExtras, OSError) as error:
        tell_error('pucrs_benchmark', error)
        return 2
    except KeyboardInterrupt:
        print('pucrs_benchmark: stopped; the same command goes on from here', file=sys.stderr)
        return 130
    for record in records:
        if 'failure' in record:
            print(f'left out: {record["instance"]}: {record["failure"]}', file=sys.stderr)
    print(f'{measured} of {len(records)} instances measured; see {options.output / "report.md"}')
    return 0 if measured else 1


def _jobs(options: argparse.Namespace) -> list[Job]:
    """Return what to run: of every domain as many instances as asked, drawn by the seed."""
    settings = Settings(
        seed=options.seed,
        planner=options.planner,
        planning_timeout=options.planning_timeout,
        deadline=options.deadline,
        selection_budget=options.selection_budget,
        plans_per_belief=options.plans_per_belief,
    )
    available = find_instances(options.dataset)
    domains = options.domains or [name for name in PAPER_DOMAINS if name in available]
    unknown = sorted(set(domains) - set(available))
    if unknown:
        raise InputError(
            str(options.dataset),
            f'no domain {", ".join(unknown)} is there, only {", ".join(available)}',
        )
    jobs = []
    for domain in domains or available:
        locations = available[domain]
        count = min(options.instances, len(locations))
        drawn = Random(f'{options.seed}/{domain}').sample(locations, count)
        for location in sorted(drawn, key=lambda chosen: chosen.name):
            file = options.output / 'instances' / domain / f'{location.name}.json'
            jobs.append(Job(location, settings, options.dataset, file))
    return jobs


def _run(jobs: Sequence[Job], processes: int) -> Iterator[dict[str, Any]]:
    """Yield the jobs' records in order, once all are done; finished ones are read again."""
    from tqdm import tqdm

    for folder in {job.file.parent for job in jobs}:
        folder.mkdir(parents=True, exist_ok=True)
    with tqdm(total=len(jobs), unit='instance', disable=None) as bar:
        for job in _as_done(jobs, processes):
            bar.set_postfix_str(job.location.name)
            bar.update()
    for job in jobs:
        yield json.loads(job.file.read_text('utf-8'))


def _as_done(jobs: Sequence[Job], processes: int) -> Iterator[Job]:
    """Yield each job when its file is written."""
    if processes == 1:
        for job in jobs:
            run_job(job)
            yield job
        return
    context = multiprocessing.get_context('spawn')
    with ProcessPoolExecutor(processes, mp_context=context) as executor:
        futures = {executor.submit(run_job, job): job for job in jobs}
        try:
            for future in as_completed(futures):
                _settle(future, futures[future])
                yield futures[future]
        except BaseException:
            _cancel(executor, futures)
            raise


def _settle(future: 'Future[None]', job: Job) -> None:
    """Record the failure of a process that ended without a word, such as for lack of memory."""
    error = future.exception()
    if error is not None:
        _write(job, {}, {'failure': f'its process ended early ({error})'})


def _cancel(executor: Executor, futures: Iterable['Future[None]']) -> None:
    for future in futures:
        future.cancel()
    executor.shutdown(wait=False, cancel_futures=True)


def run_job(job: Job) -> None:
    """Run one instance unless its file has the result already; a failure is tried again."""
    key: Mapping[str, Any] = {}
    try:
        problem = read_instance(job.location, job.dataset)
        key = _key(problem, job.settings)
        known = _known(job.file)
        if known.get('key') == key and 'result' in known:
            return
        outcome: dict[str, Any] = {
            'result': asdict(run_instance(job.location, problem, job.settings))
        }
    except (InputError, PlanningError) as error:
        outcome = {'failure': str(error)}
    except Exception as error:  # one instance must not end the run, whatever ails it
        outcome = {'failure': f'{type(error).__name__}: {error}'}
    _write(job, key, outcome)


def _key(problem: RecognitionProblem, settings: Settings) -> dict[str, Any]:
    texts = json.dumps(asdict(problem), sort_keys=True)
    digest = hashlib.sha256(texts.encode()).hexdigest()
    return {'version': _VERSION, 'files': digest, **asdict(settings)}


def _known(file: Path) -> dict[str, Any]:
    try:
        record: dict[str, Any] = json.loads(file.read_text('utf-8'))
    except (OSError, ValueError):
        return {}
    return record


def _write(job: Job, key: Mapping[str, Any], outcome: Mapping[str, Any]) -> None:
    """Write the record in one go: a run that is interrupted leaves no half of it."""
    location = job.location
    record = {'domain': location.domain, 'instance': location.name, 'key': key, **outcome}
    partial = job.file.with_suffix('.partial')
    partial.write_text(json.dumps(record, indent=1) + '\n', 'utf-8')
    partial.replace(job.file)


def _command(options: argparse.Namespace) -> str:
    """Return the command that regenerates the report."""
    words = ['python3 -m mirror_explainer.experiments.benchmark.pucrs --dataset DIR']
    words += [f'--domains {" ".join(options.domains)}'] if options.domains else []
    words += [f'--{name.replace("_", "-")} {getattr(options, name)}' for name in _REPORTED]
    words += [f'--planner {options.planner}'] if options.planner != Settings.planner else []
    return ' '.join(words)


def _parser() -> argparse.ArgumentParser:
    command = 'python3 -m mirror_explainer.experiments.benchmark.pucrs'
    parser = command_parser(
        'pucrs_benchmark',
        "Reproduce the paper's benchmark on the PUCRS data set.",
        f'{command} --dataset DIR',
        f'{command} --dataset DIR --instances 2 --jobs 4 --output few',
        ends='Exit status: 0; 1 if no instance could be measured; 2 for bad input.',
    )
    parser.add_argument(
        '--dataset',
        type=Path,
        default=os.environ.get(ENVIRONMENT),
        metavar='DIR',
        help=f'archives or unpacked folders (default: ${ENVIRONMENT})',
    )
    parser.add_argument(
        '--domains',
        nargs='+',
        metavar='NAME',
        help="folders of the data set (default: the paper's)",
    )
    parser.add_argument('--instances', type=whole(1), default=10, help='per domain (default 10)')
    parser.add_argument(
        '--seed', type=whole(0), default=0, help='of all that is drawn (default 0)'
    )
    parser.add_argument('--jobs', type=whole(1), default=2, help='instances at a time (default 2)')
    parser.add_argument(
        '--output', type=Path, default=Path('pucrs_results'), metavar='DIR',
        help='write there (default: pucrs_results), and resume what was interrupted',
    )  # fmt: skip
    parser.add_argument(
        '--plans-per-belief', type=whole(1), default=1, metavar='K',
        help='at most so many optimal plans, different in more than their order (default 1)',
    )  # fmt: skip
    parser.add_argument('--planner', default=Settings.planner, metavar='ENGINE')
    for name, meaning in (
        ('planning_timeout', 'for each belief'),
        ('deadline', "for an instance's beliefs together"),
        ('selection_budget', 'for the informative selections of an instance'),
    ):
        default = getattr(Settings, name)
        parser.add_argument(
            f'--{name.replace("_", "-")}',
            type=number(0, above=True), default=default, metavar='S',
            help=f'{meaning} (default {default:g} s)',
        )  # fmt: skip
    return parser


if __name__ == '__main__':
    sys.exit(main())
