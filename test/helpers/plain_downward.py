"""Fast Downward called plainly on one belief after another: the referee of planning."""

import contextlib
import functools
import io
import multiprocessing
import os
import re
import subprocess
import tempfile
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

from mirror_explainer.planning import Belief, BeliefPlans, BeliefSpace, Status
from mirror_explainer.planning.downward.program import find_downward


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


def plain_cost(domain: str, problem: str, search: str) -> float | None:
    """Return the cost that Fast Downward itself finds, None if there is no plan.

    Its translator is called as its own program does, in a process of the pool below.
    """
    from fast_downward.translate import main
    from fast_downward.translate.options import set_options

    downward = find_downward('')
    assert downward is not None
    with tempfile.TemporaryDirectory() as name, contextlib.redirect_stdout(io.StringIO()):
        folder = Path(name)
        domain_file, problem_file, task_file = (folder / part for part in ('d', 'p', 'sas'))
        domain_file.write_text(domain)
        problem_file.write_text(problem)
        set_options([str(domain_file), str(problem_file), '--sas-file', str(task_file)])
        main.main()
        with task_file.open() as task:
            command = [downward, '--search', search]
            searched = subprocess.run(
                command, cwd=folder, stdin=task, capture_output=True, text=True
            )
        assert searched.returncode in (0, 11), searched.stdout
        if searched.returncode == 11:
            return None
        return float((folder / 'sas_plan').read_text().split('; cost = ')[1].split()[0])


@functools.cache
def _pool() -> ProcessPoolExecutor:
    """Processes, since the translator's options are global; kept, for they start slowly."""
    return ProcessPoolExecutor(os.cpu_count(), multiprocessing.get_context('spawn'))


def plain_costs(space: BeliefSpace, beliefs: list[Belief], search: str) -> list[float | None]:
    """Return the referee's costs of several beliefs."""
    problems = [problem_of(space, belief) for belief in beliefs]
    domains, searches = [space.domain] * len(problems), [search] * len(problems)
    return list(_pool().map(plain_cost, domains, problems, searches))


def cost_of(result: BeliefPlans) -> float | None:
    """Return the cost that our planner found, None if it proved that there is no plan."""
    assert result.status is not Status.UNKNOWN, result.reason
    if result.status is Status.UNSOLVABLE:
        return None
    assert result.plans[0].optimal
    return result.plans[0].cost
