"""What is fixed before the first participant comes: scenarios, sentences, orders.

It is kept in the database, so that a study begun goes on unchanged, without a planner,
whatever version of the package serves it.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from pydantic import TypeAdapter

from mirror_explainer.experiments.study.design import (
    assignment,
    presentation_order,
    verbalizations,
)
from mirror_explainer.experiments.study.participants import Noise, simulate
from mirror_explainer.experiments.study.plans import PlannedScenario
from mirror_explainer.experiments.study.scenarios import FetchGoal, Floor, Scenario, scenarios
from mirror_explainer.settings import STRATEGIES

PRACTICE = 'practice'
PRACTICE_STRATEGY = 'increasing'
SIMULATED = 'same'
SIMULATED_PARTICIPANTS = 10
_PRACTICE_SEED = -1  # which no study can have


@dataclass(frozen=True)
class Choice:
    """A goal that a participant may choose: its name in the tables, and in words."""

    name: str
    words: str


@dataclass(frozen=True)
class Encounter:
    """A scenario as participants meet it.

    `problem` is its PDDL; `choices` are in the order shown, and `goal` is the name
    of the robot's. `sentences` are those of the plan; `orders` has for each strategy
    their positions in the order in which they are said.
    """

    name: str
    problem: str
    choices: tuple[Choice, ...]
    goal: str
    sentences: tuple[str, ...]
    orders: dict[str, tuple[int, ...]]

    @property
    def steps(self) -> int:
        """How many steps the encounter has: as many as the plan has actions."""
        return len(self.sentences)

    @property
    def goal_in_words(self) -> str:
        """The robot's goal as a participant reads it."""
        return next(choice.words for choice in self.choices if choice.name == self.goal)


@dataclass(frozen=True)
class Design:
    """A whole study.

    `drawn` scenarios were drawn from the seed; `encounters` are those that could be
    planned for. `simulated` has the hit ratio of simulated listeners: of every strategy,
    at every percentage of the plan that the measures are taken at.
    """

    seed: int
    drawn: int
    domain: str
    practice: Encounter
    encounters: tuple[Encounter, ...]
    simulated: dict[str, dict[int, float]]

    def encounter(self, name: str) -> Encounter:
        """Return an encounter by its scenario's name, the practice among them."""
        return next(item for item in (self.practice, *self.encounters) if item.name == name)


def practice_scenario(floor: Floor) -> Scenario:
    """Return the scenario to practise on, the same in every study."""
    [drawn] = scenarios(floor, 1, _PRACTICE_SEED)
    return replace(drawn, name=PRACTICE)


def design(
    seed: int, drawn: int, practice: PlannedScenario, planned: Sequence[PlannedScenario]
) -> Design:
    """Return the study of these scenarios."""
    return Design(
        seed=seed,
        drawn=drawn,
        domain=practice.scenario.floor.domain,
        practice=encounter(practice),
        encounters=tuple(map(encounter, planned)),
        simulated=_simulated(planned, seed),
    )


def encounter(planned: PlannedScenario) -> Encounter:
    """Return the scenario as participants meet it."""
    scenario = planned.scenario
    return Encounter(
        name=scenario.name,
        problem=scenario.problem,
        choices=tuple(
            Choice(goal.name, in_words(goal))
            for goal in (scenario.goals[i] for i in scenario.shown)
        ),
        goal=scenario.goals[scenario.goal].name,
        sentences=planned.model.sentences,
        orders={s: order_said(verbalizations(planned.model, s)) for s in STRATEGIES},
    )


def in_words(goal: FetchGoal) -> str:
    """Return a goal as a participant reads it."""
    items = ' and '.join(f'the {item}' for item in goal.items)
    return f'It fetches {items}, and leaves by the {goal.door}.'.replace('_', ' ')


def turns(design: Design, number: int) -> list[tuple[str, str]]:
    """Return which scenarios a participant meets, in which order and by which strategy."""
    count = len(design.encounters)
    strategies = assignment(number + 1, count, design.seed)[number]
    return [
        (PRACTICE, PRACTICE_STRATEGY),
        *(
            (design.encounters[index].name, strategies[index])
            for index in presentation_order(count, number, design.seed)
        ),
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


def _simulated(planned: Sequence[PlannedScenario], seed: int) -> dict[str, dict[int, float]]:
    # Not before the extras are known to be there.
    from mirror_explainer.experiments.study.statistics import answer_table, ratios

    strategies = assignment(SIMULATED_PARTICIPANTS, len(planned), seed)
    of_each = ratios(answer_table(simulate(planned, SIMULATED, strategies, Noise(), seed)))
    means = of_each.groupby(['strategy', 'percent'])['hit_ratio'].mean().dropna()
    return {strategy: dict(means[strategy]) for strategy in STRATEGIES}


_ADAPTER = TypeAdapter(Design)
