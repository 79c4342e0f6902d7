"""The mirror model (Section 3 of the paper): P_R^H, the user's model of the robot, beside P_R.

P_R is deterministic: belief b_R and plan π_R. P_R^H(O, Π, B) = P(O|Π) P(Π|B) P(B)
is a set of hypotheses (b, π) with what the user would hear from each.
"""

import math
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from mirror_explainer.errors import PlanningError
from mirror_explainer.listener.prior import Prior
from mirror_explainer.listener.sentences import Sentences
from mirror_explainer.listener.user_model import CandidateGoal
from mirror_explainer.planning import BeliefPlans, Plan, Status
from mirror_explainer.selection.columns import Columns

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Hypothesis:
    """A belief that the user may hold, and a plan that the robot would then have.

    `goal` is an index into the model's goals; `probability` is P(b) P(π|b),
    renormalised over what is known, so that all hypotheses sum to 1.
    """

    goal: int
    true_facts: tuple[str, ...]
    plan: Plan
    probability: float


@dataclass(frozen=True)
class Evidence:
    """What saying each position of the robot's plan would tell: the input of Algorithm 1.

    `prior`, shape (K,): weights w_k of the K distinct hypotheses, given what
    was said before; they sum to 1. `ratio`, shape (K, P): the likelihood
    ratios r_k(s_i) = P(s_i|π_k) / P(s_i|π_R) of the P positions that may be
    said. `positions`, shape (P,): their places in the plan, ascending, from 0.
    The robot's own hypothesis has ratio 1 everywhere.
    """

    prior: Array
    ratio: Array
    positions: NDArray[np.int64]

    @cached_property
    def columns(self) -> Columns:
        """The positions as a search sees them."""
        return Columns.of(self.prior, self.ratio)

    def information_gain(self, columns: Sequence[int]) -> float:
        """IG(o) = −log Σ_k w_k ∏_{i∈o} r_k(s_i), in nats (Eq. 3), o given as column indices."""
        return float(-np.log(self.prior @ self.ratio[:, list(columns)].prod(axis=1)))


@dataclass(frozen=True)
class MirrorModel:
    """P_R^H as hypotheses (b_k, π_k), k = 0 … K−1, of which `robot` is (b_R, π_R).

    `goals` are the candidates with P(G). `sentences` are those of π_R, one a
    plan position. `occurrences`, shape (K, P), counts how often π_k has the
    sentence of position i; `length`, shape (K,), is |π_k|. The masses are
    shares of P(B): enumerated, proved to have no plan, and not known.
    `stand_in_plans` counts the beliefs whose optimal plan could not be found in
    time, and which have another one instead. `warnings` say where the robot lies
    outside the user's model, and what was left out.
    """

    goals: tuple[CandidateGoal, ...]
    hypotheses: tuple[Hypothesis, ...]
    robot: int
    sentences: tuple[str, ...]
    occurrences: NDArray[np.int64]
    length: NDArray[np.int64]
    covered_mass: float = 1.0
    unsolvable_mass: float = 0.0
    unknown_mass: float = 0.0
    stand_in_plans: int = 0
    warnings: tuple[str, ...] = ()

    @property
    def plan(self) -> Plan:
        """π_R."""
        return self.hypotheses[self.robot].plan

    @property
    def robot_goal(self) -> CandidateGoal:
        """G_R."""
        return self.goals[self.hypotheses[self.robot].goal]

    @property
    def complete(self) -> bool:
        """Whether every belief of the user model was enumerated, and planned for as asked."""
        known = self.unknown_mass == 0.0 and self.stand_in_plans == 0
        return known and self.covered_mass > 1.0 - 1e-9

    @cached_property
    def prior(self) -> Array:
        """P(π_k, b_k), shape (K,)."""
        return np.array([hypothesis.probability for hypothesis in self.hypotheses])

    @cached_property
    def likelihood(self) -> Array:
        """P(s_i|π_k) = count(s_i in π_k) / |π_k|, shape (K, P); an empty plan says nothing."""
        return self.occurrences / np.maximum(self.length, 1)[:, None]

    def log_likelihood(self, positions: Sequence[int]) -> Array:
        """log P(o|π_k) = Σ_i log P(s_i|π_k), shape (K,), for o = the sentences said."""
        with np.errstate(divide='ignore'):  # log 0 = −∞: π_k does not say this sentence
            log_likelihood: Array = np.log(self.likelihood[:, list(positions)]).sum(axis=1)
        return log_likelihood

    def log_posterior(self, positions: Sequence[int] = ()) -> Array:
        """log P(π_k, b_k | o), where P ∝ P(b_k) P(π_k|b_k) P(o|π_k), shape (K,)."""
        with np.errstate(divide='ignore'):
            log_joint = np.log(self.prior) + self.log_likelihood(positions)
        log_posterior: Array = log_joint - np.logaddexp.reduce(log_joint)
        return log_posterior

    def cross_entropy(self, positions: Sequence[int] = ()) -> float:
        """H(P_R, P_R^H | o) = −log P(π_R, b_R | o) in nats (Eq. 1); 0 is full understanding."""
        return max(0.0, -float(self.log_posterior(positions)[self.robot]))

    def information_gain(self, positions: Sequence[int], said: Sequence[int] = ()) -> float:
        """IG(o) = H(P_R, P_R^H | said) − H(P_R, P_R^H | said, o) in nats (Eq. 2)."""
        return self.cross_entropy(said) - self.cross_entropy([*said, *positions])

    def goal_posterior(self, positions: Sequence[int] = ()) -> Array:
        """P(G = g | o), shape (number of goals,)."""
        goal = [hypothesis.goal for hypothesis in self.hypotheses]
        weights = np.exp(self.log_posterior(positions))
        return np.bincount(goal, weights, len(self.goals)).astype(np.float64)

    def understanding(self, positions: Sequence[int] = ()) -> float:
        """P(G = G_R | o): how sure the user is of the robot's true goal, in [0, 1]."""
        robot_goal = self.hypotheses[self.robot].goal
        return min(1.0, float(self.goal_posterior(positions)[robot_goal]))

    def evidence(self, said: Sequence[int] = ()) -> Evidence:
        """Return what is left to say, given the positions whose sentences were said.

        A sentence that was said is not said again, wherever it stands.
        Hypotheses that no sentence left can tell apart are merged.
        """
        heard = {self.sentences[position] for position in said}
        left = [i for i, sentence in enumerate(self.sentences) if sentence not in heard]
        ratio = self.likelihood[:, left] / self.likelihood[self.robot, left]
        distinct, merged_into = np.unique(ratio, axis=0, return_inverse=True)
        weights = np.bincount(merged_into.reshape(-1), weights=np.exp(self.log_posterior(said)))
        return Evidence(weights.astype(np.float64), distinct, np.array(left, dtype=np.int64))


def mirror_model(
    prior: Prior,
    results: Sequence[BeliefPlans],
    robot_plan: Plan,
    sentences: Sentences,
    rationality: float,
) -> MirrorModel:
    """Return P_R^H from P(B) and what planning found for each of its beliefs, in order.

    Beliefs without a plan are left out, and the rest is renormalised. β is
    `rationality`, in 1/cost unit. Raises PlanningError if planning failed for
    every belief but the robot's own: nothing could be told apart.
    """
    weighed: list[Hypothesis] = []
    mass = dict.fromkeys(Status, 0.0)
    robot = 0
    for index, (belief, probability, result) in enumerate(
        zip(prior.beliefs, prior.probabilities, results, strict=True)
    ):
        plans, status = result.plans, result.status
        if index == prior.robot_belief:
            plans, status = _with_robot_plan(robot_plan, result.plans), Status.SOLVED
            robot = len(weighed)
        mass[status] += probability
        true_facts = tuple(f for f in prior.space.uncertain_facts if f in belief.true_facts)
        weighed += [
            Hypothesis(belief.goal, true_facts, plan, probability * share)
            for plan, share in zip(plans, plan_probabilities(plans, rationality), strict=True)
        ]
    _require_alternatives(prior, results)
    total = math.fsum(hypothesis.probability for hypothesis in weighed)
    hypotheses = tuple(
        Hypothesis(h.goal, h.true_facts, h.plan, h.probability / total) for h in weighed
    )
    said = tuple(sentences.of(action) for action in robot_plan.actions)
    counts = [Counter(map(sentences.of, h.plan.actions)) for h in hypotheses]
    return MirrorModel(
        goals=prior.goals,
        hypotheses=hypotheses,
        robot=robot,
        sentences=said,
        occurrences=np.array([[count[s] for s in said] for count in counts], dtype=np.int64),
        length=np.array([len(h.plan.actions) for h in hypotheses], dtype=np.int64),
        covered_mass=prior.covered_mass,
        unsolvable_mass=mass[Status.UNSOLVABLE],
        unknown_mass=mass[Status.UNKNOWN],
        stand_in_plans=len(_stand_ins(prior, results)),
        warnings=(*prior.warnings, *_planning_warnings(prior, results)),
    )


def plan_probabilities(plans: Sequence[Plan], rationality: float) -> list[float]:
    """P(π|b) ∝ R(π, b) = exp(−β (cost(π) − cost*(b))) over the plans known for b."""
    if not plans:
        return []
    best = min(plan.cost for plan in plans)
    # The bound keeps a plan of absurd cost improbable, and its logarithm finite.
    weights = [math.exp(-min(600.0, rationality * (plan.cost - best))) for plan in plans]
    return [weight / math.fsum(weights) for weight in weights]


def _with_robot_plan(robot_plan: Plan, plans: Sequence[Plan]) -> tuple[Plan, ...]:
    """Return the plans known for b_R with π_R first.

    P(o|π) ignores order, so π_R takes the place of a plan with the same
    actions; failing that, of an only plan of the same cost: which of the equally
    good plans an engine returns is an accident, and must not make the robot's
    own plan look one half as likely.
    """
    proved = any(plan.optimal and plan.cost == robot_plan.cost for plan in plans)
    robot_actions = Counter(robot_plan.actions)
    same = [plan for plan in plans if Counter(plan.actions) == robot_actions]
    as_good = [plan for plan in plans if plan.cost == robot_plan.cost and len(plans) == 1]
    replaced = [*same, *as_good][:1]
    own = replace(robot_plan, optimal=proved)
    return (own, *(plan for plan in plans if plan not in replaced))


def _require_alternatives(prior: Prior, results: Sequence[BeliefPlans]) -> None:
    """Raise PlanningError if all that could be known, beside b_R, stayed unknown."""
    others = [result for i, result in enumerate(results) if i != prior.robot_belief]
    unknown = [result for result in others if result.status is Status.UNKNOWN]
    if unknown and not any(result.status is Status.SOLVED for result in others):
        raise PlanningError(
            f'no plan was found for any other belief that the user may hold ({unknown[0].reason})',
            cure='Raise planning_timeout and deadline, or give the user model fewer beliefs.',
        )


def _stand_ins(prior: Prior, results: Sequence[BeliefPlans]) -> list[BeliefPlans]:
    """Return the results that hold a plan in place of an optimal one; b_R has π_R anyway.

    An engine that never proves its plans optimal gives no reason: it was asked for.
    """
    return [
        result
        for index, result in enumerate(results)
        if result.reason
        and index != prior.robot_belief
        and not all(plan.optimal for plan in result.plans)
    ]


def _planning_warnings(prior: Prior, results: Sequence[BeliefPlans]) -> Iterator[str]:
    """Name the candidate goals that no belief can reach, and say what stayed unknown."""
    statuses: dict[int, set[Status]] = {}
    for index, (belief, result) in enumerate(zip(prior.beliefs, results, strict=True)):
        status = Status.SOLVED if index == prior.robot_belief else result.status
        statuses.setdefault(belief.goal, set()).add(status)
    unreachable = [
        f'"{prior.goals[goal].name}"'
        for goal, found in sorted(statuses.items())
        if found == {Status.UNSOLVABLE}
    ]
    if unreachable:
        more = f' and {len(unreachable) - 3} more' if len(unreachable) > 3 else ''
        named = ', '.join(unreachable[:3])
        yield f'candidate goals that cannot be reached are left out: {named}{more}'
    stand_ins = _stand_ins(prior, results)
    if stand_ins:
        yield f'{len(stand_ins)} of {len(results)} beliefs have {stand_ins[0].reason}'
    unknown = [result for result in results if result.status is Status.UNKNOWN]
    if unknown:
        yield (
            f'{len(unknown)} of {len(results)} beliefs are left out, since planning for them '
            f'gave no result ({unknown[0].reason})'
        )
