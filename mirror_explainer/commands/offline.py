"""What the commands without ROS share: their files and options in, a preparation out."""

import argparse
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any

from mirror_explainer.commands.options import add_settings, settings_from
from mirror_explainer.errors import InputError, NoPlanError, PlanningError, told
from mirror_explainer.explainer import EMPTY_PLAN, explain, robot_plan, robot_plan_of
from mirror_explainer.listener.explanation import Explanation
from mirror_explainer.listener.mirror_model import MirrorModel
from mirror_explainer.listener.own_plan import plan_for_robot
from mirror_explainer.listener.preparation import (
    Preparation,
    RobotPlan,
    prepare,
    refine,
)
from mirror_explainer.listener.user_model import UserModel, read_user_model
from mirror_explainer.pddl import Task, read_task
from mirror_explainer.pddl.plan_text import read_plan, without_dummy
from mirror_explainer.pddl.progress_text import read_progress
from mirror_explainer.pddl.situation import Situation, Statement, situation_of
from mirror_explainer.planning import Plan, Planner
from mirror_explainer.selection.baselines import ORDERS
from mirror_explainer.selection.choice import Selection, baseline, curve
from mirror_explainer.settings import PlanningSettings, Question
from mirror_explainer.text_files import read_text

_NOT_COUNTED = (
    'goals_seen: true changes nothing here: only the node counts goals, in its goals_seen_file'
)


def add_file_arguments(parser: argparse.ArgumentParser) -> argparse._ArgumentGroup:
    """Add the input files, and return their group."""
    files = parser.add_argument_group('input')
    files.add_argument('--domain', required=True, help='PDDL domain')
    files.add_argument('--problem', required=True, help="PDDL problem: the robot's state and goal")
    files.add_argument('--plan', help="the robot's plan; planned for if left out")
    files.add_argument(
        '--progress',
        help='how far the robot is: "done: (…)", "running: (…)" and so on, one step a line',
    )
    files.add_argument('--user-model', required=True, help='YAML: what the listener may believe')
    return files


def add_planning_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what planning may be told."""
    add_settings(parser.add_argument_group('planning'), PlanningSettings)


@dataclass(frozen=True)
class Files:
    """The paths of what an explanation is made from; without a plan one is found."""

    domain: str | Path
    problem: str | Path
    user_model: str | Path
    plan: str | Path | None = None
    progress: str | Path | None = None


def prepare_as_asked(options: argparse.Namespace) -> Preparation:
    """Read and plan as the options of both functions above say; see `prepare_files`."""
    names = (item.name for item in fields(Files))
    files = Files(**{name: getattr(options, name) for name in names})
    return prepare_files(files, settings_from(PlanningSettings, options), _show_progress)


def prepare_files(
    files: Files,
    settings: PlanningSettings,
    progress: Callable[[int, int], None] | None = None,
) -> Preparation:
    """Read the files and plan; `progress` is told how many beliefs of how many are done.

    Where planning fails, what is known without it is returned, with a warning. Raises
    InputError, and PlanningError if the robot's own plan was to be found and is not.
    """
    started = time.perf_counter()
    domain, problem = read_text(str(files.domain)), read_text(str(files.problem))

    def read_problem(text: str) -> Task:
        return read_task(domain, text, str(files.domain), str(files.problem))

    task = read_problem(problem)
    situation = None
    if files.plan:
        situation = _given_plan(files, task, domain, problem)
        task = read_problem(situation.problem)
    user_model = read_user_model(files.user_model, task)
    read = time.perf_counter() - started
    with Planner.of(settings) as planner:
        own = robot_plan_of(situation) if situation else None
        own = own or _own_plan(task, user_model, planner, settings, str(files.problem))
        preparation = replace(prepare(task, own, user_model, settings), situation=situation)
        if user_model.goals_seen:
            preparation = preparation.warned(_NOT_COUNTED)
        try:
            preparation = refine(preparation, planner, progress=progress)
        except PlanningError as error:
            preparation = preparation.without_planning(told(error))
    return replace(preparation, seconds=replace(preparation.seconds, read=read))


def explain_files(
    domain: str | Path,
    problem: str | Path,
    plan: str | Path | None = None,
    *,
    user_model: str | Path,
    said: Sequence[str] = (),
    planning: PlanningSettings | None = None,
    **question: Any,
) -> Explanation:
    """Explain the robot's plan from files: what `verbalize` does, for a notebook.

    Without a `plan` one is found. `said` are sentences that the listener has heard;
    `question` are fields of Question, such as `n=2`. Raises InputError and PlanningError::

        import mirror_explainer as me

        folder = 'config/warehouse'
        me.explain_files(
            f'{folder}/domain.pddl', f'{folder}/problem.pddl', f'{folder}/plan.txt',
            user_model=f'{folder}/user_model.yaml', n=2,
        )

    """
    files = Files(domain, problem, user_model, plan)
    preparation = prepare_files(files, planning or PlanningSettings())
    return explain(preparation, Question(**question), said)


def _given_plan(files: Files, task: Task, domain: str, problem: str) -> Situation:
    """Return the situation of a robot with a plan: the problem may lie in the middle of it."""
    path, told_by = str(files.plan), str(files.progress or '')
    steps = without_dummy(task, read_plan(read_text(path), path))
    progress = read_progress(read_text(told_by), told_by) if told_by else None
    try:
        situation = situation_of(Statement(domain, problem, task, steps, path, progress=progress))
    except InputError as error:
        if steps:
            raise
        cure = 'Leave --plan out, and a plan is made.'
        raise NoPlanError(path, EMPTY_PLAN, cure=cure) from error
    if progress is None:
        return situation
    return situation.telling(progress.of(situation.episode.actions), told_by)


def _own_plan(
    task: Task, user_model: UserModel, planner: Planner, settings: PlanningSettings, source: str
) -> RobotPlan:
    plan = plan_for_robot(task, user_model, planner, settings, source)
    return robot_plan(task, '\n'.join(plan.actions), 'the plan that was found')


def _show_progress(done: int, beliefs: int) -> None:
    """Tell on a terminal how far planning is, on a line that the next output overwrites."""
    if sys.stderr.isatty():
        words = f'planning {done} of {beliefs}' if done < beliefs else ''
        print(f'\r{words:40}\r', end='', file=sys.stderr, flush=True)


def usual_rationality(plan: Plan) -> float:
    """Return the β with which a way that is longer by a usual step is e times less expected."""
    mean = plan.cost / len(plan.actions) if plan.actions else 0.0
    return float(f'{1 / mean:.1g}') if mean > 0 else 1.0


def strategy_curves(
    model: MirrorModel, said: Sequence[int] = (), budget: float | None = None
) -> list[dict[str, Any]]:
    """Return, for every N from 1, what each strategy achieves; the budget is in seconds.

    Informative is what an answer of at most N sentences says.
    """
    evidence = model.evidence(said)
    at_most = curve(evidence, budget)
    return [
        {'n': n, 'informative': _measures(best, model, said)}
        | {s: _measures(baseline(evidence, s, n), model, said) for s in ORDERS}
        for n, best in enumerate(at_most, start=1)
    ]


def _measures(selection: Selection, model: MirrorModel, said: Sequence[int]) -> dict[str, Any]:
    heard = [*said, *selection.positions]
    return {
        'positions': list(selection.positions),
        'information_gain': selection.information_gain,
        'doubt': model.doubt(heard),
        'cross_entropy': model.cross_entropy(heard),
        'understanding': model.understanding(heard),
        'gap': selection.gap,
    }
