"""Durations that are open, as certain ones: planners take an action to last as long as it must."""

from dataclasses import replace

from mirror_explainer.pddl.numbers.costs import with_effects
from mirror_explainer.pddl.text.actions import Action, Effect, duration_bounds, effects
from mirror_explainer.pddl.text.tree import Branch, Tree, Word, has_word, word


def with_fixed_durations(action: Action, source: str) -> tuple[Action, bool]:
    """Return a durative action that takes the least it can, and whether it could take more.

    What its effects say of ?duration says so of that number.
    """
    least, most = duration_bounds(action, source)
    fixed = least if least is not None else most
    assert fixed is not None
    place = action.parts[':duration']
    duration = Branch(
        [word('=', place), word('?duration', place), fixed], place.line, place.column
    )
    action = action.having(duration=duration)
    changes = [*effects(action.parts.get(':effect'), source, True)]
    if any(has_word('?duration', change.change) for change in changes):
        action = with_effects(action, [_timed(change, fixed) for change in changes])
    return action, least is not most


def _timed(effect: Effect, duration: Tree) -> Effect:
    def replaced(tree: Tree) -> Tree:
        if isinstance(tree, Word):
            return duration if tree == '?duration' else tree
        return tree.like(replaced(part) for part in tree)

    change = replaced(effect.change)
    assert isinstance(change, Branch)
    return replace(effect, change=change)
