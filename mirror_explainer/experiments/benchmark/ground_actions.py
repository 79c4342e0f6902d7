"""What a plan's actions need and bring about, as atoms, and how far from the goal they are."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import unified_planning.model as up

from mirror_explainer.listener.user_model import CandidateGoal, UserModel
from mirror_explainer.listener.wording import Template, Wording
from mirror_explainer.pddl import Task, atom_text, conjuncts, words_of


@dataclass(frozen=True)
class GroundAction:
    """An action of a plan: the atoms that must hold before it, those it adds and deletes."""

    preconditions: frozenset[str]
    added: frozenset[str]
    deleted: frozenset[str]


def ground_action(task: Task, action: str) -> GroundAction:
    """Return the atoms of a ground action such as "(move left center)"."""
    name, *arguments = words_of(action)
    model = task.model
    schema = model.action(name)
    objects = [model.object(argument) for argument in arguments]
    manager = model.environment.expression_manager
    bound = dict(zip(schema.parameters, manager.auto_promote(objects), strict=True))
    effects = [part for effect in schema.effects for part in effect.expand_effect(model)]

    def atoms(expressions: Sequence[up.FNode]) -> frozenset[str]:
        return frozenset(atom_text(expression.substitute(bound)) for expression in expressions)

    return GroundAction(
        preconditions=atoms(
            [
                condition
                for precondition in schema.preconditions
                for condition in conjuncts(precondition)
                if condition.is_fluent_exp()
            ]
        ),
        added=atoms([effect.fluent for effect in effects if effect.value.is_true()]),
        deleted=atoms([effect.fluent for effect in effects if effect.value.is_false()]),
    )


def hearing_ground_actions(
    task: Task, goals: Sequence[str], uncertain_facts: Mapping[str, float]
) -> UserModel:
    """Return a listener to whom all goals are equally likely, and who hears ground actions.

    That is what the paper's experiments observe: no two actions sound alike.
    """
    templates = {}
    for action in task.model.actions:
        places = [f'{{{parameter.name}}}' for parameter in action.parameters]
        templates[action.name] = Template(Wording(f'({" ".join([action.name, *places])})'))
    return UserModel(
        tuple(CandidateGoal(goal, goal, 1 / len(goals)) for goal in goals),
        uncertain_facts,
        templates=templates,
        objects={item.name: item.name for item in task.model.all_objects},
    )


def needed_facts(task: Task, plan: Iterable[str]) -> frozenset[str]:
    """Return the atoms that are a precondition of any of the plan's actions."""
    return frozenset[str]().union(*(ground_action(task, a).preconditions for a in plan))


def distances_to_goal(task: Task, plan: Sequence[str]) -> list[float]:
    """D_G(a_i) = k/|π_R| of each action: from a_i on, the k-th has a goal predicate as effect.

    Counting is from 0: D_G is 0 for an action that has one itself. Behind the
    last such action, which ends an optimal plan, the end of the plan counts.
    """
    required = conjuncts(task.goal)
    wanted = {atom_text(goal) for goal in required if goal.is_fluent_exp()}
    unwanted = {atom_text(goal.arg(0)) for goal in required if goal.is_not()}
    actions = [ground_action(task, action) for action in plan]
    reaching = [
        i for i, action in enumerate(actions) if action.added & wanted or action.deleted & unwanted
    ]
    return [
        (next((j for j in reaching if j >= i), len(plan)) - i) / len(plan)
        for i in range(len(plan))
    ]
