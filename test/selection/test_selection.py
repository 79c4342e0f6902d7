"""What is selected: the same as enumeration, for every N, however the evidence is written."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from mirror_explainer.listener.mirror_model import Evidence
from mirror_explainer.selection.algorithm import (
    curve,
    decreasing,
    increasing,
    informative_order,
    most_informative,
    smallest_sufficient,
)

generated = settings(
    derandomize=True,
    deadline=None,
    max_examples=40,
    suppress_health_check=[HealthCheck.too_slow],
)


@st.composite
def evidences(draw, largest=9):
    """Evidence as plans give it: repeated sentences, sentences lacking, ratios above 1."""
    positions = draw(st.integers(1, largest))
    sentences = draw(st.integers(1, positions))
    others = draw(st.integers(0, 8))
    ratios = draw(
        st.sampled_from(
            [
                st.sampled_from([0.0, 1.0]),
                st.sampled_from([0.0, 0.5, 1.0, 2.0]),
                st.floats(0.01, 3.0),
                st.one_of(st.just(0.0), st.floats(0.3, 3.0)),
            ]
        )
    )
    rows = [[1.0] * sentences]
    rows += [[draw(ratios) for _ in range(sentences)] for _ in range(others)]
    said = [draw(st.integers(0, sentences - 1)) for _ in range(positions)]
    weights = [draw(st.sampled_from([1e-12, 1e-6, 0.05, 1.0]))]
    weights += [draw(st.sampled_from([0.0, 1.0, 1.0, 0.3])) for _ in range(others)]
    return Evidence(
        prior=np.array(weights) / sum(weights),
        ratio=np.array(rows)[:, said],
        positions=np.cumsum([draw(st.integers(1, 3)) for _ in range(positions)]),
    )


def evidence(prior, ratio):
    """Evidence about all positions of a plan."""
    return Evidence(np.array(prior), np.array(ratio), np.arange(len(ratio[0])))


def enumerated(evidence, n):
    """Algorithm 1 as the paper writes it: all combinations, and the rule for ties."""
    columns = list(itertools.combinations(range(len(evidence.positions)), n))
    gains = np.array([evidence.information_gain(o) for o in columns])
    single = [evidence.information_gain([i]) for i in range(len(evidence.positions))]
    sums = np.array([sum(single[i] for i in o) for o in columns])
    tied = gains >= gains.max() - 1e-9
    tied &= sums >= sums[tied].max() - 1e-9
    first = columns[int(np.flatnonzero(tied)[0])]
    return tuple(int(evidence.positions[i]) for i in first), float(gains.max())


@generated
@given(evidences(largest=10))
def test_every_n_gives_the_positions_and_the_gain_of_enumeration(evidence):
    for n in range(len(evidence.positions) + 1):
        positions, gain = enumerated(evidence, n)

        selection = most_informative(evidence, n)

        assert selection.positions == positions
        assert selection.information_gain == pytest.approx(gain, abs=2e-9)
        assert selection.optimal


@settings(generated, max_examples=4)
@given(evidences(largest=12))
def test_plans_of_twelve_actions_agree_with_enumeration_too(evidence):
    assume(len(evidence.positions) >= 10)

    selections = curve(evidence)

    assert [s.positions for s in selections] == [
        enumerated(evidence, n)[0] for n in range(len(evidence.positions) + 1)
    ]


@generated
@given(evidences())
def test_the_curve_is_the_most_informative_selection_of_every_n(evidence):
    expected = tuple(most_informative(evidence, n) for n in range(len(evidence.positions) + 1))

    selections = curve(evidence)

    assert selections == expected


@generated
@given(evidences())
def test_nothing_beats_the_informative_selection_at_its_own_n(evidence):
    for n, informative in enumerate(curve(evidence)):
        for baseline in (increasing(evidence, n), decreasing(evidence, n)):
            missing = informative.information_gain - baseline.information_gain

            assert len(baseline.positions) == n
            assert missing >= -1e-9
            assert baseline.gap >= missing - 2e-9


@generated
@given(evidences(), st.randoms(use_true_random=False))
def test_the_order_of_the_hypotheses_does_not_matter(evidence, random):
    order = list(range(len(evidence.prior)))
    random.shuffle(order)
    shuffled = replace(evidence, prior=evidence.prior[order], ratio=evidence.ratio[order])

    assert same(curve(shuffled), curve(evidence))


@generated
@given(evidences())
def test_a_hypothesis_split_into_two_halves_changes_nothing(evidence):
    halves = replace(
        evidence,
        prior=np.concatenate([evidence.prior[:1] / 2, evidence.prior[:1] / 2, evidence.prior[1:]]),
        ratio=np.concatenate([evidence.ratio[:1], evidence.ratio]),
    )

    assert same(curve(halves), curve(evidence))


@generated
@given(evidences(), st.sampled_from([1e-3, 7.0, 1e6]))
def test_weights_scaled_by_a_constant_change_nothing(evidence, constant):
    scaled = replace(evidence, prior=evidence.prior * constant)

    assert same(curve(scaled), curve(evidence))


@generated
@given(evidences())
def test_a_hypothesis_of_weight_zero_changes_nothing(evidence):
    idle = np.linspace(0.0, 2.0, len(evidence.positions))
    wider = replace(
        evidence,
        prior=np.append(evidence.prior, 0.0),
        ratio=np.vstack([evidence.ratio, idle]),
    )

    assert same(curve(wider), curve(evidence))


def same(ours, others):
    return [s.positions for s in ours] == [s.positions for s in others] and np.allclose(
        [s.information_gain for s in ours],
        [s.information_gain for s in others],
        atol=1e-9,
    )


def test_the_best_pair_need_not_hold_the_best_single_sentence():
    # Six equally likely plans, the robot's first. Left to doubt, in sixths:
    # {0}: 3, {1}: 4, {2}: 4; {0, 1}: 2, {0, 2}: 2, {1, 2}: 1 (the robot's own).
    plans = [
        [1.0, 1.0, 1.0],
        [1.0, 1.0, 0.0],
        [1.0, 0.0, 1.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [0.0, 1.0, 0.0],
    ]
    six = evidence([1 / 6] * 6, plans)

    one, two = most_informative(six, 1), most_informative(six, 2)

    assert one.positions == (0,)
    assert one.information_gain == pytest.approx(math.log(6 / 3))
    assert two.positions == (1, 2)
    assert two.information_gain == pytest.approx(math.log(6 / 1))
    assert [step.position for step in informative_order(six)][0] == 0


def test_once_all_is_known_the_most_telling_sentence_fills_up():
    # Position 2 alone leaves the robot's plan: gain log 3. Of the others,
    # position 1 excludes one of three plans (log 3/2), position 0 none (0).
    three = evidence([1 / 3] * 3, [[1.0, 1.0, 1.0], [1.0, 1.0, 0.0], [1.0, 0.0, 0.0]])

    selection = most_informative(three, 2)

    assert selection.positions == (1, 2)
    assert selection.information_gain == pytest.approx(math.log(3))


def test_equal_sentences_are_said_at_their_first_places():
    # Both sentences exclude the other plan; the first stands at 0 and 2.
    twice = evidence([0.5, 0.5], [[1.0, 1.0, 1.0], [0.0, 0.0, 0.0]])

    assert most_informative(twice, 2).positions == (0, 1)


def test_exactly_n_are_said_even_where_more_says_less():
    # The other plan says it twice as often: log P = 1/2 + 1/2 · 2ⁿ, gain −log of it.
    doubled = evidence([0.5, 0.5], [[1.0, 1.0], [2.0, 2.0]])

    gains = [selection.information_gain for selection in curve(doubled)]

    assert gains == pytest.approx([0.0, -math.log(1.5), -math.log(2.5)])


def test_more_than_there_is_means_all_and_none_means_none():
    three = evidence([0.5, 0.5], [[1.0, 1.0, 1.0], [1.0, 0.5, 0.0]])
    finished = Evidence(np.ones(1), np.ones((1, 0)), np.arange(0))

    assert most_informative(three, 9).positions == (0, 1, 2)
    assert most_informative(three, 0).positions == ()
    assert most_informative(three, 0).information_gain == 0.0
    for none in (most_informative(finished, 3), smallest_sufficient(finished, 1.0, 3)):
        assert (none.positions, none.information_gain, none.gap) == ((), 0.0, 0.0)
    assert curve(finished) == (most_informative(finished, 0),)
    assert informative_order(finished) == ()


def test_the_baselines_are_the_first_and_the_last_in_plan_order():
    plan = Evidence(np.array([0.5, 0.5]), np.array([[1.0] * 4, [1, 1, 0.5, 0]]), np.arange(2, 6))

    first, last = increasing(plan, 2), decreasing(plan, 2)

    assert (first.positions, last.positions) == ((2, 3), (4, 5))
    assert first.information_gain == 0.0  # −log (1/2 · 1 + 1/2 · 1)
    assert last.information_gain == pytest.approx(math.log(2))  # −log (1/2 + 0)
    assert first.gap == pytest.approx(math.log(2))
    assert last.optimal


@generated
@given(evidences(), st.floats(-1.0, 30.0), st.integers(0, 10))
def test_the_smallest_sufficient_selection_is_the_first_on_the_curve(evidence, required, at_most):
    selections = curve(evidence)[: at_most + 1]
    everything = evidence.information_gain(range(len(evidence.positions)))
    enough = [
        s
        for s in selections
        if s.information_gain > required or s.information_gain >= everything - 1e-9
    ]

    selection = smallest_sufficient(evidence, required, at_most)

    assert selection == (enough or selections[-1:])[0]


def test_the_threshold_is_strict_and_ends_where_saying_more_helps_no_more():
    # Gains of the best 0, 1, 2, 3 sentences: 0, log 2, log 4, log 4.
    four = evidence([0.25] * 4, [[1.0] * 3, [1.0, 0.0, 1.0], [0.0, 1.0, 1.0], [0.0, 0.0, 1.0]])

    assert len(smallest_sufficient(four, 0.5 * math.log(2), 3).positions) == 1
    assert len(smallest_sufficient(four, math.log(2) + 1e-9, 3).positions) == 2
    assert len(smallest_sufficient(four, 99.0, 3).positions) == 2
    assert len(smallest_sufficient(four, 99.0, 1).positions) == 1


def test_a_size_that_may_suffice_but_had_no_time_to_be_searched_is_told_by_the_gap():
    # Of (c a c b c c), beside (x b c) and (c d c a a x): a with b excludes both, as soon as the
    # greedy c's, which are twice as likely here, are taken back.
    ratio = [[1.0] * 6, [0.5, 0.0, 0.5, 2.0, 0.5, 0.5], [0.5, 2.0, 0.5, 0.0, 0.5, 0.5]]
    doubtful = evidence([5e-7 / 2.0000005, 1 / 2.0000005, 1 / 2.0000005], ratio)
    required = math.log(2.0000005 / 5e-7) - 0.1  # H − θ

    searched = smallest_sufficient(doubtful, required, 6)
    guessed = smallest_sufficient(doubtful, required, 6, budget=0.0)

    assert (searched.positions, searched.optimal) == ((1, 3), True)
    assert len(guessed.positions) > 2
    assert not guessed.optimal


@generated
@given(evidences())
def test_each_step_of_the_order_is_the_best_given_those_before(evidence):
    steps = informative_order(evidence)

    column = {int(position): i for i, position in enumerate(evidence.positions)}
    said = []
    for step in steps:
        before = evidence.information_gain(said)
        rest = [i for i in range(len(column)) if i not in said]
        gains = {i: evidence.information_gain([*said, i]) - before for i in rest}
        tied = [i for i in rest if gains[i] >= max(gains.values()) - 1e-9]
        single = {i: evidence.information_gain([i]) for i in tied}
        tied = [i for i in tied if single[i] >= max(single.values()) - 1e-9]
        assert column[step.position] == tied[0]
        assert step.information_gain == pytest.approx(gains[tied[0]], abs=1e-9)
        said.append(column[step.position])
    assert sorted(said) == list(range(len(column)))


def unstructured(seed, hypotheses, positions, plan_share=0.7):
    """Evidence without any structure: what is hardest to search."""
    random = np.random.default_rng(seed)
    has = random.random((hypotheses, positions)) < plan_share
    ratio = np.where(has, random.uniform(0.3, 2.0, has.shape), 0.0)
    ratio[0] = 1.0
    return Evidence(random.dirichlet(np.ones(hypotheses)), ratio, np.arange(positions))


@pytest.mark.parametrize('budget', [0.0, 1e-4, 1e-2])
@pytest.mark.parametrize('seed', range(8))
def test_out_of_time_the_gap_still_bounds_what_is_missing(seed, budget):
    hard = unstructured(seed, hypotheses=60, positions=16)

    for n in (3, 5, 8):
        selection = most_informative(hard, n, budget)

        best = most_informative(hard, n)
        missing = best.information_gain - selection.information_gain
        assert len(set(selection.positions)) == n
        assert selection.information_gain == pytest.approx(
            hard.information_gain(selection.positions)
        )
        assert 0 <= selection.gap < math.inf
        assert missing <= selection.gap + 2e-9
        assert not selection.optimal or missing <= 2e-9


@pytest.mark.parametrize('seed', range(4))
def test_without_structure_the_value_is_that_of_enumeration(seed):
    hard = unstructured(seed, hypotheses=200, positions=24)

    for n in (2, 4):
        assert most_informative(hard, n).positions == enumerated_fast(hard, n)


def enumerated_fast(evidence, n):
    """Positions of the best combination where there are no ties."""
    combinations = np.array(list(itertools.combinations(range(len(evidence.positions)), n)))
    doubt = evidence.prior @ evidence.ratio[:, combinations].prod(axis=2)
    return tuple(int(i) for i in combinations[doubt.argmin()])


def test_long_plans_and_tiny_weights_stay_finite():
    # 300 positions; ratios of 30 or 1/30 would make 30^±300 if multiplied up.
    random = np.random.default_rng(3)
    ratio = random.choice([0.0, 1 / 30, 1.0, 30.0], size=(40, 60))
    ratio[0], ratio[1] = 1.0, 30.0
    prior = np.r_[1e-12, np.ones(39)]
    long = Evidence(prior / prior.sum(), np.tile(ratio, 5), np.arange(300))

    for n in (1, 10, 299, 300):
        selection = most_informative(long, n, budget=0.2)

        assert len(selection.positions) == n
        assert math.isfinite(selection.information_gain)
        assert math.isfinite(selection.gap)
    assert all(math.isfinite(step.information_gain) for step in informative_order(long))
