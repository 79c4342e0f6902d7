"""What is fixed before the first participant comes: scenarios, sentences, orders.

It is kept in the database, so that a study begun goes on unchanged, without a planner,
whatever version of the package serves it.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from random import Random

from pydantic import TypeAdapter

from mirror_explainer.experiments.study.design import (
    PAPERS_LISTENERS,
    SPOKEN_TO,
    assignment,
    heard,
    presentation_order,
    strategies_for,
)
from mirror_explainer.experiments.study.participants import Noise, simulate
from mirror_explainer.experiments.study.plans import PlannedScenario
from mirror_explainer.experiments.study.scenarios import Floor, Scenario, scenarios

PRACTICE = 'practice'
ATTENTION = 'attention'  # the strategy of those encounters, too: the goal is told outright
ATTENTION_TRIALS = 2
SIMULATED = 'same'
SIMULATED_PARTICIPANTS = 10
# Which no study can have.
_PRACTICE_SEED = -1
_ATTENTION_SEED = -2


@dataclass(frozen=True)
class Choice:
    """A goal that a participant may choose: its name in the tables, and of what it consists.

    `things` are the names of the two items and of the door.
    """

    name: str
    things: tuple[str, ...] = ()


@dataclass(frozen=True)
class Encounter:
    """A scenario as participants meet it.

    `problem` is its PDDL, and `goal` the name of the robot's among the `choices`.
    `sentences` are those of the plan, and `actions` what they say; `orders` has for
    each strategy their positions in the order in which they are said.
    """

    name: str
    problem: str
    choices: tuple[Choice, ...]
    goal: str
    sentences: tuple[str, ...]
    orders: dict[str, tuple[int, ...]]
    actions: tuple[str, ...] = ()

    @property
    def steps(self) -> int:
        """How many steps the encounter has: as many as there are different sentences."""
        return len(next(iter(self.orders.values())))

    @property
    def true_choice(self) -> Choice:
        """The robot's goal."""
        return next(choice for choice in self.choices if choice.name == self.goal)


@dataclass(frozen=True)
class Turn:
    """An encounter as one participant meets it: how it is told, and the choices' order."""

    scenario: str
    strategy: str
    choices: tuple[int, ...]

    def as_list(self) -> list[object]:
        """Return it as the database keeps it."""
        return [self.scenario, self.strategy, list(self.choices)]


@dataclass(frozen=True)
class Design:
    """A whole study.

    `drawn` scenarios were drawn from the seed; `encounters` are those that could be
    planned for. `attention` are trials in between that show whether somebody listens: the
    robot tells its goal outright. `sure_after` is the mean number of sentences after which
    simulated listeners are sure of the goal, of every strategy, whomever it speaks to.
    `listeners` are those for whom informative words are chosen.
    """

    seed: int
    drawn: int
    domain: str
    practice: Encounter
    encounters: tuple[Encounter, ...]
    attention: tuple[Encounter, ...] = ()
    sure_after: dict[str, float] = field(default_factory=dict)
    listeners: tuple[str, ...] = PAPERS_LISTENERS

    @property
    def strategies(self) -> tuple[str, ...]:
        """What participants hear: informative for each of the listeners, and the baselines."""
        return strategies_for(self.listeners)

    def encounter(self, name: str) -> Encounter:
        """Return an encounter by its name, the practice and the attention trials among them."""
        every = (self.practice, *self.encounters, *self.attention)
        return next(item for item in every if item.name == name)


def practice_scenario(floor: Floor) -> Scenario:
    """Return the scenario to practise on, the same in every study."""
    [drawn] = scenarios(floor, 1, _PRACTICE_SEED)
    return replace(drawn, name=PRACTICE)


def design(
    seed: int,
    drawn: int,
    practice: PlannedScenario,
    planned: Sequence[PlannedScenario],
    listeners: Sequence[str] = PAPERS_LISTENERS,
) -> Design:
    """Return the study of these scenarios."""
    floor = practice.scenario.floor
    strategies = strategies_for(listeners)
    return Design(
        seed=seed,
        drawn=drawn,
        domain=floor.domain,
        practice=encounter(practice, strategies),
        encounters=tuple(encounter(each, strategies) for each in planned),
        attention=tuple(map(attention_trial, scenarios(floor, ATTENTION_TRIALS, _ATTENTION_SEED))),
        sure_after=_sure_after(planned, seed, strategies),
        listeners=tuple(listeners),
    )


def encounter(planned: PlannedScenario, strategies: Sequence[str]) -> Encounter:
    """Return the scenario as participants meet it, told by these strategies."""
    scenario = planned.scenario
    return Encounter(
        name=scenario.name,
        problem=scenario.problem,
        choices=_choices(scenario),
        goal=scenario.goals[scenario.goal].name,
        sentences=planned.model.sentences,
        orders={strategy: order_said(heard(planned, strategy)) for strategy in strategies},
        actions=tuple(planned.plan.actions),
    )


def attention_trial(scenario: Scenario) -> Encounter:
    """Return an encounter of one sentence, which tells the goal."""
    goal = scenario.goals[scenario.goal]
    return Encounter(
        name=scenario.name.replace('scenario', ATTENTION),
        problem=scenario.problem,
        choices=_choices(scenario),
        goal=goal.name,
        sentences=(f'I am up to this: {goal.name}.',),
        orders={ATTENTION: (0,)},
        actions=(f'(fetch-and-leave {" ".join((*goal.items, goal.door))})',),
    )


def _choices(scenario: Scenario) -> tuple[Choice, ...]:
    shown = [scenario.goals[index] for index in scenario.shown]
    return tuple(Choice(goal.name, (*goal.items, goal.door)) for goal in shown)


def turns(design: Design, number: int) -> list[Turn]:
    """Return what a participant, counted from 0, meets, in which order, and told how.

    The order of the choices is drawn for each encounter. The practice goes through the
    strategies from one participant to the next; attention trials part the study evenly.
    """
    count = len(design.encounters)
    strategies = assignment(number + 1, count, design.seed, design.strategies)[number]
    met = [
        (design.encounters[index], strategies[index])
        for index in presentation_order(count, number, design.seed)
    ]
    for index, trial in reversed(list(enumerate(design.attention, start=1))):
        met.insert(index * count // (len(design.attention) + 1), (trial, ATTENTION))
    met.insert(0, (design.practice, design.strategies[number % len(design.strategies)]))
    random = Random(f'choices {design.seed} {number}')
    return [
        Turn(
            item.name, strategy, tuple(random.sample(range(len(item.choices)), len(item.choices)))
        )
        for item, strategy in met
    ]


def order_said(steps: Sequence[Sequence[int]]) -> tuple[int, ...]:
    """Return which position each step adds to those of the step before."""
    before: Sequence[int] = ()
    order = []
    for positions in steps:
        [new] = set(positions) - set(before)
        order.append(new)
        before = positions
    return tuple(order)


def to_json(of: Design) -> str:
    """Return the design as it is kept in the database."""
    return _ADAPTER.dump_json(of).decode()


def from_json(text: str) -> Design:
    """Return the design that was kept."""
    return _ADAPTER.validate_json(text)


def without_listener(strategy: str) -> str:
    """Return the strategy whomever it speaks to: one name for all that is informative."""
    return 'informative' if strategy in SPOKEN_TO else strategy


def _sure_after(
    planned: Sequence[PlannedScenario], seed: int, strategies: Sequence[str]
) -> dict[str, float]:
    # Not before the extras are known to be there.
    from mirror_explainer.experiments.study.statistics import answer_table, earliest_steps

    rows = assignment(SIMULATED_PARTICIPANTS, len(planned), seed, strategies)
    answers = answer_table(simulate(planned, SIMULATED, rows, Noise(), seed))
    answers['strategy'] = answers['strategy'].map(without_listener)
    means = earliest_steps(answers).groupby('strategy')['settled'].mean()
    return {strategy: float(means[strategy]) for strategy in means.index}


_ADAPTER = TypeAdapter(Design)
