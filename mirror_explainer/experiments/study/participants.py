"""Simulated participants: an observer's belief, and the noise between belief and answer."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.random import Generator

from mirror_explainer.experiments.study.design import DONT_KNOW, Answer, heard
from mirror_explainer.experiments.study.observers import (
    KINDS,
    Theory,
    habits,
    misheard,
    theory,
    with_habits,
)
from mirror_explainer.experiments.study.plans import PlannedScenario
from mirror_explainer.selection.evidence import Floats


@dataclass(frozen=True)
class Noise:
    """How a belief becomes an answer.

    A goal is chosen with probability ∝ belief^(1/`temperature`): the most likely one
    at 0, in proportion to belief at 1. No goal is named while the largest belief is
    below `confidence`. With probability `lapse` an answer is a slip: one of the goals
    shown or "I don't know", all alike.
    """

    temperature: float = 0.5
    lapse: float = 0.02
    confidence: float = 0.5


def choose(belief: Floats, noise: Noise, whim: Floats, random: Generator) -> int | None:
    """Return the index of the goal chosen, None for "I don't know".

    `whim` is Gumbel noise, one number a goal, drawn once a scenario: its maximum
    with the scaled log belief is a draw from the softmax, and who hears nothing
    new does not change their mind.
    """
    slips, slip = random.random() < noise.lapse, int(random.integers(len(belief) + 1))
    if slips:
        return None if slip == len(belief) else slip
    if belief.max() < noise.confidence:
        return None
    if noise.temperature == 0:
        return int(np.where(belief >= belief.max() - 1e-9, whim, -np.inf).argmax())
    with np.errstate(divide='ignore'):
        return int((np.log(belief) / noise.temperature + whim).argmax())


def simulate(
    planned: Sequence[PlannedScenario],
    kind: str,
    strategies: Sequence[Sequence[str]],
    noise: Noise,
    seed: int,
    growth: str = 'order',
) -> Iterator[Answer]:
    """Yield every answer of one kind of observer; `strategies` has a row a participant.

    What one participant draws in one scenario depends on nothing else, so that
    a study with more of them contains the smaller study.
    """
    number = list(KINDS).index(kind)
    theories = [theory(kind, scenario) for scenario in planned]
    said = [
        {strategy: heard(scenario, strategy, growth) for strategy in set(dealt)}
        for scenario, dealt in zip(planned, zip(*strategies, strict=True), strict=True)
    ]
    for person, row in enumerate(strategies):
        own = habits(
            planned[0].scenario.floor.doors, np.random.default_rng([seed, number, person])
        )
        for index, (scenario, strategy) in enumerate(zip(planned, row, strict=True)):
            random = np.random.default_rng([seed, number, person, index])
            thinks = theories[index]
            if kind == 'other-prior':
                thinks = with_habits(thinks, scenario, own)
            yield from _one_scenario(
                scenario,
                f'{kind}-{person + 1}',
                kind,
                strategy,
                said[index][strategy],
                thinks,
                noise,
                random,
            )


def _one_scenario(
    planned: PlannedScenario,
    participant: str,
    kind: str,
    strategy: str,
    said: Sequence[tuple[int, ...]],
    thinks: Theory,
    noise: Noise,
    random: Generator,
) -> Iterator[Answer]:
    scenario = planned.scenario
    whim = random.gumbel(size=len(scenario.shown))
    heard = misheard(planned, random) if kind == 'mishearing' else planned.model.sentences
    for step, positions in enumerate(said, start=1):
        belief = thinks.belief([heard[position] for position in positions], scenario.shown)
        chosen = choose(belief, noise, whim, random)
        yield Answer(
            participant=participant,
            observer=kind,
            scenario=scenario.name,
            strategy=strategy,
            step=step,
            steps=len(said),
            plan_length=len(planned.plan.actions),
            said=' '.join(map(str, positions)),
            goal=scenario.goals[scenario.goal].name,
            answer=DONT_KNOW if chosen is None else scenario.goals[scenario.shown[chosen]].name,
        )
