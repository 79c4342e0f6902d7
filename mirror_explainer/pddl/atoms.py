"""Ground atoms and actions as texts, and what conditions are made of."""

from collections.abc import Iterable

import unified_planning.model as up


def atom_text(atom: up.FNode) -> str:
    """Return a ground atom as PDDL text in lower case: "(item-at red_circle red_room)"."""
    return ground_text(atom.fluent().name, [str(argument) for argument in atom.args])


def ground_text(name: str, arguments: Iterable[str]) -> str:
    """Return a ground atom or action as canonical text, "(name argument …)", lower case."""
    return f'({" ".join([name, *arguments])})'.lower()


def words_of(text: str) -> list[str]:
    """Return the name and the arguments in a text as `ground_text` makes it."""
    return text.strip('()').split()


def conjuncts(goal: up.FNode) -> list[up.FNode]:
    """Return the conditions that a goal or precondition asks for together, in order."""
    if goal.is_and():
        return [literal for part in goal.args for literal in conjuncts(part)]
    return [] if goal.is_true() else [goal]


def fluents_in(*expressions: up.FNode) -> set[up.Fluent]:
    """Return the fluents in some expressions, under quantifiers, too."""
    return {
        atom.fluent() for e in expressions for atom in e.environment.free_vars_extractor.get(e)
    }


def effects_in(action: up.Action) -> list[up.Effect]:
    """Return all effects of an action, whenever they happen."""
    if isinstance(action, up.DurativeAction):
        return [effect for timed in action.effects.values() for effect in timed]
    return list(action.effects)


def condition_text(condition: up.FNode) -> str:
    """Return a ground condition as PDDL text in lower case, such as "(not (door-open d1))"."""
    if condition.is_fluent_exp():
        return atom_text(condition)
    for connective, is_one in (
        ('not', condition.is_not()),
        ('and', condition.is_and()),
        ('or', condition.is_or()),
        ('<=', condition.is_le()),
        ('<', condition.is_lt()),
        ('=', condition.is_equals()),
        ('+', condition.is_plus()),
        ('-', condition.is_minus()),
        ('*', condition.is_times()),
        ('/', condition.is_div()),
    ):
        if is_one:
            return f'({" ".join([connective, *map(condition_text, condition.args)])})'
    return str(condition).lower()
