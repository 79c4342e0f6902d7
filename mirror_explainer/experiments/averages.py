"""What the experiments average at, how sure a mean is, and what chance alone would do."""

from collections.abc import Sequence

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

PERCENTS = tuple(range(10, 101, 10))
CONFIDENCE = 0.95
RESAMPLES = 9999


def said_at(percent: int, plan_length: ArrayLike) -> NDArray[np.float64]:
    """N = max(1, round(x·|π_R|)) for each length; halves are rounded to the even number."""
    return np.maximum(1, np.round(percent * np.asarray(plan_length) / 100))


def mean_interval(
    values: ArrayLike,
    resamples: int,
    seed: int = 0,
    clusters: Sequence[object] | None = None,
) -> tuple[float, float, float]:
    """Return the mean and its 95 % percentile bootstrap interval; the same for the same seed.

    What shares a cluster is resampled together, all its values or none; without `clusters`
    each value is one. A single cluster does not tell how sure the mean is: NaN.
    """
    sums, sizes = _of_clusters(values, clusters)
    mean = float(sums.sum() / sizes.sum())
    if len(sums) == 1 and sizes[0] > 1:
        return mean, float('nan'), float('nan')
    if np.ptp(sums / sizes) == 0:
        return mean, mean, mean
    random = np.random.default_rng(seed)
    drawn = random.integers(len(sums), size=(resamples, len(sums)))
    means = sums[drawn].sum(axis=1) / sizes[drawn].sum(axis=1)
    edge = 50 * (1 - CONFIDENCE)
    low, high = np.percentile(means, [edge, 100 - edge])
    return mean, float(low), float(high)


def paired_p(
    smaller: ArrayLike,
    larger: ArrayLike,
    seed: int = 0,
    clusters: Sequence[object] | None = None,
) -> float:
    """P of a mean difference as low as this, or lower, if pairs are exchangeable; NaN for < 2.

    The pairs of a cluster are exchanged together. Exact up to 13 clusters; 9999 exchanges
    are drawn beyond.
    """
    differences, _ = _of_clusters(np.asarray(smaller, float) - np.asarray(larger, float), clusters)
    if len(differences) < 2:
        return float('nan')
    # Importing it takes a second, and nobody but this needs it.
    from scipy.stats import permutation_test  # type: ignore[import-untyped]

    result = permutation_test(
        (differences, np.zeros_like(differences)),
        lambda x, y, axis: np.mean(x - y, axis=axis),
        permutation_type='samples',
        alternative='less',
        vectorized=True,
        n_resamples=RESAMPLES,
        random_state=np.random.default_rng(seed),
    )
    return float(result.pvalue)


def holm(p_values: Sequence[float]) -> list[float]:
    """Return the p-values of a family of tests, each corrected for all of them (Holm).

    Those that are NaN are of no test, and stay so.
    """
    corrected = list(p_values)
    tests = sorted((p, index) for index, p in enumerate(p_values) if p == p)
    largest = 0.0
    for rank, (p, index) in enumerate(tests):
        largest = max(largest, min(1.0, (len(tests) - rank) * p))
        corrected[index] = largest
    return corrected


def _of_clusters(
    values: ArrayLike, clusters: Sequence[object] | None
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the sum of each cluster's values, and how many there are."""
    numbers = np.asarray(values, dtype=np.float64)
    if clusters is None:
        return numbers, np.ones_like(numbers)
    of, _ = pd.factorize(np.asarray([str(cluster) for cluster in clusters]))
    return np.bincount(of, numbers).astype(np.float64), np.bincount(of).astype(np.float64)
