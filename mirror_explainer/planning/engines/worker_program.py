"""Worker of the general way: one unified-planning engine, one call a belief.

Run by its path by `worker.py`. unified-planning is not thread-safe and engines
may hang or crash, which is why this is a process of its own.
"""

import subprocess
import warnings
from typing import Any

import unified_planning.model as up
from unified_planning.engines import (
    OptimalityGuarantee,
    SequentialPlanValidator,
    ValidationResultStatus,
)
from unified_planning.engines import PlanGenerationResultStatus as EngineStatus
from unified_planning.exceptions import UPException
from unified_planning.shortcuts import OneshotPlanner, get_environment

from mirror_explainer import pddl
from mirror_explainer.errors import InputError, PlanningError
from mirror_explainer.planning.beliefs import Belief, BeliefPlans, BeliefSpace, Plan, Status
from mirror_explainer.planning.messages import Attempt, Refusal, Setup, unknown
from mirror_explainer.planning.processes.child import Parent
from mirror_explainer.planning.processes.confinement import limit_engine, limit_memory

_NO_PLAN = {
    EngineStatus.UNSOLVABLE_INCOMPLETELY: 'the engine found no plan, without proof that none is',
    EngineStatus.TIMEOUT: 'the engine ran out of time',
    EngineStatus.MEMOUT: 'the engine ran out of memory',
    EngineStatus.UNSUPPORTED_PROBLEM: 'the engine does not support the problem',
}


class Engine:
    """A planning engine with a belief space's problem, as it is under one belief at a time.

    Raises InputError for texts that cannot be read, and PlanningError when the
    engine is not there or does not support the problem.
    """

    def __init__(self, name: str, space: BeliefSpace) -> None:
        self._name = name
        task = pddl.read_task(space.domain, space.problem)
        if task.axioms:
            raise PlanningError(
                f'the planning engine "{name}" does not support derived predicates (:derived): '
                'unified-planning has none',
                cure='Name fast-downward-opt as the planner, or leave them out of the PDDL.',
            )
        self._model = task.model
        self._goals = [pddl.goal_expression(self._model, goal) for goal in space.goals]
        self._facts = {
            fact: pddl.fluent_expression(self._model, fact) for fact in space.uncertain_facts
        }
        engine_class = _engine_class(name)
        self._optimal = engine_class.satisfies(OptimalityGuarantee.SOLVED_OPTIMALLY)
        for goal in self._goals:
            self._set_goal(goal)
            _require_support(name, engine_class, self._model)

    def _set_goal(self, goal: up.FNode) -> None:
        self._model.clear_goals()
        self._model.add_goal(goal)

    def plan(self, belief: Belief) -> Attempt:
        """Ask the engine for a plan under one belief."""
        for fact, expression in self._facts.items():
            self._model.set_initial_value(expression, fact in belief.true_facts)
        self._set_goal(self._goals[belief.goal])
        try:
            with OneshotPlanner(name=self._name) as planner:
                result = planner.solve(self._model)
        except MemoryError:
            return unknown('the engine ran out of memory')
        except Exception as error:  # whatever a third party's engine may raise
            return unknown(f'the engine failed: {_first_line(error)}', crashed=True)
        if result.status is EngineStatus.UNSOLVABLE_PROVEN:
            return Attempt(BeliefPlans(Status.UNSOLVABLE))
        if result.plan is None:
            reason = _NO_PLAN.get(result.status)
            return unknown(reason or 'the engine failed', crashed=reason is None)
        optimal = self._optimal or result.status is EngineStatus.SOLVED_OPTIMALLY
        return self._checked(result.plan, optimal)

    def _checked(self, plan: Any, optimal: bool) -> Attempt:
        """Return an engine's plan with its cost, provided that it does reach the goal."""
        with SequentialPlanValidator() as validator:
            verdict = validator.validate(self._model, plan)
        if verdict.status is not ValidationResultStatus.VALID:
            return unknown('the engine gave a plan that does not reach the goal', crashed=True)
        actions = tuple(
            pddl.ground_text(step.action.name, map(str, step.actual_parameters))
            for step in plan.actions
        )
        costs = list((verdict.metric_evaluations or {}).values())
        cost = float(costs[0]) if costs else float(len(actions))
        return Attempt(BeliefPlans(Status.SOLVED, (Plan(actions, cost, optimal),)))


def _first_line(error: Exception) -> str:
    lines = str(error).strip().splitlines()
    return f'{type(error).__name__}: {lines[0][:200]}' if lines else type(error).__name__


def _engine_class(name: str) -> Any:
    """Return the class of an installed planning engine; raises PlanningError otherwise."""
    factory = get_environment().factory
    planners = sorted(e for e in factory.engines if factory.engine(e).is_oneshot_planner())
    if name not in planners:
        raise PlanningError(
            f'there is no planning engine "{name}" here; installed are: '
            f'{", ".join(planners) or "none"}',
            cure='Name one of them as the planner, or install it for unified-planning.',
        )
    return factory.engine(name)


def _require_support(name: str, engine_class: Any, model: up.Problem) -> None:
    """Raise PlanningError that names the features of the problem the engine lacks."""
    missing = model.kind.features - engine_class.supported_kind().features
    features = sorted(feature.lower().replace('_', ' ') for feature in missing)
    if missing or not engine_class.supports(model.kind):
        words = ', '.join(features)
        raise PlanningError(
            f'the planning engine "{name}" does not support this problem'
            f'{f": {words}" if words else ""}',
            cure='Name another engine as the planner, or leave that out of the PDDL.',
        )


def main() -> None:
    """Serve the parent until it ends this process."""
    parent = Parent()
    warnings.simplefilter('ignore')
    engine: Engine | None = None
    seconds = 0.0
    while True:
        message = parent.receive()
        if isinstance(message, Setup):
            engine, seconds = None, message.resources.planning_timeout
            limit_memory(message.resources.memory_limit)
            limit_engine(None)
            pddl.forget_expressions()
            try:
                engine = Engine(message.engine, message.space)
            except InputError as error:
                place = (error.source, error.reason, error.line)
                parent.send(Refusal(str(error), error.cure, place))
            except PlanningError as error:
                parent.send(Refusal(str(error), error.cure))
            except UPException as error:
                parent.send(Refusal(str(error), 'Name another engine as the planner.'))
            else:
                parent.send(None)
        elif engine is not None:
            limit_engine(seconds)
            parent.send(engine.plan(message))


class _SameGroup(subprocess.Popen):  # type: ignore[type-arg]
    """An engine's process, kept in the worker's group, which can then be ended as a whole."""

    def __init__(self, *arguments: Any, **options: Any) -> None:
        super().__init__(*arguments, **(options | {'start_new_session': False}))


if __name__ == '__main__':
    subprocess.Popen = _SameGroup  # type: ignore[misc]
    main()
