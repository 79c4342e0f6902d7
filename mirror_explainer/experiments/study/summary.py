"""What a study found, in a table for the terminal: how soon answers are right for good."""

from itertools import product
from math import isnan

from mirror_explainer.commands.terminal import tell_table
from mirror_explainer.experiments.study.report import Results

_COLUMNS = (
    'observer',
    'strategy',
    'n',
    'informative',
    'decreasing',
    'increasing',
    'p (dec.)',
    'p (inc.)',
)


def tell_summary(found: Results) -> None:
    """Print, for each kind of observer, the mean step from which on all answers are right.

    A row stands out where informative is earlier than both baselines, which says
    nothing of chance: that does p, corrected by Holm, of people alone.
    """
    settled = found.tests[found.tests['measure'] == 'settled'].to_dict('records')
    tests = {(row['observer'], row['strategy'], row['baseline']): row for row in settled}
    rows = []
    for observer, strategy in product(found.observers, found.informative):
        both = [tests[observer, strategy, baseline] for baseline in ('decreasing', 'increasing')]
        cells = (
            observer,
            strategy,
            f'{both[0]["participants"]}',
            f'{both[0]["mean_informative"]:.1f}',
            *(f'{test["mean_baseline"]:.1f}' for test in both),
            *('–' if isnan(test['p_holm']) else f'{test["p_holm"]:.4f}' for test in both),
        )
        rows.append((cells, all(t['mean_informative'] < t['mean_baseline'] for t in both)))
    tell_table('Sentences until the answer is right for good', _COLUMNS, rows)
