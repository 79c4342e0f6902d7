"""A task without numbers but costs, as planners for many beliefs take it.

Conditions on numbers that never change become facts, which is exact. Numbers that change are
left out: conditions on them count as true.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

from mirror_explainer.pddl.numbers.arithmetic import (
    Numbers,
    TooManyError,
    changed_function,
    changes,
    used_variables,
)
from mirror_explainer.pddl.numbers.costs import with_effects
from mirror_explainer.pddl.text.actions import (
    TOTAL_COST,
    Action,
    Effect,
    Parts,
    effects,
    timed_conditions,
    variables_of,
)
from mirror_explainer.pddl.text.declarations import Kinds
from mirror_explainer.pddl.text.definition import Definition
from mirror_explainer.pddl.text.left_out import NUMBERS, NUMBERS_IN_EFFECTS, LeftOut
from mirror_explainer.pddl.text.tree import Branch, Tree, Word, made, word, words

# A fact that stands for a condition on numbers, by its predicate.
_FACT = 'numbers-fit'


def without_numbers(
    parts: Parts,
    numbers: Numbers,
    left_out: LeftOut,
    only: Iterable[str] | None = None,
    kind: str = NUMBERS,
) -> Parts:
    """Return the task without conditions on numbers, and without effects on them.

    With `only`, just these functions are left out, and nothing else changes. What was left out
    is noted as of this `kind`.
    """
    if not numbers.declared.functions:
        return parts
    return _Folder(parts, numbers, left_out, only, kind).folded()


class _Folder:
    """Takes the numbers out of one task."""

    def __init__(
        self,
        parts: Parts,
        numbers: Numbers,
        left_out: LeftOut,
        only: Iterable[str] | None,
        kind: str,
    ) -> None:
        self._domain, self._problem, self._actions = parts.domain, parts.problem, parts.actions
        self._numbers = numbers
        self._left_out = left_out
        self._only = None if only is None else frozenset(only)
        self._kind = kind
        # A condition that counts as true makes more possible, in an effect it may make less so.
        self._kind_of_effects = NUMBERS_IN_EFFECTS if kind == NUMBERS else kind
        self._declared: dict[str, Branch] = {}
        self._facts: list[Tree] = []
        self._names: dict[tuple[str, tuple[Kinds, ...]], str] = {}

    def folded(self) -> Parts:
        kept = tuple(self._action(action) for action in self._actions)
        derived = [
            section.like([*section[:2], self._derived(section), *section[3:]])
            if len(section) > 2 and isinstance(section[1], Branch)
            else section
            for section in self._domain.all(':derived')
        ]
        domain = self._domain.having(':derived', *derived) if derived else self._domain
        goals = [
            goal.like([goal[0], self._condition(goal[1], {}, True, self._problem.source)])
            for goal in self._problem.all(':goal')
            if len(goal) == 2
        ]
        problem = self._problem.having(':goal', *goals) if goals else self._problem
        if self._declared:
            domain = domain.with_contents(
                ':predicates', [*domain.contents(':predicates'), *self._declared.values()]
            )
            problem = problem.with_contents(':init', [*problem.contents(':init'), *self._facts])
        if self._only is None:
            domain, problem = self._without_idle(domain, problem, kept)
        return Parts(domain, problem, kept)

    def _without_idle(
        self, domain: Definition, problem: Definition, actions: Sequence[Action]
    ) -> tuple[Definition, Definition]:
        """Return the definitions without the functions, and values, that nothing needs."""
        used = {TOTAL_COST} | {
            str(word)
            for action in actions
            for part in action.parts.values()
            for word in words(part)
        }
        idle = self._numbers.declared.functions.keys() - used
        if not idle:
            return domain, problem
        functions = [
            part
            for part in domain.contents(':functions')
            if isinstance(part, Branch) and part.head not in idle
        ]
        values = [
            part
            for part in problem.contents(':init')
            if not (
                isinstance(part, Branch)
                and part.head == '='
                and isinstance(part[1], Branch)
                and part[1].head in idle
            )
        ]
        if functions:
            domain = domain.with_contents(':functions', functions)
        else:
            domain = domain.without(':functions')
        return domain, problem.with_contents(':init', values)

    def _derived(self, section: Branch) -> Tree:
        head = section[1]
        assert isinstance(head, Branch)
        variables = variables_of(head[1:])
        if self._has_left_out(section[2]):
            self._left_out.note(self._kind_of_effects, self._domain.source, section)
        return self._condition(section[2], variables, True, self._domain.source)

    def _action(self, action: Action) -> Action:
        source, environment = self._domain.source, dict(action.parameters)
        if action.durative and ':condition' in action.parts:
            place = action.parts[':condition']
            timed: list[Tree] = [word('and', place)]
            for phase, part in timed_conditions(place, source):
                when = 'over' if phase == 'all' else 'at'
                inner = self._condition(part, environment, True, source)
                timed.append(
                    Branch([word(when, place), word(phase, place), inner], part.line, part.column)
                )
            action = action.having(condition=Branch(timed, place.line, place.column))
        elif ':precondition' in action.parts:
            kept = self._condition(action.parts[':precondition'], environment, True, source)
            action = action.having(precondition=kept)
        changes = [*effects(action.parts.get(':effect'), source, action.durative)]
        kept_changes = [k for c in changes if (k := self._effect(c, environment, source))]
        if kept_changes != changes:
            action = with_effects(action, kept_changes)
        return action

    def _effect(
        self, effect: Effect, environment: Mapping[str, Kinds], source: str
    ) -> Effect | None:
        """Return an effect without conditions on numbers, None if it is left out."""
        variables = dict(environment)
        for names in effect.variables:
            variables |= variables_of(names)
        if name := changed_function(effect.change):
            if self._only is not None and name in self._only:
                self._left_out.note(self._kind, source, effect.change)
                return None
            if self._only is None and name != TOTAL_COST:
                return None
        if any(self._has_left_out(condition) for condition in effect.conditions):
            self._left_out.note(self._kind_of_effects, source, effect.change)
            return None
        conditions = tuple(
            self._condition(condition, variables, True, source) for condition in effect.conditions
        )
        return replace(effect, conditions=conditions)

    def _has_left_out(self, tree: Tree) -> bool:
        """Say whether a condition rests on a number that is left out."""
        if isinstance(tree, Word):
            return False
        if self._numbers.is_comparison(tree):
            return self._is_left_out(tree)
        return any(map(self._has_left_out, tree))

    def _is_left_out(self, comparison: Branch) -> bool:
        if self._only is not None:
            return bool(self._numbers.functions(comparison) & self._only)
        return not self._numbers.is_static(comparison)

    def _condition(
        self, tree: Tree, variables: Mapping[str, Kinds], positive: bool, source: str
    ) -> Tree:
        """Return a condition without numbers; where `positive`, what is left out is true."""
        if isinstance(tree, Word) or not tree:
            return tree
        head = tree.head
        if self._numbers.is_comparison(tree):
            if self._is_left_out(tree):
                self._left_out.note(self._kind, source, tree)
                return tree.like([word('and' if positive else 'or', tree)])
            return tree if self._only is not None else self._fact(tree, variables, source)
        if head in ('forall', 'exists') and len(tree) == 3 and isinstance(tree[1], Branch):
            inner = {**variables, **variables_of(tree[1])}
            return tree.like([*tree[:2], self._condition(tree[2], inner, positive, source)])
        if head == 'not' and len(tree) == 2:
            return tree.like([tree[0], self._condition(tree[1], variables, not positive, source)])
        if head == 'imply' and len(tree) == 3:
            needs = self._condition(tree[1], variables, not positive, source)
            return tree.like(
                [tree[0], needs, self._condition(tree[2], variables, positive, source)]
            )
        if head in ('and', 'or'):
            parts = (self._condition(part, variables, positive, source) for part in tree[1:])
            return tree.like([tree[0], *parts])
        return tree

    def _fact(self, tree: Branch, variables: Mapping[str, Kinds], source: str) -> Tree:
        """Return the fact that stands for a condition on numbers that never change."""
        used = [name for name in used_variables(tree) if name in variables]
        if not used:
            return tree.like([word('and' if self._numbers.holds(tree, {}) else 'or', tree)])
        typed = {name: variables[name] for name in used}
        # Equal conditions on like variables share their facts.
        places = {name: f'?{index}' for index, name in enumerate(used)}
        key = (_renamed(tree, places), tuple(typed.values()))
        if key not in self._names:
            name = f'{_FACT}-{len(self._names) + 1}'
            while name in self._numbers.declared.predicates:
                name += '-'
            try:
                holding = [
                    binding
                    for binding in self._numbers.bindings(typed)
                    if self._numbers.holds(tree, binding)
                ]
            except TooManyError:
                self._left_out.note(self._kind_of_effects, source, tree)
                return tree.like([word('and', tree)])
            place = self._domain.section(':predicates') or tree
            listed = ' '.join(f'?{i} - {k[0]}' for i, k in enumerate(typed.values()))
            self._declared[name] = made(f'({name} {listed})', place)
            init = self._problem.section(':init') or tree
            self._facts += [
                Branch(
                    (word(text, init) for text in (name, *binding.values())),
                    init.line,
                    init.column,
                )
                for binding in holding
            ]
            self._names[key] = name
        return tree.like([word(text, tree) for text in (self._names[key], *used)])


def _renamed(tree: Tree, names: Mapping[str, str]) -> str:
    if isinstance(tree, Word):
        return names.get(str(tree), str(tree))
    return f'({" ".join(_renamed(part, names) for part in tree)})'


def unsteady(parts: Parts, numbers: Numbers) -> set[str]:
    """Return the functions whose numbers could grow beyond all bounds in a short plan.

    These are multiplied with, or divided by, what changes; and what depends on them.
    """
    multiplied = {name for name, value in changes(parts) if _multiplies(value, numbers)}
    return with_dependents(multiplied, parts, numbers)


def with_dependents(names: Iterable[str], parts: Parts, numbers: Numbers) -> set[str]:
    """Return functions with those whose numbers are changed by theirs."""
    found: set[str] = set(names)
    moves = [(name, numbers.functions(value)) for name, value in changes(parts)]
    while more := {name for name, causes in moves if causes & found} - found:
        found |= more
    return found


def _multiplies(tree: Tree, numbers: Numbers) -> bool:
    if isinstance(tree, Word):
        return False
    if tree.head in ('*', '/'):
        moving = [not numbers.is_static(part) for part in tree[1:]]
        if sum(moving) > 1 or (tree.head == '/' and any(moving[1:])):
            return True
    return any(_multiplies(part, numbers) for part in tree[1:])
