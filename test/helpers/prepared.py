"""What is known of a robot once all planning is done."""

from mirror_explainer.explainer import robot_plan
from mirror_explainer.listener.own_plan import plan_for_robot
from mirror_explainer.listener.preparation import Preparation, prepare, refine
from mirror_explainer.listener.user_model import UserModel
from mirror_explainer.pddl import Task
from mirror_explainer.planning import Planner
from mirror_explainer.settings import PlanningSettings


def prepared(
    task: Task, plan: str | None, user_model: UserModel, planner: Planner, **settings: object
) -> Preparation:
    """Prepare and plan; without a plan's text the robot's own is planned, too."""
    given = PlanningSettings(**settings)
    if plan is None:
        plan = '\n'.join(plan_for_robot(task, user_model, planner, given).actions)
    return refine(prepare(task, robot_plan(task, plan), user_model, given), planner)
