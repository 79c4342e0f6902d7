"""What a study found, in a table for the terminal: how soon answers are right for good."""

from mirror_explainer.commands.terminal import tell_table
from mirror_explainer.experiments.study.report import Results

_COLUMNS = ('observer', 'n', 'informative', 'decreasing', 'increasing', 'p (dec.)', 'p (inc.)')


def tell_summary(found: Results) -> None:
    """Print, for each kind of observer, the mean step from which on all answers are right.

    A row stands out where informative is earlier than both baselines, which says
    nothing of chance: that does p, corrected by Holm, of people alone.
    """
    settled = found.tests[found.tests['measure'] == 'settled'].to_dict('records')
    tests = {(row['observer'], row['baseline']): row for row in settled}
    rows = []
    for observer in found.observers:
        both = [tests[observer, baseline] for baseline in ('decreasing', 'increasing')]
        decreasing, increasing = both
        cells = (
            observer,
            f'{increasing["participants"]}',
            f'{increasing["mean_informative"]:.1f}',
            f'{decreasing["mean_baseline"]:.1f}',
            f'{increasing["mean_baseline"]:.1f}',
            *(
                '–' if test['p_holm'] != test['p_holm'] else f'{test["p_holm"]:.4f}'
                for test in both
            ),
        )
        rows.append((cells, all(test['p_holm'] < SIGNIFICANT for test in both)))
    tell_table('Sentences until the answer is right for good', _COLUMNS, rows)
