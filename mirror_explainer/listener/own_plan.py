"""PLAN(P_R), line 2 of Algorithm 1: the robot's own plan, where none is given."""

from dataclasses import replace

from mirror_explainer.errors import PlanningError
from mirror_explainer.listener.prior import Prior, belief_prior
from mirror_explainer.listener.user_model import UserModel
from mirror_explainer.pddl import Task
from mirror_explainer.planning import Belief, Plan, Planner, Status
from mirror_explainer.settings import PlanningSettings

# Where the robot's goal cannot be reached: how many of its parts are tried, and for how long (s).
_MOST_PARTS = 20
_SECONDS_FOR_PARTS = 10.0


def plan_for_robot(
    task: Task,
    user_model: UserModel,
    planner: Planner,
    settings: PlanningSettings,
    source: str = 'the problem',
) -> Plan:
    """Return a plan for the robot's own goal; raises PlanningError if there is none.

    It names the `source` of the goal, and the parts of it that cannot even be reached alone.
    """
    prior = belief_prior(task, user_model, settings.max_beliefs)
    robot = prior.beliefs[prior.robot_belief]
    result = planner.plan(prior.space, [robot], deadline=settings.deadline).results[0]
    if result.status is Status.UNSOLVABLE:
        parts = _unreachable_parts(prior, planner)
        alone = f', nor can {", ".join(parts)} alone' if parts else ''
        raise PlanningError(
            f"the robot's own goal cannot be reached from its initial state{alone}",
            cure=f'Correct the :init or the :goal of {source}.',
        )
    if result.status is Status.UNKNOWN:
        raise PlanningError(
            f"no plan was found for the robot's own goal ({result.reason})",
            cure="Give planning more time or memory, or give the robot's plan.",
        )
    return result.plans[0]


def _unreachable_parts(prior: Prior, planner: Planner) -> list[str]:
    """Return the parts of a goal of the robot's of several that are proved out of reach alone."""
    parts = [str(part) for part in prior.parts[prior.robot_goal][:_MOST_PARTS]]
    if len(parts) < 2:
        return []
    true_facts = prior.beliefs[prior.robot_belief].true_facts
    beliefs = [Belief(index, true_facts) for index in range(len(parts))]
    space = replace(prior.space, goals=tuple(parts))
    results = planner.plan(space, beliefs, deadline=_SECONDS_FOR_PARTS).results
    found = zip(parts, results, strict=True)
    return [part for part, result in found if result.status is Status.UNSOLVABLE]
