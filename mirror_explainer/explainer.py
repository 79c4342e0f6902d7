"""One call: the robot's task and plan, and a user model, in; an explanation out.

`prepare` does the slow part, planning for what the user may believe;
`explain` answers from its result (VERBALIZE-PLAN in Algorithm 1).
"""

import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

from mirror_explainer.errors import InputError, NoPlanError, PlanningError
from mirror_explainer.input_limits import InputLimits
from mirror_explainer.listener.mirror_model import MirrorModel, mirror_model
from mirror_explainer.listener.prior import belief_prior
from mirror_explainer.listener.sentences import sentences_for
from mirror_explainer.listener.user_model import UserModel
from mirror_explainer.pddl import Task
from mirror_explainer.pddl.plan_check import check_plan
from mirror_explainer.pddl.plan_text import read_plan, without_dummy
from mirror_explainer.planning import Belief, BeliefPlans, Plan, Planner, Status, Stop
from mirror_explainer.selection.algorithm import (
    Selection,
    decreasing,
    increasing,
    is_enough,
    most_informative,
    smallest_sufficient,
)
from mirror_explainer.settings import PlanningSettings, Question


@dataclass(frozen=True)
class Seconds:
    """Where the time went."""

    read: float = 0.0
    planning: float = 0.0
    selection: float = 0.0


@dataclass(frozen=True)
class Preparation:
    """All that is needed to answer at once: the mirror model, and what it cost.

    `inputs` tells whoever made it which inputs it was made from. For `failed_beliefs`
    the planner failed, and trying again may bring more.
    """

    model: MirrorModel
    seconds: Seconds
    planner_calls: int
    inputs: str = ''
    failed_beliefs: int = 0


@dataclass(frozen=True)
class Explanation:
    """What to say, and what it does to the listener's beliefs.

    `selection` has the plan positions in plan order (from 0), the information
    gain and its gap (nats). `said` are positions whose sentences were said
    before: all quantities are conditioned on them.
    """

    strategy: str
    preparation: Preparation
    selection: Selection
    said: tuple[int, ...]

    @property
    def sentences(self) -> tuple[str, ...]:
        """The sentences to say, in plan order."""
        model = self.preparation.model
        return tuple(model.sentences[position] for position in self.selection.positions)

    @property
    def text(self) -> str:
        """The answer as a person hears it: one sentence a line."""
        if not self.preparation.model.sentences:
            return 'Nothing is left to do: my goal is reached.'
        if self.sentences:
            return '\n'.join(self.sentences)
        heard = {self.preparation.model.sentences[position] for position in self.said}
        if heard.issuperset(self.preparation.model.sentences):
            return 'You have heard every step of my plan.'
        return 'There is nothing that you need to hear of my plan.'

    def as_dict(self, hypotheses: bool = True) -> dict[str, Any]:
        """Return the explanation as plain values, ready for JSON."""
        model = self.preparation.model
        positions = list(self.selection.positions)
        heard = [*self.said, *positions]
        before, after = model.goal_posterior(self.said), model.goal_posterior(heard)
        explanation = {
            'strategy': self.strategy,
            'n': len(positions),
            'sentences': list(self.sentences),
            'positions': positions,
            'actions': [model.plan.actions[position] for position in positions],
            'information_gain': self.selection.information_gain,
            'cross_entropy_before': model.cross_entropy(self.said),
            'cross_entropy_after': model.cross_entropy(heard),
            'understanding_before': model.understanding(self.said),
            'understanding': model.understanding(heard),
            'true_goal': model.robot_goal.name,
            'optimal': self.selection.optimal,
            'gap': self.selection.gap,
            'complete': model.complete,
            'covered_mass': model.covered_mass,
            'unsolvable_mass': model.unsolvable_mass,
            'unknown_mass': model.unknown_mass,
            'stand_in_plans': model.stand_in_plans,
            'goals': [
                {'name': goal.name, 'prior': float(prior), 'posterior': float(posterior)}
                for goal, prior, posterior in zip(model.goals, before, after, strict=True)
            ],
            'plan': [
                {
                    'position': position,
                    'action': action,
                    'sentence': sentence,
                    'information_gain': model.information_gain([position], self.said),
                }
                for position, (action, sentence) in enumerate(
                    zip(model.plan.actions, model.sentences, strict=True)
                )
            ],
        }
        if hypotheses:
            explanation['hypotheses'] = [
                {
                    'goal': model.goals[hypothesis.goal].name,
                    'true_facts': list(hypothesis.true_facts),
                    'plan': list(hypothesis.plan.actions),
                    'cost': hypothesis.plan.cost,
                    'optimal_plan': hypothesis.plan.optimal,
                    'probability': hypothesis.probability,
                    'robot': index == model.robot,
                }
                for index, hypothesis in enumerate(model.hypotheses)
            ]
        explanation['seconds'] = asdict(self.preparation.seconds)
        explanation['planner_calls'] = self.preparation.planner_calls
        return explanation


def robot_plan(
    task: Task, text: str, source: str = 'plan', limits: InputLimits | None = None
) -> Plan:
    """Return π_R from its text, checked against the task.

    Raises InputError for a text that is no plan of the task, NoPlanError for
    an empty one unless the goal already holds.
    """
    steps = without_dummy(task, read_plan(text, source, limits))
    try:
        run = check_plan(task, steps, source, limits)
    except InputError as error:
        if steps:
            raise
        raise NoPlanError(
            source,
            'the robot has no current plan',
            cure='Nothing is to be done if the robot has no task now: its next plan is explained.',
        ) from error
    return Plan(tuple(step.action for step in steps), run.cost)


def prepare(
    task: Task,
    plan: Plan | None,
    user_model: UserModel,
    planner: Planner,
    *,
    max_beliefs: int = PlanningSettings.max_beliefs,
    plans_per_belief: int = PlanningSettings.plans_per_belief,
    deadline: float | None = None,
    cancelled: Stop | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Preparation:
    """Plan for every belief that the user may hold, and return the mirror model.

    Without a `plan` the robot's own is planned too (line 2 of Algorithm 1).
    `deadline` is in seconds, `cancelled` is the planner's; `progress` is told (done, all).
    Raises PlanningError, Cancelled, and InputError.
    """
    started = time.perf_counter()
    prior = belief_prior(task, user_model, max_beliefs)
    told: set[Belief] = set()

    def found(belief: Belief, _: BeliefPlans) -> None:
        told.add(belief)
        if progress:
            progress(len(told), len(prior.beliefs))

    if progress:
        progress(0, len(prior.beliefs))
    report = planner.plan(
        prior.space,
        prior.beliefs,
        plans_per_belief=plans_per_belief,
        deadline=deadline,
        cancelled=cancelled,
        found=found,
    )
    if plan is not None:
        _require_truth(report.results[prior.robot_belief], plan)
    own = plan or _planned(report.results[prior.robot_belief])
    model = mirror_model(
        prior,
        report.results,
        own,
        sentences_for(task, user_model, own.actions),
        user_model.rationality,
    )
    seconds = Seconds(planning=time.perf_counter() - started)
    return Preparation(model, seconds, report.planner_calls, failed_beliefs=report.failed)


def explain(
    preparation: Preparation,
    *,
    strategy: str = 'informative',
    n: int | None = Question.n,
    threshold: float = 0.0,
    said: Sequence[str] = (),
    said_source: str = 'sentences said earlier',
    selection_budget: float | None = Question.selection_budget,
) -> Explanation:
    """Choose what to say: `n` sentences, or all with None.

    With a `threshold` (nats, above 0) only as many as bring the cross-entropy
    below it, `n` at most. `said` are sentences that the listener has heard, from
    `said_source`; `selection_budget` is in seconds. Raises InputError for a
    sentence said that is not in the plan.
    """
    started = time.perf_counter()
    model = preparation.model
    heard = _positions_of(said, said_source, model)
    evidence = model.evidence(heard)
    at_most = len(evidence.positions) if n is None else n
    required_gain = model.cross_entropy(heard) - threshold
    if strategy != 'informative':
        baseline = {'increasing': increasing, 'decreasing': decreasing}[strategy]
        selection = baseline(evidence, at_most)
        if threshold > 0:
            size = len(selection.positions)
            everything = baseline(evidence, len(evidence.positions)).information_gain
            growing = (baseline(evidence, k) for k in range(size))
            enough = (
                s for s in growing if is_enough(s.information_gain, required_gain, everything)
            )
            selection = next(enough, selection)
    elif threshold > 0:
        selection = smallest_sufficient(evidence, required_gain, at_most, selection_budget)
    else:
        selection = most_informative(evidence, at_most, selection_budget)
    seconds = replace(preparation.seconds, selection=time.perf_counter() - started)
    return Explanation(strategy, replace(preparation, seconds=seconds), selection, heard)


def _require_truth(result: BeliefPlans, robot_plan: Plan) -> None:
    """Raise PlanningError if the planner says of b_R what π_R, which was checked, disproves."""
    cheapest = min((plan.cost for plan in result.plans if plan.optimal), default=0.0)
    if result.status is Status.UNSOLVABLE:
        claim = 'that there is no plan'
    elif cheapest > robot_plan.cost + 1e-6 * abs(cheapest):
        claim = f'that no plan costs less than {cheapest:g}'
    else:
        return
    raise PlanningError(
        f'the planner is wrong: it says {claim}, where the robot has one that costs '
        f'{robot_plan.cost:g}',
        cure='Install the planner anew, or name another one.',
    )


def _planned(result: BeliefPlans) -> Plan:
    """Return PLAN(P_R), or raise PlanningError if there is none."""
    if result.status is Status.UNSOLVABLE:
        raise PlanningError(
            "the robot's own goal cannot be reached from its initial state",
            cure='Correct the :init or the :goal of the problem.',
        )
    if result.status is Status.UNKNOWN:
        raise PlanningError(
            f"no plan was found for the robot's own goal ({result.reason})",
            cure="Give planning more time or memory, or give the robot's plan.",
        )
    return result.plans[0]


def _positions_of(said: Sequence[str], source: str, model: MirrorModel) -> tuple[int, ...]:
    """Return plan positions of the sentences that were said, as often as the plan has them."""
    heard: dict[str, list[int]] = {}
    for sentence in said:
        if sentence not in model.sentences:
            raise InputError(
                source,
                f'no step of the plan is said as "{sentence}"',
                cure='Leave it out, or give the plan and the user model it was said with.',
            )
        places = [i for i, other in enumerate(model.sentences) if other == sentence]
        heard[sentence] = places[: len(heard.get(sentence, [])) + 1]
    return tuple(position for positions in heard.values() for position in positions)
