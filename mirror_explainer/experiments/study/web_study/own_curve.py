"""A participant's own hit ratio, as table and picture, beside that of simulated listeners."""

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from mirror_explainer.experiments.study.design import Answer
from mirror_explainer.settings import STRATEGIES

WIDTH, HEIGHT = 640, 290
_LEFT, _TOP, _RIGHT, _BOTTOM = 60, 16, 600, 250


@dataclass(frozen=True)
class Cell:
    """One strategy at one percentage: of `named` goals `hits` were right; `simulated` is usual."""

    strategy: str
    hits: int
    named: int
    simulated: float | None

    @property
    def ratio(self) -> float | None:
        """The hit ratio; None where no goal was named."""
        return self.hits / self.named if self.named else None

    @property
    def percent(self) -> str:
        """The hit ratio as a participant reads it."""
        return 'no choice' if self.ratio is None else _percent(self.ratio)

    @property
    def usual(self) -> str:
        """That of simulated listeners."""
        return '–' if self.simulated is None else _percent(self.simulated)


@dataclass(frozen=True)
class Row:
    """What was answered when a percentage of the plan was said."""

    percent: int
    cells: tuple[Cell, ...]


@dataclass(frozen=True)
class Mark:
    """A point of a curve, in the units of the picture."""

    x: float
    y: float


@dataclass(frozen=True)
class Line:
    """A strategy's curve: where a goal was named at all."""

    strategy: str
    marks: tuple[Mark, ...]

    @property
    def points(self) -> str:
        """The curve as SVG's polyline has it."""
        return ' '.join(f'{mark.x:g},{mark.y:g}' for mark in self.marks)


@dataclass(frozen=True)
class Chart:
    """The picture: its curves and axes."""

    lines: tuple[Line, ...]
    x_ticks: tuple[tuple[float, str], ...]
    y_ticks: tuple[tuple[float, str], ...]
    width: int = WIDTH
    height: int = HEIGHT
    left: int = _LEFT
    right: int = _RIGHT
    bottom: int = _BOTTOM


def rows(
    answers: Sequence[Answer], simulated: Mapping[str, Mapping[int, float]]
) -> tuple[Row, ...]:
    """Return the participant's hit ratios, by the same function as the study's."""
    # Not before the extras are known to be there.
    from mirror_explainer.experiments.averages import PERCENTS
    from mirror_explainer.experiments.study.statistics import answer_table, ratios

    found = {
        (row['strategy'], row['percent']): row
        for row in ratios(answer_table(answers)).to_dict('records')
    }
    return tuple(
        Row(
            percent,
            tuple(
                _cell(strategy, found[strategy, percent], simulated[strategy].get(percent))
                for strategy in STRATEGIES
            ),
        )
        for percent in PERCENTS
    )


def chart(of: Sequence[Row]) -> Chart:
    """Return the picture of the rows."""
    return Chart(
        lines=tuple(
            Line(
                strategy,
                tuple(
                    Mark(_x(row.percent), _y(cell.ratio))
                    for row in of
                    for cell in row.cells
                    if cell.strategy == strategy and cell.ratio is not None
                ),
            )
            for strategy in STRATEGIES
        ),
        x_ticks=tuple((_x(percent), f'{percent} %') for percent in (10, 20, 50, 100)),
        y_ticks=tuple((_y(ratio), _percent(ratio)) for ratio in (0.0, 0.5, 1.0)),
    )


def _cell(strategy: str, row: Mapping[Hashable, Any], simulated: float | None) -> Cell:
    return Cell(strategy, int(row['correct']), int(row['predicted']), simulated)


def _percent(ratio: float) -> str:
    return f'{100 * ratio:.0f} %'


def _x(percent: float) -> float:
    return _LEFT + (_RIGHT - _LEFT) * percent / 100


def _y(ratio: float) -> float:
    return _BOTTOM - (_BOTTOM - _TOP) * ratio
