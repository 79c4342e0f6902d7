"""From the fullest initial states down: what is known of one belief spares searching another.

A fact that no condition wants false can only help. So the cost under more such
facts is a lower bound under fewer, a plan that reaches the bound is optimal, and
where more facts leave no plan, fewer leave none.
"""

from collections import defaultdict, deque
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from mirror_explainer.planning.beliefs import Belief, BeliefPlans, Cut, Plan, Status
from mirror_explainer.planning.downward.ground_task import Actions, State
from mirror_explainer.planning.downward.grounding.ground_once import Grounding, atom_name
from mirror_explainer.planning.downward.subject import Finding, SearchInput, Subject
from mirror_explainer.planning.downward.what_matters import GoalTask


@dataclass(eq=False)
class Node(Subject):
    """All asked beliefs that are one and the same task, and what is known of it.

    `facts` are the uncertain facts that hold and matter to the goal. `plan` is an optimal
    plan and `cost` what it costs, None while none is known. `hopeless` says that a search ran
    out of time here, or where more facts hold. The first belief's node waits for no parent.
    """

    goal: int
    facts: frozenset[str]
    state: State
    children: list['Node'] = field(default_factory=list)
    open_parents: int = 0
    unsolvable: bool = False
    plan: Actions | None = None
    cost: int | None = None


def released(node: Node) -> list[Node]:
    """Return the nodes below a settled one that wait for no other parent."""
    for child in node.children:
        child.open_parents -= 1
    return [child for child in node.children if child.open_parents == 0]


class SupersetWalk:
    """The distinct tasks of some beliefs, the plans known for them, and what follows.

    `initial` has the problem's initial atoms, costs are divided by `scale`;
    `cut` says what becomes of further plans: 'time' if they are looked for afterwards, 'planner'
    if nothing here could do so, '' if none are asked for.
    `ready` has the first belief's node, then those whose parents, which have more facts, are
    settled, goals in the order of the beliefs.
    """

    def __init__(
        self,
        grounding: Grounding,
        initial: frozenset[str],
        beliefs: Sequence[Belief],
        scale: int,
        cut: Cut,
    ) -> None:
        self.provisional = cut == 'time'
        self._cut: Cut = cut
        self._scale = scale
        self.task = grounding.task
        self.objects = grounding.objects
        self.goals = grounding.goals
        self._helpful = frozenset(grounding.uncertain) - grounding.negative
        self._goal_tasks = {
            index: GoalTask(grounding.task, goal, gain=0)
            for index in {belief.goal for belief in beliefs}
            if (goal := grounding.goals[index]) is not None
        }
        certain = initial - frozenset(grounding.uncertain)
        self.nodes = self._distinct(grounding, certain, beliefs)
        for group in self._comparable(self.nodes):
            for node in group.values():
                node.parents = list(self._parents(node, group))
                node.open_parents = len(node.parents) if beliefs[0] not in node.members else 0
                for parent in node.parents:
                    parent.children.append(node)
        ready = (node for node in self.nodes if not node.open_parents)
        self.ready = deque(sorted(ready, key=lambda node: beliefs[0] not in node.members))

    def _comparable(self, nodes: Sequence[Node]) -> Iterator[dict[frozenset[str], Node]]:
        """Yield the nodes that differ in helpful facts only, by their facts."""
        groups: dict[object, dict[frozenset[str], Node]] = defaultdict(dict)
        for node in nodes:
            groups[node.goal, node.facts - self._helpful][node.facts] = node
        yield from groups.values()

    def _parents(self, node: Node, group: dict[frozenset[str], Node]) -> Iterator[Node]:
        """Yield the nodes just above; all above if some of those just above were not asked."""
        helpful = frozenset().union(*group) & self._helpful
        above = [node.facts | {fact} for fact in helpful - node.facts]
        if all(facts in group for facts in above):
            yield from sorted((group[facts] for facts in above), key=lambda n: sorted(n.facts))
        else:
            yield from (other for facts, other in group.items() if node.facts < facts)

    def known(self, node: Node) -> Finding | None:
        """Return what can be said of a ready node without a search, None if nothing."""
        goal = self.goals[node.goal]
        if goal is None or any(parent.unsolvable for parent in node.parents):
            return Finding(())
        if all(node.state[variable] == value for variable, value in goal):
            return Finding(((),))
        bound = max((parent.cost or 0 for parent in node.parents), default=0)
        for parent in node.parents:
            if parent.plan and parent.cost == bound and self.works(node, parent.plan):
                return Finding((parent.plan,))
        if not self._goal_tasks[node.goal].may_be_reached(node.state):
            return Finding(())
        node.hopeless = any(parent.hopeless for parent in node.parents)
        return None

    def search_input(self, node: Node) -> SearchInput:
        """Return what matters of the node's task."""
        goal_task = self._goal_tasks[node.goal]
        return SearchInput(goal_task.text(node.state), *goal_task.searches)

    def checked(self, node: Node, plans: Sequence[Actions]) -> Finding | None:
        """Return the plans if they reach the goal, None otherwise."""
        return Finding(tuple(plans)) if all(self.works(node, plan) for plan in plans) else None

    def cost(self, plan: Actions) -> float:
        """Return a plan's cost, in the problem's metric."""
        return self.task.cost(plan) / self._scale

    def _result(self, finding: Finding | None) -> BeliefPlans | None:
        if finding is None:
            return None
        if not finding.plans:
            return BeliefPlans(Status.UNSOLVABLE)
        plans = tuple(Plan(plan, self.cost(plan)) for plan in finding.plans)
        return BeliefPlans(Status.SOLVED, plans, cut=self._cut if any(finding.plans) else '')

    def settle(self, node: Node, finding: Finding | None) -> BeliefPlans | None:
        """Take in all that will be known of a node; nodes below it may become ready."""
        if finding is not None:
            node.unsolvable = not finding.plans
            for plan in finding.plans:
                node.plan, node.cost = plan, self.task.cost(plan)
        self.ready.extend(released(node))
        return self._result(finding)

    def works(self, node: Node, plan: Actions) -> bool:
        """Say whether a plan can be carried out, and then the node's goal holds."""
        goal = self.goals[node.goal]
        return goal is not None and self.task.leads(plan, node.state, goal)

    def _distinct(
        self, grounding: Grounding, certain: frozenset[str], beliefs: Sequence[Belief]
    ) -> list[Node]:
        """Return the distinct tasks, goals as they come, those with more facts first."""
        relevant = {
            goal: grounding.atoms(task.variables) for goal, task in self._goal_tasks.items()
        }
        nodes: dict[tuple[int, frozenset[str]], Node] = {}
        states: dict[frozenset[str], State] = {}
        names = {fact: atom_name(fact[1:-1].split()) for b in beliefs for fact in b.true_facts}
        for belief in beliefs:
            named = frozenset(names[fact] for fact in belief.true_facts)
            facts = named & relevant.get(belief.goal, frozenset())
            if facts not in states:
                state = grounding.initial_state(certain | facts)
                assert state is not None, 'a grounding covers every belief of its space'
                states[facts] = state
            node = nodes.setdefault((belief.goal, facts), Node(belief.goal, facts, states[facts]))
            node.members.append(belief)
        goals = {goal: rank for rank, goal in enumerate(dict.fromkeys(b.goal for b in beliefs))}
        return sorted(nodes.values(), key=lambda node: (goals[node.goal], -len(node.facts)))
