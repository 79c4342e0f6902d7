"""How much is lost with so many plans a belief, and how long they take, as Markdown tables."""

import statistics
from collections.abc import Callable, Sequence
from dataclasses import dataclass

COUNTS = (1, 3, 10, 30, 100, 300)
SIZES = (1, 2, 3, 4)


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


def regret_table(found: Sequence[Choice]) -> str:
    """Return the regret as Markdown: mean and worst in nats, and share of the referee's best."""
    lines = [
        '| domain | plans a belief | '
        + ' | '.join(f'N = {size}: mean, worst' for size in SIZES)
        + ' | share of the best |',
        '|---|---' + '|---' * (len(SIZES) + 1) + '|',
    ]
    for domain in _domains(found):
        for count in COUNTS:
            own = [c for c in found if (c.domain, c.count) == (domain, count)]
            cells = [_nats([c.regret for c in own if c.size == size]) for size in SIZES]
            lines.append(f'| {domain} | {count} | {" | ".join(cells)} | {_share(own):.1%} |')
    return '\n'.join(lines)


def _nats(regrets: Sequence[float]) -> str:
    return f'{statistics.mean(regrets):.2f}, {max(regrets):.2f}' if regrets else '–'


def _share(found: Sequence[Choice]) -> float:
    """Return the summed regret as a share of the summed best."""
    best = sum(choice.best for choice in found)
    return sum(choice.regret for choice in found) / best if best > 0 else 0.0


def renaming_table(found: Sequence[Choice]) -> str:
    """Return how often renaming the objects changes the sentences said, as Markdown."""

    def changed(domain: str, count: int) -> str:
        own = [c.changed for c in found if c.count == count and domain in (c.domain, 'all')]
        cases = [each for one in own for each in one]
        return f'{statistics.mean(cases):.1%} of {len(cases)}' if cases else '–'

    return _by_count([*_domains(found), 'all'], changed)


def cold_table(found: Sequence[Cold]) -> str:
    """Return the seconds of cold planning, as Markdown."""

    def seconds(domain: str, count: int) -> str:
        own = [c for c in found if c.count == count and domain in (c.domain, 'all')]
        times = [c.seconds for c in own]
        searches = statistics.median(c.searches for c in own)
        return f'{statistics.median(times):.2f}, {max(times):.2f} ({searches:.0f})'

    return _by_count([*dict.fromkeys(c.domain for c in found), 'all'], seconds)


def _domains(found: Sequence[Choice]) -> list[str]:
    return list(dict.fromkeys(choice.domain for choice in found))


def _by_count(domains: Sequence[str], cell: Callable[[str, int], str]) -> str:
    lines = [
        f'| domain | {" | ".join(f"k = {count}" for count in COUNTS)} |',
        '|---' * (len(COUNTS) + 1) + '|',
    ]
    for domain in domains:
        lines.append(f'| {domain} | {" | ".join(cell(domain, count) for count in COUNTS)} |')
    return '\n'.join(lines)
