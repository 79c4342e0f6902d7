"""The scenarios of the paper's user study (Section 'User Study'): whom the operator meets.

Two rooms joined by corridors, one to three objects of one colour in each, three
exit doors, a recharge station on the way; a robot that fetches two of the objects
and leaves by one of the doors. Everything follows from a seed; nothing is read or written.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import combinations, product
from random import Random

from mirror_explainer.listener.user_model import CandidateGoal, UserModel
from mirror_explainer.listener.wording import Template
from mirror_explainer.pddl import Task

COLOURS = ('red', 'blue')
SHAPES = ('circle', 'square', 'triangle')
ITEMS = tuple(f'{colour}_{shape}' for colour, shape in product(COLOURS, SHAPES))
CORRIDORS = ('left', 'center', 'right')
GOALS_SHOWN = 3


@dataclass(frozen=True)
class Floor:
    """What all scenarios share: the PDDL domain, the map, and how actions are said.

    `facts` are those of the map, as texts; `called` is what the doors are called.
    """

    domain: str
    places: tuple[str, ...]
    doors: tuple[str, ...]
    facts: tuple[str, ...]
    templates: Mapping[str, Template]
    called: Mapping[str, str]


@dataclass(frozen=True)
class FetchGoal:
    """What the robot may be up to: these items in its hands, and itself outside this door."""

    items: tuple[str, ...]
    door: str

    @property
    def name(self) -> str:
        """The goal in words: "red circle and blue square, top left door"."""
        return f'{" and ".join(self.items)}, {self.door}'.replace('_', ' ')

    @property
    def pddl(self) -> str:
        """The goal as a PDDL goal description."""
        held = ' '.join(f'(holding {item})' for item in self.items)
        return f'(and {held} (outside {self.door}))'


@dataclass(frozen=True)
class Scenario:
    """One encounter with the robot.

    `items` are those in each room, `start` is where the robot is met, and with
    `charged` False it must recharge before it may leave. `goals` are all that the
    robot may have; `goal` is the index of its own, `shown` are the indices of the
    three that a participant chooses among, in the order shown.
    """

    name: str
    floor: Floor
    items: Mapping[str, tuple[str, ...]]
    start: str
    charged: bool
    goals: tuple[FetchGoal, ...]
    goal: int
    shown: tuple[int, ...]

    @property
    def all_items(self) -> tuple[str, ...]:
        """The items of both rooms."""
        return tuple(item for items in self.items.values() for item in items)

    @property
    def problem(self) -> str:
        """The scenario as a PDDL problem: the robot's initial state and goal."""
        facts = [
            f'(robot-at {self.start})',
            *self.floor.facts,
            *(f'(item-at {item} {room})' for room, items in self.items.items() for item in items),
            *(['(charged)'] if self.charged else []),
        ]
        return '\n'.join(
            [
                f'(define (problem {self.name})',
                '  (:domain warehouse)',
                '  (:objects',
                f'    {" ".join(self.floor.places)} - place',
                f'    {" ".join(self.all_items)} - item',
                f'    {" ".join(self.floor.doors)} - door)',
                '  (:init',
                *(f'    {fact}' for fact in facts),
                '  )',
                f'  (:goal {self.goals[self.goal].pddl}))',
            ]
        )

    @property
    def user_model(self) -> UserModel:
        """What the robot assumes about a participant: every goal of the scenario equally likely.

        The participant sees the whole initial state, battery included, and was told
        nothing about goals, as in the paper. The robot doesn't know which three goals
        the participant will choose among: an operator who meets it in a corridor has
        no such list, and with it the robot could single its goal out by a word that
        means nothing to anyone else.
        """
        share = 1 / len(self.goals)
        return UserModel(
            goals=tuple(CandidateGoal(goal.name, goal.pddl, share) for goal in self.goals),
            templates=self.floor.templates,
            objects={
                **self.floor.called,
                **{item: f'a {item.replace("_", " ")}' for item in self.all_items},
            },
        )


def floor(task: Task, user_model: UserModel) -> Floor:
    """Return the floor of a warehouse problem: its map without robot, items and battery."""
    by_type = {
        name: tuple(item.name for item in task.model.objects(task.model.user_type(name)))
        for name in ('place', 'door')
    }
    kept = ('(connected ', '(door-at ', '(station-at ')
    return Floor(
        domain=task.domain,
        places=by_type['place'],
        doors=by_type['door'],
        facts=tuple(sorted(fact for fact in task.initial_facts if fact.startswith(kept))),
        templates=user_model.templates,
        called={door: user_model.objects[door] for door in by_type['door']},
    )


def scenarios(on: Floor, number: int, seed: int) -> tuple[Scenario, ...]:
    """Draw the scenarios of a study; in half of them (rounded down) recharging is needed."""
    random = Random(f'scenarios {seed}')
    charged = [index >= number // 2 for index in range(number)]
    random.shuffle(charged)
    return tuple(
        _scenario(f'scenario-{index + 1}', on, charged[index], random) for index in range(number)
    )


def _scenario(name: str, on: Floor, charged: bool, random: Random) -> Scenario:
    items = {
        f'{colour}_room': tuple(
            f'{colour}_{shape}' for shape in random.sample(SHAPES, random.randint(1, len(SHAPES)))
        )
        for colour in COLOURS
    }
    pairs = combinations([item for of_room in items.values() for item in of_room], 2)
    goals = tuple(FetchGoal(pair, door) for pair, door in product(pairs, on.doors))
    goal = random.randrange(len(goals))
    others = [index for index in range(len(goals)) if index != goal]
    shown = [goal, *random.sample(others, GOALS_SHOWN - 1)]
    random.shuffle(shown)
    return Scenario(name, on, items, random.choice(CORRIDORS), charged, goals, goal, tuple(shown))
