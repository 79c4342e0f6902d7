"""The tasks of "who understands what": the PUCRS data set's, and those of our own robots."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from random import Random

from mirror_explainer.experiments.benchmark.dataset import (
    RecognitionProblem,
    find_instances,
    read_instance,
)
from mirror_explainer.experiments.benchmark.ground_actions import hearing_ground_actions
from mirror_explainer.experiments.benchmark.protocol import FACT_PROBABILITY
from mirror_explainer.experiments.understanding.robots import ROBOTS
from mirror_explainer.listener.user_model import CandidateGoal, UserModel
from mirror_explainer.pddl import Task

PUCRS, OWN = 'PUCRS', 'our robots'


@dataclass(frozen=True)
class DrawnTask:
    """A goal recognition problem; goals and facts of the listener are drawn by the seed."""

    group: str
    domain: str
    name: str
    problem: RecognitionProblem
    seed: str

    @property
    def world(self) -> str:
        """What tasks have in common whose robots are in the same world."""
        texts = f'{self.problem.domain}{self.problem.template}'
        return sha256(texts.encode()).hexdigest()[:12]

    def user_model(self, task: Task, goals: Sequence[str], facts: Sequence[str]) -> UserModel:
        """Return who listens: to ground actions in the data set, to our robots' sentences."""
        uncertain = dict.fromkeys(facts, FACT_PROBABILITY)
        if self.group == PUCRS:
            return hearing_ground_actions(task, goals, uncertain)
        return UserModel(
            tuple(CandidateGoal(goal, goal, 1 / len(goals)) for goal in goals), uncertain
        )


def pucrs_tasks(dataset: Path, instances: int, seed: int) -> Iterator[DrawnTask]:
    """Draw so many instances of each domain of the data set."""
    for domain, locations in find_instances(dataset).items():
        shuffled = Random(f'{seed}/{domain}').sample(locations, len(locations))
        for location in shuffled[:instances]:
            problem = read_instance(location, dataset)
            yield DrawnTask(
                PUCRS, domain, location.name, problem, f'{seed}/{domain}/{location.name}'
            )


def own_tasks(instances: int, seed: int) -> Iterator[DrawnTask]:
    """Draw so many tasks of each of our robots, each in a world of its own."""
    for robot, draw in ROBOTS.items():
        for number in range(1, instances + 1):
            name = f'{robot}-{number}'
            yield DrawnTask(OWN, robot, name, draw(Random(f'{seed}/{name}')), f'{seed}/{name}')
