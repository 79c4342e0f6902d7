"""P(B) = P(I) P(G): the beliefs that the user may hold, and the robot's own among them.

Section 4 of the paper: a categorical distribution over goals, and a Bernoulli
variable for each uncertain fact; here also groups of which exactly one fact holds.
"""

import heapq
import math
import re
from collections.abc import Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import islice
from typing import Any

from mirror_explainer.errors import did_you_mean
from mirror_explainer.listener.goals import Part, parts_of
from mirror_explainer.listener.user_model import CandidateGoal, UserModel
from mirror_explainer.pddl import Task, goal_expression
from mirror_explainer.planning import Belief, BeliefSpace
from mirror_explainer.settings import PlanningSettings

# What b_R gets when the user model calls it impossible (footnote 2 of the paper).
CONTRADICTED_PROBABILITY = 1e-6
# Of names, for a mere hint: each takes some microseconds, in every update.
_MOST_COMPARISONS = 2000


@dataclass(frozen=True)
class Prior:
    """P(B) over the enumerated beliefs, the most probable first.

    `goals` are the distinct candidates that are possible, the robot's own among them, with
    P(G); `parts` are those of each. `facts` are the uncertain ones with the probability that
    each holds. `beliefs` and `probabilities` go together; `robot_belief` is the index of b_R.
    `goal_masses` are what all beliefs of each goal have together, enumerated or not.
    `warnings` say where the robot lies outside the user's model.
    """

    space: BeliefSpace
    goals: tuple[CandidateGoal, ...]
    parts: tuple[tuple[Part, ...], ...]
    facts: Mapping[str, float]
    beliefs: tuple[Belief, ...]
    probabilities: tuple[float, ...]
    robot_belief: int
    goal_masses: tuple[float, ...]
    warnings: tuple[str, ...]

    @property
    def robot_goal(self) -> int:
        """The index of G_R."""
        return self.beliefs[self.robot_belief].goal

    @property
    def common_parts(self) -> frozenset[str]:
        """The parts that all of several goals have, as texts."""
        if len(self.parts) < 2:
            return frozenset()
        common = frozenset.intersection(*map(frozenset, self.parts))
        return frozenset(str(part.condition) for part in common)

    @property
    def covered_mass(self) -> float:
        """The probability of all enumerated beliefs together, 1 unless they were cut off."""
        return min(1.0, math.fsum(self.probabilities))

    @property
    def to_plan_for(self) -> tuple[Belief, ...]:
        """The beliefs in the order in which planning tells most: b_R, others of G_R, the rest."""
        robot = self.beliefs[self.robot_belief]
        return tuple(sorted(self.beliefs, key=lambda b: (b != robot, b.goal != robot.goal)))


@dataclass(frozen=True)
class _Factor:
    """One independent variable of P(B): its outcomes' probabilities, and b_R's outcome."""

    probability: Mapping[Any, float]
    robot: Any
    contradiction: str

    @property
    def possible(self) -> set[Any]:
        """The outcomes that some belief has."""
        return {outcome for outcome, p in self.probability.items() if p} | {self.robot}


def belief_prior(
    task: Task, user_model: UserModel, max_beliefs: int = PlanningSettings.max_beliefs
) -> Prior:
    """Enumerate the beliefs of a user model from the most probable down.

    At most `max_beliefs` are taken, and b_R always is one of them. Of beliefs that are equally
    probable all are taken or none, if about half of the limit is used without them.
    """
    candidates, robot_goal, warnings = _distinct_goals(task, user_model)
    goals = tuple(goal for goal, _ in candidates)
    warnings += _misspelt_objects(task, user_model)
    factors = [
        _Factor(
            {index: goal.probability for index, goal in enumerate(goals)},
            robot_goal,
            f'the goal "{goals[robot_goal].name}" has probability 0',
        ),
        *_fact_factors(user_model, task.initial_facts),
    ]
    robot = _belief([factor.robot for factor in factors])
    robot_probability = math.prod(factor.probability.get(factor.robot, 0.0) for factor in factors)
    scale = 1.0
    if robot_probability == 0.0:
        robot_probability, scale = CONTRADICTED_PROBABILITY, 1.0 - CONTRADICTED_PROBABILITY
        warnings += [
            f'the user model rules out what is true of the robot: {factor.contradiction}'
            for factor in factors
            if not factor.probability.get(factor.robot)
        ]
    taken = {
        _belief(outcomes): scale * probability
        for outcomes, probability in _cut_off(
            _most_probable_first([factor.probability for factor in factors]), max_beliefs
        )
    }
    if not taken.get(robot):
        taken.pop(robot, None)
        taken = dict([*taken.items()][: max_beliefs - 1]) | {robot: robot_probability}
        taken = dict(sorted(taken.items(), key=lambda item: -item[1]))
    contradicted = robot_probability if scale < 1.0 else 0.0
    # What no belief has must change nothing, and a hard fact may take the fast way of planning
    # from the others.
    held = {fact for factor in factors[1:] for facts in factor.possible for fact in facts}
    facts = [fact for fact in user_model.fact_probabilities if fact in held]
    return Prior(
        space=BeliefSpace(
            task.domain, task.problem, tuple(goal.goal for goal in goals), tuple(facts)
        ),
        goals=goals,
        parts=tuple(parts for _, parts in candidates),
        facts=user_model.fact_probabilities,
        beliefs=tuple(taken),
        probabilities=tuple(taken.values()),
        robot_belief=list(taken).index(robot),
        goal_masses=tuple(
            scale * goal.probability + contradicted * (index == robot_goal)
            for index, goal in enumerate(goals)
        ),
        warnings=tuple(warnings),
    )


def _distinct_goals(
    task: Task, user_model: UserModel
) -> tuple[list[tuple[CandidateGoal, tuple[Part, ...]]], int, list[str]]:
    """Return the possible candidate goals with their parts, the index of G_R, and warnings.

    Goals are equal when they mean the same; equal candidates become one, under the first
    one's name. The robot's own is possible whatever the user model says.
    """
    warnings = []
    distinct: dict[frozenset[Part], CandidateGoal] = {}
    written: dict[frozenset[Part], tuple[Part, ...]] = {}
    for goal in user_model.goals:
        parts = parts_of(goal_expression(task.model, goal.goal), task.model)
        meaning = frozenset(parts)
        if meaning in distinct:
            first = distinct[meaning]
            warnings.append(f'the candidates "{first.name}" and "{goal.name}" are the same goal')
            distinct[meaning] = replace(first, probability=first.probability + goal.probability)
        else:
            distinct[meaning], written[meaning] = goal, parts
    own_parts = parts_of(task.goal, task.model)
    own = frozenset(own_parts)
    if own not in distinct:
        unlisted = user_model.unlisted_goal_probability
        distinct = {
            meaning: replace(goal, probability=(1.0 - unlisted) * goal.probability)
            for meaning, goal in distinct.items()
        }
        distinct[own] = CandidateGoal(task.goal_text, task.goal_text, unlisted)
        written[own] = own_parts
        warnings.append(
            f"the robot's goal {task.goal_text} is not among the user model's candidates; "
            f'it was added with probability {unlisted:g}'
        )
    possible = [
        meaning for meaning, goal in distinct.items() if goal.probability or meaning == own
    ]
    candidates = [(distinct[meaning], written[meaning]) for meaning in possible]
    return candidates, possible.index(own), warnings


def _misspelt_objects(task: Task, user_model: UserModel) -> Iterator[str]:
    """Warn of objects that the problem does not have, but for a letter or two.

    Others may come and go: the user model is for all problems of the robot. So what stands
    beside a name in one mapping, or differs from it in a number, is not what is meant by it.
    """
    wordings = [by for template in user_model.templates.values() for by in template.when.values()]
    objects = {item.name.lower() for item in task.model.all_objects}
    unnamed_beside: dict[str, list[set[str]]] = {}
    for names in (user_model.objects, *wordings):
        if missing := names.keys() - objects:
            unnamed = objects - names.keys()
            for name in missing:
                unnamed_beside.setdefault(name, []).append(unnamed)
    left = _MOST_COMPARISONS
    for name, unnamed_sets in sorted(unnamed_beside.items()):
        unnamed = set.intersection(*unnamed_sets)
        left -= len(unnamed)
        if left < 0:
            return
        likely = [other for other in sorted(unnamed) if _lettering(other) != _lettering(name)]
        if hint := did_you_mean(name, likely, cutoff=0.8):
            reason = f'the user model names the object "{name}", which the problem does not have'
            yield reason + hint


def _lettering(name: str) -> str:
    """Return what "box1" and "box22" have in common."""
    return re.sub(r'\d+', '0', name)


def _fact_factors(user_model: UserModel, initial_facts: frozenset[str]) -> Iterator[_Factor]:
    """Yield P(I)'s variables; an outcome is the set of facts that hold."""
    for fact, probability in user_model.uncertain_facts.items():
        holds = fact in initial_facts
        yield _Factor(
            {frozenset([fact]): probability, frozenset(): 1.0 - probability},
            frozenset([fact]) if holds else frozenset(),
            f'{fact} {"holds" if holds else "does not hold"}',
        )
    for group in user_model.one_of:
        held = frozenset(group) & initial_facts
        yield _Factor(
            {frozenset([fact]): probability for fact, probability in group.items()},
            held,
            _held(sorted(held), sorted(group)),
        )


def _held(held: Sequence[str], group: Sequence[str]) -> str:
    """Say which facts of a group hold."""
    if len(held) == 1:
        return f'{held[0]} holds'
    several = f'more than one of {", ".join(group)} holds: {", ".join(held)}'
    return several if held else f'none of {", ".join(group)} holds'


def _belief(outcomes: Sequence[Hashable]) -> Belief:
    goal, *facts = outcomes
    assert isinstance(goal, int)
    return Belief(goal, frozenset().union(*facts))  # type: ignore[arg-type]


def _cut_off(
    outcomes: Iterator[tuple[list[Hashable], float]], most: int
) -> list[tuple[list[Hashable], float]]:
    """Return the most probable joint outcomes, and none that is as probable as one left out.

    For whoever is planned for by chance would be told of rather than its equals. Where that
    would leave out the most of them, equals are parted after all.
    """
    taken = list(islice(outcomes, most))
    left_out = next(outcomes, None)
    if left_out is None:
        return taken
    least = left_out[1] * (1.0 + 1e-9)
    unlike = [outcome for outcome in taken if outcome[1] > least]
    return unlike if len(unlike) > most / 2 else taken


def _most_probable_first(
    factors: Sequence[Mapping[Hashable, float]],
) -> Iterator[tuple[list[Hashable], float]]:
    """Yield the joint outcomes of independent variables, the most probable first, none of zero.

    Every joint outcome but the first has one parent, in which its last
    variable that is not at its best is one outcome better: a best-first
    search of that tree meets each outcome once, and in order.
    """
    sorted_factors = [
        sorted(((p, outcome) for outcome, p in factor.items() if p > 0), key=lambda o: -o[0])
        for factor in factors
    ]

    def entry(ranks: tuple[int, ...]) -> tuple[float, tuple[int, ...]]:
        return -math.prod(f[r][0] for f, r in zip(sorted_factors, ranks, strict=True)), ranks

    heap = [entry((0,) * len(sorted_factors))]
    while heap:
        negative, ranks = heapq.heappop(heap)
        yield [f[r][1] for f, r in zip(sorted_factors, ranks, strict=True)], -negative
        last = max((i for i, rank in enumerate(ranks) if rank), default=0)
        for i in range(last, len(ranks)):
            if ranks[i] + 1 < len(sorted_factors[i]):
                heapq.heappush(heap, entry((*ranks[:i], ranks[i] + 1, *ranks[i + 1 :])))
