"""P(Π|B) P(B): every way that the robot may be going, weighed (method, section 1).

From what planning found so far: a belief without a plan gives its mass to the unforeseen
ways of its goal, one that is proved to have none gives nothing.
"""

import math
from collections import Counter
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from mirror_explainer.listener.listeners import Listener
from mirror_explainer.listener.mirror_model import Floats, Hypothesis, MirrorModel
from mirror_explainer.listener.prior import Prior
from mirror_explainer.listener.ratios import Ratios
from mirror_explainer.listener.way import Way
from mirror_explainer.planning import Belief, BeliefPlans, Plan, Status

_ROUNDING = 1e-9  # of a share: sums of floats leave something where there is nothing
_NOT_YET = BeliefPlans(Status.UNKNOWN, reason='not planned for yet')


def mirror_model(
    prior: Prior,
    results: Mapping[Belief, BeliefPlans],
    way: Way,
    sentence_of: Callable[[str], str],
    rationality: float,
    listener: Listener,
    *,
    one_plan: bool = True,
    stop: Callable[[], None] = lambda: None,
) -> MirrorModel:
    """Return P_R^H from P(B) and what planning found so far for its beliefs.

    `sentence_of` says a ground action; β is `rationality`, in 1/cost unit. `one_plan` says
    that one plan a belief was asked for. `stop` is called now and then, and may raise to
    end the work.
    """
    own_result = results.get(prior.beliefs[prior.robot_belief], _NOT_YET)
    ratios = Ratios(listener, way, prior.robot_goal, sentence_of, own_result.plans)
    mu, omega = listener.unforeseen, listener.partial_goals
    judged = [
        (belief, mass, results.get(belief, _NOT_YET))
        for belief, mass in zip(prior.beliefs, prior.probabilities, strict=True)
    ]
    robot_belief = prior.beliefs[prior.robot_belief]
    unsolvable = math.fsum(
        mass
        for belief, mass, result in judged
        if result.status is Status.UNSOLVABLE and belief != robot_belief
    )
    scale = 1.0 / (math.fsum(prior.goal_masses) - unsolvable)
    # The mass of each goal's unforeseen ways: their μ-share, and what was not planned for.
    not_enumerated = _not_enumerated(prior)
    shares, unplanned = mu * not_enumerated, (1 - mu) * not_enumerated
    foreseen: list[Hypothesis] = []
    robot = -1
    for index, (belief, mass, result) in enumerate(judged):
        if index % 256 == 0:
            stop()
        plans: Sequence[Plan] = result.plans
        if belief == robot_belief:
            plans = _with_robot_plan(way.plan, plans, one_plan)
            robot = len(foreseen)
        elif result.status is Status.UNSOLVABLE:
            continue
        for plan, share in zip(plans, plan_probabilities(plans, rationality), strict=True):
            weight, row = (1 - mu) * mass * share * scale, ratios.of_plan(plan.actions)
            foreseen.append(Hypothesis(belief.goal, weight, row, plan, belief))
        shares[belief.goal] += mu * mass
        unplanned[belief.goal] += 0.0 if plans else (1 - mu) * mass

    means = _means(foreseen, prior.robot_goal, ratios)
    unforeseen: list[Hypothesis] = []
    for goal, (whole, *partial) in enumerate(way.aims):
        lent = omega * shares[goal] if partial else 0.0
        masses = [
            shares[goal] - lent + unplanned[goal],
            *[lent / max(1, len(partial))] * len(partial),
        ]
        unforeseen += [
            Hypothesis(goal, float(mass * scale), ratios.of_aim(aim, means), aim=aim)
            for aim, mass in zip((whole, *partial), masses, strict=True)
            if mass > 0.0
        ]
    cut = [result.cut for result in results.values() if result.cut]
    return MirrorModel(
        listener=listener,
        goals=prior.goals,
        facts=prior.facts,
        way=way,
        told=ratios.told,
        hypotheses=(*foreseen, *unforeseen),
        robot=robot,
        ratios=ratios.rows,
        covered=prior.covered_mass,
        planned=planned_share(prior, results),
        unsolvable=unsolvable,
        plans_cut=len(cut),
        cut_by_time=cut.count('time'),
    )


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


def _means(foreseen: Sequence[Hypothesis], goal: int, ratios: Ratios) -> Floats:
    """The share of the robot's goal's foreseen ways that have each sentence, shape (T,).

    That is what a means weighs in an unforeseen way: how the robot goes about a goal tells
    nothing about the goal to those who cannot foresee it.
    """
    own = [h for h in foreseen if h.goal == goal]
    mass = np.array([h.probability for h in own])
    return np.asarray(mass @ (ratios.rows[[h.ratios for h in own]] > 0) / mass.sum())
