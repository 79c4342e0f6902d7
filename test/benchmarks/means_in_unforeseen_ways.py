"""What a means should weigh in an unforeseen way: its share in the foreseen ones, or 1.

    scripts/benchmark means_in_unforeseen_ways DIR [INSTANCES]

DIR has the PUCRS data set; so many instances a domain are taken (default 2). Prints, for both
weights, the mean understanding of both listeners as speakers with one plan a belief, judged
by both with up to 300, at N = 1 … 4; and where it differs from task to task.
"""

import sys
from collections.abc import Iterator
from pathlib import Path
from unittest.mock import patch

import numpy as np
import pandas as pd

from mirror_explainer.errors import InputError, PlanningError
from mirror_explainer.experiments.markdown import markdown_table
from mirror_explainer.experiments.understanding.judged import Judged, judgements, plan_task
from mirror_explainer.experiments.understanding.tasks import own_tasks, pucrs_tasks
from mirror_explainer.listener import weighing
from mirror_explainer.planning import Planner

WEIGHTS = {
    'share of the foreseen ways': weighing._means,
    '1': lambda foreseen, goal, ratios: np.ones(ratios.shape[1]),
}


def rows(dataset: Path, instances: int) -> Iterator[dict[str, object]]:
    """Yield each judgement with the weight that a means had."""
    for drawn in [*pucrs_tasks(dataset, instances, 0), *own_tasks(instances, 0)]:
        with Planner(planning_timeout=10.0) as planner:
            try:
                planned = plan_task(drawn, planner, 15.0)
            except (InputError, PlanningError) as error:
                print(f'left out: {drawn.name}: {error}', file=sys.stderr)
                continue
        for weight, means in WEIGHTS.items():
            with patch.object(weighing, '_means', means):
                planned.one._models.clear()
                planned.many._models.clear()
                judged: list[Judged] = [*judgements(planned, counts=(1,))]
            yield from ({**vars(row), 'a means weighs': weight} for row in judged)


def main() -> None:
    """Measure and print."""
    dataset, *more = sys.argv[1:]
    found = pd.DataFrame(rows(Path(dataset), int(more[0]) if more else 2))
    found = found[found['plans'] == 1]
    keys = ['group', 'judge', 'speaker', 'a means weighs']
    table = found.pivot_table(index=keys, columns='N', values='understanding').reset_index()
    table.columns = [f'N = {c}' if isinstance(c, int) else str(c) for c in table.columns]
    print(markdown_table(table.round(4)))
    by_task = found.pivot(
        index=['group', 'task', 'judge', 'speaker', 'N'],
        columns='a means weighs',
        values='understanding',
    )
    gained = by_task['share of the foreseen ways'] - by_task['1']
    print(f'\n{gained[gained.abs() > 0.005].describe().to_string()}')
    print(gained[gained.abs() > 0.05].to_string())


if __name__ == '__main__':
    main()
