"""P(Π|B): what a rational robot would do under each belief that the user may hold."""

from mirror_explainer.planning.beliefs import (
    Belief,
    BeliefPlans,
    BeliefSpace,
    Plan,
    PlanningReport,
    Status,
)
from mirror_explainer.planning.limits import Stop
from mirror_explainer.planning.planner import Planner

__all__ = [
    'Belief',
    'BeliefPlans',
    'BeliefSpace',
    'Plan',
    'Planner',
    'PlanningReport',
    'Status',
    'Stop',
]
