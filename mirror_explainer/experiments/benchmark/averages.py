"""The benchmark's results as tables: every row, their averages, and the paper's domains."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd

from mirror_explainer.experiments.averages import PERCENTS, mean_interval, said_at

MEASURES = ('G_inf', 'D_G', 'H', 'IG', 'understanding')
RESAMPLES = 2000

# The paper's table: |P|, |A|, |I|, |G|, |π|.
PAPER_TABLE: Mapping[str, tuple[float, float, float, float, float]] = {
    'logistics': (3, 6, 22.16, 10.39, 24.41),
    'intrusion-detection': (11, 9, 1, 16.67, 13.07),
    'rovers': (32, 9, 172.71, 6, 24.93),
    'satellite': (12, 5, 58, 6.43, 16.89),
    'blocks-world': (5, 4, 14.58, 20.28, 14.50),
    'miconic': (8, 4, 517, 6, 35.57),
}


def every_row(records: Sequence[Mapping[str, Any]]) -> pd.DataFrame:
    """Return one row for each instance, strategy and N."""
    rows = []
    for record in records:
        result = record['result']
        place = {'domain': record['domain'], 'instance': record['instance']}
        place['problem'] = result['problem']
        place['plan_length'] = len(result['plan'])
        place['last_shared'] = result['last_shared']
        for row in result['rows']:
            positions = ' '.join(map(str, row['positions']))
            rows.append(place | row | {'positions': positions})
    return pd.DataFrame(rows)


def at_percents(rows: pd.DataFrame) -> pd.DataFrame:
    """Return each instance's and strategy's row at 10 %, 20 %, … 100 % of its plan.

    A plan that takes an action twice has fewer different ones than steps: with all of these
    said, there is no more to say.
    """
    parts = []
    different = rows.groupby(['domain', 'instance'])['N'].transform('max')
    for percent in PERCENTS:
        part = rows[rows['N'] == said_at(percent, rows['plan_length']).clip(max=different)].copy()
        part.insert(2, 'percent', percent)
        parts.append(part)
    return pd.concat(parts, ignore_index=True)


def averages(shares: pd.DataFrame) -> pd.DataFrame:
    """Return the mean over a domain's instances with its confidence interval.

    The interval is the 95 % percentile bootstrap of the mean, problems resampled with all of
    their instances. A domain with a single problem has none.
    """
    lines = []
    for (domain, strategy, percent), group in shares.groupby(
        ['domain', 'strategy', 'percent'], sort=False
    ):
        for measure in MEASURES:
            values = np.asarray(group[measure], dtype=np.float64)
            mean, low, high = mean_interval(values, RESAMPLES, clusters=list(group['problem']))
            lines.append(
                {
                    'domain': domain,
                    'strategy': strategy,
                    'percent': percent,
                    'measure': measure,
                    'mean': mean,
                    'low': low,
                    'high': high,
                    'instances': len(group),
                    'problems': group['problem'].nunique(),
                }
            )
    return pd.DataFrame(lines)


def domain_measures(records: Sequence[Mapping[str, Any]]) -> pd.DataFrame:
    """Return the paper's table of domain measures beside ours."""
    ours = pd.DataFrame(
        [{'domain': r['domain'], **r['result']['measures']} for r in records]
    ).astype({'optimal': float, 'observed': float})
    lines = []
    for domain, group in ours.groupby('domain', sort=False):
        paper = PAPER_TABLE.get(str(domain), (np.nan,) * 5)
        mean = group.mean(numeric_only=True)
        lines.append(
            {
                'domain': domain,
                'predicates (paper)': paper[0],
                'predicates': mean['predicates'],
                'actions (paper)': paper[1],
                'actions': mean['actions'],
                'initial facts (paper)': paper[2],
                'initial facts': mean['initial'],
                'goals (paper)': paper[3],
                'goals': mean['goals'],
                'plan length (paper)': paper[4],
                'recorded plan': mean['observed'],
                'optimal plan': mean['optimal'],
                'plan of the robot': mean['robot_plan'],
                'instances': len(group),
                'with recorded plan': int(group['observed'].notna().sum()),
            }
        )
    return pd.DataFrame(lines)
