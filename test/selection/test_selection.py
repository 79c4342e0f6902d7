"""What is selected: the same as looking at every set, however the evidence is written."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from mirror_explainer.selection import choice, enumeration
from mirror_explainer.selection.choice import (
    baseline,
    best_of_each,
    curve,
    informative_order,
    most_informative,
    smallest_sufficient,
)
from mirror_explainer.selection.enumeration import OutOfTime, best_of_all
from mirror_explainer.selection.evidence import Doubt, Evidence
from mirror_explainer.selection.search import least_doubt

generated = settings(
    derandomize=True,
    deadline=None,
    max_examples=60,
    suppress_health_check=[HealthCheck.too_slow],
)
DOUBTS = {'open': Doubt(0.05), 'curious': Doubt(0.3, 0.2), 'planner': Doubt(whole=True)}


@st.composite
def evidences(draw, largest=8):
    """Evidence as mirror models give it, of all kinds of listeners."""
    sentences = draw(st.integers(1, largest))
    kinds = draw(st.integers(0, 7))
    ratios = draw(
        st.sampled_from(
            [
                st.sampled_from([0.0, 1.0]),
                st.sampled_from([0.0, 0.05, 1.0, 20.0]),
                st.floats(0.01, 3.0),
            ]
        )
    )
    rows = [[1.0] * sentences]
    rows += [[draw(ratios) for _ in range(sentences)] for _ in range(kinds)]
    masses = [draw(st.sampled_from([1e-9, 0.05, 1.0]))]
    masses += [draw(st.sampled_from([0.1, 1.0, 3.0])) for _ in range(kinds)]
    counts = [4, *(draw(st.integers(1, 4)) for _ in range(kinds))]  # how far a kind is like π_R
    weight = [
        [m if place < c else 0.0 for place in range(4)]
        for m, c in zip(masses, counts, strict=True)
    ]
    ends = itertools.accumulate(draw(st.integers(1, 3)) for _ in range(sentences))
    return Evidence(
        np.array(rows),
        np.array(weight) / sum(masses),
        masses[0] / sum(masses),
        tuple((end,) for end in ends),
        draw(st.sampled_from(list(DOUBTS.values()))),
        frozenset(c for c in range(sentences) if draw(st.booleans())),
        draw(st.sampled_from([None, 0.0, 0.02, 0.3])),
    )


def doubt(evidence, columns):
    """D of the sentences of some columns, written out once more."""
    left = [
        [weight * math.prod(row[c] for c in columns) for weight in weights]
        for row, weights in zip(evidence.ratio.tolist(), evidence.weight.tolist(), strict=True)
    ]
    everything, goal, foreseen, belief = (sum(column) for column in zip(*left, strict=True))
    if evidence.doubt.whole:
        return math.log(everything / evidence.robot)
    facts = max(belief / foreseen, 0.01)
    way = evidence.robot / belief
    of = evidence.doubt
    return math.log(everything / goal) - of.facts * math.log(facts) - of.way * math.log(way)


def best_set(evidence, n):
    """The best of all sets of n sentences, the latest of those that are as good."""
    columns = [*itertools.combinations(range(len(evidence.places)), n)]
    doubts = [doubt(evidence, chosen) for chosen in columns]
    tied = [c for c, d in zip(columns, doubts, strict=True) if d <= min(doubts) + 1e-9]
    return max(tied, key=lambda chosen: chosen[::-1])


def plain(evidence):
    return replace(evidence, means=frozenset(), min_gain=None)


@generated
@given(evidences())
def test_of_every_size_it_is_the_best_of_all_sets_and_the_latest_of_the_best(evidence):
    evidence = plain(evidence)
    for n in range(1, len(evidence.places) + 1):
        found = most_informative(evidence, n)
        best = best_set(evidence, n)
        gain = doubt(evidence, ()) - doubt(evidence, best)

        assert found.positions == tuple(evidence.positions[c] for c in best)
        assert found.information_gain == pytest.approx(gain, abs=1e-9)
        assert found.optimal


@generated
@given(evidences())
def test_what_weighs_most_is_looked_at_first_and_it_is_the_best_of_all_sets(evidence):
    evidence = plain(evidence)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(enumeration, '_HEAVIEST', 1)
        for n in range(1, len(evidence.places) + 1):
            found = most_informative(evidence, n)

            assert found.positions == tuple(evidence.positions[c] for c in best_set(evidence, n))
            assert found.optimal


@generated
@given(evidences(), st.integers(1, 8))
def test_the_smallest_that_tells_nearly_as_much_as_the_best_is_said(evidence, n):
    evidence = replace(evidence, means=frozenset(), min_gain=evidence.min_gain or 0.0)
    n = min(n, len(evidence.places))
    gains = [doubt(evidence, ()) - doubt(evidence, best_set(evidence, k)) for k in range(1, n + 1)]
    enough = max(gains) - evidence.min_gain - 1e-9
    size = next(k for k, gain in enumerate(gains, start=1) if gain >= enough)

    found = most_informative(evidence, n)

    assert found.positions == tuple(evidence.positions[c] for c in best_set(evidence, size))
    again = most_informative(evidence, n, first=False)
    if max(gains) <= max(evidence.min_gain, 1e-9):
        assert again.positions == ()
    else:
        assert again == found


@generated
@given(evidences(), st.integers(1, 8))
def test_a_means_is_not_said_while_an_end_would_tell_more_of_the_goal(evidence, n):
    evidence = replace(evidence, doubt=DOUBTS['open'], min_gain=0.02)

    found = most_informative(evidence, n)

    said = [c for c, place in enumerate(evidence.positions) if place in found.positions]
    goal = replace(evidence, doubt=Doubt())
    ends = set(range(len(evidence.places))) - evidence.means - set(said)
    if evidence.means & set(said):
        for end in ends:
            assert doubt(goal, said) - doubt(goal, [*said, end]) <= 0.02 + 1e-9


@generated
@given(evidences())
def test_never_below_a_baseline_less_the_least_gain(evidence):
    evidence = replace(evidence, means=frozenset())
    for n, best in enumerate(curve(evidence), start=1):
        for strategy in ('increasing', 'decreasing'):
            said = baseline(evidence, strategy, n)
            columns = [c for c, p in enumerate(evidence.places) if p[-1] in said.positions]

            assert len(said.positions) == n
            assert said.information_gain == pytest.approx(
                doubt(evidence, ()) - doubt(evidence, columns), abs=1e-9
            )
            least = evidence.min_gain or 0.0
            assert best.information_gain >= said.information_gain - least - 1e-9
            most = doubt(evidence, ()) - doubt(evidence, best_set(evidence, n))
            assert said.gap >= most - said.information_gain - 1e-9


@generated
@given(evidences(largest=7))
def test_a_search_is_honest_about_its_gap_and_never_below_a_baseline(evidence):
    evidence = plain(evidence)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(choice, 'least_seconds', lambda evidence, size: math.inf)
        sizes = range(1, len(evidence.places) + 1)
        for n, found in zip(sizes, best_of_each(evidence, sizes), strict=True):
            best = doubt(evidence, ()) - doubt(evidence, best_set(evidence, n))
            said = [baseline(evidence, s, n) for s in ('increasing', 'decreasing')]

            assert best <= found.information_gain + found.gap + 1e-9
            assert all(found.information_gain >= s.information_gain - 1e-9 for s in said)


@generated
@given(evidences(), st.integers(0, 6))
def test_an_enumeration_that_is_stopped_gives_the_best_so_far(evidence, looked_at):
    size, known = min(3, len(evidence.places)), range(min(3, len(evidence.places)))
    ticks = itertools.count()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(enumeration._Pace, 'goes_on', lambda *_: next(ticks) < looked_at)
        try:
            found = best_of_all(evidence, size, known, math.inf)
        except OutOfTime as stopped:
            found = stopped.best
            assert len(set(found)) == size
        else:
            assert found == best_set(evidence, size)

    assert evidence.doubt_after(found) <= evidence.doubt_after(known) + 1e-9


@generated
@given(evidences())
def test_no_set_leaves_less_doubt_than_the_bound(evidence):
    for n in range(1, len(evidence.places) + 1):
        assert least_doubt(evidence, n) <= max(0.0, doubt(evidence, best_set(evidence, n))) + 1e-9


@generated
@given(evidences(), st.floats(0.0, 3.0), st.integers(1, 8))
def test_a_threshold_takes_the_smallest_that_leaves_less_doubt(evidence, threshold, at_most):
    evidence = plain(evidence)
    sizes = range(1, min(at_most, len(evidence.places)) + 1)
    doubts = [max(0.0, doubt(evidence, best_set(evidence, k))) for k in sizes]
    enough = [k for k, d in zip(sizes, doubts, strict=True) if d < threshold - 1e-9]

    found = smallest_sufficient(evidence, threshold, at_most)

    if enough:
        assert len(found.positions) == enough[0] or doubts[len(found.positions) - 1] < threshold
        assert len(found.positions) <= enough[0]
    else:
        assert evidence.doubt_before - found.information_gain == pytest.approx(
            min(doubts), abs=1e-8
        )


@generated
@given(evidences())
def test_each_of_the_order_is_the_best_given_those_before(evidence):
    evidence = plain(evidence)
    said = []
    for added in informative_order(evidence):
        left = [c for c in range(len(evidence.places)) if c not in said]
        doubts = {c: doubt(evidence, [*said, c]) for c in left}
        best = max(c for c in left if doubts[c] <= min(doubts.values()) + 1e-9)

        assert added.position == evidence.positions[best]
        before = max(0.0, doubt(evidence, said))
        assert added.information_gain == pytest.approx(before - max(0.0, doubts[best]), abs=1e-9)
        said.append(best)


def evidence(ratio, weight, doubt=DOUBTS['planner'], **named):
    weight = np.array(weight, dtype=float)
    places = tuple((i,) for i in range(len(ratio[0])))
    return Evidence(np.array(ratio, dtype=float), weight, weight[0, 0], places, doubt, **named)


def test_the_best_pair_need_not_hold_the_best_single_sentence():
    # Each of the last two leaves two of the four others, and both together none; the first
    # leaves one and a half.
    found = evidence(
        [[1, 1, 1], [0.5, 1, 0], [0.5, 1, 0], [0.25, 0, 1], [0.25, 0, 1]],
        [[0.2, 0.2, 0.2, 0.2], *[[0.2, 0, 0, 0]] * 4],
    )

    assert most_informative(found, 1).positions == (0,)
    assert most_informative(found, 2).positions == (1, 2)
    assert most_informative(found, 2).information_gain == pytest.approx(math.log(5))


def test_the_baselines_are_first_and_last_in_plan_order_each_sentence_once_where_it_is_met():
    found = replace(evidence([[1, 1, 1]], [[1, 1, 1, 1]]), places=((1, 2), (0, 4), (3, 5)))

    assert baseline(found, 'increasing', 2).positions == (0, 1)
    assert baseline(found, 'decreasing', 2).positions == (4, 5)
    assert baseline(found, 'increasing', 9).positions == (0, 1, 3)


def test_more_than_there_is_means_all_and_none_means_none():
    found = evidence([[1, 1], [0, 1]], [[0.5] * 4, [0.5, 0, 0, 0]])

    assert most_informative(found, 5).positions == (0, 1)
    nothing = replace(found, ratio=found.ratio[:, :0], places=())
    assert most_informative(nothing, 3).positions == ()
    assert informative_order(nothing) == ()


def test_long_plans_and_many_hypotheses_are_answered_within_the_budget_with_an_honest_gap():
    random = np.random.default_rng(1)
    ratio = (random.random((5_000, 120)) < 0.5).astype(float)
    ratio[0] = 1.0
    weight = np.zeros((5_000, 4))
    weight[:, 0] = 1 / 5_000
    weight[0] = 1 / 5_000
    found = evidence(ratio, weight)

    for n in (1, 2, 8, 60, 119, 120):
        selection = most_informative(found, n, 0.2)

        assert len(selection.positions) == n
        columns = list(selection.positions)
        assert selection.information_gain == pytest.approx(
            found.doubt_before - found.doubt_after(columns)
        )
        assert selection.information_gain + selection.gap <= found.doubt_before + 1e-9
