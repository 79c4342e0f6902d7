"""How much is lost with so many plans a belief, and how long they take, as Markdown tables."""

import statistics
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeVar

from mirror_explainer.experiments.markdown import worded_table

COUNTS = (1, 3, 10, 30, 100, 300)


@dataclass(frozen=True)
class Choice:
    """What is said with so many plans a belief, and what the referee thinks of it, in nats.

    `changed` says, for each renaming of the objects, whether another set of
    sentences would have been said.
    """

    domain: str
    count: int
    size: int
    regret: float
    best: float
    changed: tuple[bool, ...]


@dataclass(frozen=True)
class Cold:
    """Seconds and searches of planning for 64 beliefs of a new problem."""

    domain: str
    count: int
    seconds: float
    searches: int


_Found = TypeVar('_Found', Choice, Cold)


def regret_table(found: Sequence[Choice]) -> str:
    """Return the regret as Markdown: the share of the referee's best, and the worst in nats."""

    def lost(own: Sequence[Choice]) -> str:
        best = sum(choice.best for choice in own)
        share = sum(choice.regret for choice in own) / best if best > 0 else 0.0
        return f'{share:.1%} ({max(choice.regret for choice in own):.2f})'

    return _by_count(found, lost)


def renaming_table(found: Sequence[Choice]) -> str:
    """Return how often renaming the objects changes the sentences said, as Markdown."""

    def changed(own: Sequence[Choice]) -> str:
        cases = [each for one in own for each in one.changed]
        return f'{statistics.mean(cases):.1%} of {len(cases)}' if cases else '–'

    return _by_count(found, changed)


def cold_table(found: Sequence[Cold]) -> str:
    """Return the seconds of cold planning, as Markdown."""

    def seconds(own: Sequence[Cold]) -> str:
        times = [one.seconds for one in own]
        searches = statistics.median(one.searches for one in own)
        return f'{statistics.median(times):.2f}, {max(times):.2f} ({searches:.0f})'

    return _by_count(found, seconds)


def _by_count(found: Sequence[_Found], cell: Callable[[Sequence[_Found]], str]) -> str:
    """Return a row for each domain, and one for all, with a cell for each count of plans."""
    domains = [*dict.fromkeys(one.domain for one in found), 'all']
    rows = (
        [domain]
        + [
            cell([one for one in found if one.count == count and domain in (one.domain, 'all')])
            for count in COUNTS
        ]
        for domain in domains
    )
    return worded_table(['domain', *(f'k = {count}' for count in COUNTS)], rows)
