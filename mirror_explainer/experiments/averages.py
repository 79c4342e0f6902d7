"""What both experiments average at, and how sure a mean is."""

import warnings

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.stats import bootstrap  # type: ignore[import-untyped]

PERCENTS = tuple(range(10, 101, 10))
CONFIDENCE = 0.95


def said_at(percent: int, plan_length: ArrayLike) -> NDArray[np.float64]:
    """N = max(1, round(x·|π_R|)) for each length; halves are rounded to the even number."""
    return np.maximum(1, np.round(percent * np.asarray(plan_length) / 100))


def mean_interval(
    values: NDArray[np.float64], resamples: int, seed: int = 0
) -> tuple[float, float, float]:
    """Return the mean and its 95 % percentile bootstrap interval; the same for the same seed."""
    mean = float(values.mean())
    if np.ptp(values) == 0:
        return mean, mean, mean
    with warnings.catch_warnings():
        warnings.simplefilter('ignore')
        found = bootstrap(
            (values,), np.mean, n_resamples=resamples, confidence_level=CONFIDENCE,
            method='percentile', random_state=np.random.default_rng(seed),
        ).confidence_interval  # fmt: skip
    return mean, float(found.low), float(found.high)
