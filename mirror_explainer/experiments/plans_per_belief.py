"""How many plans a belief should get: what a selection loses that knows only some of them.

Run as `python3 -m mirror_explainer.experiments.plans_per_belief --pucrs DIR`; without
DIR, for the warehouse alone. The referee knows all optimal plans up to order, at most
1000 a belief; a selection with fewer plans gets a sample of these, as it would get one
from the planner. Prints Markdown tables.
"""

import argparse
import itertools
import json
import re
import statistics
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from random import Random

from mirror_explainer.errors import InputError, PlanningError
from mirror_explainer.experiments.planning_speed import (
    every_belief,
    uncertain_case,
    warehouse,
)
from mirror_explainer.experiments.planning_speed import read_instance as read_timed
from mirror_explainer.experiments.pucrs_dataset import find_instances, read_instance
from mirror_explainer.experiments.pucrs_protocol import draw_facts, draw_goals
from mirror_explainer.experiments.warehouse_files import warehouse_folder
from mirror_explainer.mirror_model import MirrorModel, mirror_model
from mirror_explainer.pddl import Task, read_task
from mirror_explainer.planning import Belief, BeliefPlans, BeliefSpace, Plan, Planner
from mirror_explainer.prior import belief_prior
from mirror_explainer.selection import most_informative
from mirror_explainer.sentences import Sentences, action_parameters
from mirror_explainer.user_model import CandidateGoal, UserModel, read_user_model

COUNTS = (1, 3, 10, 30, 100, 300)
SIZES = (1, 2, 3, 4)
REFEREE = 1000
_FACTS, _TIMED_FACTS = 2, 4
_DEADLINE = 60.0  # seconds
_BUDGET = 2.0  # seconds for one selection


@dataclass(frozen=True)
class Scene:
    """The robot's task and plan, and what the listener believes."""

    domain: str
    name: str
    task: Task
    plan: Plan
    user_model: UserModel


@dataclass(frozen=True)
class Choice:
    """What is said with so many plans a belief, and what the referee thinks of it, in nats.

    `changed` says, for each renaming of the objects, whether another set of
    sentences would have been said.
    """

    domain: str
    count: int
    size: int
    regret: float
    best: float
    changed: tuple[bool, ...]


@dataclass(frozen=True)
class Cold:
    """Seconds and searches of planning for 64 beliefs of a new problem."""

    domain: str
    count: int
    seconds: float
    searches: int


def pucrs_scene(planner: Planner, dataset: Path, domain: str, name: str) -> Scene:
    """Draw goals and facts of an instance of the data set, as in the paper's protocol."""
    [location] = [found for found in find_instances(dataset)[domain] if found.name == name]
    problem = read_instance(location, dataset)
    random = Random(name)
    draw = draw_goals(problem, planner, _DEADLINE, random, name)
    task = read_task(problem.domain, problem.problem(draw.goals[0]), name, name)
    facts = draw_facts(task, draw.plan, random, name)[:_FACTS]
    goals = tuple(CandidateGoal(goal, goal, 1 / len(draw.goals)) for goal in draw.goals)
    model = UserModel(goals, dict.fromkeys(facts, 0.5))
    return Scene(domain, name, task, draw.plan, model)


def warehouse_scene(planner: Planner) -> Scene:
    """Return the demo: the robot, and the operator who meets it, unsure of the battery."""
    folder = warehouse_folder()
    task = read_task((folder / 'domain.pddl').read_text(), (folder / 'problem.pddl').read_text())
    model = read_user_model(folder / 'user_model.yaml', task)
    prior = belief_prior(task, model)
    [own] = planner.plan(prior.space, [prior.beliefs[prior.robot_belief]]).results
    unsure = replace(model, uncertain_facts={'(charged)': 0.5})
    return Scene('warehouse', 'warehouse', task, own.plans[0], unsure)


def renamed(scene: Scene, random: Random) -> Scene:
    """Return the scene with other names for the objects, and nothing else changed."""
    taken = {
        *(action.name for action in scene.task.model.actions),
        *(fluent.name for fluent in scene.task.model.fluents),
        *(kind.name for kind in scene.task.model.user_types),
    }
    objects = sorted({item.name for item in scene.task.model.all_objects} - taken)
    numbers = random.sample(range(len(objects)), len(objects))
    names = {item: f'renamed{number:04}' for item, number in zip(objects, numbers, strict=True)}

    def other(text: str) -> str:
        return _with_names(text, names)

    model = scene.user_model
    task = read_task(other(scene.task.domain), other(scene.task.problem))
    return replace(
        scene,
        task=task,
        plan=replace(scene.plan, actions=tuple(map(other, scene.plan.actions))),
        user_model=UserModel(
            tuple(replace(goal, goal=other(goal.goal)) for goal in model.goals),
            {other(fact): share for fact, share in model.uncertain_facts.items()},
            templates={
                action: replace(
                    template,
                    when={
                        parameter: {other(item): said for item, said in wordings.items()}
                        for parameter, wordings in template.when.items()
                    },
                )
                for action, template in model.templates.items()
            },
            objects={names[item]: called for item, called in _called(scene, names).items()},
        ),
    )


def _called(scene: Scene, names: Mapping[str, str]) -> dict[str, str]:
    """Return what each renamed object is called in the sentences: as before."""
    readable = {item: item.replace('-', ' ').replace('_', ' ') for item in names}
    own = {item: said for item, said in scene.user_model.objects.items() if item in names}
    return {**readable, **own}


def _with_names(text: str, names: Mapping[str, str]) -> str:
    without_comments = re.sub(r';[^\n]*', '', text).lower()
    return re.sub(r'[^\s()]+', lambda word: names.get(word[0], word[0]), without_comments)


class Listener:
    """The mirror models of a scene, by how many plans a belief they have.

    Planning is done twice, for one plan a belief and for all that the referee knows.
    """

    def __init__(self, planner: Planner, scene: Scene) -> None:
        self._scene = scene
        self._prior = belief_prior(scene.task, scene.user_model)
        self._one, self._all = (
            planner.plan(self._prior.space, self._prior.beliefs, plans_per_belief=count).results
            for count in (1, REFEREE)
        )
        self._said: dict[tuple[int, int], tuple[int, ...]] = {}

    def said(self, count: int, size: int) -> tuple[int, ...]:
        """Return the positions of what is said with so many plans a belief."""
        largest = max(len(result.plans) for result in self._all)
        key = min(count, largest), size  # there are no more plans than these
        if key not in self._said:
            model = self.model(count)
            self._said[key] = most_informative(model.evidence(), size, _BUDGET).positions
        return self._said[key]

    def model(self, count: int) -> MirrorModel:
        """Return the mirror model with so many plans a belief."""
        model = self._scene.user_model
        found = self._one if count == 1 else [_sampled(result, count) for result in self._all]
        sentences = Sentences(action_parameters(self._scene.task), model.templates, model.objects)
        return mirror_model(self._prior, found, self._scene.plan, sentences, model.rationality)


def _sampled(result: BeliefPlans, count: int) -> BeliefPlans:
    if len(result.plans) <= count:
        return result
    return replace(result, plans=tuple(Random(0).sample(result.plans, count)))


def choices(planner: Planner, scene: Scene, renamings: int) -> Iterator[Choice]:
    """Yield what is said with each number of plans, and with each number of sentences."""
    listener = Listener(planner, scene)
    referee = listener.model(REFEREE)
    sizes = [size for size in SIZES if size <= len(scene.plan.actions)]
    best = {size: referee.information_gain(listener.said(REFEREE, size)) for size in sizes}
    others = [
        Listener(planner, renamed(scene, Random(f'{scene.name} {number}')))
        for number in range(renamings)
    ]
    for count, size in itertools.product(COUNTS, sizes):
        said = listener.said(count, size)
        yield Choice(
            scene.domain,
            count,
            size,
            max(0.0, best[size] - referee.information_gain(said)),
            best[size],
            tuple(
                _sentences(referee, other.said(count, size)) != _sentences(referee, said)
                for other in others
            ),
        )


def _sentences(model: MirrorModel, positions: Sequence[int]) -> list[str]:
    return sorted(model.sentences[position] for position in positions)


def cold(domain: str, space: BeliefSpace, count: int) -> Cold:
    """Measure planning for all beliefs of a space by a planner that knows another problem."""
    other = warehouse()
    with Planner() as planner:
        planner.plan(BeliefSpace(other.domain, other.problem, other.goals), [Belief(0)])
        began = time.perf_counter()
        report = planner.plan(space, every_belief(space), plans_per_belief=count)
        seconds = time.perf_counter() - began
    return Cold(domain, count, seconds, report.planner_calls)


def regret_table(found: Sequence[Choice]) -> str:
    """Return the regret as Markdown: mean and worst in nats, and share of the referee's best."""
    lines = [
        '| domain | plans a belief | '
        + ' | '.join(f'N = {size}: mean, worst' for size in SIZES)
        + ' | share of the best |',
        '|---|---' + '|---' * (len(SIZES) + 1) + '|',
    ]
    for domain in _domains(found):
        for count in COUNTS:
            own = [c for c in found if (c.domain, c.count) == (domain, count)]
            cells = [_nats([c.regret for c in own if c.size == size]) for size in SIZES]
            lines.append(f'| {domain} | {count} | {" | ".join(cells)} | {_share(own):.1%} |')
    return '\n'.join(lines)


def _nats(regrets: Sequence[float]) -> str:
    return f'{statistics.mean(regrets):.2f}, {max(regrets):.2f}' if regrets else '–'


def _share(found: Sequence[Choice]) -> float:
    """Return the summed regret as a share of the summed best."""
    best = sum(choice.best for choice in found)
    return sum(choice.regret for choice in found) / best if best > 0 else 0.0


def renaming_table(found: Sequence[Choice]) -> str:
    """Return how often renaming the objects changes the sentences said, as Markdown."""

    def changed(domain: str, count: int) -> str:
        own = [c.changed for c in found if c.count == count and domain in (c.domain, 'all')]
        cases = [each for one in own for each in one]
        return f'{statistics.mean(cases):.1%} of {len(cases)}' if cases else '–'

    return _by_count([*_domains(found), 'all'], changed)


def cold_table(found: Sequence[Cold]) -> str:
    """Return the seconds of cold planning, as Markdown."""

    def seconds(domain: str, count: int) -> str:
        own = [c for c in found if c.count == count and domain in (c.domain, 'all')]
        times = [c.seconds for c in own]
        searches = statistics.median(c.searches for c in own)
        return f'{statistics.median(times):.2f}, {max(times):.2f} ({searches:.0f})'

    return _by_count([*dict.fromkeys(c.domain for c in found), 'all'], seconds)


def _domains(found: Sequence[Choice]) -> list[str]:
    return list(dict.fromkeys(choice.domain for choice in found))


def _by_count(domains: Sequence[str], cell: Callable[[str, int], str]) -> str:
    lines = [
        f'| domain | {" | ".join(f"k = {count}" for count in COUNTS)} |',
        '|---' * (len(COUNTS) + 1) + '|',
    ]
    for domain in domains:
        lines.append(f'| {domain} | {" | ".join(cell(domain, count) for count in COUNTS)} |')
    return '\n'.join(lines)


def _easy_instances(dataset: Path, limit: int) -> Iterator[tuple[str, str]]:
    """Yield domain and name of the instances that optimal planning finishes, some a domain."""
    taken: dict[str, int] = {}
    for entry in json.loads((dataset / 'manifest.json').read_text())['instances']:
        domain = entry['domain']
        if entry['lmcut_tier'] != 'hard' and taken.get(domain, 0) < limit:
            taken[domain] = taken.get(domain, 0) + 1
            yield domain, entry['instance']


def _said(options: argparse.Namespace, names: Sequence[tuple[str, str]]) -> Iterator[Choice]:
    """Yield the choices in the warehouse and in the instances named."""
    for domain, name in [('', 'warehouse'), *names]:
        _tell(name)
        with Planner(planning_timeout=30.0) as planner:
            try:
                scene = (
                    pucrs_scene(planner, options.pucrs, domain, name)
                    if domain
                    else warehouse_scene(planner)
                )
                yield from choices(planner, scene, options.renamings)
            except (InputError, PlanningError) as error:
                _tell(f'left out: {name}: {error}')


def _timed(options: argparse.Namespace, names: Sequence[tuple[str, str]]) -> Iterator[Cold]:
    """Yield the times in the warehouse and in the instances named."""
    instances = [('warehouse', warehouse())]
    instances += [(domain, read_timed(options.pucrs / domain / name)) for domain, name in names]
    for domain, instance in instances:
        _tell(f'time of {instance.name}')
        with Planner() as planner:
            case = uncertain_case(planner, instance, _TIMED_FACTS, Random(instance.name))
        for count in COUNTS:
            yield cold(domain, case.space, count)


def _tell(text: str) -> None:
    print(text, file=sys.stderr, flush=True)


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--pucrs', type=Path, help='folder of the PUCRS instances')
    parser.add_argument('--limit', type=int, default=1000, help='instances of each domain')
    parser.add_argument('--renamings', type=int, default=2, help='of the objects, a scene')
    parser.add_argument('--only', choices=['choices', 'times'], help='measure these alone')
    options = parser.parse_args()
    names = list(_easy_instances(options.pucrs, options.limit)) if options.pucrs else []
    if options.only != 'times':
        said = list(_said(options, names))
        print('Information gain lost, in nats, under a referee that knows all plans:\n')
        print(regret_table(said))
        print('\nHow often renaming the objects changes what is said:\n')
        print(renaming_table(said), flush=True)
    if options.only != 'choices':
        print('\nCold planning for 64 beliefs, s: median, worst (searches in the median):\n')
        print(cold_table(list(_timed(options, names))))


if __name__ == '__main__':
    main()
