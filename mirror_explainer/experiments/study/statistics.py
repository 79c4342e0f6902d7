"""The measures and tests of the user study, on a table of answers, of people or simulated.

The participant is the unit throughout: scenarios and steps of one participant are
averaged before anything is compared or resampled.
"""

from collections.abc import Iterable
from dataclasses import asdict, fields

import numpy as np
import pandas as pd

from mirror_explainer.experiments.averages import (
    PERCENTS,
    RESAMPLES,
    holm,
    mean_interval,
    paired_p,
    said_at,
)
from mirror_explainer.experiments.study.design import (
    BASELINES,
    DONT_KNOW,
    PEOPLE,
    SPOKEN_TO,
    Answer,
)

# Two readings of the paper's hit ratio: is "I don't know" a prediction that missed, or none?
MEASURES = {'hit_ratio': 'of predictions', 'hit_ratio_of_answers': 'of all answers'}


def answer_table(answers: Iterable[Answer]) -> pd.DataFrame:
    """Return one row an answer, with whether it names a goal and whether that is the robot's.

    `listener` is whom the words are chosen for, empty where they are not chosen.
    """
    columns = [field.name for field in fields(Answer)]
    table = pd.DataFrame([asdict(answer) for answer in answers], columns=columns)
    kinds = {strategy: listener.kind for strategy, listener in SPOKEN_TO.items()}
    table['listener'] = table['strategy'].map(kinds)
    table['predicted'] = table['answer'] != DONT_KNOW
    table['correct'] = table['answer'] == table['goal']
    return table


def at_percents(answers: pd.DataFrame) -> pd.DataFrame:
    """Return the answers at 10 %, 20 %, … 100 % of the plan: those given at step `said_at`.

    Where all different sentences are said before, the last answer counts.
    """
    parts = []
    for percent in PERCENTS:
        step = said_at(percent, answers['plan_length']).clip(max=answers['steps'])
        parts.append(answers[answers['step'] == step].assign(percent=percent))
    return pd.concat(parts)


def ratios(answers: pd.DataFrame) -> pd.DataFrame:
    """Return both measures of each participant at each % of the plan, for each strategy.

    The hit ratio of predictions is missing where none was made.
    """
    keys = ['observer', 'strategy', 'percent', 'participant']
    counts = (
        at_percents(answers)
        .groupby(keys, sort=False)
        .agg(
            correct=('correct', 'sum'), predicted=('predicted', 'sum'), answers=('correct', 'size')
        )
        .reset_index()
    )
    counts['hit_ratio'] = counts['correct'] / counts['predicted'].where(counts['predicted'] > 0)
    counts['hit_ratio_of_answers'] = counts['correct'] / counts['answers']
    return counts


def curves(answers: pd.DataFrame, seed: int = 0) -> pd.DataFrame:
    """Return the mean over participants of both measures, with 95 % confidence bands.

    The bands are bootstrapped over participants (percentiles): they hold their
    answers together, as these are not independent.
    """
    rows = []
    for keys, group in ratios(answers).groupby(['observer', 'strategy', 'percent'], sort=False):
        row = dict(zip(('observer', 'strategy', 'percent'), keys, strict=True))
        for measure in MEASURES:
            values = group[measure].dropna().to_numpy(float)
            mean = values.mean() if len(values) else np.nan
            low = high = np.nan
            if len(values) > 1:
                mean, low, high = mean_interval(values, RESAMPLES, seed)
            row |= {measure: mean, f'{measure}_low': low, f'{measure}_high': high}
        rows.append(row)
    return pd.DataFrame(rows)


def reached_at(
    curve: pd.DataFrame, observer: str, strategy: str, measure: str, level: float
) -> float:
    """Return the % of the plan from which on the measure is at the level or above; NaN: never."""
    of = curve[(curve['observer'] == observer) & (curve['strategy'] == strategy)]
    below = of.loc[~(of[measure] >= level), 'percent'].max()
    return float(of.loc[~(of['percent'] <= below), 'percent'].min())


def earliest_steps(answers: pd.DataFrame) -> pd.DataFrame:
    """Return, for each scenario of each participant, when the answer became right.

    `first_right` is the first step with the right answer, `settled` the first from
    which on all answers are right. Where there is none, it is one step more than
    the plan has.
    """
    keys = ['observer', 'participant', 'scenario', 'strategy', 'steps']
    wrong = answers['step'].where(~answers['correct'], 0)
    right = answers['step'].where(answers['correct'], answers['steps'] + 1)
    grouped = answers.assign(first_right=right, settled=wrong).groupby(keys, sort=False)
    table = grouped.agg({'first_right': 'min', 'settled': 'max'}).reset_index()
    table['settled'] += 1
    return table


def informative_of(strategies: Iterable[str]) -> list[str]:
    """Return the informative strategies among these, the paper's first."""
    among = set(strategies)
    return [strategy for strategy in SPOKEN_TO if strategy in among]


def mean_tests(earliest: pd.DataFrame, seed: int = 0) -> pd.DataFrame:
    """Test μ_inf < μ_inc and μ_inf < μ_dec, μ the mean earliest step, as the paper does.

    With words for an open listener as well, these are tested likewise, and against the words
    for a planner, which are a baseline then.

    A permutation test of paired means, one-sided. Each participant hears all of the
    strategies, so that differences between people cancel in the pair of means, which
    is one observation however many scenarios lie behind it. Strategies are dealt to
    scenarios at random, so that without an effect the two means of a pair could as
    well be exchanged: the test needs no more than that, no normal steps (they are
    small integers, cut off at the plan's end) and no large sample. Since as many
    participants as there are strategies, in turn, hear every strategy on every scenario,
    hard scenarios cancel in their means, which the test doesn't count on: it errs on the
    side of caution.
    It is exact up to 13 participants, and draws 9999 exchanges beyond. `p_holm` is
    corrected for all tests of the table. Of simulated observers p would only
    measure how many of them were simulated: it is left out.
    """
    rows = []
    for measure in ('settled', 'first_right'):
        for observer, group in earliest.groupby('observer', sort=False):
            means = group.pivot_table(index='participant', columns='strategy', values=measure)
            told = informative_of(group['strategy'])
            means = means.reindex(columns=[*told, *BASELINES])
            tested = [(strategy, baseline) for strategy in told for baseline in BASELINES]
            for strategy, baseline in [*tested, *zip(told[1:], told, strict=False)]:
                pairs = means[[strategy, baseline]].dropna()
                rows.append(
                    {
                        'observer': observer,
                        'measure': measure,
                        'strategy': strategy,
                        'baseline': baseline,
                        'participants': len(pairs),
                        'mean_informative': pairs[strategy].mean(),
                        'mean_baseline': pairs[baseline].mean(),
                        'p': paired_p(pairs[strategy], pairs[baseline], seed)
                        if observer == PEOPLE
                        else np.nan,
                    }
                )
    table = pd.DataFrame(rows)
    return table.assign(p_holm=holm(list(table['p'])))
