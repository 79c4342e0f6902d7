"""The design of the user study: who hears what, in which order, and what is kept of it.

The same for simulated participants and for people.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from random import Random

from mirror_explainer.experiments.study.plans import PlannedScenario
from mirror_explainer.listener.listeners import OPEN, PLANNER, Listener
from mirror_explainer.listener.mirror_model import MirrorModel
from mirror_explainer.selection.baselines import ORDERS
from mirror_explainer.selection.choice import curve, informative_order
from mirror_explainer.settings import STRATEGIES

DONT_KNOW = "I don't know"
PEOPLE = 'people'  # the observer of an answer that was given by a person
GROWTHS = ('order', 'sets')
# The study's informative strategies, and whom each chooses its words for. The paper's is the
# first; the baselines choose no words, and so are the same for every listener.
SPOKEN_TO: Mapping[str, Listener] = {'informative': PLANNER, 'informative-open': OPEN}
BASELINES = tuple(strategy for strategy in STRATEGIES if strategy not in SPOKEN_TO)
PAPERS_LISTENERS = (PLANNER.kind,)


@dataclass(frozen=True)
class Answer:
    """What one participant said at one step: a row of the study's table.

    `step` counts from 1 to `steps`, as many as there are different sentences;
    `plan_length` is |π_R|, in which a sentence may come twice. `said` are the plan
    positions said so far; `goal` is the robot's, and `answer` is the name of a
    goal, or DONT_KNOW.
    """

    participant: str
    observer: str
    scenario: str
    strategy: str
    step: int
    steps: int
    plan_length: int
    said: str
    goal: str
    answer: str


def strategies_for(listeners: Iterable[str]) -> tuple[str, ...]:
    """Return the strategies of a study with these listeners: informative for each, baselines."""
    wanted = set(listeners)
    informative = (name for name, listener in SPOKEN_TO.items() if listener.kind in wanted)
    return (*informative, *BASELINES)


def assignment(
    participants: int, number: int, seed: int, strategies: Sequence[str] = STRATEGIES
) -> tuple[tuple[str, ...], ...]:
    """Return the strategy of every scenario, for every participant.

    Random and balanced, by Latin squares of as many as there are strategies: each participant
    hears each strategy equally often, and each three participants in turn (four, for four
    strategies) hear all of them on every scenario. Where that does not divide the numbers, as
    nearly so as can be.
    """
    random = Random(f'assignment {seed}')
    rows: list[tuple[str, ...]] = []
    while len(rows) < participants:
        first = [index % len(strategies) for index in range(number)]
        random.shuffle(first)
        turns = random.sample(range(len(strategies)), len(strategies))
        rows += [
            tuple(strategies[(index + turn) % len(strategies)] for index in first)
            for turn in turns
        ]
    return tuple(rows[:participants])


def presentation_order(number: int, participant: int, seed: int) -> tuple[int, ...]:
    """Return the order in which one participant, counted from 0, meets the scenarios."""
    return tuple(Random(f'order {seed} {participant}').sample(range(number), number))


def heard(
    planned: PlannedScenario, strategy: str, growth: str = 'order'
) -> tuple[tuple[int, ...], ...]:
    """Return the plan positions that one of the study's strategies has said by each step."""
    listener = SPOKEN_TO.get(strategy, PLANNER)
    model = planned.model  # a planner's
    if listener is not PLANNER:
        model = planned.mirror_model(planned.scenario.user_model, listener=listener)
    return verbalizations(model, 'informative' if strategy in SPOKEN_TO else strategy, growth)


def verbalizations(
    model: MirrorModel, strategy: str, growth: str = 'order'
) -> tuple[tuple[int, ...], ...]:
    """Return the plan positions said by step 1, 2, … until all different sentences are.

    The informative verbalization grows by the informative order ("order"): one
    more sentence a step, the best next, as in the paper's Table 1, since
    what has been heard cannot be unsaid. With "sets", step N has the best set of
    size N, which may drop a sentence of the step before.
    """
    evidence = model.evidence()
    if strategy != 'informative':
        met = 0 if strategy == 'increasing' else -1
        order = [evidence.places[column][met] for column in ORDERS[strategy](evidence)]
    elif growth == 'sets':
        return tuple(selection.positions for selection in curve(evidence))
    else:
        order = [addition.position for addition in informative_order(evidence)]
    return tuple(tuple(sorted(order[:n])) for n in range(1, len(order) + 1))
