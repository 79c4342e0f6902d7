"""The mirror model and what is chosen, against the method's definitions written a second time.

Plans and beliefs are made up: no planner takes part.
"""

import math
from dataclasses import replace
from random import Random

import numpy as np
import pytest
from little_robots import Definitions, Robot, draw_courier, draw_robot, said

from mirror_explainer.listener.listeners import OPEN, PLANNER, Listener
from mirror_explainer.listener.mirror_model import MirrorModel
from mirror_explainer.listener.weighing import plan_probabilities
from mirror_explainer.planning import Plan
from mirror_explainer.selection.choice import most_informative

CURIOUS = replace(OPEN, interest_in_facts=0.4, interest_in_way=0.2, other_ends=0.2, unforeseen=0.3)
LISTENERS = {'open': OPEN, 'planner': PLANNER, 'curious': CURIOUS}


def answer(model: MirrorModel, n: int, heard: list[int]) -> tuple[list[int], float]:
    """What is said of at most n, given what was heard, as `explain` chooses it."""
    found = most_informative(model.evidence(heard), n, first=not heard)
    return list(found.positions), found.information_gain


@pytest.mark.parametrize('who', LISTENERS)
@pytest.mark.parametrize('hundred', range(10))
def test_every_quantity_and_answer_is_that_of_the_definitions(hundred: int, who: str) -> None:
    for seed in range(100 * hundred, 100 * hundred + 100):
        robot = draw_robot(seed)
        model, written = robot.model(LISTENERS[who]), Definitions(robot, LISTENERS[who])
        random = Random(seed)
        heard = random.sample(
            range(len(robot.plan)), random.choice([0, 0, 1, 2]) % len(robot.plan)
        )
        sentences = sorted({said(robot.plan[i]) for i in heard})

        assert model.prior.sum() == pytest.approx(1.0)
        assert model.goal_posterior(heard) == pytest.approx(
            written.goal_posterior(sentences), abs=1e-12
        )
        assert model.fact_posterior(heard)['(f)'] == pytest.approx(
            written.fact_posterior(sentences)
        )
        assert model.cross_entropy(heard) == pytest.approx(written.cross_entropy(sentences))
        assert model.doubt(heard) == pytest.approx(max(0.0, written.doubt(sentences)), abs=1e-12)
        for n in range(1, 5):
            positions, gain = answer(model, n, heard)
            assert (positions, pytest.approx(gain, abs=1e-9)) == written.answer(n, sentences)


@pytest.mark.parametrize('hundred', range(10))
def test_no_means_is_said_while_an_end_is_unsaid(hundred: int) -> None:
    for seed in range(100 * hundred, 100 * hundred + 100):
        robot = draw_courier(seed)
        written, model = Definitions(robot, OPEN), robot.model(OPEN)
        ends = written.ends(written.open[0])
        telling = ends - written.ends(written.shared)

        positions, _ = answer(model, len(ends), [])

        spoken = {said(robot.plan[i]) for i in positions}
        of_any = set().union(*(written.ends(goal) for goal in written.open))
        understood = model.understanding(positions) >= 0.94
        assert spoken <= of_any or telling <= spoken or understood
        assert not spoken & of_any - ends  # no end of others
        assert 'I do detour.' not in spoken
        assert (positions, pytest.approx(model.information_gain(positions), abs=1e-9)) == (
            written.answer(len(ends))
        )


def test_a_belief_is_honest_about_what_was_not_planned_for() -> None:
    for seed in range(200):
        robot = replace(draw_robot(seed), found=('unknown',) * len(draw_robot(seed).beliefs))
        model = robot.model(OPEN)
        means = [
            position
            for position, sentence in enumerate(model.sentences)
            if sentence not in Definitions(robot, OPEN).ends(frozenset(robot.truth))
        ]

        assert model.planned == 0.0
        assert not model.complete
        # Nothing planned: no means changes what the listener takes the goal to be.
        for position in means:
            assert model.goal_posterior([position]) == pytest.approx(model.goal_posterior())


def test_the_order_of_the_goals_changes_no_answer() -> None:
    for seed in range(100):
        robot = draw_robot(seed)
        order = [0, *Random(seed).sample(range(1, len(robot.goals)), len(robot.goals) - 1)]
        place = {goal: index for index, goal in enumerate(order)}
        other = replace(
            robot,
            goals=tuple(robot.goals[goal] for goal in order),
            masses=tuple(robot.masses[goal] for goal in order),
            beliefs=tuple((place[g], holds, p) for g, holds, p in robot.beliefs),
        )
        for listener in (OPEN, PLANNER):
            for n in (1, 2, 3):
                found, again = (answer(r.model(listener), n, []) for r in (robot, other))
                assert found[0] == again[0]
                assert found[1] == pytest.approx(again[1], abs=1e-9)


def test_the_scale_of_the_probabilities_changes_nothing() -> None:
    for seed in range(50):
        robot = draw_robot(seed)
        other = replace(
            robot,
            masses=tuple(3.0 * mass for mass in robot.masses),
            beliefs=tuple((goal, holds, 3.0 * p) for goal, holds, p in robot.beliefs),
        )
        assert other.model(OPEN).prior == pytest.approx(robot.model(OPEN).prior)


def solo(listener: Listener, *parts: str, **truth: list[bool]) -> MirrorModel:
    """One candidate with these parts, nothing planned for."""
    robot = Robot(
        (frozenset(parts),), truth, ('(a u)', '(a v)', '(a w)'), 3.0, ((0, True, 1.0),),
        ('unknown',), (1.0,), 1.0, True, 1.0,
    )  # fmt: skip
    return robot.model(listener)


def test_one_candidate_of_two_parts_is_understood_by_three_quarters_at_first() -> None:
    truth = {'p': [False, False, True, True], 'q': [False, False, False, True]}

    model = solo(OPEN, 'p', 'q', **truth)

    # Half is foreseen, and of the unforeseen half one half is for p or q alone.
    assert model.understanding() == pytest.approx(0.75)
    assert model.goal_posterior() == pytest.approx([0.75, 0.25])
    assert [h.goal for h in model.hypotheses if h.of_part] == [0, 0]
    # "I do v." is an end of p and of p alone: of the two h, δ = 0.05 is left of one.
    assert model.understanding([1]) == pytest.approx(0.75 / (0.75 + 0.125 * (1 + 0.05)))
    assert [str(part.meaning) for part in model.unmentioned([1])] == ['q']


def test_a_part_that_is_true_all_the_way_is_no_aim() -> None:
    truth = {'p': [True] * 4, 'q': [False, False, True, True]}

    model = solo(OPEN, 'p', 'q', **truth)

    assert model.understanding() == pytest.approx(1.0)
    assert not any(h.of_part for h in model.hypotheses)


def test_a_part_undone_and_restored_is_an_end_where_it_is_restored() -> None:
    truth = {'p': [True, False, False, True]}

    model = solo(OPEN, 'p', **truth)

    assert model.way.aims[0][0].positions == [2]


def test_the_papers_listener_alone_knows_everything_of_a_robot_with_one_way() -> None:
    model = solo(PLANNER, 'p', p=[False, False, False, True])

    assert model.cross_entropy() == 0.0
    assert model.evidence().ratio.tolist() == [[1.0, 1.0, 1.0]]


@pytest.mark.parametrize('listener', LISTENERS.values())
def test_a_robot_with_nothing_to_do_has_nothing_to_say(listener: Listener) -> None:
    robot = Robot(
        (frozenset(['p']), frozenset(['q'])), {'p': [True], 'q': [False]}, (), 0.0,
        ((0, True, 0.5), (1, True, 0.5)), ((((), 0.0),), 'unsolvable'), (0.5, 0.5), 1.0, True, 1.0,
    )  # fmt: skip
    model = robot.model(listener)

    assert model.evidence().places == ()
    assert model.goal_posterior().sum() == pytest.approx(1.0)
    assert most_informative(model.evidence(), 3).positions == ()


def test_masses_and_cut_plans_are_told() -> None:
    robot = Robot(
        (frozenset(['p']), frozenset(['q']), frozenset(['p', 'q'])),
        {'p': [False, True], 'q': [False, False]},
        ('(a u)',),
        1.0,
        ((0, True, 0.4), (1, True, 0.3), (2, True, 0.2)),
        (((('(a u)',), 1.0),), 'unsolvable', 'unknown'),
        (0.4, 0.3, 0.3),  # a tenth is not enumerated
        1.0,
        True,
        1.0,
    )
    model = robot.model(OPEN)

    assert model.covered == pytest.approx(0.9)
    assert model.unsolvable == pytest.approx(0.3)
    assert model.planned == pytest.approx(0.7)
    assert not model.complete
    # Of the third goal all 0.3 is unforeseen; the second has nothing. Of the third one's μ-share
    # none is lent: its parts alone are the other candidates.
    assert model.goal_posterior() == pytest.approx([0.4 / 0.7, 0.0, 0.3 / 0.7, 0.0])


def test_hypotheses_that_sound_alike_share_a_row_and_are_kept_for_reports() -> None:
    plans = ((('(a u)', '(a v)'), 2.0), (('(b v)', '(b u)'), 2.0))
    robot = Robot(
        (frozenset(['p']),), {'p': [False, False, True]}, ('(a u)', '(a v)'), 2.0,
        ((0, True, 0.5), (0, False, 0.5)), (plans[:1], plans), (1.0,), 0.5, False, 1.0,
    )  # fmt: skip
    model = robot.model(PLANNER)

    assert len(model.hypotheses) == 3
    assert len(model.ratios) == 1
    assert len(model.evidence().weight) == 1


def test_a_boundless_rationality_leaves_only_the_cheapest_plans() -> None:
    assert plan_probabilities((Plan((), 1.0), Plan((), 2.0)), 1e300) == [1.0, pytest.approx(0.0)]


def test_no_rationality_makes_all_known_plans_equally_likely() -> None:
    assert plan_probabilities((Plan((), 1.0), Plan((), 9.0)), 0.0) == [0.5, 0.5]


def test_equal_costs_share_evenly_and_absurd_ones_stay_finite() -> None:
    shares = plan_probabilities((Plan((), 1.0), Plan((), 1.0), Plan((), 1e308)), 1.0)

    assert shares[:2] == [0.5, 0.5]
    assert 0 < shares[2] < 1e-200


def test_rationality_between_weighs_by_what_a_plan_costs_more() -> None:
    cheap, dear = plan_probabilities((Plan((), 1.0), Plan((), 3.0)), 0.5)

    assert dear / cheap == pytest.approx(math.exp(-1.0))


def test_weights_of_any_magnitude_give_finite_numbers() -> None:
    robot = replace(draw_robot(3), rationality=1e6, cost=400.0)

    model = robot.model(PLANNER)

    assert np.isfinite(model.cross_entropy())
    assert np.isfinite(model.doubt([0]))
