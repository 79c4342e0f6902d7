"""The fast way finds what Fast Downward finds when it is called plainly on each belief.

MIRROR_EXPLAINER_BELIEFS sets how many random beliefs are tried (320 without).
"""

import os
from collections.abc import Iterator
from fnmatch import fnmatch
from pathlib import Path
from random import Random

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from pddl_cases import random_space, with_changed_state
from plain_downward import cost_of, plain_costs

from mirror_explainer.experiments.benchmark.dataset import find_instances
from mirror_explainer.experiments.planning.cases import (
    every_belief,
    pucrs_instance,
    uncertain_case,
)
from mirror_explainer.planning import Planner

BELIEFS_A_SPACE = 16  # 2 goals, 3 uncertain facts
BELIEFS_A_ROUND = 320
ROUNDS = -(-int(os.environ.get('MIRROR_EXPLAINER_BELIEFS', '320')) // BELIEFS_A_ROUND)
PUCRS = os.environ.get('MIRROR_EXPLAINER_PUCRS', '')


@pytest.fixture(scope='module')
def planner() -> Iterator[Planner]:
    with Planner('fast-downward-opt', planning_timeout=60.0) as planner:
        yield planner


@pytest.mark.parametrize('number', range(ROUNDS))
@settings(
    max_examples=BELIEFS_A_ROUND // BELIEFS_A_SPACE,
    derandomize=True,
    deadline=None,
    suppress_health_check=list(HealthCheck),
    database=None,
)
@given(seed=st.integers(0, 2**32))
def test_random_beliefs_cost_what_fast_downward_says(
    planner: Planner, number: int, seed: int
) -> None:
    space = random_space(Random(f'{number} {seed}'))
    beliefs = every_belief(space)
    assert len(beliefs) == BELIEFS_A_SPACE

    report = planner.plan(space, beliefs)

    expected = plain_costs(space, beliefs, 'astar(blind())')
    assert [cost_of(result) for result in report.results] == expected
    # A search a belief, and a second one where the first was slow.
    assert report.planner_calls <= 2 * len(beliefs)

    # The same once the world has changed a little, so that the grounding may be kept.
    random = Random(seed)
    moved = with_changed_state(space, random)
    report = planner.plan(moved, beliefs)

    asked = random.sample(beliefs, 4)
    found = dict(zip(beliefs, map(cost_of, report.results), strict=True))
    assert [found[belief] for belief in asked] == plain_costs(moved, asked, 'astar(blind())')


@pytest.mark.skipif(not PUCRS, reason='MIRROR_EXPLAINER_PUCRS does not name the PUCRS problems')
@pytest.mark.parametrize(
    'name',
    [
        'blocks-world/block-words_p01_hyp-1',
        'intrusion-detection/*p10_hyp-1',
        'logistics/logistics_p02_hyp-1',
        'miconic/miconic_p01_hyp-1',
        'rovers/rovers_p01_hyp-1',
        'satellite/*_p0[1-3]*',
    ],
)
def test_beliefs_of_a_goal_recognition_problem_cost_what_fast_downward_says(
    planner: Planner, name: str
) -> None:
    domain, pattern = name.split('/')
    locations = find_instances(Path(PUCRS))[domain]
    location = next(found for found in locations if fnmatch(found.name, pattern))
    instance = pucrs_instance(location, Path(PUCRS))
    space = uncertain_case(planner, instance, 4, Random(name)).space
    asked = Random(name).sample(every_belief(space), 8)

    report = planner.plan(space, every_belief(space))

    found = dict(zip(every_belief(space), report.results, strict=True))
    search = 'astar(max([lmcut(),cegar(max_time=0.1)]))'
    assert [cost_of(found[belief]) for belief in asked] == plain_costs(space, asked, search)
