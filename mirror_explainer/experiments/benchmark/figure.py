"""The paper's figure of the benchmark: G_inf above, D_G below, a column for each domain."""

import pandas as pd
from matplotlib.figure import Figure

from mirror_explainer.commands.figures import STRATEGY_STYLES, draw_curve, percent_axis

_ROWS = (
    ('G_inf', 'told less than by\ninformative: $G_{\\mathrm{inf}}$ (nats)'),
    ('D_G', 'distance to the goal:\n$D_G$ (share of the plan)'),
)
_SHORT = {'intrusion-detection': 'intrusion', 'blocks-world': 'blocks'}


def benchmark_figure(means: pd.DataFrame) -> Figure:
    """Draw the averages against the share of the plan that is said, with confidence bands."""
    domains = list(dict.fromkeys(means['domain']))
    figure = Figure(figsize=(2.1 * len(domains) + 1.2, 4.6), layout='constrained')
    axes = figure.subplots(2, len(domains), sharex=True, sharey='row', squeeze=False)
    for row, (measure, label) in enumerate(_ROWS):
        axes[row][0].set_ylabel(label)
        for column, domain in enumerate(domains):
            for strategy, style in reversed(list(STRATEGY_STYLES.items())):
                curve = means[
                    (means['domain'] == domain)
                    & (means['strategy'] == strategy)
                    & (means['measure'] == measure)
                ].sort_values('percent')
                draw_curve(
                    axes[row][column], style, curve['percent'] / 100,
                    curve['mean'], curve['low'], curve['high'],
                )  # fmt: skip
            percent_axis(axes[row][column])
            axes[row][column].tick_params(axis='x', labelsize='small')
    for column, domain in enumerate(domains):
        [instances] = set(means.loc[means['domain'] == domain, 'instances'])
        title = f'{_SHORT.get(domain, domain)} (n = {instances})'
        axes[0][column].set_title(title, fontsize='medium')
    for axis in axes.flat:
        axis.set_ylim(bottom=-0.03 * axis.get_ylim()[1])
    handles, labels = axes[0][0].get_legend_handles_labels()
    figure.legend(handles[::-1], labels[::-1], loc='outside upper center', ncols=3, frameon=False)
    figure.supxlabel(
        'share of the plan that is said (mean over a domain, with 95 % bootstrap interval)',
        fontsize='medium',
    )
    return figure
