"""The figure of the user study: hit ratio against the share of the plan, the paper's beside it."""

from collections.abc import Mapping
from typing import Any

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from mirror_explainer.commands.figures import (
    STRATEGY_STYLES,
    StrategyStyle,
    draw_curve,
    percent_axis,
)
from mirror_explainer.experiments.study.statistics import MEASURES

HEADLINE = 0.85
# Where the paper's ten people reach 0.85, as shares of the plan: "after 20 %", "half of
# the plan", "almost all of the plan" (drawn at 95 %; the paper has no number for it).
PAPER = {'informative': 0.2, 'decreasing': 0.5, 'increasing': 0.95}
_STYLES = {
    **STRATEGY_STYLES,
    'informative-open': StrategyStyle(
        'informative, for an open listener', '#cc79a7', (0, (5, 1, 1, 1)), 'D'
    ),
}
_INCHES = 2.0  # height of a row


def study_figure(curves: pd.DataFrame, participants: Mapping[str, int]) -> Figure:
    """Draw both readings of the hit ratio side by side, a row for each kind of observer.

    `participants` is how many there are of each kind.
    """
    observers = list(dict.fromkeys(curves['observer']))
    figure = Figure(figsize=(8.0, _INCHES * len(observers) + 1.3), layout='constrained')
    axes = figure.subplots(len(observers), len(MEASURES), sharex=True, sharey=True, squeeze=False)
    for row, observer in enumerate(observers):
        of = curves[curves['observer'] == observer]
        for column, measure in enumerate(MEASURES):
            _draw(axes[row][column], of, measure)
        axes[row][0].set_ylabel(
            f'{observer}\nn = {participants[str(observer)]}', fontweight='bold'
        )
    for column, measure in enumerate(MEASURES):
        axes[0][column].set_title(f'hit ratio, {MEASURES[measure]}', fontsize='medium')
    figure.legend(
        handles=_legend(curves),
        loc='outside upper center',
        ncols=2,
        frameon=False,
        fontsize='medium',
    )
    figure.supxlabel('share of the plan that is said', fontsize='medium')
    return figure


def _draw(axes: Axes, curves: pd.DataFrame, measure: str) -> None:
    for strategy, style in reversed(_styles(curves)):
        curve = curves[curves['strategy'] == strategy].sort_values('percent')
        draw_curve(
            axes, style, curve['percent'] / 100,
            curve[measure], curve[f'{measure}_low'], curve[f'{measure}_high'],
        )  # fmt: skip
    for strategy, share in PAPER.items():
        axes.plot(share, HEADLINE, **_paper_mark(strategy))
    percent_axis(axes)
    axes.set_xticks([0.2, 0.5, 1.0])
    axes.set_ylim(-0.03, 1.05)
    axes.set_yticks([0.0, 0.5, HEADLINE, 1.0])


def _styles(curves: pd.DataFrame) -> list[tuple[str, StrategyStyle]]:
    """Return the strategies that there are curves of, with their styles."""
    return [item for item in _STYLES.items() if item[0] in set(curves['strategy'])]


def _paper_mark(strategy: str) -> Mapping[str, Any]:
    return {
        'marker': STRATEGY_STYLES[strategy].marker,
        'linestyle': 'none',
        'markersize': 9,
        'markerfacecolor': 'none',
        'markeredgecolor': 'black',
        'markeredgewidth': 1.4,
        'zorder': 5,
    }


def _legend(curves: pd.DataFrame) -> list[Line2D]:
    """Return the strategies, and beside each where the paper's participants reach 0.85."""
    lines = [Line2D([], [], **dict(style.plot)) for _, style in _styles(curves)]
    said = {
        'informative': 'after 20 %',
        'decreasing': 'after half',
        'increasing': 'after nearly all',
    }
    marks = []
    for strategy in STRATEGY_STYLES:
        mark = Line2D([], [], label=f'{HEADLINE} in the paper: {said[strategy]}')
        mark.set(**_paper_mark(strategy))
        marks.append(mark)
    return [*lines, *marks]
