"""What comes true by itself, at a time or by an event: taken as true from the beginning.

So the robot's plan, and what the listener thinks of, may wait for it without a clock. Only facts
that are nowhere wanted false are taken so.
"""

import itertools
import math
from collections.abc import Iterable, Iterator, Sequence

from mirror_explainer.pddl.text.actions import Action, effects, timed_conditions
from mirror_explainer.pddl.text.declarations import Declarations
from mirror_explainer.pddl.text.definition import Definition
from mirror_explainer.pddl.text.tree import Branch, Tree, branches, word, words

# Of a predicate whose facts come true by events, so many facts at most.
_MOST_FACTS = 10_000


def facts_to_come(
    domain: Definition,
    problem: Definition,
    declared: Declarations,
    actions: Sequence[Action],
    changes: Iterable[Branch],
) -> list[Branch]:
    """Return the facts among changes that come by themselves, such as (open ?d), and may hold now.

    A change with variables stands for each fact of its predicate.
    """
    wanted_false = _wanted_false(domain, problem, actions)
    found: dict[tuple[str, ...], Branch] = {}
    for change in changes:
        predicate = declared.predicates.get(change.head)
        if predicate is None or change.head in wanted_false:
            continue
        facts = [tuple(map(str, words(change)))]
        if any(name.startswith('?') for name in facts[0]):
            extents = [declared.extent(kinds) for _, kinds in predicate.parameters]
            if math.prod(map(len, extents)) > _MOST_FACTS:
                continue
            facts = [(change.head, *names) for names in itertools.product(*extents)]
        for fact in facts:
            found[fact] = change.like(word(name, change) for name in fact)
    return list(found.values())


def _wanted_false(
    domain: Definition, problem: Definition, actions: Sequence[Action]
) -> frozenset[str]:
    """Return the predicates, and other words, that stand in conditions under a negation."""
    negated = {
        str(name)
        for condition in _conditions(domain, problem, actions)
        for branch in branches(condition)
        if branch.head in ('not', 'imply')
        for name in words(branch)
    }
    derived = [section for section in domain.all(':derived') if len(section) == 3]
    if any(str(name) in negated for section in derived for name in words(section[1])):
        negated.update(str(name) for section in derived for name in words(section[2]))
    return frozenset(negated)


def _conditions(
    domain: Definition, problem: Definition, actions: Sequence[Action]
) -> Iterator[Tree]:
    for action in actions:
        for _, condition in timed_conditions(action.parts.get(':condition'), domain.source):
            yield condition
        if ':precondition' in action.parts:
            yield action.parts[':precondition']
        for effect in effects(action.parts.get(':effect'), domain.source, action.durative):
            yield from effect.conditions
    for section in domain.all(':derived'):
        yield from section[2:]
    for section in problem.all(':goal'):
        yield from section[1:]
