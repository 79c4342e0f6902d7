"""Types with two supertypes, and (either a b), as a tree of types and facts.

unified-planning has trees of types only. A type with two supertypes goes below what is above
both; what is between is no type any more, but a fact about objects, which variables are
asked for. That is exact: facts about what an object is never change.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from mirror_explainer.pddl.text.actions import ACTION, DURATIVE, Action, Effect, effects
from mirror_explainer.pddl.text.declarations import (
    OBJECT,
    Declarations,
    Kinds,
    read_declarations,
    typed_names,
)
from mirror_explainer.pddl.text.definition import Definition
from mirror_explainer.pddl.text.tree import Branch, Tree, Word, branches, made, word


def with_plain_types(
    domain: Definition, problem: Definition, declared: Declarations, actions: Sequence[Action]
) -> tuple[Definition, Definition, Declarations, tuple[Action, ...]]:
    """Return the task with a single type for each name, none with two supertypes.

    Raises InputError for what cannot be read of the types.
    """
    several = any(
        len(kinds) > 1 for kinds in (*declared.types.values(), *declared.objects.values())
    )
    either = any(branch.head == 'either' for part in (domain, problem) for branch in _typing(part))
    if not several and not either:
        return domain, problem, declared, tuple(actions)
    return _Plainer(domain, problem, declared).plain(actions)


def _typing(definition: Definition) -> list[Branch]:
    """Return all branches but those of the initial state, in which no types stand."""
    sections = definition.without(':init').sections.values()
    return [branch for parts in sections for part in parts for branch in branches(part)]


class _Plainer:
    """Makes the types of one task plain."""

    def __init__(self, domain: Definition, problem: Definition, declared: Declarations) -> None:
        self._domain = domain
        self._problem = problem
        self._declared = declared
        self._facts: dict[str, tuple[Kinds, str]] = {}
        several = [*declared.types.values(), *declared.objects.values()]
        self._loose = {
            between
            for kinds in several
            if len(kinds) > 1
            for between in self._above(kinds) - declared.above(self._common(kinds))
        }

    def plain(
        self, actions: Sequence[Action]
    ) -> tuple[Definition, Definition, Declarations, tuple[Action, ...]]:
        """Return the whole task."""
        domain, problem = self._domain, self._problem
        changed = tuple(self._action(action) for action in actions)
        place = domain.section(':types') or Branch((), domain.line)
        types = [
            f'{name} - {self._single(above)}'
            for name, above in self._declared.types.items()
            if name not in self._loose and name != OBJECT
        ]
        domain = domain.having(':types', made(f'(:types {" ".join(types)})', place))
        domain = domain.having(
            ':derived', *(self._derived(section) for section in domain.all(':derived'))
        )
        for keyword in (':predicates', ':functions'):
            contents = [
                part.like([part[0], *self._typed(part[1:])[0]])
                for part in domain.contents(keyword)
                if isinstance(part, Branch)
            ]
            domain = domain.with_contents(keyword, contents)
        domain = domain.with_contents(':constants', self._objects(domain, ':constants'))
        problem = problem.with_contents(':objects', self._objects(problem, ':objects'))
        goals = [
            goal.like(self._condition(part) for part in goal) for goal in problem.all(':goal')
        ]
        problem = problem.having(':goal', *goals)
        for name, (kinds, single) in self._facts.items():
            predicates = domain.section(':predicates') or place
            domain = domain.with_contents(
                ':predicates', [*predicates[1:], made(f'({name} ?x - {single})', predicates)]
            )
            init = problem.section(':init') or Branch((), problem.line)
            facts = [
                Branch([word(name, init), word(item, init)], init.line, init.column)
                for item in self._declared.extent(kinds)
            ]
            problem = problem.with_contents(':init', [*init[1:], *facts])
        return domain, problem, read_declarations(domain, problem), changed

    def _above(self, kinds: Kinds) -> set[str]:
        return {above for kind in kinds for above in self._declared.above(kind)}

    def _common(self, kinds: Kinds) -> str:
        """Return the lowest type that is above all of these, and below what else is so."""
        shared = frozenset.intersection(*(self._declared.above(kind) for kind in kinds))
        return next((name for name in shared if shared <= self._declared.above(name)), OBJECT)

    def _single(self, kinds: Kinds) -> str:
        """Return the type, of those that stay, which has the objects of all of these."""
        found = self._common(kinds)
        while found in self._loose:
            found = self._common(self._declared.types[found])
        return found

    def _typed(self, parts: Sequence[Tree]) -> tuple[list[Tree], list[Tree]]:
        """Return variables with single types, and the conditions that they have besides."""
        listed: list[Tree] = []
        conditions: list[Tree] = []
        for name, kinds in typed_names(parts, self._domain.source):
            own = tuple(dict.fromkeys(map(str, kinds)))
            single = self._single(own)
            listed += [name, word('-', name), word(single, name)]
            if own != (single,):
                fact = f'is-{"-or-".join(sorted(own))}'
                while fact in self._declared.predicates:
                    fact += '-'
                self._facts[fact] = (own, single)
                conditions.append(Branch([word(fact, name), name], name.line, name.column))
        return listed, conditions

    def _objects(self, definition: Definition, keyword: str) -> list[Tree]:
        listed: list[Tree] = []
        for name, kinds in typed_names(definition.contents(keyword), definition.source):
            single = self._single(tuple(dict.fromkeys(map(str, kinds))))
            listed += [name, word('-', name), word(single, name)]
        return listed

    def _action(self, action: Action) -> Action:
        source = self._domain.source
        parameters = action.parts.get(':parameters', action.section.like([]))
        assert isinstance(parameters, Branch)
        listed, conditions = self._typed(parameters)
        parts = {**action.parts, ':parameters': parameters.like(listed)}
        needs = ':condition' if action.durative else ':precondition'
        place = action.parts.get(needs, parameters)
        if action.durative:
            conditions = [
                place.like([word('at', place), word('start', place), condition])
                if isinstance(place, Branch)
                else condition
                for condition in conditions
            ]
        if needs in parts or conditions:
            old = self._condition(parts[needs]) if needs in parts else None
            every = conditions if old is None else [old, *conditions]
            parts[needs] = Branch([word('and', place), *every], place.line, place.column)
        changes = [
            self._effect(effect)
            for effect in effects(action.parts.get(':effect'), source, action.durative)
        ]
        if changes:
            effect = action.parts[':effect']
            every = [change.tree() for change in changes]
            parts[':effect'] = Branch([word('and', effect), *every], effect.line, effect.column)
        single = {name: (self._single(kinds),) for name, kinds in action.parameters.items()}
        return replace(action, parameters=single, parts=parts)

    def _effect(self, effect: Effect) -> Effect:
        variables: list[Branch] = []
        conditions: list[Tree] = []
        for names in effect.variables:
            listed, more = self._typed(names)
            variables.append(names.like(listed))
            conditions += more
        conditions += [self._condition(condition) for condition in effect.conditions]
        return replace(effect, variables=tuple(variables), conditions=tuple(conditions))

    def _derived(self, section: Branch) -> Branch:
        if len(section) != 3 or not isinstance(section[1], Branch) or not section[1]:
            return section
        head = section[1]
        listed, conditions = self._typed(head[1:])
        body = self._condition(section[2])
        if conditions:
            body = Branch([word('and', head), *conditions, body], head.line, head.column)
        return section.like([section[0], head.like([head[0], *listed]), body])

    def _condition(self, tree: Tree) -> Tree:
        """Return a condition whose variables have single types."""
        if isinstance(tree, Word):
            return tree
        if tree.head in ('forall', 'exists') and len(tree) == 3 and isinstance(tree[1], Branch):
            listed, conditions = self._typed(tree[1])
            body = self._condition(tree[2])
            if conditions:
                if tree.head == 'exists':
                    body = tree.like([word('and', tree), *conditions, body])
                else:
                    needs = tree.like([word('and', tree), *conditions])
                    body = tree.like([word('imply', tree), needs, body])
            return tree.like([tree[0], tree[1].like(listed), body])
        return tree.like(map(self._condition, tree))


def with_actions(domain: Definition, actions: Sequence[Action]) -> Definition:
    """Return the domain with these actions."""
    kinds: Mapping[str, bool] = {ACTION: False, DURATIVE: True}
    for keyword, durative in kinds.items():
        own = [action.tree() for action in actions if action.durative == durative]
        domain = domain.having(keyword, *own) if own else domain.without(keyword)
    return domain
