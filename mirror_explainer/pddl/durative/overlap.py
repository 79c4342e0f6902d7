"""Whether plans may exist only with actions that overlap in time.

Planning takes actions one after the other. That loses no plan unless an action
changes something at its start that another one needs, and either takes it back at
its end (a match that burns), or itself waits for something that others do.
(Cushing et al., "When is temporal planning really temporal?", IJCAI 2007.)
"""

import unified_planning.model as up

from mirror_explainer.pddl.atoms import conjuncts, effects_in, fluents_in
from mirror_explainer.pddl.derived.axioms import Axioms

# A fluent's name, and the truth value at issue; numbers, and what stands in more than a literal,
# may matter both ways.
_Need = tuple[str, bool]


def may_need_overlap(model: up.Problem, axioms: Axioms | None) -> bool:
    """Say whether a task, with its durative actions, may have no plan but with overlap."""
    needs = {need for action in model.actions for need in _needs(action, axioms)}
    changed = {
        effect.fluent.fluent().name for action in model.actions for effect in effects_in(action)
    }
    for action in model.actions:
        if not isinstance(action, up.DurativeAction):
            continue
        start, end = effects_of(action)
        helps = {change for effect in start for change in _changes(effect)} & needs
        taken_back = {(name, not value) for effect in end for name, value in _changes(effect)}
        waits_for = _basis(fluents_in(*later_conditions(action)), axioms) & changed
        own = {effect.fluent.fluent().name for effect in start}
        if helps & taken_back or (helps and waits_for - own):
            return True
    return False


def _needs(action: up.Action, axioms: Axioms | None) -> set[_Need]:
    """Return what conditions of the action, and of its effects, look at."""
    conditions = [effect.condition for effect in effects_in(action)]
    if isinstance(action, up.DurativeAction):
        conditions += [part for parts in action.conditions.values() for part in parts]
    else:
        conditions += action.preconditions
    found: set[_Need] = set()
    for condition in conditions:
        parts = condition.args if condition.is_and() else (condition,)
        for part in parts:
            literal = as_literal(part)
            if literal and not (axioms and literal[0].fluent().name in axioms.names):
                found.add((literal[0].fluent().name, literal[1]))
            else:
                both = _basis(fluents_in(part), axioms)
                found |= {(name, value) for name in both for value in (True, False)}
    return found


def _changes(effect: up.Effect) -> set[_Need]:
    """Return what an effect makes true or false; for a number it may be both."""
    name = effect.fluent.fluent().name
    if effect.value.is_bool_constant():
        return {(name, effect.value.is_true())}
    return {(name, True), (name, False)}


def _basis(fluents: set[up.Fluent], axioms: Axioms | None) -> frozenset[str]:
    """Return the names of fluents, with all that derived ones rest on."""
    names = {fluent.name for fluent in fluents}
    return axioms.basis(names) if axioms else frozenset(names)


def as_literal(condition: up.FNode) -> tuple[up.FNode, bool] | None:
    """Return a literal's atom and whether it must hold, None for other conditions."""
    atom = condition.arg(0) if condition.is_not() else condition
    return (atom, not condition.is_not()) if atom.is_fluent_exp() else None


def effects_of(action: up.DurativeAction) -> tuple[list[up.Effect], list[up.Effect]]:
    """Return the effects at the start and those at the end."""
    return (
        list(action.effects.get(up.StartTiming(), [])),
        list(action.effects.get(up.EndTiming(), [])),
    )


def later_conditions(action: up.DurativeAction) -> list[up.FNode]:
    """Return the conditions over all and at end."""
    return [
        part
        for interval, conditions in action.conditions.items()
        if interval.upper == up.EndTiming()
        for condition in conditions
        for part in conjuncts(condition)
    ]
