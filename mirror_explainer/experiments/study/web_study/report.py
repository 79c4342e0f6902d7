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
from mirror_explainer.experiments.study.summary import tell_summary
from mirror_explainer.experiments.study.warehouse_floor import read_floor
from mirror_explainer.experiments.study.web_study.database import open_database
from mirror_explainer.experiments.study.web_study.design import (
    ATTENTION,
    SIMULATED_PARTICIPANTS,
    Design,
    encounter,
)
from mirror_explainer.experiments.study.web_study.study_file import StudyFile


def export(file: Path, folder: Path) -> None:
    """Write answers.csv, of those who finished, response_times.csv and participants.csv."""
    found, study, _ = open_database(file)
    folder.mkdir(parents=True, exist_ok=True)
    for name, table in tables(found, study).items():
        table.to_csv(folder / f'{name}.csv', index=False)
    _say(file, found, study)
    print(f'see {folder}')


def analyse(file: Path, folder: Path) -> None:
    """Write figure, tests and report on those who finished, and on simulated participants."""
    found, study, _ = open_database(file)
    answers, times = _recorded(found, study)
    _say(file, found, study)
    if not answers:
        raise InputError(str(file), 'nobody has finished the study yet')
    folder.mkdir(parents=True, exist_ok=True)
    planned, left_out = plan_scenarios(scenarios(read_floor(), found.drawn, found.seed))
    if tuple(encounter(each, found.strategies) for each in planned) != found.encounters:
        raise InputError(
            str(file),
            'its scenarios or their plans are not those that this version of the package and '
            'of the planner make, so that simulated participants would hear something else',
            cure='"export" writes what people answered.',
        )
    strategies = assignment(SIMULATED_PARTICIPANTS, len(planned), found.seed, found.strategies)
    for kind in KINDS:
        answers += simulate(planned, kind, strategies, Noise(), found.seed)
    computed = results(answer_table(answers), found.seed)
    write_report(
        computed,
        planned,
        left_out,
        folder,
        f'python3 -m mirror_explainer.experiments.study.user_study analyse --database {file}',
        [_times_section(times)],
    )
    times.to_csv(folder / 'response_times.csv', index=False)
    tell_summary(computed)
    print(f'see {folder / "report.md"}')


def tables(found: Design, study: StudyFile) -> dict[str, pd.DataFrame]:
    """Return what people answered as tables by name: `answers` of those who finished only."""
    from mirror_explainer.experiments.study.web_study import records

    answers, times = _recorded(found, study)
    finished, others = records.participants(found, study)
    people = [
        *records.people(finished, True, found, study),
        *records.people(others, False, found, study),
    ]
    return {
        'answers': answer_table(answers),
        'response_times': times,
        'participants': pd.DataFrame(people),
    }


def _recorded(found: Design, study: StudyFile) -> tuple[list[Answer], pd.DataFrame]:
    """Return the answers of those who finished, and everybody's times."""
    # Models can be imported only once the database is set up.
    from mirror_explainer.experiments.study.web_study import records

    finished, others = records.participants(found, study)
    rows = [*records.times(finished, True, found), *records.times(others, False, found)]
    answers = [row for participant in finished for row in records.answers(participant, found)]
    return answers, pd.DataFrame(rows, columns=list(records.TIME_COLUMNS))


def _say(file: Path, found: Design, study: StudyFile) -> None:
    from mirror_explainer.experiments.study.web_study import records

    finished, others = records.participants(found, study)
    print(f'user_study: {file}: {len(finished)} finished, {len(others)} have not', file=sys.stderr)


def _times_section(times: pd.DataFrame) -> str:
    of_scenarios = (times['place'] > 0) & (times['strategy'] != ATTENTION)
    counted = times[times['finished'] & of_scenarios]
    by_strategy = counted.groupby('strategy', sort=False)['seconds']
    table = by_strategy.agg(answers='size', median='median', mean='mean').reset_index()
    return (
        '## Response times\n\n' + markdown_table(table) + '\n\n'
        'Seconds from when a step was shown until it was answered, of the people who finished, '
        'without the practice and the attention trials. '
        f'{(counted["pages"] > 1).sum()} of the answers came after the page was loaded again, so '
        'that their times may hold a break.'
    )
