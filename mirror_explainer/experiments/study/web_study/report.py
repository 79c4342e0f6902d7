"""What people answered, analysed beside simulated listeners."""

from pathlib import Path

import pandas as pd

from mirror_explainer.errors import InputError
from mirror_explainer.experiments.markdown import markdown_table
from mirror_explainer.experiments.study.design import assignment
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
    encounter,
)
from mirror_explainer.experiments.study.web_study.export import recorded, say_who


def analyse(file: Path, folder: Path) -> None:
    """Write figure, tests and report on those who finished, and on simulated participants."""
    found, study, _ = open_database(file)
    answers, times = recorded(found, study)
    say_who(file, found, study)
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
