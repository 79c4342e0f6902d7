"""What was measured of planning, as Markdown tables and a figure."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median

from mirror_explainer.experiments.markdown import worded_table


@dataclass(frozen=True)
class Row:
    """What was measured on one instance; all times in seconds.

    `naive` is the time of one unified-planning call a belief, `cold` ours for a new
    problem, `step` after the robot's first action, and `many` with 2⁸ initial states.
    `calls` and `searching` are the searches of the cold one, and the time in them.
    """

    domain: str
    name: str
    beliefs: int
    naive: float
    cold: float
    step: float
    calls: int
    searching: float
    many: float
    compared: int

    @property
    def faster(self) -> float:
        """How many times less ours takes for a new problem."""
        return self.naive / self.cold


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
    """Return the measurements of every instance as Markdown, and what they come to."""
    headings = (
        'instance',
        'beliefs',
        'one call a belief, s',
        'cold, s',
        'times faster',
        'searches',
        'searching, share',
        'after a step, s',
        '2⁸ states, s',
        'costs compared',
    )
    lines = [
        (
            row.name,
            row.beliefs,
            f'{row.naive:.1f}',
            f'{row.cold:.3f}',
            f'{row.faster:.0f}',
            row.calls,
            f'{row.searching / row.cold:.0%}',
            f'{row.step:.3f}',
            f'{row.many:.3f}',
            row.compared,
        )
        for row in rows
    ]
    faster = [row.faster for row in rows]
    cold = [row.cold for row in rows]
    more = [row.many / row.cold for row in rows]
    return (
        f'{worded_table(headings, lines)}\n\n'
        f'{len(rows)} instances: {median(faster):.0f} times faster in the median, '
        f'{min(faster):.0f} at least; cold {median(cold):.3f} s in the median, '
        f'{max(cold):.3f} s at most, {median(row.searching / row.cold for row in rows):.0%} of it '
        f'searching; after a step {median(row.step for row in rows):.3f} s in the median; 2⁸ '
        f'initial states take {median(more):.1f} times as long as 2⁴ in the median, '
        f'{max(more):.1f} at most. {sum(row.compared for row in rows)} costs compared, none '
        'different.'
    )


def domains_table(rows: Sequence[Row]) -> str:
    """Return the medians over each domain's instances as Markdown."""
    headings = (
        'domain',
        'problems',
        'one call a belief, s',
        'here, s',
        'times faster',
        'searches',
        'after a step, s',
        '2⁸ states, s',
        'searching, share',
    )

    def cells(domain: str) -> tuple[object, ...]:
        own = [row for row in rows if row.domain == domain]
        faster = [row.faster for row in own]
        return (
            domain,
            len(own),
            f'{median(row.naive for row in own):.1f}',
            f'{median(row.cold for row in own):.3f}',
            f'{median(faster):.0f} (least {min(faster):.0f})',
            f'{median(row.calls for row in own):.0f}',
            f'{median(row.step for row in own):.3f}',
            f'{median(row.many for row in own):.2f}',
            f'{median(row.searching / row.cold for row in own):.0%}',
        )

    return worded_table(headings, map(cells, dict.fromkeys(row.domain for row in rows)))


def hard_table(rows: Sequence[HardRow]) -> str:
    """Return what the deadline leaves of the instances that optimal planning cannot finish."""
    return worded_table(
        ('hard instance', 'beliefs', 'seconds', 'solved', 'unsolvable', 'unknown'),
        [
            (row.name, row.beliefs, f'{row.seconds:.1f}', row.solved, row.unsolvable, row.unknown)
            for row in rows
        ],
    )


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
