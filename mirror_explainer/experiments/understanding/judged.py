"""One task of "who understands what": who says what, and what each listener makes of it.

The judges know up to 300 optimal plans of each belief, far more than a speaker may have
looked for: a listener is not told which plan the robot's planner happened to return.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from random import Random

import numpy as np

from mirror_explainer.experiments.benchmark.protocol import draw_facts, draw_goals
from mirror_explainer.experiments.understanding.tasks import DrawnTask
from mirror_explainer.explainer import robot_plan
from mirror_explainer.listener.listeners import LISTENERS
from mirror_explainer.listener.mirror_model import MirrorModel
from mirror_explainer.listener.preparation import Preparation, prepare, refine
from mirror_explainer.pddl import read_task
from mirror_explainer.planning import BeliefPlans, Planner
from mirror_explainer.selection.baselines import ORDERS
from mirror_explainer.selection.choice import baseline, most_informative
from mirror_explainer.selection.enumeration import TIE
from mirror_explainer.settings import PlanningSettings

REFEREE = 300  # plans a belief
EQUALS = "planner's equals"
COUNTS = (1, 3, 10, 30, 100, REFEREE)
SIZES = (1, 2, 3, 4)
_EQUALS = 100  # of as many at most the mean is taken


@dataclass(frozen=True)
class Judged:
    """What a `judge` makes of what a `speaker` said.

    A speaker is a listener's name or an order, or EQUALS: any of the choices that tell the
    planner's as much as its own, and what is made of them in the mean. It knew `plans` plans
    a belief (0: an order that needs none), was asked for `N` sentences and said `said`, fewer
    where more would be fillers. `understanding` is P(G_R | o) to the judge, who has so many
    `hypotheses`; `doubt` is D(o) in nats; `cut` counts the beliefs of which time left plans
    unknown. Tasks of the same `problem` share a world.
    """

    group: str
    domain: str
    problem: str
    task: str
    speaker: str
    plans: int
    N: int
    judge: str
    said: int
    understanding: float
    doubt: float
    hypotheses: int
    cut: int


@dataclass(frozen=True)
class Planned:
    """A task with one plan a belief, and with all that the judges know."""

    drawn: DrawnTask
    one: Preparation
    many: Preparation

    def known(self, count: int) -> Preparation:
        """Return what a speaker knows who has so many plans a belief."""
        if count == 1:
            return self.one
        results = {belief: _sampled(result, count) for belief, result in self.many.results.items()}
        return self.many.knowing(results)


def plan_task(drawn: DrawnTask, planner: Planner, deadline: float) -> Planned:
    """Draw goals and facts as in the paper's protocol, and plan for all beliefs, twice.

    Raises InputError, and PlanningError where a drawn goal has no optimal plan in time.
    """
    name, random = drawn.name, Random(drawn.seed)
    draw = draw_goals(drawn.problem, planner, deadline, random, name)
    text = drawn.problem.problem(draw.goals[0])
    task = read_task(drawn.problem.domain, text, name, name)
    user_model = drawn.user_model(task, draw.goals, draw_facts(task, draw.plan, random, name))
    own = robot_plan(task, '\n'.join(draw.plan.actions), name)
    settings = [PlanningSettings(plans_per_belief=n, deadline=deadline) for n in (1, REFEREE)]
    one, many = (refine(prepare(task, own, user_model, s), planner) for s in settings)
    return Planned(drawn, one, many)


def judgements(
    planned: Planned, counts: tuple[int, ...] = COUNTS, budget: float = 1.0
) -> Iterator[Judged]:
    """Yield what each judge makes of what each speaker says at each N."""
    judges = {name: planned.many.model_for(listener) for name, listener in LISTENERS.items()}

    def row(
        speaker: str, plans: int, judge: str, sets: Sequence[tuple[int, ...]], n: int
    ) -> Judged:
        model, drawn = judges[judge], planned.drawn
        return Judged(
            group=drawn.group,
            domain=drawn.domain,
            problem=drawn.world,
            task=drawn.name,
            speaker=speaker,
            plans=plans,
            N=n,
            judge=judge,
            said=len(sets[0]),
            understanding=float(np.mean([model.understanding(said) for said in sets])),
            doubt=float(np.mean([model.doubt(said) for said in sets])),
            hypotheses=len(model.hypotheses),
            cut=model.cut_by_time,
        )

    for speaker, plans, n, positions in _said(planned, counts, budget):
        for judge in judges:
            yield row(speaker, plans, judge, [positions], n)
    for n in SIZES:
        if equals := _equals(judges['planner'], n, planned.drawn.seed):
            for judge in judges:
                yield row(EQUALS, REFEREE, judge, equals, n)


def _said(
    planned: Planned, counts: tuple[int, ...], budget: float
) -> Iterator[tuple[str, int, int, tuple[int, ...]]]:
    """Yield speaker, plans a belief, N, and the positions said."""
    models: Mapping[tuple[str, int], MirrorModel] = {
        (name, count): planned.known(count).model_for(listener)
        for count in counts
        for name, listener in LISTENERS.items()
    }
    for (speaker, count), model in models.items():
        evidence = model.evidence()
        for n in SIZES:
            yield speaker, count, n, most_informative(evidence, n, budget).positions
    for order in ORDERS:
        for n in SIZES:
            yield order, 0, n, baseline(evidence, order, n).positions


def _equals(model: MirrorModel, n: int, seed: str) -> list[tuple[int, ...]]:
    """Return the choices of N that tell as much as the best, a sample where they are many."""
    evidence = model.evidence()
    n = min(n, len(evidence.places))
    found: list[tuple[float, tuple[int, ...]]] = []
    every = list(combinations(range(len(evidence.places)), n))
    for begin in range(0, len(every), 1000):  # at a time, for the memory's sake
        sets = every[begin : begin + 1000]
        fit = evidence.ratio[:, np.array(sets)].prod(axis=2).T
        doubts = evidence.doubt.of(fit @ evidence.weight, evidence.robot)
        least = min([doubts.min(), *(doubt for doubt, _ in found[:1])])
        found = [(doubt, said) for doubt, said in found if doubt <= least + TIE]
        found += [(d, s) for d, s in zip(doubts, sets, strict=True) if d <= least + TIE]
    tied = [tuple(evidence.positions[column] for column in columns) for _, columns in found]
    return Random(seed).sample(tied, min(_EQUALS, len(tied)))


def _sampled(result: BeliefPlans, count: int) -> BeliefPlans:
    if len(result.plans) <= count:
        return result
    return replace(result, plans=tuple(Random(0).sample(result.plans, count)))
