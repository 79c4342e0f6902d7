"""Carry out a plan in a task of Fast Downward's translator: a search is not taken at its word.

To be imported in a worker process only, as `translator.py`.
"""

from collections.abc import Iterable, Sequence

from fast_downward.translate.sas_tasks import SASOperator, SASTask

from mirror_explainer.planning.downward.ground_task import Fact, canonical


def reaches_goal(task: SASTask, actions: Sequence[str]) -> bool:
    """Say whether the actions, named "(move a b)", can be done in order and reach the goal."""
    operators: dict[str, list[SASOperator]] = {}
    for operator in task.operators:
        operators.setdefault(canonical(operator.name), []).append(operator)
    values = list(task.init.values)
    _derive(task, values)
    for name in actions:
        for operator in operators.get(name, ()):
            if _hold(values, operator.get_applicability_conditions()):
                effects = [
                    (variable, value)
                    for variable, _, value, condition in operator.pre_post
                    if _hold(values, condition)
                ]
                for variable, value in effects:
                    values[variable] = value
                _derive(task, values)
                break
        else:
            return False
    return _hold(values, task.goal.pairs)


def _derive(task: SASTask, values: list[int]) -> None:
    """Set the derived variables to what the axioms make of the others, layer by layer."""
    layers = task.variables.axiom_layers
    for variable, layer in enumerate(layers):
        if layer >= 0:
            values[variable] = task.init.values[variable]
    for layer in sorted({layer for layer in layers if layer >= 0}):
        axioms = [axiom for axiom in task.axioms if layers[axiom.effect[0]] == layer]
        changed = True
        while changed:
            changed = False
            for axiom in axioms:
                variable, value = axiom.effect
                if values[variable] != value and _hold(values, axiom.condition):
                    values[variable] = value
                    changed = True


def _hold(values: Sequence[int], facts: Iterable[Fact]) -> bool:
    return all(values[variable] == value for variable, value in facts)
