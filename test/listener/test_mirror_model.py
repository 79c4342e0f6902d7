"""The mirror model against the formulas of the method, written out a second time in plain Python.

Plans and beliefs are made up by hand or by hypothesis: no planner takes part.
"""

import itertools
import math
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from mirror_explainer.errors import PlanningError
from mirror_explainer.listener.mirror_model import MirrorModel, mirror_model, plan_probabilities
from mirror_explainer.listener.prior import Prior
from mirror_explainer.listener.sentences import Sentences
from mirror_explainer.listener.user_model import CandidateGoal
from mirror_explainer.listener.wording import Template, Wording
from mirror_explainer.planning import Belief, BeliefPlans, BeliefSpace, Plan, Status

# (go x) and (go y) are one sentence, and so are (take x) and (put x).
SENTENCES = Sentences(
    {'go': ('p',), 'take': ('o',), 'put': ('o',), 'wait': ()},
    {
        'go': Template(Wording('I go.')),
        'take': Template(Wording('I hold {o}.')),
        'put': Template(Wording('I hold {o}.')),
    },
)
SENTENCE = {
    '(go x)': 'I go.',
    '(go y)': 'I go.',
    '(take x)': 'I hold x.',
    '(put x)': 'I hold x.',
    '(take y)': 'I hold y.',
    '(wait)': 'I will wait.',
}


@dataclass(frozen=True)
class Case:
    """All that a mirror model is made from. `beliefs` and `results` go together."""

    beliefs: tuple[tuple[Belief, float], ...]
    results: tuple[BeliefPlans, ...]
    robot_belief: int
    robot_plan: Plan
    rationality: float = 1.0

    def model(self, sentences: Sentences = SENTENCES) -> MirrorModel:
        facts = sorted(frozenset().union(*(belief.true_facts for belief, _ in self.beliefs)))
        count = 1 + max(belief.goal for belief, _ in self.beliefs)
        goals = tuple(CandidateGoal(f'goal {i}', f'(g{i})', 1 / count) for i in range(count))
        prior = Prior(
            BeliefSpace('', '', tuple(goal.goal for goal in goals), tuple(facts)),
            goals,
            tuple(belief for belief, _ in self.beliefs),
            tuple(probability for _, probability in self.beliefs),
            self.robot_belief,
            ('a warning of the prior',),
        )
        return mirror_model(prior, self.results, self.robot_plan, sentences, self.rationality)


def solved(*plans: tuple[str, float]) -> BeliefPlans:
    """Return plans given as ("go x, take y", cost)."""
    return BeliefPlans(Status.SOLVED, tuple(plan(actions, cost) for actions, cost in plans))


def plan(actions: str, cost: float) -> Plan:
    return Plan(tuple(f'({action})' for action in actions.split(', ') if action), cost)


UNSOLVABLE = BeliefPlans(Status.UNSOLVABLE)
UNKNOWN = BeliefPlans(Status.UNKNOWN, reason='the time was up')


class Written:
    """P_R^H and the quantities of the method, from nothing but their definitions."""

    def __init__(self, case: Case) -> None:
        self.weighed: list[tuple[Belief, Plan, float]] = []
        for index, ((belief, probability), result) in enumerate(
            zip(case.beliefs, case.results, strict=True)
        ):
            plans = [*result.plans]
            if index == case.robot_belief:
                plans = self._with_own(plans, case.robot_plan)
                self.robot = len(self.weighed)
            if not plans:
                continue
            best = min(plan.cost for plan in plans)
            shares = [math.exp(-case.rationality * (plan.cost - best)) for plan in plans]
            self.weighed += [
                (belief, plan, probability * share / sum(shares))
                for plan, share in zip(plans, shares, strict=True)
            ]
        total = sum(weight for _, _, weight in self.weighed)
        self.weighed = [(belief, plan, weight / total) for belief, plan, weight in self.weighed]
        self.said = [SENTENCE[action] for action in case.robot_plan.actions]

    @staticmethod
    def _with_own(plans: list[Plan], own: Plan) -> list[Plan]:
        """π_R stands for a plan of the same actions, or the only one if as costly, else beside."""
        same = [plan for plan in plans if sorted(plan.actions) == sorted(own.actions)]
        only = [plan for plan in plans if [plan] == plans and plan.cost == own.cost]
        for replaced in [*same, *only][:1]:
            plans.remove(replaced)
        return [own, *plans]

    def likelihood(self, observed: Iterable[int], plan: Plan) -> float:
        """P(o|π) = ∏ count(s_i in π) / |π|."""
        heard = [SENTENCE[action] for action in plan.actions]
        return math.prod(
            heard.count(self.said[i]) / len(heard) if heard else 0.0 for i in observed
        )

    def posterior(self, observed: Sequence[int]) -> list[float]:
        joint = [w * self.likelihood(observed, plan) for _, plan, w in self.weighed]
        return [p / sum(joint) for p in joint]

    def cross_entropy(self, observed: Sequence[int]) -> float:
        return -math.log(self.posterior(observed)[self.robot])

    def expected_likelihood(self, observed: Sequence[int]) -> float:
        return sum(w * self.likelihood(observed, plan) for _, plan, w in self.weighed)

    def goal_posterior(self, observed: Sequence[int]) -> dict[int, float]:
        found: dict[int, float] = {}
        for (belief, _, _), p in zip(self.weighed, self.posterior(observed), strict=True):
            found[belief.goal] = found.get(belief.goal, 0.0) + p
        return found


ACTIONS = st.lists(st.sampled_from([*SENTENCE]), max_size=5).map(tuple)
STATUSES = st.sampled_from([Status.SOLVED] * 5 + [Status.UNSOLVABLE, Status.UNKNOWN])


@st.composite
def cases(draw: st.DrawFn) -> Case:
    beliefs = draw(
        st.lists(
            st.builds(
                Belief, st.integers(0, 2), st.sets(st.sampled_from(['(f)', '(g)'])).map(frozenset)
            ),
            min_size=1,
            max_size=6,
            unique=True,
        )
    )
    weights = [draw(st.integers(1, 9)) for _ in beliefs]
    probabilities = [weight / sum(weights) for weight in weights]
    results = []
    for _ in beliefs:
        status = draw(STATUSES)
        costs = sorted(draw(st.sets(st.integers(0, 6), min_size=1, max_size=3)))
        plans = tuple(Plan(draw(ACTIONS), float(cost)) for cost in costs)
        results.append(BeliefPlans(status, plans if status is Status.SOLVED else ()))
    robot = draw(st.integers(0, len(beliefs) - 1))
    others = {result.status for i, result in enumerate(results) if i != robot}
    assume(Status.UNKNOWN not in others or Status.SOLVED in others)
    own = [plan.actions for plan in results[robot].plans]
    actions = draw(st.sampled_from([tuple(reversed(a)) for a in own]) if own else ACTIONS)
    return Case(
        tuple(zip(beliefs, probabilities, strict=True)),
        tuple(results),
        robot,
        Plan(draw(st.just(actions) | ACTIONS), float(draw(st.integers(0, 7)))),
        draw(st.sampled_from([0.0, 0.3, 1.0, 5.0])),
    )


def subsets(positions: Iterable[int]) -> list[tuple[int, ...]]:
    positions = [*positions]
    return [
        chosen
        for n in range(len(positions) + 1)
        for chosen in itertools.combinations(positions, n)
    ]


@settings(max_examples=150, deadline=None, derandomize=True)
@given(cases())
def test_every_quantity_is_that_of_the_method_whatever_is_said(case: Case) -> None:
    written = Written(case)

    model = case.model()

    assert model.sentences == tuple(written.said)
    assert model.plan.actions == case.robot_plan.actions
    for observed in subsets(range(len(written.said))):
        posterior = np.exp(model.log_posterior(observed))
        by_goal = written.goal_posterior(observed)
        # Both sides of Eq. 3: H − H(o), and log P(o|π_R) − log E[P(o|π)].
        difference = written.cross_entropy(()) - written.cross_entropy(observed)
        ratio = math.log(written.likelihood(observed, case.robot_plan)) - math.log(
            written.expected_likelihood(observed)
        )

        assert posterior[model.robot] == pytest.approx(written.posterior(observed)[written.robot])
        assert sorted(posterior) == pytest.approx(sorted(written.posterior(observed)))
        assert model.cross_entropy(observed) == pytest.approx(written.cross_entropy(observed))
        assert model.information_gain(observed) == pytest.approx(difference, abs=1e-9)
        assert model.information_gain(observed) == pytest.approx(ratio, abs=1e-9)
        assert model.goal_posterior(observed) == pytest.approx(
            [by_goal.get(goal, 0.0) for goal in range(len(model.goals))]
        )
        assert model.understanding(observed) == pytest.approx(
            by_goal[case.beliefs[case.robot_belief][0].goal]
        )


@settings(max_examples=150, deadline=None, derandomize=True)
@given(cases(), st.data())
def test_the_evidence_given_what_was_said_tells_the_same_gains(
    case: Case, data: st.DataObject
) -> None:
    written = Written(case)
    count = len(written.said)
    said = data.draw(st.lists(st.integers(0, count - 1), max_size=2)) if count else []

    evidence = case.model().evidence(said)

    heard = {written.said[i] for i in said}
    left = [i for i in range(count) if written.said[i] not in heard]
    assert [*evidence.positions] == left
    assert evidence.prior.sum() == pytest.approx(1.0)
    assert len({tuple(row) for row in evidence.ratio}) == len(evidence.ratio)  # merged
    assert any((row == 1.0).all() for row in evidence.ratio)  # the robot's own
    for columns in subsets(range(len(left))):
        observed = [*said, *(left[column] for column in columns)]
        gain = written.cross_entropy(said) - written.cross_entropy(observed)

        assert evidence.information_gain(columns) == pytest.approx(gain, abs=1e-9)
        assert case.model().information_gain([left[c] for c in columns], said) == pytest.approx(
            gain, abs=1e-9
        )


@settings(max_examples=150, deadline=None, derandomize=True)
@given(cases())
def test_the_masses_are_those_of_the_beliefs_left_out(case: Case) -> None:
    model = case.model()

    mass = {status: 0.0 for status in Status}
    for index, ((_, probability), result) in enumerate(
        zip(case.beliefs, case.results, strict=True)
    ):
        mass[Status.SOLVED if index == case.robot_belief else result.status] += probability
    assert model.unsolvable_mass == pytest.approx(mass[Status.UNSOLVABLE])
    assert model.unknown_mass == pytest.approx(mass[Status.UNKNOWN])
    assert model.complete == (mass[Status.UNKNOWN] == 0.0)
    assert sum(hypothesis.probability for hypothesis in model.hypotheses) == pytest.approx(1.0)
    robot = model.hypotheses[model.robot]
    assert robot.plan.actions == case.robot_plan.actions
    assert robot.goal == case.beliefs[case.robot_belief][0].goal


def gains(model: MirrorModel) -> list[float]:
    return [model.information_gain(observed) for observed in subsets(range(len(model.sentences)))]


@settings(max_examples=50, deadline=None, derandomize=True)
@given(cases(), st.permutations(range(3)))
def test_permuting_the_candidate_goals_changes_no_gain(case: Case, order: list[int]) -> None:
    permuted = replace(
        case,
        beliefs=tuple((replace(belief, goal=order[belief.goal]), p) for belief, p in case.beliefs)[
            ::-1
        ],
        results=case.results[::-1],
        robot_belief=len(case.beliefs) - 1 - case.robot_belief,
    )

    assert gains(permuted.model()) == pytest.approx(gains(case.model()), abs=1e-9)


@settings(max_examples=50, deadline=None, derandomize=True)
@given(cases())
def test_renaming_objects_changes_no_gain(case: Case) -> None:
    def renamed(plan: Plan) -> Plan:
        names = str.maketrans({'x': 'y', 'y': 'x'})
        return replace(plan, actions=tuple(action.translate(names) for action in plan.actions))

    renamed_case = replace(
        case,
        results=tuple(
            replace(result, plans=tuple(map(renamed, result.plans))) for result in case.results
        ),
        robot_plan=renamed(case.robot_plan),
    )
    # By default sentences: in SENTENCES, (put y) would be a new one.
    plain = Sentences({})

    assert gains(renamed_case.model(plain)) == pytest.approx(gains(case.model(plain)), abs=1e-9)


@settings(max_examples=50, deadline=None, derandomize=True)
@given(cases(), st.integers(0, 2))
def test_splitting_a_goal_into_equal_halves_changes_no_gain(case: Case, goal: int) -> None:
    # The same plans in both halves: those of b_R with π_R among them.
    own = case.results[case.robot_belief].plans
    same = {robot_like for robot_like in own if robot_like.cost == case.robot_plan.cost}
    assume(not same)
    assume(Counter(case.robot_plan.actions) not in [Counter(p.actions) for p in own])
    results = list(case.results)
    results[case.robot_belief] = BeliefPlans(Status.SOLVED, (*own, case.robot_plan))
    whole = replace(case, results=tuple(results))

    halves = [
        (new, p / 2 if belief.goal == goal else p, result)
        for (belief, p), result in zip(whole.beliefs, whole.results, strict=True)
        for new in ([belief, replace(belief, goal=3)] if belief.goal == goal else [belief])
    ]
    robot = [belief for belief, _, _ in halves].index(whole.beliefs[case.robot_belief][0])
    split = replace(
        whole,
        beliefs=tuple((belief, p) for belief, p, _ in halves),
        results=tuple(result for _, _, result in halves),
        robot_belief=robot,
    )

    assert gains(split.model()) == pytest.approx(gains(whole.model()), abs=1e-9)


@settings(max_examples=50, deadline=None, derandomize=True)
@given(cases(), ACTIONS)
def test_a_belief_of_probability_zero_changes_nothing(case: Case, actions: tuple) -> None:
    never = BeliefPlans(Status.SOLVED, (Plan(actions, 1.0),))
    more = replace(
        case,
        beliefs=(*case.beliefs, (Belief(0, frozenset({'(never)'})), 0.0)),
        results=(*case.results, never),
    )

    plain, model = case.model(), more.model()

    assert gains(model) == pytest.approx(gains(plain), abs=1e-12)
    assert model.cross_entropy() == pytest.approx(plain.cross_entropy(), abs=1e-12)
    assert model.goal_posterior() == pytest.approx(plain.goal_posterior(), abs=1e-12)
    evidence = model.evidence()
    for observed in subsets(range(len(model.sentences))):
        assert evidence.information_gain(observed) == pytest.approx(
            plain.information_gain(observed), abs=1e-9
        )


@settings(max_examples=50, deadline=None, derandomize=True)
@given(cases(), st.floats(0.01, 100))
def test_the_scale_of_the_probabilities_changes_nothing(case: Case, scale: float) -> None:
    scaled = replace(case, beliefs=tuple((belief, scale * p) for belief, p in case.beliefs))

    assert gains(scaled.model()) == pytest.approx(gains(case.model()), abs=1e-9)


# Goal 0 is the robot's, P = 1/4; goal 1 has P = 3/4.
BY_HAND = Case(
    beliefs=((Belief(1), 0.75), (Belief(0), 0.25)),
    results=(
        solved(('go x, take y', 2), ('go x, go y, go x, wait', 4)),
        solved(('go y, wait', 2)),
    ),
    robot_belief=1,
    robot_plan=plan('go y, wait', 2),
    rationality=0.5,
)


def test_a_small_model_by_hand() -> None:
    model = BY_HAND.model()

    # R = exp(−0.5 · (4 − 2)) = e⁻¹ for the longer plan of goal 1
    weights = [0.75 / (1 + math.exp(-1)), 0.75 * math.exp(-1) / (1 + math.exp(-1)), 0.25]
    assert model.prior == pytest.approx(weights)
    assert model.robot == 2
    assert model.sentences == ('I go.', 'I will wait.')
    assert model.likelihood == pytest.approx(
        np.array([[1 / 2, 0], [3 / 4, 1 / 4], [1 / 2, 1 / 2]])
    )
    assert model.cross_entropy() == pytest.approx(math.log(4))  # −log 0.25
    # "I go." : P(o) = w₀/2 + w₁·3/4 + w₂/2; "I will wait." : P(o) = w₁/4 + w₂/2
    go = weights[0] / 2 + weights[1] * 3 / 4 + weights[2] / 2
    wait = weights[1] / 4 + weights[2] / 2
    assert model.information_gain([0]) == pytest.approx(math.log(1 / 2) - math.log(go))
    assert model.information_gain([1]) == pytest.approx(math.log(1 / 2) - math.log(wait))
    assert model.understanding([1]) == pytest.approx(weights[2] / 2 / wait)
    # both: P(o) = w₁·3/16 + w₂/4
    both = weights[1] * 3 / 16 + weights[2] / 4
    assert model.goal_posterior([0, 1]) == pytest.approx(
        [weights[2] / 4 / both, weights[1] * 3 / 16 / both]
    )


def test_a_boundless_rationality_leaves_only_the_cheapest_plans() -> None:
    model = replace(BY_HAND, rationality=1e9).model()

    assert model.prior == pytest.approx([0.75, 0.0, 0.25], abs=1e-12)
    assert math.isfinite(model.cross_entropy([0, 1]))
    assert model.cross_entropy([1]) == pytest.approx(0.0, abs=1e-9)  # no cheapest plan waits


def test_no_rationality_makes_all_known_plans_equally_likely() -> None:
    model = replace(BY_HAND, rationality=0.0).model()

    assert model.prior == pytest.approx([0.375, 0.375, 0.25])  # 0.75 / 2 twice


def test_equal_costs_share_evenly_and_absurd_ones_stay_finite() -> None:
    assert plan_probabilities((), 1.0) == []
    assert plan_probabilities([plan('wait', 3), plan('go x', 3)], 1.0) == [0.5, 0.5]
    cheap, dear = plan_probabilities([plan('wait', 1), plan('wait', 1e12)], 1.0)
    assert (cheap, 0.0 < dear < 1e-200) == (1.0, True)


def test_rationality_between_weighs_by_what_a_plan_costs_more() -> None:
    better, worse = plan_probabilities([plan('wait', 3.0), plan('go x', 4.5)], 2.0)

    assert worse / better == pytest.approx(math.exp(-2.0 * 1.5))


def test_of_a_costly_robot_plan_the_cross_entropy_is_still_finite() -> None:
    model = replace(BY_HAND, robot_plan=plan('wait', 1e9), rationality=10.0).model()

    assert 200 < model.cross_entropy() < 1000
    assert math.isfinite(model.information_gain([0]))


@pytest.mark.parametrize(
    ('own', 'expected'),
    [
        ([('go y, wait', 2.0)], ['go y, wait']),
        ([('wait, go y', 2.0)], ['go y, wait']),
        ([('wait, go y', 2.0), ('take x, wait', 2.0)], ['go y, wait', 'take x, wait']),
        ([('take x, wait', 2.0)], ['go y, wait']),
        ([('take x', 1.0)], ['go y, wait', 'take x']),
        ([('take x', 2.0), ('put x, put x', 2.0)], ['go y, wait', 'take x', 'put x, put x']),
        ([], ['go y, wait']),
    ],
    ids=['itself', 'reordered', 'reordered of two', 'as good', 'better', 'as good as two', 'none'],
)
def test_the_robots_plan_stands_for_one_like_it_or_an_only_one_as_good_else_beside_the_others(
    own: list, expected: list[str]
) -> None:
    result = solved(*own) if own else UNKNOWN

    model = replace(BY_HAND, results=(BY_HAND.results[0], result)).model()

    plans = [h.plan.actions for h in model.hypotheses if h.goal == 0]
    assert plans == [plan(actions, 0).actions for actions in expected]
    assert model.plan.actions == BY_HAND.robot_plan.actions
    assert model.unknown_mass == 0.0


def test_beliefs_without_a_plan_are_left_out_and_the_rest_renormalised() -> None:
    case = Case(
        beliefs=tuple(
            (Belief(goal, facts), p)
            for goal, facts, p in [
                (0, frozenset({'(f)'}), 0.4),
                (1, frozenset(), 0.3),
                (2, frozenset(), 0.2),
                (0, frozenset(), 0.1),
            ]
        ),
        results=(solved(('wait', 1)), UNSOLVABLE, UNKNOWN, solved(('go x', 1))),
        robot_belief=0,
        robot_plan=plan('wait', 1),
    )

    model = case.model()

    assert model.prior == pytest.approx([0.8, 0.2])  # 0.4 / 0.5 and 0.1 / 0.5
    assert [h.true_facts for h in model.hypotheses] == [('(f)',), ()]
    assert (model.unsolvable_mass, model.unknown_mass) == pytest.approx((0.3, 0.2))
    assert model.covered_mass == 1.0
    assert not model.complete
    assert model.warnings == (
        'a warning of the prior',
        'candidate goals that cannot be reached are left out: "goal 1"',
        '1 of 4 beliefs are left out, since planning for them gave no result (the time was up)',
    )


def test_beliefs_that_were_not_enumerated_make_the_model_incomplete() -> None:
    cut = replace(BY_HAND, beliefs=((Belief(1), 0.5), (Belief(0), 0.25)))

    model = cut.model()

    assert model.covered_mass == 0.75
    assert not model.complete
    assert BY_HAND.model().complete


def test_a_goal_that_can_be_reached_in_some_beliefs_only_is_not_warned_of() -> None:
    beliefs = (*BY_HAND.beliefs, (Belief(1, frozenset({'(f)'})), 0.0))
    case = replace(BY_HAND, beliefs=beliefs, results=(*BY_HAND.results, UNSOLVABLE))

    assert case.model().warnings == ('a warning of the prior',)


def test_when_nothing_is_known_beside_the_robots_belief_that_is_an_error() -> None:
    case = replace(BY_HAND, results=(UNKNOWN, solved(('go y, wait', 2))))

    with pytest.raises(PlanningError, match=r'no plan was found for any other .*the time was up'):
        case.model()


def test_when_nothing_else_can_be_reached_the_user_knows_everything() -> None:
    case = replace(BY_HAND, results=(UNSOLVABLE, solved(('go y, wait', 2))))

    model = case.model()

    assert model.cross_entropy() == 0.0
    assert model.understanding() == 1.0
    assert gains(model) == [0.0, 0.0, 0.0, 0.0]


def test_an_empty_plan_says_nothing_and_is_ruled_out_by_any_sentence() -> None:
    case = replace(BY_HAND, results=(solved(('', 0)), BY_HAND.results[1]))

    model = case.model()

    assert model.understanding() == pytest.approx(0.25)
    assert model.understanding([0]) == 1.0
    assert model.information_gain([0]) == pytest.approx(math.log(4))


def test_a_robot_with_nothing_to_do_has_nothing_to_say() -> None:
    case = replace(BY_HAND, robot_plan=plan('', 0), results=(BY_HAND.results[0], solved(('', 0))))

    model = case.model()

    assert model.sentences == ()
    assert model.cross_entropy() == pytest.approx(math.log(4))
    assert model.evidence().positions.size == 0
    assert model.evidence().information_gain([]) == pytest.approx(0.0)


def test_a_sentence_said_once_is_not_said_again_wherever_it_stands() -> None:
    case = replace(BY_HAND, robot_plan=plan('go x, wait, go y, take x, go x', 5))

    model = case.model()

    assert [*model.evidence([0]).positions] == [1, 3]
    assert [*model.evidence([4, 3]).positions] == [1]
    assert [*model.evidence([0, 1, 3]).positions] == []


def test_hypotheses_that_sound_alike_are_merged_as_evidence_and_kept_for_reports() -> None:
    beliefs = tuple((Belief(i), 0.25) for i in range(4))
    results = (
        solved(('go x, wait', 2)),
        solved(('wait, go y', 2)),  # the same sentences, in another order
        solved(('go x, wait, go x, wait', 4)),  # the same shares of the sentences
        solved(('take x, wait', 2)),
    )

    model = Case(beliefs, results, 0, plan('go x, wait', 2)).model()

    assert len(model.hypotheses) == 4
    assert sorted(model.evidence().prior) == pytest.approx([0.25, 0.75])


def test_a_plan_that_stands_in_counts_and_leaves_the_model_incomplete() -> None:
    stand_in = BeliefPlans(
        Status.SOLVED, (replace(plan('go x', 3), optimal=False),), 'a plan that stands in: slow'
    )
    case = Case(
        beliefs=((Belief(0), 0.5), (Belief(1), 0.5)),
        results=(solved(('wait', 1)), stand_in),
        robot_belief=0,
        robot_plan=plan('wait', 1),
    )

    model = case.model()

    assert model.stand_in_plans == 1
    assert [h.plan.optimal for h in model.hypotheses] == [True, False]
    assert model.unknown_mass == 0.0
    assert not model.complete
    assert model.warnings[-1] == '1 of 2 beliefs have a plan that stands in: slow'


def test_plans_of_an_engine_that_proves_none_optimal_do_not_stand_in() -> None:
    satisficing = BeliefPlans(Status.SOLVED, (replace(plan('go x', 3), optimal=False),))
    case = Case(
        beliefs=((Belief(0), 0.5), (Belief(1), 0.5)),
        results=(solved(('wait', 1)), satisficing),
        robot_belief=0,
        robot_plan=plan('wait', 1),
    )

    model = case.model()

    assert model.stand_in_plans == 0
    assert model.complete
