"""What was measured of planning, as Markdown tables and a figure."""

import statistics
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Row:
    """What was measured on one instance; all times in seconds.

    `naive` is the time of one unified-planning call a belief, `cold` ours for a new
    problem, `step` after the robot's first action, and `many` with 2⁸ initial states.
    `calls` and `searching` are the searches of the cold one, and the time in them.
    """

    name: str
    beliefs: int
    naive: float
    cold: float
    step: float
    calls: int
    searching: float
    many: float
    compared: int


@dataclass(frozen=True)
class HardRow:
    """How many beliefs of a hard instance got what, and how many seconds that took."""

    name: str
    beliefs: int
    seconds: float
    solved: int
    unsolvable: int
    unknown: int


def table(rows: Sequence[Row]) -> str:
    """Return the measurements as Markdown."""
    lines = [
        '| instance | beliefs | one call a belief, s | cold, s | times faster | searches | '
        'searching, share | after a step, s | 2⁸ states, s | costs compared |',
        '|---|---|---|---|---|---|---|---|---|---|',
    ]
    for row in rows:
        lines.append(
            f'| {row.name} | {row.beliefs} | {row.naive:.1f} | {row.cold:.3f} | '
            f'{row.naive / row.cold:.0f} | {row.calls} | {row.searching / row.cold:.0%} | '
            f'{row.step:.3f} | {row.many:.3f} | {row.compared} |'
        )
    faster = [row.naive / row.cold for row in rows]
    cold = [row.cold for row in rows]
    lines.append(
        f'\n{len(rows)} instances: {statistics.median(faster):.0f} times faster in the median, '
        f'{min(faster):.0f} at least; cold {statistics.median(cold):.3f} s in the median, '
        f'{max(cold):.3f} s at most; after a step '
        f'{statistics.median(row.step for row in rows):.3f} s in the median; 2⁸ initial states '
        f'take {statistics.median(row.many / row.cold for row in rows):.1f} times as long as 2⁴ '
        f'in the median, {max(row.many / row.cold for row in rows):.1f} at most. '
        f'{sum(row.compared for row in rows)} costs compared, none different.'
    )
    return '\n'.join(lines)


def hard_table(rows: Sequence[HardRow]) -> str:
    """Return what the deadline leaves of the instances that optimal planning cannot finish."""
    lines = [
        '| hard instance | beliefs | seconds | solved | unsolvable | unknown |',
        '|---|---|---|---|---|---|',
    ]
    for row in rows:
        lines.append(
            f'| {row.name} | {row.beliefs} | {row.seconds:.1f} | {row.solved} | '
            f'{row.unsolvable} | {row.unknown} |'
        )
    return '\n'.join(lines)


def draw(rows: Sequence[Row], path: Path) -> None:
    """Draw every instance's seconds, one call a belief beside ours, as PNG and SVG."""
    from matplotlib.figure import Figure

    from mirror_explainer.commands.figures import save

    figure = Figure(figsize=(7.5, 3.6), layout='constrained')
    axes = figure.subplots()
    ordered = sorted(rows, key=lambda row: row.naive)
    places = range(len(ordered))
    for seconds, label, marker, colour in (
        ([row.naive for row in ordered], 'one call a belief (extrapolated)', 's', '#d55e00'),
        ([row.cold for row in ordered], 'here, a new problem', 'o', '#009e73'),
        ([row.step for row in ordered], 'here, after one step of the robot', 'x', '#0072b2'),
    ):
        axes.plot(places, seconds, marker, label=label, color=colour, markersize=5)
    axes.set_yscale('log')
    axes.set_ylabel('seconds for 64 beliefs')
    axes.set_xlabel(f'{len(ordered)} problems, by the time of one call a belief')
    axes.set_xticks([])
    figure.legend(loc='outside upper center', ncols=3, frameon=False)
    save(figure, path)
