"""Understanding and information gain against the number of sentences, on one plan."""

from collections.abc import Mapping, Sequence
from typing import Any

from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator, PercentFormatter

from mirror_explainer.commands.figures import STRATEGY_STYLES, draw_curve
from mirror_explainer.listener.mirror_model import MirrorModel

_LEAST_GAP = 0.1  # between two levels that are labelled, so that their labels do not touch


def comparison_figure(
    model: MirrorModel, curves: Sequence[Mapping[str, Any]], levels: Sequence[float]
) -> Figure:
    """Draw both measures from N = 0, where nothing is said yet."""
    figure = Figure(figsize=(9.0, 3.8), layout='constrained')
    understanding, gain = figure.subplots(1, 2)
    x = [0, *(row['n'] for row in curves)]
    before = model.understanding()
    for strategy, style in reversed(list(STRATEGY_STYLES.items())):
        sure = [before, *(row[strategy]['understanding'] for row in curves)]
        told = [0.0, *(row[strategy]['information_gain'] for row in curves)]
        draw_curve(understanding, style, x, sure)
        draw_curve(gain, style, x, told)
    understanding.set_title("how sure the listener is of the robot's goal")
    understanding.set_ylim(-0.03, 1.03)
    apart = [level for level in levels if level <= 1.0 - _LEAST_GAP]
    understanding.set_yticks([0.0, 0.25, *apart, 1.0])
    understanding.yaxis.set_major_formatter(PercentFormatter(xmax=1, decimals=0, symbol=' %'))
    entropy = model.cross_entropy()
    gain.set_title('information gain (nats)')
    gain.axhline(entropy, color='0.3', linewidth=0.8)
    gain.annotate(
        'all there is to know', (0, entropy), (0, 5), textcoords='offset points', fontsize='small'
    )
    gain.margins(y=0.12)
    for axes in (understanding, gain):
        axes.set_xlabel('N: how many sentences are said (n = 1 plan)')
        axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    handles, labels = understanding.get_legend_handles_labels()
    figure.legend(handles[::-1], labels[::-1], loc='outside upper center', ncols=3, frameon=False)
    return figure
