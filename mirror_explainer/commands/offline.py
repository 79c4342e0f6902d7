"""What the commands without ROS share: their files and options in, a prepared model out."""

import argparse
import time
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from mirror_explainer.commands.options import add_settings
from mirror_explainer.errors import NoPlanError
from mirror_explainer.explainer import Preparation, prepare, robot_plan
from mirror_explainer.listener.mirror_model import MirrorModel
from mirror_explainer.listener.user_model import read_user_model
from mirror_explainer.pddl import Task, read_task
from mirror_explainer.planning import Plan, Planner
from mirror_explainer.selection.algorithm import Selection, curve, decreasing, increasing
from mirror_explainer.settings import PlanningSettings
from mirror_explainer.text_files import read_text


def add_file_arguments(parser: argparse.ArgumentParser) -> argparse._ArgumentGroup:
    """Add the input files, and return their group."""
    files = parser.add_argument_group('input')
    files.add_argument('--domain', required=True, help='PDDL domain')
    files.add_argument('--problem', required=True, help="PDDL problem: the robot's state and goal")
    files.add_argument('--plan', help="the robot's plan; planned for if left out")
    files.add_argument('--user-model', required=True, help='YAML: what the listener may believe')
    return files


def add_planning_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what planning may be told."""
    add_settings(parser.add_argument_group('planning'), PlanningSettings)


def prepare_files(options: argparse.Namespace) -> Preparation:
    """Read the files and plan, as the options of both functions above say.

    Raises InputError and PlanningError.
    """
    started = time.perf_counter()
    task = read_task(
        read_text(options.domain), read_text(options.problem), options.domain, options.problem
    )
    plan = _given_plan(task, options.plan) if options.plan else None
    user_model = read_user_model(options.user_model, task)
    read = time.perf_counter() - started
    with Planner(
        options.planner,
        workers=options.workers,
        planning_timeout=options.planning_timeout,
        memory_limit=options.planner_memory_limit,
        downward_binary=options.downward_binary,
    ) as planner:
        preparation = prepare(
            task,
            plan,
            user_model,
            planner,
            max_beliefs=options.max_beliefs,
            plans_per_belief=options.plans_per_belief,
            deadline=options.deadline,
        )
    return replace(preparation, seconds=replace(preparation.seconds, read=read))


def _given_plan(task: Task, path: str) -> Plan:
    """Read and check the robot's plan."""
    try:
        return robot_plan(task, read_text(path), path)
    except NoPlanError as error:
        cure = 'Leave --plan out, and a plan is made.'
        raise NoPlanError(error.source, error.reason, cure=cure) from error


def strategy_curves(
    model: MirrorModel, said: Sequence[int] = (), budget: float | None = None
) -> list[dict[str, Any]]:
    """Return, for every N from 1, what each strategy achieves; the budget is in seconds."""
    evidence = model.evidence(said)
    best = curve(evidence, budget)
    return [
        {
            'n': n,
            'informative': _measures(best[n], model, said),
            'increasing': _measures(increasing(evidence, n), model, said),
            'decreasing': _measures(decreasing(evidence, n), model, said),
        }
        for n in range(1, len(evidence.positions) + 1)
    ]


def _measures(selection: Selection, model: MirrorModel, said: Sequence[int]) -> dict[str, Any]:
    heard = [*said, *selection.positions]
    return {
        'positions': list(selection.positions),
        'information_gain': selection.information_gain,
        'cross_entropy': model.cross_entropy(heard),
        'understanding': model.understanding(heard),
        'gap': selection.gap,
    }
