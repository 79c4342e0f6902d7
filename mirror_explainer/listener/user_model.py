"""The user model's YAML in: what the listener believes about the robot, P(B) of P_R^H.

All faults of a file are reported in one error, each with its line.
"""

import math
import os
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from pydantic import ValidationError

from mirror_explainer.input_limits import InputLimits
from mirror_explainer.listener.listeners import LISTENERS, OPEN, Listener
from mirror_explainer.listener.patterns import written_out
from mirror_explainer.listener.phrases import Phrases
from mirror_explainer.listener.slips import slips
from mirror_explainer.listener.user_model_checks import (
    atoms,
    candidate_goals,
    canonical,
    fact_faults,
    phrase_text_faults,
    sentence_faults,
)
from mirror_explainer.listener.user_model_file import (
    GoalEntry,
    SentenceEntry,
    Tenses,
    UserModelFile,
    faults_error,
    parse_yaml,
    schema_fault,
    text_faults,
)
from mirror_explainer.listener.wording import Template, Wording
from mirror_explainer.pddl import Task
from mirror_explainer.text_files import read_text


@dataclass(frozen=True)
class CandidateGoal:
    """A goal that the user thinks the robot may have: P(G = goal) = probability."""

    name: str
    goal: str
    probability: float


@dataclass(frozen=True)
class UserModel:
    """P(B) = P(I) P(G) of the second-order theory of mind, and how actions are said.

    `uncertain_facts` are independent Bernoulli variables, atom → P(atom holds).
    Of each group in `one_of` exactly one fact holds, atom → probability.
    `rationality` is β of R(π, b), in 1/cost unit. `goals_seen` says that the listener knows
    which goals the robot had before (`goals_seen.py`).
    """

    goals: tuple[CandidateGoal, ...]
    uncertain_facts: Mapping[str, float] = field(default_factory=dict)
    one_of: tuple[Mapping[str, float], ...] = ()
    rationality: float = 1.0
    unlisted_goal_probability: float = 0.05
    goals_seen: bool = False
    listener: Listener = OPEN
    templates: Mapping[str, Template] = field(default_factory=dict)
    objects: Mapping[str, str] = field(default_factory=dict)
    phrases: Phrases = field(default_factory=Phrases)

    @property
    def fact_probabilities(self) -> dict[str, float]:
        """The probability that each fact holds which is uncertain, by itself or in a group."""
        groups = {fact: p for group in self.one_of for fact, p in group.items()}
        return {**self.uncertain_facts, **groups}


def read_user_model(
    path: str | os.PathLike[str],
    task: Task | None = None,
    read: Callable[[str], str] = read_text,
    limits: InputLimits | None = None,
) -> UserModel:
    """Read a user model's YAML file, and check it against the task's domain if one is given.

    `read` reads the file, and the `hyps_file` that it may name. Raises InputError
    with all faults: unknown keys, wrong types, atoms, actions or parameters that
    the domain does not have; or for more than the limits allow.
    """
    source = os.fspath(path)
    root, values = parse_yaml(read(source), source)
    plain = written_out(values, task)
    faults = [*text_faults(root), *plain.faults]
    if plain.faults:  # what patterns stand for is not known: the rest is checked without them
        plain = written_out(values, None)
    data = plain.data
    try:
        file: UserModelFile | None = UserModelFile.model_validate(data)
    except ValidationError as error:
        file = None
        slipped = [*slips(values)]
        told = {fault.path[:2] for fault in slipped}
        others = map(plain.placed, map(schema_fault, error.errors()))
        faults += [*slipped, *(fault for fault in others if fault.path[:2] not in told)]
    goals, goal_faults = candidate_goals(data, Path(path), task, read)
    if limits:
        limits.require('max_goals', len(goals), 'its goals', source)
        facts = sum(1 for _ in atoms(data))
        limits.require('max_uncertain_facts', facts, 'its uncertain facts', source)
    faults += map(plain.placed, [*goal_faults, *fact_faults(data, task)])
    if task is not None:
        actions = {a.name: tuple(p.name for p in a.parameters) for a in task.model.actions}
        faults += sentence_faults(data, actions, {kind.name for kind in task.model.user_types})
    faults += phrase_text_faults(data)
    patterns = {(fault.path[0],) for fault in plain.faults}
    faults = [fault for fault in faults if fault.path not in patterns]  # such as: there are none
    if faults or file is None:
        raise faults_error(source, faults, root)
    return _user_model(file, goals)


def _user_model(file: UserModelFile, goals: Sequence[GoalEntry]) -> UserModel:
    """Return the normalised values of a file without faults."""
    weights = [1.0 if goal.probability is None else goal.probability for goal in goals]
    return UserModel(
        goals=tuple(
            CandidateGoal(goal.name or goal.goal, goal.goal, probability)
            for goal, probability in zip(goals, _normalised(weights), strict=True)
        ),
        uncertain_facts={canonical(f.fact): f.probability for f in file.uncertain_facts},
        one_of=tuple(
            dict(zip(map(canonical, group.facts), _normalised(group.facts.values()), strict=True))
            for group in file.one_of
        ),
        rationality=file.rationality,
        unlisted_goal_probability=file.unlisted_goal_probability,
        goals_seen=file.goals_seen,
        listener=replace(
            LISTENERS[file.listener.kind], **file.listener.model_dump(exclude_none=True)
        ),
        templates={action.lower(): _template(entry) for action, entry in file.sentences.items()},
        objects={name.lower(): called for name, called in file.objects.items()},
        phrases=Phrases.of(file.phrases),
    )


def _template(entry: SentenceEntry) -> Template:
    wording = _wording(entry.template) if entry.template else _wording(entry)
    return Template(
        wording,
        {
            parameter: {item.lower(): _wording(said) for item, said in by_object.items()}
            for parameter, by_object in entry.when.items()
        },
    )


def _wording(said: Tenses | SentenceEntry) -> Wording:
    return Wording(said.future or '', said.present, said.past)


def _normalised(weights: Collection[float]) -> list[float]:
    """Return the weights as probabilities; their sum may be beyond what a float can hold."""
    largest = max(weights)
    total = math.fsum(weight / largest for weight in weights)
    return [weight / largest / total for weight in weights]
