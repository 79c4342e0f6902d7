"""The fast way finds what Fast Downward finds when it is called plainly on each belief.

MIRROR_EXPLAINER_BELIEFS sets how many random beliefs are tried (512 without).
"""

import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from random import Random

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from pddl_cases import random_space, with_changed_state

from mirror_explainer.experiments.planning_speed import every_belief, read_instance, uncertain_case
from mirror_explainer.planning import Belief, BeliefPlans, BeliefSpace, Planner, Status
from mirror_explainer.planning.downward import find_downward

BELIEFS_A_SPACE = 16  # 2 goals, 3 uncertain facts
BELIEFS_A_ROUND = 512
ROUNDS = -(-int(os.environ.get('MIRROR_EXPLAINER_BELIEFS', '512')) // BELIEFS_A_ROUND)
PUCRS = os.environ.get('MIRROR_EXPLAINER_PUCRS', '')


@pytest.fixture(scope='module')
def planner() -> Iterator[Planner]:
    with Planner('fast-downward-opt', planning_timeout=60.0) as planner:
        yield planner


def problem_of(space: BeliefSpace, belief: Belief) -> str:
    """Return one belief's problem as PDDL, made from the text alone."""
    problem = space.problem
    for fact in space.uncertain_facts:
        problem = problem.replace(fact, '')
    problem = re.sub(r'\(:init', f'(:init {" ".join(sorted(belief.true_facts))} ', problem)
    goal = f'(:goal {space.goals[belief.goal]})'
    before, after = problem.split('(:goal', 1)
    depth = 1
    for end, letter in enumerate(after):
        depth += {'(': 1, ')': -1}.get(letter, 0)
        if not depth:
            return f'{before}{goal}{after[end + 1 :]}'
    raise ValueError('the problem has no whole goal')


def plain_cost(space: BeliefSpace, belief: Belief, search: str) -> float | None:
    """Return the cost that Fast Downward itself finds for a belief, None if there is no plan."""
    downward = find_downward('')
    assert downward is not None
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / 'domain.pddl').write_text(space.domain)
        (Path(folder) / 'problem.pddl').write_text(problem_of(space, belief))
        translator = [sys.executable, '-m', 'fast_downward.translate']
        translated = subprocess.run(
            [*translator, 'domain.pddl', 'problem.pddl'],
            cwd=folder,
            capture_output=True,
            text=True,
        )
        assert translated.returncode == 0, translated.stdout + translated.stderr
        with (Path(folder) / 'output.sas').open() as task:
            command = [downward, '--search', search]
            searched = subprocess.run(
                command, cwd=folder, stdin=task, capture_output=True, text=True
            )
        assert searched.returncode in (0, 11), searched.stdout
        if searched.returncode == 11:
            return None
        return float((Path(folder) / 'sas_plan').read_text().split('; cost = ')[1].split()[0])


def plain_costs(space: BeliefSpace, beliefs: list[Belief], search: str) -> list[float | None]:
    """Return the referee's costs of several beliefs."""
    with ThreadPoolExecutor(os.cpu_count()) as threads:
        return list(threads.map(lambda belief: plain_cost(space, belief, search), beliefs))


def cost_of(result: BeliefPlans) -> float | None:
    assert result.status is not Status.UNKNOWN, result.reason
    if result.status is Status.UNSOLVABLE:
        return None
    assert result.plans[0].optimal
    return result.plans[0].cost


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
    assert report.planner_calls <= len(beliefs)

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
    instance = read_instance(sorted(Path(PUCRS).glob(name))[0])
    space = uncertain_case(planner, instance, 4, Random(name)).space
    asked = Random(name).sample(every_belief(space), 8)

    report = planner.plan(space, every_belief(space))

    found = dict(zip(every_belief(space), report.results, strict=True))
    search = 'astar(max([lmcut(),cegar(max_time=0.1)]))'
    assert [cost_of(found[belief]) for belief in asked] == plain_costs(space, asked, search)
