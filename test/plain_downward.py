"""Fast Downward called plainly on one belief after another: the referee of planning."""

import os
import re
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from mirror_explainer.planning import Belief, BeliefPlans, BeliefSpace, Status
from mirror_explainer.planning.downward import find_downward


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
    """Return the cost that our planner found, None if it proved that there is no plan."""
    assert result.status is not Status.UNKNOWN, result.reason
    if result.status is Status.UNSOLVABLE:
        return None
    assert result.plans[0].optimal
    return result.plans[0].cost
