"""The beliefs that are translated each by itself: no shortcut, so that it is always right."""

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

from mirror_explainer.planning.beliefs import Belief, BeliefPlans, BeliefSpace, Plan, Status
from mirror_explainer.planning.downward.ground_task import Actions
from mirror_explainer.planning.downward.grounding import translator
from mirror_explainer.planning.downward.grounding.pddl_lists import Lists
from mirror_explainer.planning.downward.grounding.replay import reaches_goal
from mirror_explainer.planning.downward.subject import Finding, SearchInput, Subject


@dataclass(eq=False)
class Single(Subject):
    """One belief, and its translation once there is one."""

    translation: translator.Translation | None = None


class Translations:
    """The beliefs to translate and plan for, one after another."""

    provisional = False

    def __init__(self, lists: Lists, space: BeliefSpace, beliefs: Sequence[Belief]) -> None:
        self._lists = lists
        self._facts = space.uncertain_facts
        self.ready = deque(Single(members=[belief]) for belief in beliefs)

    def known(self, single: Single) -> Finding | None:
        """Return None: nothing is known without a search."""

    def search_input(self, single: Single) -> SearchInput:
        """Translate the belief."""
        translation = translator.translate(self._lists, single.members[0], self._facts)
        single.translation = translation
        return SearchInput(translation.text, translation.searches)

    def checked(self, single: Single, plans: Sequence[Actions]) -> Finding | None:
        """Return the plans without their last actions, which stand for the goal."""
        assert single.translation is not None, 'a search is made from it'
        works = all(reaches_goal(single.translation.task, plan) for plan in plans)
        return Finding(tuple(plan[:-1] for plan in plans)) if works else None

    def settle(self, single: Single, finding: Finding | None) -> BeliefPlans | None:
        """Return what the finding says of the belief; no other depends on it."""
        if finding is None:
            return None
        if not finding.plans:
            return BeliefPlans(Status.UNSOLVABLE)
        assert single.translation is not None, 'a plan is found with it'
        costs = single.translation.costs
        return BeliefPlans(
            Status.SOLVED,
            tuple(
                Plan(plan, sum(costs[action] for action in plan) / self._lists.scale)
                for plan in finding.plans
            ),
        )
