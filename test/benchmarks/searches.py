"""Each search of the portfolio by itself, on tasks of several kinds: `scripts/benchmark searches`.

Prints the table of docs/planning.md: seconds of processor time for the first belief of some of
the robots that planning is measured on, and, where MIRROR_EXPLAINER_PUCRS is a folder with the
data set, for the robot's goal of some of its problems, those that are there. A search that has
not ended after 6 s has no time.
"""

import os
from collections.abc import Iterator
from pathlib import Path

import pandas as pd

from mirror_explainer.experiments.benchmark.dataset import find_instances
from mirror_explainer.experiments.markdown import markdown_table
from mirror_explainer.experiments.planning.cases import pucrs_instance
from mirror_explainer.experiments.planning.plain_searches import seconds_of, translated
from mirror_explainer.experiments.planning.robots import robots
from mirror_explainer.planning import Belief, BeliefSpace
from mirror_explainer.planning.downward.portfolio import AXIOMS, PLAIN
from mirror_explainer.planning.downward.program import find_downward

SEARCHES = ('landmarks and patterns', 'LM-cut', 'merge-and-shrink', 'blind')
ROBOTS = (
    '12 parts to mount',
    'hospital, 3 packs',
    'one hand, 4 of 10',
    'map of 500 places',
    'drone over 49 places',
)
PUCRS = ('satellite_p04_hyp-1', 'miconic_p06_hyp-1', 'logistics_p05_hyp-1', 'rovers_p04_hyp-1')
LIMIT = 6.0


def tasks() -> Iterator[tuple[str, BeliefSpace, Belief]]:
    """Yield what a task is called, and the belief that is planned for."""
    for robot in robots():
        if robot.name in ROBOTS:
            yield robot.name, robot.space, robot.beliefs[0]
    dataset = Path(os.environ.get('MIRROR_EXPLAINER_PUCRS', ''))
    found = find_instances(dataset) if dataset.name else {}
    locations = [location for each in found.values() for location in each]
    for location in sorted(locations, key=lambda location: location.name):
        if location.name in PUCRS:
            instance = pucrs_instance(location, dataset)
            space = BeliefSpace(instance.domain, instance.problem, instance.goals)
            yield location.name, space, Belief(0)


def main() -> None:
    """Print the table."""
    program = find_downward('')
    assert program, "Fast Downward's search is not installed"
    rows = []
    for name, space, belief in tasks():
        task = translated(space, belief)
        took = [
            seconds_of([program, '--search', search], task, LIMIT) for search in (*PLAIN, *AXIOMS)
        ]
        rows.append([name, *('–' if each is None else f'{each:.2f}' for each in took)])
    print(markdown_table(pd.DataFrame(rows, columns=['task', *SEARCHES])))


if __name__ == '__main__':
    main()
