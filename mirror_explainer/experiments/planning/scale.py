"""How planning grows with the robot: families of tasks in three sizes each, beside other ways.

Run as `python3 -m mirror_explainer.experiments.planning.scale`. Prints Markdown tables. Of the
other planners those are in it that are installed (`plain_searches.py`).
"""

import argparse
import math
import multiprocessing
import resource
import statistics
import subprocess
import sys
import time
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path

from mirror_explainer.commands.command_line import command_parser
from mirror_explainer.commands.extras import MissingExtras, require_extras
from mirror_explainer.commands.options import number, whole
from mirror_explainer.commands.terminal import tell_error
from mirror_explainer.errors import PlanningError
from mirror_explainer.experiments.planning.cases import after_step, problem_of, running_planner
from mirror_explainer.experiments.planning.plain_searches import (
    PEERS,
    best_single,
    peer_seconds,
    translated,
)
from mirror_explainer.experiments.planning.robots import Robot, robots
from mirror_explainer.experiments.planning.scale_tables import (
    Row,
    Searches,
    draw,
    searches_table,
    table,
)
from mirror_explainer.experiments.planning.speed import naive
from mirror_explainer.explainer import explain, robot_plan
from mirror_explainer.listener.preparation import prepare
from mirror_explainer.listener.user_model import CandidateGoal, UserModel
from mirror_explainer.pddl import read_task
from mirror_explainer.planning import Belief, BeliefSpace, Status

_GOALS = 4  # that plain searches are made for
_DEADLINE = 120.0  # seconds
_IMPORT = (sys.executable, '-c', 'import unified_planning.shortcuts')


def measure(robot: Robot, sample: int, limit: float) -> Row:
    """Measure one robot: `sample` beliefs naively, calls and plain searches for `limit` s each."""
    began = time.perf_counter()
    subprocess.run(_IMPORT, check=True)
    unit = time.perf_counter() - began
    told_at: list[float] = []
    with running_planner() as planner:
        began = time.perf_counter()
        report = planner.plan(
            robot.space,
            robot.beliefs,
            deadline=_DEADLINE,
            found=lambda *_: told_at.append(time.perf_counter() - began),
        )
        took = time.perf_counter() - began
        own = report.results[0].plans[0].actions
        stepped = after_step(robot.space, robot.beliefs[0], own[0])
        began = time.perf_counter()
        planner.plan(stepped, robot.beliefs, deadline=_DEADLINE)
        step = time.perf_counter() - began
    asked = robot.beliefs[:: max(1, len(robot.beliefs) // sample)][:sample]
    called = _called(robot.space, asked, limit)
    return Row(
        robot.name,
        len(robot.beliefs),
        sum(result.status is Status.UNKNOWN for result in report.results),
        unit,
        _answered(robot, own),
        told_at[0],
        took,
        step,
        report.planner_calls,
        report.searching,
        statistics.mean(called) * len(robot.beliefs),
        max(called) < limit,
        _searches(robot, limit),
    )


def _called(space: BeliefSpace, beliefs: Sequence[Belief], limit: float) -> list[float]:
    """Return the seconds of one unified-planning call for each belief.

    In a process of its own: where there are many places, the engine may not even come to the
    end of writing its problem within the limit.
    """
    spawn = multiprocessing.get_context('spawn')
    most = limit * len(beliefs)
    with ProcessPoolExecutor(1, spawn, _limit_processor_time, (most,)) as process:
        try:
            return process.submit(_call, space, beliefs, limit).result()
        except BrokenProcessPool:
            return [limit]


def _limit_processor_time(seconds: float) -> None:
    """Let this process, and each that it starts, have about so many seconds more."""
    most = math.ceil(time.process_time() + seconds)
    resource.setrlimit(resource.RLIMIT_CPU, (most, most))


def _call(space: BeliefSpace, beliefs: Sequence[Belief], limit: float) -> list[float]:
    return [seconds for seconds, _ in naive(space, beliefs, limit)]


def _answered(robot: Robot, plan: Sequence[str]) -> float:
    """Return the seconds from a robot's texts to an answer with nothing planned.

    The second time: what a process loads once is not counted.
    """
    space, belief = robot.space, robot.beliefs[0]
    goals = tuple(CandidateGoal(goal, goal, 1 / len(space.goals)) for goal in space.goals)
    facts = dict.fromkeys(sorted({*space.uncertain_facts} - {*robot.group}), 0.8)
    groups = (dict.fromkeys(robot.group, 1 / len(robot.group)),) if robot.group else ()
    problem, steps = problem_of(space, belief), '\n'.join(plan)
    took = 0.0
    for _ in range(2):
        began = time.perf_counter()
        task = read_task(space.domain, problem)
        user_model = UserModel(goals, facts, groups)
        explain(prepare(task, robot_plan(task, steps), user_model))
        took = time.perf_counter() - began
    return took


def _searches(robot: Robot, limit: float) -> Searches:
    """Measure searches for some goals, all uncertain facts true, alone and by other planners."""
    goals = [Belief(goal, robot.beliefs[0].true_facts) for goal in range(_GOALS)]
    with running_planner() as planner:
        here = planner.plan(robot.space, goals, deadline=_DEADLINE).worked
    tasks = [translated(robot.space, belief) for belief in goals]
    return Searches(
        len(goals),
        here,
        best_single(tasks, limit),
        {
            peer.name: peer_seconds(peer, program, tasks, limit)
            for peer in PEERS
            if (program := peer.found())
        },
    )


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure and print; return 0, or 2 where planning fails, told on stderr."""
    options = _parser().parse_args(arguments)
    try:
        if options.figure:
            require_extras('experiments')
        rows = []
        for robot in robots():
            if options.only in robot.name:
                rows.append(measure(robot, options.sample, options.limit))
                print(f'{robot.name}: {rows[-1].all:.2f} s', file=sys.stderr)
        if rows:
            print(f'{table(rows)}\n\n{searches_table(rows)}')
            if options.figure:
                draw(rows, options.figure)
    except (PlanningError, MissingExtras, OSError) as error:
        tell_error('scale', error)
        return 2
    except KeyboardInterrupt:
        return 130
    return 0


def _parser() -> argparse.ArgumentParser:
    command = 'python3 -m mirror_explainer.experiments.planning.scale'
    parser = command_parser(
        'scale',
        'Measure planning for robots of growing size.',
        command,
        f'{command} --sample 1 --limit 5',
        ends='Exit status: 0, or 2 where planning fails.',
    )
    parser.add_argument('--only', default='', help='only robots whose name contains this')
    parser.add_argument('--sample', type=whole(1), default=2, help='naive calls a robot')
    parser.add_argument('--limit', type=number(0), default=10.0, help='s of one call, or search')
    parser.add_argument('--figure', type=Path, help='draw FIGURE.png and FIGURE.svg')
    return parser


if __name__ == '__main__':
    sys.exit(main())
