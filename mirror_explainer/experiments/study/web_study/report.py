"""What people answered, written to files: as they are, and analysed beside simulated listeners."""

import sys
from pathlib import Path

import pandas as pd

from mirror_explainer.errors import InputError
from mirror_explainer.experiments.markdown import markdown_table
from mirror_explainer.experiments.study.design import Answer, assignment
from mirror_explainer.experiments.study.observers import KINDS
from mirror_explainer.experiments.study.participants import Noise, simulate
from mirror_explainer.experiments.study.plans import plan_scenarios
from mirror_explainer.experiments.study.report import results, write_report
from mirror_explainer.experiments.study.scenarios import scenarios
from mirror_explainer.experiments.study.statistics import answer_table
from mirror_explainer.experiments.study.warehouse_floor import read_floor
from mirror_explainer.experiments.study.web_study.database import open_database
from mirror_explainer.experiments.study.web_study.design import (
    SIMULATED_PARTICIPANTS,
    Design,
    encounter,
)


def export(file: Path, folder: Path) -> None:
    """Write answers.csv, of those who finished, and response_times.csv, of everybody."""
    found = open_database(file)
    answers, times = _recorded(file, found)
    folder.mkdir(parents=True, exist_ok=True)
    answer_table(answers).to_csv(folder / 'answers.csv', index=False)
    times.to_csv(folder / 'response_times.csv', index=False)
    print(f'see {folder}')


def analyse(file: Path, folder: Path) -> None:
    """Write figure, tests and report on those who finished, and on simulated participants."""
    found = open_database(file)
    answers, times = _recorded(file, found)
    if not answers:
        raise InputError(str(file), 'nobody has finished the study yet')
    folder.mkdir(parents=True, exist_ok=True)
    planned, left_out = plan_scenarios(scenarios(read_floor(), found.drawn, found.seed))
    if tuple(map(encounter, planned)) != found.encounters:
        raise InputError(
            str(file),
            'its scenarios or their plans are not those that this version of the package and '
            'of the planner make, so that simulated participants would hear something else',
            cure='"export" writes what people answered.',
        )
    strategies = assignment(SIMULATED_PARTICIPANTS, len(planned), found.seed)
    for kind in KINDS:
        answers += simulate(planned, kind, strategies, Noise(), found.seed)
    write_report(
        results(answer_table(answers), found.seed),
        planned,
        left_out,
        folder,
        f'python3 -m mirror_explainer.experiments.study.user_study analyse --database {file}',
        [_times_section(times)],
    )
    times.to_csv(folder / 'response_times.csv', index=False)
    print(f'see {folder / "report.md"}')


def _recorded(file: Path, found: Design) -> tuple[list[Answer], pd.DataFrame]:
    """Return the answers of those who finished, and everybody's times."""
    # Models can be imported only once the database is set up.
    from mirror_explainer.experiments.study.web_study import records

    finished, others = records.participants(found)
    print(f'user_study: {file}: {len(finished)} finished, {len(others)} have not', file=sys.stderr)
    rows = [*records.times(finished, True), *records.times(others, False)]
    answers = [row for participant in finished for row in records.answers(participant, found)]
    return answers, pd.DataFrame(rows, columns=list(records.TIME_COLUMNS))


def _times_section(times: pd.DataFrame) -> str:
    counted = times[times['finished'] & (times['place'] > 0)]
    by_strategy = counted.groupby('strategy', sort=False)['seconds']
    table = by_strategy.agg(answers='size', median='median', mean='mean').reset_index()
    return (
        '## Response times\n\n' + markdown_table(table) + '\n\n'
        'Seconds from when a step was shown until it was answered, of the people who finished, '
        f'without the practice. {(counted["pages"] > 1).sum()} of the answers came after the page '
        'was loaded again, so that their times may hold a break.'
    )
