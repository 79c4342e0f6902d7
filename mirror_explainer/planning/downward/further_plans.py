"""The other optimal plans of each belief: which of them a search returns is an accident.

K* (kstar-planner) finds them: unordered top-quality planning, as two plans with the same actions
in another order are one observation to the listener.
"""

from collections import deque
from collections.abc import Sequence
from dataclasses import replace
from random import Random

from mirror_explainer.planning.beliefs import BeliefPlans, Cut, Plan, Status
from mirror_explainer.planning.downward.ground_task import Actions, GroundTask
from mirror_explainer.planning.downward.program import PLAN_FILE
from mirror_explainer.planning.downward.subject import Finding, SearchInput
from mirror_explainer.planning.downward.superset_walk import Node, SupersetWalk, released
from mirror_explainer.planning.downward.what_matters import GoalTask

# K* gives those plans first that are much alike. So it is asked for as many as this, if there are
# so many, and of these a sample is drawn.
_SAMPLED = 3000

# With free actions, a cost counts this much, and an action 1: so the shortest of the cheapest
# plans are the optimal ones, and no plan goes on for nothing.
_COST_UNIT = 1000
_LARGEST_SUM = 1_000_000_000


def _configuration(count: int) -> str:
    """Return a search by K* for the optimal plans up to order, at most so many.

    It is as its package has it, but that it puts plans together once, when it has all states
    within the optimal cost, and not anew for every few states: mostly that is much faster.
    """
    return (
        f'kstar(lmcut(transform=undo_to_origin()),q=1.0,k={count},find_unordered_plans=true,'
        f'restart_eppstein=false,dump_plan_files=false,json_file_to_dump={PLAN_FILE},'
        'symmetries=structural_symmetries(search_symmetries=oss,keep_operator_symmetries=true),'
        'pruning=limited_pruning(pruning=atom_centric_stubborn_sets(use_sibling_shortcut=true,'
        'atom_selection_strategy=quick_skip)))'
    )


class FurtherPlans:
    """Finds up to `most` optimal plans, up to order, for each node that a walk has solved."""

    provisional = False

    def __init__(self, walk: SupersetWalk, most: int) -> None:
        self._walk = walk
        self._task = _with_positive_costs(walk.task)
        self._most = most
        self._count = max(most + 1, _SAMPLED)
        self._members = (_configuration(self._count),)
        self._places = {item: place for place, item in enumerate(walk.objects)}
        self._goal_tasks: dict[int, GoalTask] = {}
        self._found: dict[Node, Finding | None] = {}
        self._plan = {node: node.plan for node in walk.nodes if node.plan}
        for node in self._plan:
            node.hopeless, node.lesson = False, None  # by other searches
            node.open_parents = sum(parent in self._plan for parent in node.parents)
        self.ready = deque(node for node in self._plan if not node.open_parents)

    def known(self, node: Node) -> Finding | None:
        """Return what needs no search: mostly the plans under more facts, if all work here.

        What is as good under fewer facts is so under more: there are no others, then.
        """
        if self._task is None:  # the costs are too large to search for more
            return Finding((self._plan[node],))
        for parent in node.parents:
            found = self._found.get(parent)
            if found and self._all_work(node, found.plans):
                return found
        node.hopeless = any(p.hopeless for p in node.parents if p in self._plan)
        return None

    def search_input(self, node: Node) -> SearchInput:
        """Return what matters of the node's task, with no free actions."""
        if node.goal not in self._goal_tasks:
            assert self._task is not None, 'else all is known'
            self._goal_tasks[node.goal] = GoalTask(self._task, self._walk.goals[node.goal] or ())
        return SearchInput(self._goal_tasks[node.goal].text(node.state), self._members)

    def checked(self, node: Node, plans: Sequence[Actions]) -> Finding | None:
        """Return up to `most` of the plans, None if these are none, or one is wrong."""
        # An action whose condition has alternatives is several operators of one name.
        different = {tuple(sorted(map(self._as_declared, plan))): plan for plan in plans}
        kept = sorted(different)
        if len(kept) > self._most:
            kept = Random(0).sample(kept, self._most)
        chosen = tuple(different[plan] for plan in kept)
        if not chosen or not self._all_work(node, chosen):
            return None
        return Finding(chosen, all=len(plans) < self._count and len(kept) == len(different))

    def _all_work(self, node: Node, plans: Sequence[Actions]) -> bool:
        """Say whether the plans reach the node's goal at the optimal cost."""
        return all(
            self._walk.works(node, plan) and self._walk.task.cost(plan) == node.cost
            for plan in plans
        )

    def _as_declared(self, action: str) -> tuple[str, tuple[int, ...]]:
        """Return an action with its objects by where they are declared: names mean nothing."""
        name, _, objects = action[1:-1].partition(' ')
        return name, tuple(self._places.get(item, -1) for item in objects.split())

    def settle(self, node: Node, finding: Finding | None) -> BeliefPlans:
        """Take in the plans that were found, or why it is the first one only."""
        self._found[node] = finding
        self.ready.extend(released(node))
        if finding is None:
            cut: Cut = 'time' if node.hopeless else 'planner'
            plans: tuple[Actions, ...] = (self._plan[node],)
        else:
            cut, plans = '' if finding.all else 'number', finding.plans
        cost = self._walk.cost(self._plan[node])
        return BeliefPlans(Status.SOLVED, tuple(Plan(plan, cost) for plan in plans), cut=cut)


def _with_positive_costs(task: GroundTask) -> GroundTask | None:
    """Return the task with no free actions, in which the optimal plans are also the shortest.

    The task itself if it has none; None if the costs get too large for the search.
    """
    if all(operator.cost for operator in task.operators):
        return task
    if sum(operator.cost for operator in task.operators) * _COST_UNIT > _LARGEST_SUM:
        return None
    dearer = (replace(o, cost=o.cost * _COST_UNIT + 1) for o in task.operators)
    return replace(task, operators=tuple(dearer))
