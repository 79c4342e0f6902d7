"""A robot's task and plan, and what its listener believes: as they are, and with other names."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from random import Random

from mirror_explainer.experiments.benchmark.dataset import Location, read_instance
from mirror_explainer.experiments.benchmark.protocol import draw_facts, draw_goals
from mirror_explainer.experiments.warehouse_files import read_warehouse
from mirror_explainer.listener.prior import belief_prior
from mirror_explainer.listener.user_model import CandidateGoal, UserModel
from mirror_explainer.listener.wording import plain_name
from mirror_explainer.pddl import Task, read_task
from mirror_explainer.pddl.text.sections import without_comments
from mirror_explainer.planning import Plan, Planner

_FACTS = 2
_DEADLINE = 60.0  # seconds


@dataclass(frozen=True)
class Scene:
    """The robot's task and plan, and what the listener believes."""

    domain: str
    name: str
    task: Task
    plan: Plan
    user_model: UserModel


def pucrs_scene(planner: Planner, location: Location, dataset: Path) -> Scene:
    """Draw goals and facts of an instance of the data set, as in the paper's protocol."""
    name, problem = location.name, read_instance(location, dataset)
    random = Random(name)
    draw = draw_goals(problem, planner, _DEADLINE, random, name)
    task = read_task(problem.domain, problem.problem(draw.goals[0]), name, name)
    facts = draw_facts(task, draw.plan, random, name)[:_FACTS]
    goals = tuple(CandidateGoal(goal, goal, 1 / len(draw.goals)) for goal in draw.goals)
    model = UserModel(goals, dict.fromkeys(facts, 0.5))
    return Scene(location.domain, name, task, draw.plan, model)


def warehouse_scene(planner: Planner) -> Scene:
    """Return the demo: the robot, and the operator who meets it, unsure of the battery."""
    task, model = read_warehouse()
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
    readable = {item: plain_name(item) for item in names}
    own = {item: said for item, said in scene.user_model.objects.items() if item in names}
    return {**readable, **own}


def _with_names(text: str, names: Mapping[str, str]) -> str:
    plain = without_comments(text).lower()
    return re.sub(r'[^\s()]+', lambda word: names.get(word[0], word[0]), plain)
