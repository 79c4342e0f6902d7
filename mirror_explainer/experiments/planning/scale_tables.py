"""How planning grows with the robot, as Markdown tables and a figure."""

import re
import statistics
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from mirror_explainer.experiments.markdown import worded_table
from mirror_explainer.experiments.planning.plain_searches import PEERS


@dataclass(frozen=True)
class Searches:
    """Processor time of searches for some goals of a robot, in seconds.

    `here` is ours, `best` the best single one of the portfolio for each goal, and `peers` has
    other planners by their names. None is where a goal's does not end.
    """

    goals: int
    here: float
    best: float | None
    peers: Mapping[str, float | None]


@dataclass(frozen=True)
class Row:
    """What was measured of one robot, in seconds.

    `unit` is how long an import took just before. `answer` is when a question could be answered
    with nothing planned, `first` when the first belief's plan was there, `all` when every
    belief's was, and `step` the same after one step of the robot. `calls` searches were made for
    all, in `searching` of the seconds. `naive` is one unified-planning call a belief, at least
    so much where not all `naive_ended` that were made.
    """

    name: str
    beliefs: int
    unknown: int
    unit: float
    answer: float
    first: float
    all: float
    step: float
    calls: int
    searching: float
    naive: float
    naive_ended: bool
    searches: Searches

    @property
    def family_and_size(self) -> tuple[str, int]:
        """The name without its first number, and that."""
        before, size, after = re.split(r'(\d+)', self.name, maxsplit=1)
        return f'{before}…{after}', int(size)


_HEADINGS = (
    'robot',
    'beliefs',
    'first answer',
    'first plan',
    'all first plans',
    'after a step',
    'searches',
    'searching, share',
    'one call a belief',
)


def table(rows: Sequence[Row]) -> str:
    """Return when there were plans, as Markdown, times in units of one import."""

    def cells(row: Row) -> tuple[object, ...]:
        unknown = f' ({row.unknown} unknown)' if row.unknown else ''
        times = (row.answer, row.first, row.all, row.step)
        return (
            row.name,
            f'{row.beliefs}{unknown}',
            *(f'{seconds / row.unit:.2f}' for seconds in times),
            row.calls,
            f'{row.searching / row.all:.0%}',
            f'{"" if row.naive_ended else "> "}{row.naive / row.unit:.0f}',
        )

    units = [row.unit for row in rows]
    return (
        f'{worded_table(_HEADINGS, map(cells, rows))}\n\nTimes in units of one `import '
        'unified_planning.shortcuts`, measured before each robot '
        f'({min(units):.1f} to {max(units):.1f} s).'
    )


def searches_table(rows: Sequence[Row]) -> str:
    """Return the searches by themselves as Markdown, beside those peers that are installed."""
    told = [peer.name for peer in PEERS if peer.name in rows[0].searches.peers]
    headings = ('robot', 'goals', 'here', 'best single ones', 'here : best', *told)

    def cells(row: Row) -> tuple[object, ...]:
        own = row.searches
        others = (_seconds(own.peers[name]) for name in told)
        ratio = f'{own.here / own.best:.1f}' if own.best else '–'
        return row.name, own.goals, _seconds(own.here), _seconds(own.best), ratio, *others

    lines = [
        f'{worded_table(headings, map(cells, rows))}\n\nSeconds of processor time; – is where a '
        'search did not end.'
    ]
    ratios = [row.searches.here / row.searches.best for row in rows if row.searches.best]
    if ratios:
        lines.append(
            f'The searches took {statistics.median(ratios):.1f} times as long as the best '
            f'single ones in the median of {len(ratios)} robots, {max(ratios):.1f} at most.'
        )
    missing = [f'{peer.name} ({peer.package})' for peer in PEERS if peer.name not in told]
    if missing:
        lines.append(f'Left out, since not installed: {", ".join(missing)}.')
    return ' '.join(lines)


def _seconds(seconds: float | None) -> str:
    return '–' if seconds is None else f'{seconds:.2f}'


def draw(rows: Sequence[Row], path: Path) -> None:
    """Draw each family's times over its sizes, as PNG and SVG."""
    from matplotlib.figure import Figure

    from mirror_explainer.commands.figures import save

    families: dict[str, list[Row]] = {}
    for row in rows:
        families.setdefault(row.family_and_size[0], []).append(row)
    figure = Figure(figsize=(1.5 + 1.25 * len(families), 4.2), layout='constrained')
    panels = figure.subplots(1, len(families), sharey=True, squeeze=False)[0]
    for axes, (family, own) in zip(panels, families.items(), strict=True):
        for label, colour, style, values in (
            (
                'one call a belief (extrapolated; at least)',
                '#d55e00',
                's--',
                [row.naive for row in own],
            ),
            ('all first plans', '#009e73', 'o-', [row.all for row in own]),
            ('all first plans, after a step', '#0072b2', 'x-', [row.step for row in own]),
            ('first plan', '#cc79a7', '^:', [row.first for row in own]),
            ('first answer, nothing planned', '#000000', '+:', [row.answer for row in own]),
        ):
            units = [value / row.unit for value, row in zip(values, own, strict=True)]
            axes.plot(units, style, label=label, color=colour, markersize=5)
        axes.set_xticks(
            range(len(own)),
            [f'{row.family_and_size[1]}\n({row.beliefs})' for row in own],
        )
        axes.set_xmargin(0.2)
        axes.set_title(family.replace(',', ',\n'), fontsize=9)
    panels[0].set_yscale('log')
    panels[0].set_ylabel('imports of unified-planning')
    figure.supxlabel(f'{len(rows)} robots by their size (how many beliefs)', fontsize=10)
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc='outside upper center', ncols=2, frameon=False)
    save(figure, path)
