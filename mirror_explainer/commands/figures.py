"""The look that all figures share: one style a strategy, and PNG beside SVG.

Colours are from Okabe and Ito's palette, which colour-blind readers can tell
apart. Every strategy has its own line style and marker as well, so that a
figure printed in grey can be read.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib

matplotlib.use('Agg')  # no display is needed

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import PercentFormatter

# The fixed salt and the missing date make equal figures equal files.
matplotlib.rcParams.update(
    {
        'svg.hashsalt': 'mirror_explainer',
        'font.size': 10,
        'axes.grid': True,
        'grid.color': '0.85',
        'axes.axisbelow': True,
        'axes.spines.top': False,
        'axes.spines.right': False,
    }
)


@dataclass(frozen=True)
class StrategyStyle:
    """How one strategy is drawn everywhere."""

    label: str
    colour: str
    line: str | tuple[int, tuple[int, ...]]
    marker: str

    @property
    def plot(self) -> Mapping[str, Any]:
        """The keyword arguments of Axes.plot()."""
        return {
            'label': self.label,
            'color': self.colour,
            'linestyle': self.line,
            'marker': self.marker,
            'markersize': 4,
            'linewidth': 1.6,
        }


STRATEGY_STYLES: Mapping[str, StrategyStyle] = {
    'informative': StrategyStyle('informative', '#009e73', '-', 'o'),
    'decreasing': StrategyStyle('decreasing', '#d55e00', '--', 's'),
    'increasing': StrategyStyle('increasing', '#0072b2', ':', '^'),
}


def draw_curve(
    axes: Axes, style: StrategyStyle, x: Any, mean: Any, low: Any = None, high: Any = None
) -> None:
    """Draw one strategy's curve, with its confidence band where there is one."""
    axes.plot(x, mean, **style.plot)
    if low is not None and high is not None:
        axes.fill_between(x, low, high, color=style.colour, alpha=0.15, linewidth=0)


def percent_axis(axes: Axes) -> None:
    """Let the x axis be the share of the plan that is said, from 10 % to 100 %."""
    axes.set_xlim(0.07, 1.03)
    axes.set_xticks([0.1, 0.5, 1.0])
    axes.xaxis.set_major_formatter(PercentFormatter(xmax=1, decimals=0, symbol=' %'))


def save(figure: Figure, path_without_suffix: Path) -> tuple[Path, Path]:
    """Write the figure as PNG and SVG, and return the two paths."""
    path_without_suffix.parent.mkdir(parents=True, exist_ok=True)
    png = path_without_suffix.with_name(path_without_suffix.name + '.png')
    svg = path_without_suffix.with_name(path_without_suffix.name + '.svg')
    figure.savefig(png, dpi=120, bbox_inches='tight')
    figure.savefig(svg, bbox_inches='tight', metadata={'Date': None})
    return png, svg
