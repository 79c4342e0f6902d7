"""A drafted user model beside the one that a person wrote for the same robot."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import yaml
from prepared import prepared

from mirror_explainer.commands.draft_user_model import main
from mirror_explainer.explainer import explain
from mirror_explainer.listener.goals import Part, parts_of
from mirror_explainer.listener.mirror_model import MirrorModel
from mirror_explainer.listener.preparation import Preparation
from mirror_explainer.listener.user_model import CandidateGoal, UserModel, read_user_model
from mirror_explainer.pddl import Task, goal_expression, read_task
from mirror_explainer.planning import Planner
from mirror_explainer.settings import Question

NUMBERS = (1, 2, 3)  # of sentences


@dataclass(frozen=True)
class Drafted:
    """What a draft has of the model by hand.

    `missing` are the names of goals that it lacks. Of the `by_hand` facts and groups of facts
    it `found` some, and `proposed` so many, those in comments included. `answers` are the plan
    positions that the robot tells of with at most 1, 2 and 3 sentences; `tied` says of each
    whether its listener would find the answer by hand as good.
    """

    missing: tuple[str, ...]
    by_hand: int
    found: int
    proposed: int
    answers: tuple[frozenset[int], ...]
    tied: tuple[bool, ...]


@dataclass(frozen=True)
class Robot:
    """A folder with `domain.pddl`, `problem.pddl`, `plan.txt`, and `user.yaml` by hand."""

    folder: Path
    planner: Planner

    @cached_property
    def task(self) -> Task:
        return read_task(self._read('domain.pddl'), self._read('problem.pddl'))

    @cached_property
    def by_hand(self) -> UserModel:
        return read_user_model(self.folder / 'user.yaml', self.task)

    @cached_property
    def model(self) -> MirrorModel:
        """The listener of the model by hand, all planned."""
        return self._prepared(self.by_hand).model

    @property
    def others(self) -> list[CandidateGoal]:
        """The goals by hand, but the robot's own."""
        own = frozenset(parts_of(self.task.goal, self.task.model))
        return [goal for goal in self.by_hand.goals if self._meaning(goal) != own]

    @cached_property
    def answers(self) -> tuple[frozenset[int], ...]:
        """The plan positions that are told of with the model by hand."""
        return _answers(self._prepared(self.by_hand))

    def drafted(self, seen: Sequence[CandidateGoal], folder: Path) -> Drafted:
        """Draft a model where these goals were seen once, in a folder for its files."""
        goals_seen, file = folder / 'seen.txt', folder / 'drafted.yaml'
        goals_seen.write_text('\n'.join(goal.goal for goal in seen))
        options = ['--goals-seen', str(goals_seen), '--output', str(file)]
        for name, text in (('domain', 'domain.pddl'), ('problem', 'problem.pddl')):
            options += [f'--{name}', str(self.folder / text)]
        assert main([*options, '--plan', str(self.folder / 'plan.txt')]) == 0
        user_model = read_user_model(file, self.task)
        # Groups are comments, for a person to choose from.
        groups = [
            set(yaml.safe_load(group)['facts'])
            for group in re.findall(r'^#\s+- (\{facts: .*\})$', file.read_text(), re.MULTILINE)
        ]
        facts = [
            fact for fact in self.by_hand.uncertain_facts if fact in user_model.uncertain_facts
        ]
        found = [group for group in self.by_hand.one_of if any(set(group) <= g for g in groups)]
        preparation = self._prepared(user_model)
        answers = _answers(preparation)
        return Drafted(
            self._missing(user_model),
            len(self.by_hand.uncertain_facts) + len(self.by_hand.one_of),
            len(facts) + len(found),
            len(user_model.uncertain_facts) + len(groups),
            answers,
            tuple(
                is_as_good(preparation.model, by_hand, told)
                for by_hand, told in zip(self.answers, answers, strict=True)
            ),
        )

    def ends(self, positions: frozenset[int]) -> frozenset[Part]:
        """Return the parts of the robot's goal that it brings about at these positions."""
        own = self.model.way.aims[self.model.true_goal][0]
        return frozenset(part for part, position in own.ends.items() if position in positions)

    def _missing(self, user_model: UserModel) -> tuple[str, ...]:
        """Return the names of the goals by hand that a draft does not have."""
        goals = {self._meaning(goal) for goal in user_model.goals}
        return tuple(goal.name for goal in self.by_hand.goals if self._meaning(goal) not in goals)

    def _prepared(self, user_model: UserModel) -> Preparation:
        return prepared(self.task, self._read('plan.txt'), user_model, self.planner)

    def _meaning(self, goal: CandidateGoal) -> frozenset[Part]:
        return frozenset(parts_of(goal_expression(self.task.model, goal.goal), self.task.model))

    def _read(self, name: str) -> str:
        return (self.folder / name).read_text()


def loss(model: MirrorModel, told: frozenset[int], best: frozenset[int]) -> float:
    """Return how many nats less an answer tells a listener than another."""
    return model.information_gain(sorted(best)) - model.information_gain(sorted(told))


def is_as_good(model: MirrorModel, told: frozenset[int], best: frozenset[int]) -> bool:
    """Say whether an answer tells a listener as much, but for what is not worth a sentence."""
    return loss(model, told, best) <= (model.listener.min_gain or 0.0)


def _answers(preparation: Preparation) -> tuple[frozenset[int], ...]:
    return tuple(frozenset(explain(preparation, Question(n=n)).positions) for n in NUMBERS)
