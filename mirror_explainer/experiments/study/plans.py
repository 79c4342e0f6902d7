"""What planning finds for a scenario: the robot's plan, and the mirror models built on it."""

import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import combinations, product

from mirror_explainer.errors import PlanningError
from mirror_explainer.experiments.study.scenarios import FetchGoal, Scenario
from mirror_explainer.explainer import robot_plan
from mirror_explainer.listener.listeners import PLANNER, Listener
from mirror_explainer.listener.mirror_model import MirrorModel
from mirror_explainer.listener.preparation import RobotPlan, way_of
from mirror_explainer.listener.prior import belief_prior
from mirror_explainer.listener.sentences import Sentences, sentences_for
from mirror_explainer.listener.user_model import UserModel
from mirror_explainer.listener.weighing import mirror_model
from mirror_explainer.pddl import Task, read_task
from mirror_explainer.planning import Belief, BeliefPlans, BeliefSpace, Plan, Planner, Status

CHARGED = '(charged)'
LEAST_SCENARIOS = 3  # so that everybody hears every strategy
_DEADLINE = 600.0  # s for a scenario, which takes about one: a busy machine must change nothing


@dataclass(frozen=True)
class PlannedScenario:
    """A scenario with an optimal plan for whatever somebody may believe of the robot.

    `plans` has one for each goal, with the battery charged (True) or not: for the
    scenario's own goals, and for those of fetching one item more.
    """

    scenario: Scenario
    task: Task
    plans: Mapping[tuple[FetchGoal, bool], Plan]

    @property
    def plan(self) -> Plan:
        """π_R."""
        return self.plans[self.scenario.goals[self.scenario.goal], self.scenario.charged]

    @cached_property
    def sentences(self) -> Sentences:
        """How the robot says its actions."""
        return sentences_for(self.task, self.scenario.user_model, self.plan.actions)

    @cached_property
    def model(self) -> MirrorModel:
        """P_R^H as the robot assumes it: the model that it chooses its words by."""
        return self.mirror_model(self.scenario.user_model)

    @cached_property
    def robot_plan(self) -> RobotPlan:
        """π_R, with the run that it leads through."""
        return robot_plan(self.task, '\n'.join(self.plan.actions), self.scenario.name)

    def mirror_model(
        self, user_model: UserModel, wasteful: bool = False, listener: Listener = PLANNER
    ) -> MirrorModel:
        """Return P_R^H for other beliefs about the scenario's goals, or about the battery.

        With `wasteful` plans that do more than is needed are thought possible too, as
        β allows: fetching one item more, and recharging a charged battery.
        """
        prior = belief_prior(self.task, user_model)
        goals = {goal.pddl: goal for goal in self.scenario.goals}
        results = {}
        for belief in prior.beliefs:
            goal = goals[prior.goals[belief.goal].goal]
            uncertain = CHARGED in user_model.uncertain_facts
            charged = CHARGED in belief.true_facts if uncertain else self.scenario.charged
            needless = self._needless(goal, charged) if wasteful else []
            plans = (self.plans[goal, charged], *needless)
            results[belief] = BeliefPlans(Status.SOLVED, plans)
        way = way_of(self.task, self.robot_plan, prior, self.sentences)
        return mirror_model(prior, results, way, listener, user_model.rationality)

    def _needless(self, goal: FetchGoal, charged: bool) -> list[Plan]:
        """Return plans that reach the goal with more work than is needed, the cheapest first."""
        found = [
            self.plans[more, charged]
            for more in _one_item_more(self.scenario)
            if more.door == goal.door and set(goal.items) < set(more.items)
        ]
        if charged:  # a plan that recharges can be carried out with a charged battery, too
            found.append(self.plans[goal, False])
        return sorted((replace(plan, optimal=False) for plan in found), key=lambda p: p.cost)


def plan_scenarios(
    drawn: Sequence[Scenario],
) -> tuple[list[PlannedScenario], dict[str, str]]:
    """Return the scenarios with their plans, and of those left out the reason by name.

    Says on stderr which are left out. Raises PlanningError where too few are left.
    """
    from tqdm import tqdm

    planned, left_out = [], {}
    with Planner(planning_timeout=_DEADLINE) as planner:
        for scenario in tqdm(drawn, unit='scenario', disable=None):
            try:
                planned.append(plan_scenario(scenario, planner))
            except PlanningError as error:
                left_out[scenario.name] = str(error)
                print(f'user_study: left out: {scenario.name}: {error}', file=sys.stderr)
    if len(planned) < LEAST_SCENARIOS:
        raise PlanningError(
            f'only {len(planned)} scenarios could be planned for',
            cure='Try again when the machine is less busy.',
        )
    return planned, left_out


def plan_scenario(
    scenario: Scenario, planner: Planner, deadline: float = _DEADLINE
) -> PlannedScenario:
    """Plan for the scenario, for `deadline` s. Raises PlanningError unless every plan is found."""
    task = read_task(scenario.floor.domain, scenario.problem, problem_source=scenario.name)
    goals = [*scenario.goals, *_one_item_more(scenario)]
    space = BeliefSpace(task.domain, task.problem, tuple(g.pddl for g in goals), (CHARGED,))
    states = {True: frozenset([CHARGED]), False: frozenset[str]()}
    beliefs = [Belief(goal, facts) for goal in range(len(goals)) for facts in states.values()]
    report = planner.plan(space, beliefs, deadline=deadline)
    plans = {}
    for belief, result in zip(beliefs, report.results, strict=True):
        goal = goals[belief.goal]
        if result.status is not Status.SOLVED:
            reason = result.reason or 'it cannot be reached'
            raise PlanningError(f'there is no plan for "{goal.name}" ({reason})')
        plans[goal, CHARGED in belief.true_facts] = result.plans[0]
    return PlannedScenario(scenario, task, plans)


def _one_item_more(scenario: Scenario) -> list[FetchGoal]:
    size = len(scenario.goals[0].items) + 1
    return [
        FetchGoal(items, door)
        for items, door in product(combinations(scenario.all_items, size), scenario.floor.doors)
    ]
