"""What people answered, as it is: as tables, and written to files."""

import sys
from pathlib import Path

import pandas as pd

from mirror_explainer.experiments.study.design import Answer
from mirror_explainer.experiments.study.statistics import answer_table
from mirror_explainer.experiments.study.web_study.database import open_database
from mirror_explainer.experiments.study.web_study.design import Design
from mirror_explainer.experiments.study.web_study.study_file import StudyFile


def export(file: Path, folder: Path) -> None:
    """Write answers.csv, of those who finished, response_times.csv and participants.csv."""
    found, study, _ = open_database(file)
    folder.mkdir(parents=True, exist_ok=True)
    for name, table in tables(found, study).items():
        table.to_csv(folder / f'{name}.csv', index=False)
    say_who(file, found, study)
    print(f'see {folder}')


def tables(found: Design, study: StudyFile) -> dict[str, pd.DataFrame]:
    """Return what people answered as tables by name: `answers` of those who finished only."""
    # Models can be imported only once the database is set up.
    from mirror_explainer.experiments.study.web_study import records

    answers, times = recorded(found, study)
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


def recorded(found: Design, study: StudyFile) -> tuple[list[Answer], pd.DataFrame]:
    """Return the answers of those who finished, and everybody's times."""
    from mirror_explainer.experiments.study.web_study import records

    finished, others = records.participants(found, study)
    rows = [*records.times(finished, True, found), *records.times(others, False, found)]
    answers = [row for participant in finished for row in records.answers(participant, found)]
    return answers, pd.DataFrame(rows, columns=list(records.TIME_COLUMNS))


def say_who(file: Path, found: Design, study: StudyFile) -> None:
    """Say on stderr how many have taken part."""
    from mirror_explainer.experiments.study.web_study import records

    finished, others = records.participants(found, study)
    print(f'user_study: {file}: {len(finished)} finished, {len(others)} have not', file=sys.stderr)
