"""What closes a node of the branch and bound: tangents below F, and copies no set can miss."""

import numpy as np

from mirror_explainer.selection.columns import LARGEST_EXPONENT, Booleans, Floats, Ints


def tangents(
    ceiling: Floats,
    unhit: Floats,
    cost: Floats,
    spared: Booleans,
) -> tuple[Floats, Floats]:
    """Height and slope of the tangents to `ceiling` · exp(−x) at x = `cost`; all (B, K).

    A flat one at `unhit`, the least value without a hit, where that is
    higher; none at all for hypotheses that are not `spared` from being hit.
    """
    cost = np.clip(cost, 0.0, LARGEST_EXPONENT)
    slope = np.where(spared, ceiling * np.exp(-cost), 0.0)
    flat = spared & (unhit > slope)
    return np.where(flat, unhit, slope * (1.0 + cost)), np.where(flat, 0.0, slope)


def leading_copies(
    score: Floats,
    allowed: Booleans,
    missing: int,
    required: Floats,
) -> tuple[Ints, Ints]:
    """Rank the copies by score, and count the leading ones of which a set must have one.

    `score` has shape (B, P) or (P,), `allowed` (B, P). Sets of `missing` copies without
    any of the leading ones cannot bring the `required` (B,) sum of scores.
    Returns the ranks (B, P) and the numbers of leading copies (B,).
    """
    each = np.arange(len(allowed))[:, None]
    order = np.argsort(np.where(allowed, -score, np.inf), axis=1, kind='stable')
    rank = np.empty_like(order)
    rank[each, order] = np.arange(order.shape[1])
    running = np.zeros((len(order), order.shape[1] + 1))
    np.cumsum(np.where(allowed, score, 0.0)[each, order], axis=1, out=running[:, 1:])
    window = running[:, missing:] - running[:, :-missing]  # the best set from each rank on
    full = np.arange(window.shape[1]) <= allowed.sum(axis=1)[:, None] - missing
    return rank, ((window >= required[:, None]) & full).sum(axis=1)
