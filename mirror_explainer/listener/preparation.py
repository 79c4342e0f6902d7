"""What is known before a question is asked: the robot's way, and what planning found so far.

There is a preparation without any planning, from which a sensible answer comes at once;
planning refines it (method, section 4).
"""

import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace

from mirror_explainer.errors import PlanningError
from mirror_explainer.listener.ends import aims
from mirror_explainer.listener.goal_names import GoalNames, goal_names
from mirror_explainer.listener.listeners import Listener
from mirror_explainer.listener.mirror_model import MirrorModel
from mirror_explainer.listener.prior import Prior, belief_prior
from mirror_explainer.listener.sentences import Sentences, sentences_for
from mirror_explainer.listener.user_model import UserModel
from mirror_explainer.listener.way import Way
from mirror_explainer.listener.weighing import mirror_model, planned_share
from mirror_explainer.pddl import Task
from mirror_explainer.pddl.progress import StepStatus
from mirror_explainer.pddl.simulation import Run, truths
from mirror_explainer.pddl.situation import Situation
from mirror_explainer.planning import Belief, BeliefPlans, Plan, Planner, Status, Stop
from mirror_explainer.settings import FURTHER_PLANS, PlanningSettings

# Planning tells of what it found no more often than this, in seconds.
_BETWEEN_REFINEMENTS = 0.1


@dataclass(frozen=True)
class Seconds:
    """Where the time went."""

    read: float = 0.0
    planning: float = 0.0
    selection: float = 0.0


@dataclass(frozen=True)
class RobotPlan:
    """π_R, checked, with the run that it leads through."""

    plan: Plan
    run: Run


@dataclass(frozen=True)
class Preparation:
    """All that is needed to answer at once.

    `goal_names` are for goals that have none. `results` are what planning found so far.
    `inputs` tells whoever made it which inputs it was made from. For `failed_beliefs` the
    planner failed, and trying again may bring more. `situation` says how far the robot is with
    its plan. `unsure` says, if planning leaves something of the domain out, why a belief without
    a plan may have one all the same.
    """

    prior: Prior
    way: Way
    sentences: Sentences
    goal_names: GoalNames = field(repr=False)
    rationality: float
    listener: Listener
    settings: PlanningSettings
    results: Mapping[Belief, BeliefPlans] = field(default_factory=dict, repr=False)
    warnings: tuple[str, ...] = ()
    seconds: Seconds = Seconds()
    planner_calls: int = 0
    failed_beliefs: int = 0
    inputs: str = ''
    situation: Situation | None = None
    unsure: str = ''
    _models: dict[Listener, MirrorModel] = field(default_factory=dict, repr=False, compare=False)

    @property
    def statuses(self) -> tuple[StepStatus, ...]:
        """How far the robot is with each step of its plan."""
        if self.situation is None:
            return (StepStatus.AHEAD,) * len(self.way.plan.actions)
        return self.situation.progress.steps

    @property
    def failed(self) -> tuple[int, ...]:
        """The plan positions of the steps that failed, ascending."""
        return self.situation.progress.failed if self.situation else ()

    @property
    def reasons(self) -> Mapping[int, str]:
        """Why steps failed or were left out, by plan position, in the robot's words."""
        return self.situation.progress.reasons if self.situation else {}

    @property
    def excused(self) -> tuple[int, ...]:
        """The plan positions of the steps that were left out for a reason."""
        statuses = self.statuses
        return tuple(p for p in sorted(self.reasons) if statuses[p] is StepStatus.SKIPPED)

    @property
    def model(self) -> MirrorModel:
        """P_R^H of the user model's listener."""
        return self.model_for(self.listener)

    @property
    def planned(self) -> float:
        """The share of P(B) that is planned for, or proved unsolvable."""
        return planned_share(self.prior, self.results)

    def is_of_task_of(self, other: 'Preparation') -> bool:
        """Whether both came of one call of `prepare`, however far planning and robot are."""
        return self.way is other.way

    def at(self, newer: 'Preparation') -> 'Preparation':
        """Return it with the robot as far as in a newer one of the same task."""
        return replace(self, situation=newer.situation, inputs=newer.inputs)

    def knowing(self, results: Mapping[Belief, BeliefPlans]) -> 'Preparation':
        """Return it with these plans, and so with other models."""
        return replace(self, results=results, _models={})

    def warned(self, warning: str) -> 'Preparation':
        """Return it with one more warning."""
        return replace(self, warnings=(*self.warnings, warning))

    def without_planning(self, reason: str) -> 'Preparation':
        """Return it with a warning that planning failed, for a reason."""
        return self.warned(f'answered without planning: {reason}')

    def model_for(
        self, listener: Listener, stop: Callable[[], None] = lambda: None
    ) -> MirrorModel:
        """P_R^H of a listener, made once. `stop` may raise to end the work."""
        if listener not in self._models:
            self._models[listener] = mirror_model(
                self.prior,
                self.results,
                self.way,
                listener,
                self.rationality,
                one_plan=self.settings.plans_per_belief == 1,
                stop=stop,
            )
        return self._models[listener]


def prepare(
    task: Task,
    robot_plan: RobotPlan,
    user_model: UserModel,
    settings: PlanningSettings | None = None,
) -> Preparation:
    """Return what is known without any planning. Raises InputError."""
    settings = settings or PlanningSettings()
    prior = belief_prior(task, user_model, settings.max_beliefs)
    sentences = sentences_for(task, user_model, robot_plan.plan.actions)
    return Preparation(
        prior,
        way_of(task, robot_plan, prior, sentences),
        sentences,
        goal_names(task, sentences, robot_plan.plan.actions),
        user_model.rationality,
        user_model.listener,
        settings,
        warnings=(*task.warnings, *prior.warnings, *_verbless(sentences, robot_plan)),
        unsure=_unsure(task),
    )


def _verbless(sentences: Sentences, robot_plan: RobotPlan) -> Iterator[str]:
    for name in sentences.verbless(robot_plan.plan.actions):
        yield (
            f'"{name}" does not begin with an English verb: give it a sentence in the user model '
            '(sentences)'
        )


def _unsure(task: Task) -> str:
    """Say why a belief without a plan may have one, "" if it cannot."""
    if task.may_need_overlap:
        return 'its actions may have to overlap'
    return 'planned for with something left out' if task.loses_plans else ''


def way_of(task: Task, robot_plan: RobotPlan, prior: Prior, sentences: Sentences) -> Way:
    """Return π_R with what is said of it, and what it brings about of the candidate goals."""
    parts = tuple(dict.fromkeys(part for parts in prior.parts for part in parts))
    run = robot_plan.run
    held = truths(task, run.states, [part.condition for part in parts])
    return Way(
        robot_plan.plan,
        sentences.of,
        aims(prior.parts, dict(zip(parts, held, strict=True)), run.positions),
    )


def refine(
    preparation: Preparation,
    planner: Planner,
    *,
    cancelled: Stop | None = None,
    on_refined: Callable[[Preparation], None] | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Preparation:
    """Plan for every belief that the user may hold, and return what is known then.

    `on_refined` is called with what is known meanwhile, `progress` with how many beliefs of
    how many are done. Raises PlanningError, Cancelled, and
    InputError, all as the planner does.
    """
    started = told = time.monotonic()
    prior, settings = preparation.prior, preparation.settings
    beliefs = prior.to_plan_for
    found: dict[Belief, BeliefPlans] = {}

    def judged(result: BeliefPlans) -> BeliefPlans:
        if preparation.unsure and result.status is Status.UNSOLVABLE:
            return BeliefPlans(Status.UNKNOWN, reason=preparation.unsure)
        return result

    def take(belief: Belief, result: BeliefPlans) -> None:
        nonlocal told
        found[belief] = judged(result)
        if progress:
            progress(len(found), len(beliefs))
        if on_refined and time.monotonic() - told > _BETWEEN_REFINEMENTS:
            told = time.monotonic()
            on_refined(preparation.knowing(dict(found)))

    report = planner.plan(
        prior.space,
        beliefs,
        plans_per_belief=settings.plans_per_belief,
        deadline=settings.deadline,
        cancelled=cancelled,
        found=take,
    )
    results = dict(zip(beliefs, map(judged, report.results), strict=True))
    if not preparation.unsure:
        _require_truth(results[beliefs[0]], preparation.way.plan)
    seconds = replace(preparation.seconds, planning=time.monotonic() - started)
    return replace(
        preparation.knowing(results),
        warnings=(*preparation.warnings, *_warnings(prior, results)),
        seconds=seconds,
        planner_calls=report.planner_calls,
        failed_beliefs=report.failed,
    )


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


def _warnings(prior: Prior, results: Mapping[Belief, BeliefPlans]) -> Iterator[str]:
    """Name the candidate goals that no belief can reach, and say what was not planned for."""
    statuses: dict[int, set[Status]] = {}
    for belief, result in results.items():
        statuses.setdefault(belief.goal, set()).add(result.status)
    unreachable = [
        f'"{prior.goals[goal].name}"'
        for goal, found in sorted(statuses.items())
        if found == {Status.UNSOLVABLE}
    ]
    if unreachable:
        more = f' and {len(unreachable) - 3} more' if len(unreachable) > 3 else ''
        named = ', '.join(unreachable[:3])
        yield f'candidate goals that cannot be reached are left out: {named}{more}'
    unknown = [result for result in results.values() if result.status is Status.UNKNOWN]
    if unknown:
        yield (
            f'for {len(unknown)} of {len(results)} beliefs planning gave no result '
            f'({unknown[0].reason}): the listener is taken not to foresee the way there'
        )
    without = [result for result in results.values() if result.cut == 'planner']
    if without:
        why = without[0].reason or f'they need the extra [plans]: pip install {FURTHER_PLANS}'
        yield f'no further plans for {len(without)} of {len(results)} beliefs: {why}'
