"""How many plans a belief should get: what a selection loses that knows only some of them.

Run as `python3 -m mirror_explainer.experiments.planning.plans_per_belief --pucrs DIR`; without
DIR, for the warehouse alone. The referee knows all optimal plans up to order, at most
1000 a belief; a selection with fewer plans gets a sample of these, as it would get one
from the planner. Prints Markdown tables.
"""

import argparse
import itertools
import sys
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from random import Random

from mirror_explainer.commands.command_line import command_parser
from mirror_explainer.commands.extras import MissingExtras, require_extras
from mirror_explainer.commands.options import whole
from mirror_explainer.commands.terminal import tell_error
from mirror_explainer.errors import InputError, PlanningError
from mirror_explainer.experiments.benchmark.dataset import Location, listed_locations
from mirror_explainer.experiments.planning.cases import (
    pucrs_instance,
    running_planner,
    timed,
    uncertain_case,
    warehouse,
)
from mirror_explainer.experiments.planning.plans_scenes import (
    Scene,
    pucrs_scene,
    renamed,
    warehouse_scene,
)
from mirror_explainer.experiments.planning.plans_tables import (
    COUNTS,
    Choice,
    Cold,
    cold_table,
    regret_table,
    renaming_table,
)
from mirror_explainer.explainer import robot_plan
from mirror_explainer.listener.listeners import PLANNER
from mirror_explainer.listener.mirror_model import MirrorModel
from mirror_explainer.listener.preparation import way_of
from mirror_explainer.listener.prior import belief_prior
from mirror_explainer.listener.sentences import sentences_for
from mirror_explainer.listener.weighing import mirror_model
from mirror_explainer.planning import BeliefPlans, BeliefSpace, Planner
from mirror_explainer.selection.choice import most_informative

REFEREE = 1000
_SIZES = (1, 2, 3, 4)  # how many sentences are said
_TIMED_FACTS = 4
_BUDGET = 2.0  # seconds for one selection


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
            self._said[key] = most_informative(model.evidence(), size, budget=_BUDGET).positions
        return self._said[key]

    def model(self, count: int) -> MirrorModel:
        """Return the mirror model with so many plans a belief."""
        model = self._scene.user_model
        found = self._one if count == 1 else [_sampled(result, count) for result in self._all]
        scene, prior = self._scene, self._prior
        sentences = sentences_for(scene.task, model, scene.plan.actions)
        own = robot_plan(scene.task, '\n'.join(scene.plan.actions), scene.name)
        return mirror_model(
            prior,
            dict(zip(prior.beliefs, found, strict=True)),
            way_of(scene.task, own, prior, sentences),
            PLANNER,
            model.rationality,
            one_plan=count == 1,
        )


def _sampled(result: BeliefPlans, count: int) -> BeliefPlans:
    if len(result.plans) <= count:
        return result
    return replace(result, plans=tuple(Random(0).sample(result.plans, count)))


def choices(planner: Planner, scene: Scene, renamings: int) -> Iterator[Choice]:
    """Yield what is said with each number of plans, and with each number of sentences."""
    listener = Listener(planner, scene)
    referee = listener.model(REFEREE)
    sizes = [size for size in _SIZES if size <= len(scene.plan.actions)]
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
    with running_planner() as planner:
        seconds, report = timed(planner, space, plans_per_belief=count)
    return Cold(domain, count, seconds, report.planner_calls)


def _easy_instances(dataset: Path, limit: int, named: str) -> list[Location]:
    """Return the instances so named that optimal planning finishes, some of each domain."""
    found = [where for where in listed_locations(dataset, hard=False) if named in where.name]
    domains = [location.domain for location in found]
    return [
        location
        for index, location in enumerate(found)
        if domains[:index].count(location.domain) < limit
    ]


def _said(options: argparse.Namespace, locations: Sequence[Location]) -> Iterator[Choice]:
    """Yield the choices in the warehouse and in the instances there."""
    own = [None] if options.problems in 'warehouse' else []
    for location in (*own, *locations):
        name = location.name if location else 'warehouse'
        _tell(name)
        with Planner(planning_timeout=30.0) as planner:
            try:
                scene = (
                    pucrs_scene(planner, location, options.pucrs)
                    if location
                    else warehouse_scene(planner)
                )
                yield from choices(planner, scene, options.renamings)
            except (InputError, PlanningError) as error:
                _tell(f'left out: {name}: {error}')


def _timed(options: argparse.Namespace, locations: Sequence[Location]) -> Iterator[Cold]:
    """Yield the times in the warehouse and in the instances there."""
    known = [warehouse()] if options.problems in 'warehouse' else []
    for instance in (*known, *(pucrs_instance(where, options.pucrs) for where in locations)):
        _tell(f'time of {instance.name}')
        with Planner() as planner:
            case = uncertain_case(planner, instance, _TIMED_FACTS, Random(instance.name))
        for count in COUNTS:
            yield cold(instance.domain_name, case.space, count)


def _tell(text: str) -> None:
    print(text, file=sys.stderr, flush=True)


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure and print; return 0, or 2 for bad input, told on stderr."""
    options = _parser().parse_args(arguments)
    try:
        _measure(options)
    except (InputError, PlanningError, MissingExtras, OSError) as error:
        tell_error('plans_per_belief', error)
        return 2
    except KeyboardInterrupt:
        return 130
    return 0


def _measure(options: argparse.Namespace) -> None:
    locations = (
        _easy_instances(options.pucrs, options.limit, options.problems) if options.pucrs else []
    )
    require_extras('plans')
    if options.only != 'times':
        said = list(_said(options, locations))
        print('Information gain lost under a referee that knows all: share, and worst in nats:\n')
        print(regret_table(said))
        print('\nHow often renaming the objects changes what is said:\n')
        print(renaming_table(said), flush=True)
    if options.only != 'choices':
        print('\nCold planning for 64 beliefs, s: median, worst (searches in the median):\n')
        print(cold_table(list(_timed(options, locations))))


def _parser() -> argparse.ArgumentParser:
    command = 'python3 -m mirror_explainer.experiments.planning.plans_per_belief'
    parser = command_parser(
        'plans_per_belief',
        'Measure what a selection loses that knows only some plans of each belief.',
        command,
        f'{command} --only choices --renamings 1',
    )
    parser.add_argument('--pucrs', type=Path, help='folder of the PUCRS instances')
    parser.add_argument('--limit', type=whole(1), default=1000, help='instances of each domain')
    parser.add_argument('--problems', default='', help='only those whose name contains this')
    parser.add_argument('--renamings', type=whole(0), default=2, help='of the objects, a scene')
    parser.add_argument('--only', choices=['choices', 'times'], help='measure these alone')
    return parser


if __name__ == '__main__':
    sys.exit(main())
