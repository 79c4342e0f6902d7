"""What simulated participants make of the sentences they hear: Bayes, each on a model of theirs.

One kind has the very model that the robot assumes. The others differ from it,
so that the study doesn't merely confirm itself.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from mirror_explainer.experiments.study.plans import CHARGED, PlannedScenario
from mirror_explainer.experiments.study.scenarios import ITEMS
from mirror_explainer.listener.mirror_model import MirrorModel
from mirror_explainer.pddl import words_of
from mirror_explainer.selection.evidence import Floats

# Each kind, with what sets it apart from the listener whom the robot has in mind.
KINDS: Mapping[str, str] = {
    'same': 'has the model that the robot assumes',
    'other-beta': 'thinks that the robot may do needless work (β = 0.5 for each action of it)',
    'other-prior': 'expects some items and doors more than others, each in their own way',
    'unknown-battery': 'does not know whether the battery is charged',
    'mishearing': 'mishears every tenth sentence, and knows it',
    'literal': 'thinks of no plan at all, only whether what is named belongs to a goal',
}
OTHER_RATIONALITY = 0.5  # β, in 1/action
MISHEARD = 0.1  # probability that a sentence is taken for another one
STRAY = 0.05  # how likely a literal listener finds it that a thing outside the goal is named


@dataclass(frozen=True)
class Theory:
    """What a listener thinks the robot may say, hypothesis by hypothesis k = 0 … K−1.

    `goal`, shape (K,), is the goal's index in the scenario; `prior`, shape (K,), is
    P(k); `likelihood`, shape (K, S), is P(s|k) of each sentence s of `vocabulary`.
    """

    goal: NDArray[np.int64]
    prior: Floats
    vocabulary: tuple[str, ...]
    likelihood: Floats

    def belief(self, heard: Sequence[str], among: Sequence[int]) -> Floats:
        """P(G = g | heard, G among some), shape (number of those,); even where nothing fits."""
        columns = [self.vocabulary.index(sentence) for sentence in heard]
        weight = self.prior * self.likelihood[:, columns].prod(axis=1)
        belief = np.array([weight[self.goal == goal].sum() for goal in among])
        total = belief.sum()
        return belief / total if total > 0 else np.full(len(among), 1 / len(among))


@dataclass(frozen=True)
class Habits:
    """How much more one participant expects some items and doors: weights by name."""

    weights: Mapping[str, float]


def habits(doors: Sequence[str], random: Generator) -> Habits:
    """Draw one participant's habits: log-normal weights with σ = 1."""
    names = [*ITEMS, *doors]
    weights = np.exp(random.normal(size=len(names)))
    return Habits(dict(zip(names, map(float, weights), strict=True)))


def theory(kind: str, planned: PlannedScenario) -> Theory:
    """Return how an observer of this kind thinks about a scenario, habits aside."""
    user_model = planned.scenario.user_model
    if kind == 'other-beta':
        doubtful = replace(user_model, rationality=OTHER_RATIONALITY)
        return _of_model(planned, planned.mirror_model(doubtful, wasteful=True))
    if kind == 'unknown-battery':
        unsure = replace(user_model, uncertain_facts={CHARGED: 0.5})
        return _of_model(planned, planned.mirror_model(unsure))
    same = _of_model(planned, planned.model)
    if kind == 'mishearing':
        even = 1 / len(same.vocabulary)
        return replace(same, likelihood=(1 - MISHEARD) * same.likelihood + MISHEARD * even)
    if kind == 'literal':
        return _literal(planned, same.vocabulary)
    return same


def with_habits(of: Theory, planned: PlannedScenario, own: Habits) -> Theory:
    """Return the theory with another P(G): the product of the weights of what a goal names."""
    goals = planned.scenario.goals
    factor = np.array(
        [np.prod([own.weights[name] for name in (*goal.items, goal.door)]) for goal in goals]
    )
    prior = of.prior * factor[of.goal]
    return replace(of, prior=prior / prior.sum())


def misheard(planned: PlannedScenario, random: Generator) -> tuple[str, ...]:
    """Return what is heard for each sentence of π_R: now and then the same with another thing."""
    by_action: dict[str, list[str]] = {}
    for action in _actions(planned):
        sentence = planned.sentences.of(action)
        alike = by_action.setdefault(words_of(action)[0], [])
        if sentence not in alike:
            alike.append(sentence)
    heard = []
    for action, sentence in zip(planned.plan.actions, planned.model.sentences, strict=True):
        others = [other for other in by_action[words_of(action)[0]] if other != sentence]
        slips = random.random() < MISHEARD
        heard.append(str(random.choice(others)) if slips and others else sentence)
    return tuple(heard)


def _of_model(planned: PlannedScenario, model: MirrorModel) -> Theory:
    """Return P(s|π_k) = count(s in π_k) / |π_k| for all sentences, those of π_R and others."""
    sentences = planned.sentences
    foreseen = [h.plan.actions for h in model.hypotheses if h.plan]
    said = [[sentences.of(action) for action in actions] for actions in foreseen]
    vocabulary = tuple(dict.fromkeys(map(sentences.of, _actions(planned))))
    number = {goal.pddl: index for index, goal in enumerate(planned.scenario.goals)}
    return Theory(
        np.array([number[model.goals[h.goal].goal] for h in model.hypotheses]),
        model.prior,
        vocabulary,
        np.array([[plan.count(s) / len(plan) for s in vocabulary] for plan in said]),
    )


def _literal(planned: PlannedScenario, vocabulary: tuple[str, ...]) -> Theory:
    """Return the theory of somebody who only asks whether the things named are in the goal."""
    scenario = planned.scenario
    things = {*scenario.all_items, *scenario.floor.doors}
    named = {
        planned.sentences.of(action): things & set(words_of(action))
        for action in _actions(planned)
    }
    parts = [{*goal.items, goal.door} for goal in scenario.goals]
    return Theory(
        np.arange(len(parts)),
        np.full(len(parts), 1 / len(parts)),
        vocabulary,
        np.array([[1.0 if named[s] <= part else STRAY for s in vocabulary] for part in parts]),
    )


def _actions(planned: PlannedScenario) -> list[str]:
    """Return the distinct ground actions of all plans, in a fixed order."""
    plans = planned.plans.values()
    return list(dict.fromkeys(action for plan in plans for action in plan.actions))
