"""The paper's findings on the benchmark, each set beside what came out."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pandas as pd

from mirror_explainer.experiments.averages import mean_interval, paired_p
from mirror_explainer.experiments.benchmark.averages import RESAMPLES

_ROUNDING = 1e-9
_INSTANCE = ['domain', 'problem', 'instance']
# What counts as "equally informative", in nats: a listener of two equally likely
# readings who is told this much is 61 % sure of one.
EQUALLY = 0.1


@dataclass(frozen=True)
class Finding:
    """A claim of the paper, whether it held, and the numbers that say so."""

    claim: str
    held: str
    numbers: str


def findings(rows: pd.DataFrame, shares: pd.DataFrame, means: pd.DataFrame) -> list[Finding]:
    """Return the paper's findings in its order, from all rows, those at x %, and the averages."""
    return [
        _never_below(rows),
        *_first_tenth(shares, means),
        _decreasing_above_increasing(shares, means),
        *_near_the_goal(shares, means),
    ]


def _never_below(rows: pd.DataFrame) -> Finding:
    least = rows['G_inf'].min()
    below = int((rows['G_inf'] < -_ROUNDING).sum())
    unproved = rows[(rows['strategy'] == 'informative') & (rows['gap'] > 0)]
    numbers = (
        f'min G_inf = {least:.2g} nats over {len(rows)} rows (instance, strategy, N); '
        f'{below} below −1e-9; {len(unproved)} informative selections not proved optimal'
    )
    return Finding(
        'Informative is at least as informative as both others, everywhere (true by '
        'construction: it has the largest gain of all sets of a size).',
        'no' if below else 'yes',
        numbers,
    )


def _first_tenth(shares: pd.DataFrame, means: pd.DataFrame) -> Iterator[Finding]:
    gains = _cells(means, 'G_inf', 'decreasing', 10)
    close = [domain for domain, gain in gains.items() if gain <= EQUALLY]
    first = _paired(shares, 'G_inf', 10)
    equal = first['decreasing'] <= _ROUNDING
    shared = shares.groupby(_INSTANCE)['last_shared'].first().reindex(first.index) > 0
    by_sharing = {
        'no other candidate goal has:': first.loc[~shared, 'decreasing'],
        'another one has too:': first.loc[shared, 'decreasing'],
    }
    split = ', '.join(
        f'{which} {_interval(gain)} ({len(gain)} instances)'
        for which, gain in by_sharing.items()
        if len(gain)
    )
    yield Finding(
        'After the first 10 %, informative and decreasing are equally informative '
        f'(here: a mean G_inf of decreasing of at most {EQUALLY} nats).',
        _verdict(len(close), len(gains), 'domains'),
        f'mean G_inf of decreasing at 10 %: {_listed(gains)}; all instances '
        f'{_interval(first["decreasing"])}, increasing {_interval(first["increasing"])}; '
        f'exactly equal on {int(equal.sum())} of {len(first)} instances. Where the last action '
        f'brings about what {split}',
    )


def _decreasing_above_increasing(shares: pd.DataFrame, means: pd.DataFrame) -> Finding:
    table = means[(means['measure'] == 'G_inf') & (means['percent'] < 100)].pivot(
        index=['domain', 'percent'], columns='strategy', values='mean'
    )
    ahead = table['decreasing'] < table['increasing'] - _ROUNDING
    behind = table['decreasing'] > table['increasing'] + _ROUNDING
    paired = shares[shares['percent'] < 100].pivot(
        index=['domain', 'problem', 'instance', 'percent'], columns='strategy', values='IG'
    )
    lead = (paired['decreasing'] - paired['increasing']).groupby(level=_INSTANCE).mean()
    by_domain = {str(k): float(v) for k, v in lead.groupby('domain', sort=False).mean().items()}
    problems = list(lead.index.get_level_values('problem'))
    p = paired_p(-lead, np.zeros(len(lead)), clusters=problems)
    test = f'; one-sided sign-flip test over {len(set(problems))} problems, p = {p:.2g}'
    return Finding(
        'Decreasing is consistently more informative than increasing.',
        _verdict(int(ahead.sum()), len(table), 'means (domain, x below 100 %)'),
        f'equal in {int((~ahead & ~behind).sum())}, behind in {int(behind.sum())}; it is '
        f'{_interval(lead)} nats ahead in the mean over x (by domain: {_listed(by_domain)})'
        + test,
    )


def _near_the_goal(shares: pd.DataFrame, means: pd.DataFrame) -> Iterator[Finding]:
    first = _paired(shares, 'D_G', 10)
    whole = _paired(shares, 'D_G', 100)['informative']
    early = _cells(means, 'D_G', 'informative', 10)
    average = _cells(means, 'D_G', 'informative', 100)
    low = [domain for domain in early if early[domain] < average[domain]]
    counted = shares[(shares['percent'] == 10) & shares['ties'].notna()].set_index(_INSTANCE)
    tied = counted.astype({'ties': float, 'D_G_ties': float, 'D_G_nearest': float})
    yield Finding(
        'What informative says first is near the goal (here: D_G at 10 % below the '
        "plan's average, which is D_G at 100 %).",
        _verdict(len(low), len(early), 'domains'),
        f'mean D_G of informative at 10 %: {_listed(early)}; all instances '
        f"{_interval(first['informative'])}, the plan's average {_interval(whole)}. Which of the "
        f'equally informative selections is said decides this: there are '
        f'{tied["ties"].median():.0f} of them in the median at 10 %, their mean D_G is '
        f'{_interval(tied["D_G_ties"])}, that of the nearest {_interval(tied["D_G_nearest"])}',
    )
    to_decreasing = (first['informative'] - first['decreasing']).abs().groupby('domain').mean()
    to_increasing = (first['informative'] - first['increasing']).abs().groupby('domain').mean()
    nearer = int((to_decreasing < to_increasing).sum())
    yield Finding(
        'Its D_G is similar to that of decreasing in the early actions (here: on average '
        'nearer to it than to that of increasing).',
        _verdict(nearer, len(to_decreasing), 'domains'),
        f'D_G at 10 %, all instances: informative {_interval(first["informative"])}, decreasing '
        f'{_interval(first["decreasing"])}, increasing {_interval(first["increasing"])}; '
        f'mean distance of informative from decreasing {to_decreasing.mean():.2f}, from '
        f'increasing {to_increasing.mean():.2f}',
    )


def _paired(shares: pd.DataFrame, measure: str, percent: int) -> pd.DataFrame:
    """Return a measure at one x: a row for each instance, a column for each strategy."""
    return shares[shares['percent'] == percent].pivot(
        index=_INSTANCE, columns='strategy', values=measure
    )


def _cells(means: pd.DataFrame, measure: str, strategy: str, percent: int) -> dict[str, float]:
    """Return the means of the domains."""
    chosen = means[
        (means['measure'] == measure)
        & (means['strategy'] == strategy)
        & (means['percent'] == percent)
    ]
    return dict(zip(chosen['domain'], chosen['mean'], strict=True))


def _verdict(held: int, total: int, of: str) -> str:
    word = 'yes' if held == total else 'no' if held == 0 else 'in part'
    return f'{word}: {held} of {total} {of}'


def _listed(values: dict[str, float]) -> str:
    return ', '.join(f'{name} {value:.2f}' for name, value in values.items())


def _interval(values: 'pd.Series[float]') -> str:
    """Say the mean of some instances with its interval, problems resampled."""
    problems = list(values.index.get_level_values('problem'))
    mean, low, high = mean_interval(values, RESAMPLES, clusters=problems)
    return f'{mean:.2f} [{low:.2f}, {high:.2f}]' if low == low else f'{mean:.2f}'
