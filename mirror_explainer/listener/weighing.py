"""P(Π|B) P(B): every way that the robot may be going, weighed (method, section 1).

From what planning found so far: a belief without a plan gives its mass to the unforeseen
ways of its goal, one that is proved to have none gives nothing.
"""

import math
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from mirror_explainer.listener.listeners import Listener
from mirror_explainer.listener.mirror_model import Hypothesis, MirrorModel
from mirror_explainer.listener.prior import Prior
from mirror_explainer.listener.ratios import Ratios
from mirror_explainer.listener.way import Way
from mirror_explainer.planning import Belief, BeliefPlans, Plan, Status
from mirror_explainer.selection.evidence import Floats

_ROUNDING = 1e-9  # of a share: sums of floats leave something where there is nothing
_NOT_YET = BeliefPlans(Status.UNKNOWN, reason='not planned for yet')


@dataclass(frozen=True)
class _Held:
    """A belief that may have a plan, its P(b), and the plans that are known."""

    belief: Belief
    probability: float
    plans: Sequence[Plan]


def mirror_model(
    prior: Prior,
    results: Mapping[Belief, BeliefPlans],
    way: Way,
    listener: Listener,
    rationality: float,
    *,
    one_plan: bool = True,
    stop: Callable[[], None] = lambda: None,
) -> MirrorModel:
    """Return P_R^H from P(B) and what planning found so far for its beliefs.

    β is `rationality`, in 1/cost unit. `one_plan` says that one plan a belief was asked for.
    `stop` is called now and then, and may raise to end the work.
    """
    held = [*_held(prior, results, way.plan, one_plan)]
    unsolvable = math.fsum(prior.probabilities) - math.fsum(h.probability for h in held)
    scale = 1.0 / (math.fsum(prior.goal_masses) - unsolvable)

    robot_belief = prior.beliefs[prior.robot_belief]
    ratios = Ratios(listener, way, prior.robot_goal, results.get(robot_belief, _NOT_YET).plans)
    hypotheses: list[Hypothesis] = []
    robot = -1
    for index, of in enumerate(held):
        if index % 256 == 0:
            stop()
        if of.belief == robot_belief:
            robot = len(hypotheses)
        mass = (1.0 - listener.unforeseen) * of.probability * scale
        for plan, share in zip(of.plans, plan_probabilities(of.plans, rationality), strict=True):
            row = ratios.of_plan(plan.actions)
            hypotheses.append(Hypothesis(of.belief.goal, mass * share, row, plan, of.belief))

    means = _means(hypotheses, prior.robot_goal, ratios.rows)
    for goal, masses in enumerate(_unforeseen(prior, held, way, listener)):
        hypotheses += [
            Hypothesis(goal, float(mass * scale), ratios.of_aim(aim, means), aim=aim)
            for aim, mass in zip(way.aims[goal], masses, strict=True)
            if mass > 0.0
        ]
    cut = [result.cut for result in results.values() if result.cut]
    return MirrorModel(
        listener=listener,
        goals=prior.goals,
        facts=prior.facts,
        way=way,
        told=ratios.told,
        hypotheses=tuple(hypotheses),
        robot=robot,
        ratios=ratios.rows,
        covered=prior.covered_mass,
        planned=planned_share(prior, results),
        unsolvable=unsolvable,
        plans_cut=len(cut),
        cut_by_time=cut.count('time'),
    )


def _held(
    prior: Prior, results: Mapping[Belief, BeliefPlans], robot_plan: Plan, one_plan: bool
) -> Iterator[_Held]:
    """Yield the beliefs that are not proved to have no plan; b_R has π_R first."""
    robot_belief = prior.beliefs[prior.robot_belief]
    for belief, probability in zip(prior.beliefs, prior.probabilities, strict=True):
        result = results.get(belief, _NOT_YET)
        if belief == robot_belief:
            plans = _with_robot_plan(robot_plan, result.plans, one_plan)
            yield _Held(belief, probability, plans)
        elif result.status is not Status.UNSOLVABLE:
            yield _Held(belief, probability, result.plans)


def _unforeseen(
    prior: Prior, held: Sequence[_Held], way: Way, listener: Listener
) -> Iterator[list[float]]:
    """Yield for each goal the masses of the unforeseen ways with its aims, in their order.

    That is the μ-share of all that may be believed of it, of which ω goes to the aims that
    lack a part; and, to the whole goal, all of what is not planned for.
    """
    shares = _not_enumerated(prior)
    unplanned = shares.copy()
    for of in held:
        shares[of.belief.goal] += of.probability
        unplanned[of.belief.goal] += 0.0 if of.plans else of.probability
    mu = listener.unforeseen
    for share, without_plan, aims in zip(
        mu * shares, (1.0 - mu) * unplanned, way.aims, strict=True
    ):
        partial = len(aims) - 1
        lent = listener.partial_goals * share if partial else 0.0
        yield [share - lent + without_plan, *[lent / max(1, partial)] * partial]


def planned_share(prior: Prior, results: Mapping[Belief, BeliefPlans]) -> float:
    """The share of P(B) that is planned for, or proved unsolvable, in [0, 1]."""
    known = (results.get(belief, _NOT_YET).status for belief in prior.beliefs)
    masses = zip(prior.probabilities, known, strict=True)
    planned = math.fsum(mass for mass, status in masses if status is not Status.UNKNOWN)
    share = planned / math.fsum(prior.goal_masses)
    return 1.0 if share > 1.0 - _ROUNDING else share


def _not_enumerated(prior: Prior) -> Floats:
    """The mass of each goal's beliefs that are not among those enumerated, shape (goals,)."""
    masses = np.array(prior.goal_masses)
    goals = [belief.goal for belief in prior.beliefs]
    left = masses - np.bincount(goals, prior.probabilities, len(masses))
    return np.where(left > _ROUNDING * masses, left, 0.0)


def plan_probabilities(plans: Sequence[Plan], rationality: float) -> list[float]:
    """P(π|b) ∝ R(π, b) = exp(−β (cost(π) − cost*(b))) over the plans known for b."""
    if not plans:
        return []
    best = min(plan.cost for plan in plans)
    # The bound keeps a plan of absurd cost improbable, and its logarithm finite.
    weights = [math.exp(-min(600.0, rationality * (plan.cost - best))) for plan in plans]
    return [weight / math.fsum(weights) for weight in weights]


def _with_robot_plan(robot_plan: Plan, plans: Sequence[Plan], one_plan: bool) -> tuple[Plan, ...]:
    """Return the plans known for b_R with π_R first.

    What is observed has no order, so π_R takes the place of a plan with the same actions.
    Where one plan was asked for, it takes the place of that if it costs the same: which of
    the equally good plans an engine returns is an accident, and must not make the robot's
    own plan look one half as likely.
    """
    robot_actions = Counter(robot_plan.actions)
    replaced = [
        plan
        for plan in plans
        if (one_plan and plan.cost == robot_plan.cost) or Counter(plan.actions) == robot_actions
    ]
    return (robot_plan, *(plan for plan in plans if plan not in replaced[:1]))


def _means(foreseen: Sequence[Hypothesis], goal: int, ratios: Floats) -> Floats:
    """The share of the robot's goal's foreseen ways that have each sentence, shape (T,).

    That is what a means weighs in an unforeseen way: how the robot goes about a goal tells
    nothing about the goal to those who cannot foresee it. `ratios` are the rows so far.
    """
    own = [h for h in foreseen if h.goal == goal]
    mass = np.array([h.probability for h in own])
    return np.asarray(mass @ (ratios[[h.ratios for h in own]] > 0) / mass.sum())
