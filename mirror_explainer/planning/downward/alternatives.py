"""The other optimal plans of each belief: which of them a search returns is an accident.

For a belief whose optimal cost is known, its plans are put together from all operators
that matter (`optimal_plans.py`). Where these are too many, searches find the operators of
optimal plans (`flagged_task.py`), until all are seen, or enough for as many plans as are asked
for. Fewer facts leave no operator that more facts did not have.
"""

import itertools
from collections import deque
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass, field

from mirror_explainer.planning.beliefs import Belief, BeliefPlans, Cut, Plan, Status
from mirror_explainer.planning.downward.flagged_task import DOWN, flagged, with_positive_costs
from mirror_explainer.planning.downward.ground_task import GroundTask, State
from mirror_explainer.planning.downward.optimal_paths import Effort
from mirror_explainer.planning.downward.optimal_plans import OptimalPlans, optimal_plans
from mirror_explainer.planning.downward.portfolio import PLAIN, Try
from mirror_explainer.planning.downward.search_task import SearchTask
from mirror_explainer.planning.downward.subject import Finding, SearchInput
from mirror_explainer.planning.downward.superset_walk import Node, SupersetWalk
from mirror_explainer.planning.downward.what_matters import GoalTask

# All is looked at if that takes some tenths of a second, then a sample, and after searches more.
_LITTLE = Effort(steps=10_000)
_SAMPLED = Effort(steps=100_000, width=60)
_MUCH = Effort(steps=100_000)


@dataclass(eq=False)
class Alternative:
    """A solved node of the walk, and what is known of its optimal plans.

    `plan` is one of them, `cost` what it costs with no free actions, `found` all
    that searches met, by their sorted actions. `seen` are the names of their operators as far
    as known, all of them (and perhaps others) when `complete`. `large` says that all that
    matter are too many. `parents` have more facts.
    """

    node: Node
    plan: tuple[str, ...]
    cost: int | None = None
    found: dict[tuple[str, ...], tuple[str, ...]] = field(default_factory=dict)
    seen: set[str] = field(default_factory=set)
    complete: bool = False
    large: bool = False
    result: OptimalPlans | None = None
    parents: list['Alternative'] = field(default_factory=list)
    open_parents: int = 0
    children: list['Alternative'] = field(default_factory=list)
    hopeless: bool = False
    lesson: Try | None = None

    @property
    def members(self) -> list[Belief]:
        """The beliefs that are this task."""
        return self.node.members


def alternatives(
    walks: Iterable[SupersetWalk], most: int
) -> tuple[list['Alternatives'], dict[Node, BeliefPlans]]:
    """Return what is still to be found after some walks, and results that stay as they are.

    Those are of nodes where the goal holds already, and of all nodes of a walk whose
    costs are too large for these searches.
    """
    found, settled = [], {}
    for walk in walks:
        task = with_positive_costs(walk.task)
        if task is not None:
            found.append(Alternatives(walk, task, most))
        for node, plan in walk.optimal():
            if task is None or not plan:
                own = Plan(plan, walk.cost(node, plan))
                settled[node] = BeliefPlans(Status.SOLVED, (own,), cut='number' if plan else '')
    return found, settled


class Alternatives:
    """Finds up to `most` optimal plans, up to order, for each node that the walk has solved.

    `task` is the walk's without free actions.
    """

    required = False
    provisional = False

    def __init__(self, walk: SupersetWalk, task: GroundTask, most: int) -> None:
        self._walk = walk
        self._task = task
        self._goal_tasks: dict[int, GoalTask] = {}
        self._most = most
        self._cost_of = {operator.name: operator.cost for operator in task.operators}
        found = {node: Alternative(node, plan) for node, plan in walk.optimal() if plan}
        for node, alternative in found.items():
            alternative.parents = [
                found[p] for p in node.parents if p in found and p.cost == node.cost
            ]
            alternative.open_parents = len(alternative.parents)
            for parent in alternative.parents:
                parent.children.append(alternative)
            if task is walk.task:
                self._take_in(alternative, alternative.plan)
        self.ready = deque(a for a in found.values() if not a.open_parents)

    def known(self, subject: Alternative) -> Finding | None:
        """Return a finding if the plans can be put together without another search."""
        if subject.cost is None:
            return None
        alike = [parent for parent in subject.parents if parent.cost == subject.cost]
        complete = [parent for parent in alike if parent.complete]
        if complete:
            subject.seen = set.intersection(*(parent.seen for parent in complete))
            return Finding(None)
        subject.result = self._inherited(subject)
        if subject.result:
            return Finding(subject.plan)
        subject.large = subject.large or any(parent.large for parent in alike)
        if not subject.large:
            helpful = {operator.name for operator in self._search(subject)[0].operators}
            for effort in (_SAMPLED,) if alike else (_LITTLE, _SAMPLED):
                result = self._put_together(subject, helpful, effort)
                everything = result and (result.all or effort is _LITTLE)
                if result and (everything or len(result.plans) == self._most):
                    subject.result = result
                    used = itertools.chain(*result.plans)
                    subject.seen = set(used) if result.all else helpful
                    return Finding(None if everything else subject.plan)
            subject.large = True
        for plan in itertools.chain(*(parent.found.values() for parent in alike)):
            if self.checked(subject, plan):
                self._take_in(subject, plan)
        return None

    def _search(self, subject: Alternative) -> tuple[SearchTask, State]:
        """Return what matters to the subject's task, and its initial state."""
        node = subject.node
        if node.goal not in self._goal_tasks:
            self._goal_tasks[node.goal] = GoalTask(self._task, self._walk.goal(node))
        return self._goal_tasks[node.goal].from_here(node.state)

    def _put_together(
        self, subject: Alternative, names: Collection[str], effort: Effort
    ) -> OptimalPlans | None:
        """Return the plans of the operators so named, None if that is too much."""
        operators = self._walk.as_declared(o for o in self._task.operators if o.name in names)
        node = subject.node
        goal = self._walk.goal(node)
        return optimal_plans(operators, node.state, goal, subject.plan, self._most, effort)

    def search_input(self, subject: Alternative) -> SearchInput:
        """Return a search for an optimal plan with an operator not seen yet."""
        whole, state = self._search(subject)
        return SearchInput(flagged(whole, subject.seen).text((*state, DOWN)), PLAIN)

    def checked(self, subject: Alternative, actions: Sequence[str]) -> tuple[str, ...] | None:
        """Return the actions if they reach the goal, None otherwise."""
        return self._walk.checked(subject.node, actions)

    def cost(self, subject: Alternative, plan: tuple[str, ...]) -> float:
        """Return what a plan costs, in the problem's metric."""
        return self._walk.cost(subject.node, plan)

    def settle(self, subject: Alternative, finding: Finding | None) -> None:
        """Go on to the next search, or put the plans together."""
        plan = finding.plan if finding else None
        if plan and subject.result is None and self._is_optimal(subject, plan):
            self._take_in(subject, plan)
            self.ready.append(subject)
            return
        subject.complete = finding is not None and not (plan and subject.result)
        if subject.result is None and subject.cost is not None:
            subject.result = self._inherited(subject) or self._put_together(
                subject, subject.seen, _MUCH
            )
        if subject.result is None:
            plans = tuple(subject.found.values()) or (subject.plan,)
            subject.result = OptimalPlans(plans[: self._most], all=False)
        for child in subject.children:
            child.open_parents -= 1
            if not child.open_parents:
                self.ready.append(child)

    def result(self, subject: Alternative, finding: Finding | None) -> BeliefPlans | None:
        """Return all plans once they are put together, None before."""
        if subject.result is None:
            return None
        cost = self.cost(subject, subject.plan)
        plans = tuple(Plan(actions, cost) for actions in subject.result.plans)
        enough = subject.complete or len(plans) == self._most
        everything = subject.complete and subject.result.all
        cut: Cut = '' if everything else 'number' if enough else 'time'
        return BeliefPlans(Status.SOLVED, plans, cut=cut)

    def _inherited(self, subject: Alternative) -> OptimalPlans | None:
        """Return the plans of a node with more facts if they are enough and all work here."""
        for parent in subject.parents:
            if parent.result and parent.cost == subject.cost:
                plans = parent.result.plans
                enough = len(plans) == self._most or (parent.complete and parent.result.all)
                if enough and all(self._walk.checked(subject.node, plan) for plan in plans):
                    return parent.result
        return None

    def _is_optimal(self, subject: Alternative, plan: Sequence[str]) -> bool:
        return subject.cost is None or self._cost(plan) == subject.cost

    def _take_in(self, subject: Alternative, plan: tuple[str, ...]) -> None:
        subject.plan = plan
        subject.found[tuple(sorted(plan))] = plan
        subject.cost = self._cost(plan)
        subject.seen.update(plan)

    def _cost(self, plan: Sequence[str]) -> int:
        return sum(self._cost_of[name] for name in plan)
