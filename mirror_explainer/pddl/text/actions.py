"""Actions as they stand in a domain: their parts by keyword, and their effects one by one."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from mirror_explainer.errors import InputError, did_you_mean
from mirror_explainer.pddl.text.declarations import Kinds, typed_names, typed_variables
from mirror_explainer.pddl.text.definition import Definition, unequal
from mirror_explainer.pddl.text.tree import Branch, Tree, Word, as_text, require_name, word

ACTION, DURATIVE = ':action', ':durative-action'
TOTAL_COST = 'total-cost'
CHANGES = ('increase', 'decrease', 'assign')  # of numbers
_FORMS = {'forall': '(forall (?x - type) effect)', 'when': '(when condition effect)'}
_PARTS = {
    ACTION: (':parameters', ':precondition', ':effect'),
    DURATIVE: (':parameters', ':duration', ':condition', ':effect'),
}


@dataclass(frozen=True)
class Action:
    """An action: its parts by keyword; `parameters` have the question mark."""

    name: Word
    durative: bool
    parameters: Mapping[str, Kinds]
    parts: Mapping[str, Tree]
    section: Branch

    def tree(self) -> Branch:
        """Return the action as it stands in a domain."""
        place = self.section
        parts: list[Tree] = [place[0], self.name]
        for keyword, part in self.parts.items():
            parts += [word(keyword, part), part]
        return place.like(parts)

    def having(self, **parts: Tree) -> 'Action':
        """Return the action with other parts, such as precondition=…."""
        named = {f':{name}': part for name, part in parts.items()}
        return replace(self, parts={**self.parts, **named})


@dataclass(frozen=True)
class Effect:
    """One change, under a quantifier and conditions.

    `change` is (p …), (not (p …)), (increase (f …) …) and the like; `phase` is
    'start' or 'end' in a durative action, else ''.
    """

    variables: tuple[Branch, ...]
    conditions: tuple[Tree, ...]
    change: Branch
    phase: str = ''

    def tree(self) -> Branch:
        """Return the effect as it stands in an action."""
        tree = self.change
        place = tree
        if self.phase:
            tree = place.like([word('at', place), word(self.phase, place), tree])
        for condition in reversed(self.conditions):
            timed = condition
            if self.phase:
                timed = place.like([word('at', place), word(self.phase, place), condition])
            tree = place.like([word('when', place), timed, tree])
        for variables in reversed(self.variables):
            tree = place.like([word('forall', place), variables, tree])
        return tree


@dataclass(frozen=True)
class Parts:
    """A task taken apart: its definitions, and the actions that count instead of the domain's."""

    domain: Definition
    problem: Definition
    actions: tuple[Action, ...]


def variables_of(parts: Sequence[Tree]) -> dict[str, Kinds]:
    """Return the variables of "?a ?b - type"; the faults in it are found elsewhere."""
    try:
        return {str(name): tuple(map(str, kinds)) for name, kinds in typed_names(parts, '')}
    except InputError:
        return {}


def read_actions(domain: Definition, types: Mapping[str, Kinds]) -> list[Action]:
    """Return the domain's actions. Raises InputError with the line of what is wrong."""
    found: dict[str, Action] = {}
    for section in domain.all(ACTION, DURATIVE):
        action = _action(section, domain.source, types)
        if action.name in found:
            first = found[action.name].name
            raise unequal(f'the action "{action.name}"', first, action.name, domain.source)
        found[action.name] = action
    return sorted(found.values(), key=lambda action: (action.name.line, action.name.column))


def _action(section: Branch, source: str, types: Mapping[str, Kinds]) -> Action:
    keyword = section.head
    name, *others = section[1:] or [word('', section)]
    if not isinstance(name, Word) or not name or name.startswith(':'):
        raise InputError(source, f'this ({keyword} …) has no name', section.line)
    bare, colon, part_name = name.partition(':')
    if f':{part_name}' in _PARTS[keyword]:  # a blank is missing between the two
        others = [word(colon + part_name, name), *others]
        name = word(bare, name)
    require_name(name, source)
    parts: dict[str, Tree] = {}
    rest = iter(others)
    for part in rest:
        if not isinstance(part, Word) or part not in _PARTS[keyword]:
            shown = as_text(part)[:60]
            hint = did_you_mean(shown, _PARTS[keyword])
            known = ', '.join(_PARTS[keyword])
            reason = f'"{name}" has no part "{shown}"'
            reason += hint or f': it may have {known}; is a parenthesis missing?'
            if isinstance(part, Branch) and not part.head.startswith(':'):
                reason = f'"{shown}" of "{name}" has no keyword before it: it may be {known}'
            if part == ':vars':
                reason = f'"{name}" has :vars, an old form; make them :parameters'
            raise InputError(source, reason, part.line)
        content = next(rest, None)
        if not isinstance(content, Branch):
            reason = f'"{part}" of "{name}" must be followed by something in parentheses'
            raise InputError(source, reason, part.line)
        if part in parts:
            raise InputError(source, f'"{name}" has {part} twice', part.line)
        parts[str(part)] = content
    parameters = typed_variables(
        parts.get(':parameters', section.like([])), types, source, f'"{name}"', name.line
    )
    if keyword == DURATIVE and ':duration' not in parts:
        raise InputError(source, f'"{name}" has no :duration', name.line)
    return Action(name, keyword == DURATIVE, parameters, parts, section)


def effects(tree: Tree | None, source: str, durative: bool) -> Iterator[Effect]:
    """Yield the effects one by one, quantifiers and conditions joined from outside in."""
    if tree is not None:
        yield from _effects(tree, source, Effect((), (), Branch()), durative)


def _effects(tree: Tree, source: str, around: Effect, durative: bool) -> Iterator[Effect]:
    head = tree.head if isinstance(tree, Branch) else ''
    if not isinstance(tree, Branch) or (tree and not head):
        raise InputError(source, f'"{as_text(tree)[:80]}" is no effect', tree.line)
    if head in ('and', ''):
        for part in tree[1:]:
            yield from _effects(part, source, around, durative)
    elif head == 'forall' and len(tree) == 3 and isinstance(tree[1], Branch):
        inner = replace(around, variables=(*around.variables, tree[1]))
        yield from _effects(tree[2], source, inner, durative)
    elif head == 'when' and len(tree) == 3:
        conditions = [tree[1]]
        if durative and not around.phase:
            phases, conditions = _phases_of(tree[1], source)
            for effect in _effects(tree[2], source, around, durative):
                if phases - {effect.phase}:
                    raise InputError(
                        source,
                        'this effect depends on what held at another time than its own: that is '
                        'PDDL, but not supported here',
                        tree.line,
                        cure='Say (at start …) of both condition and effect, or (at end …).',
                    )
                yield replace(effect, conditions=(*conditions, *effect.conditions))
            return
        inner = replace(around, conditions=(*around.conditions, *conditions))
        yield from _effects(tree[2], source, inner, durative)
    elif durative and head == 'at' and len(tree) == 3 and tree[1] in ('start', 'end'):
        yield from _effects(tree[2], source, replace(around, phase=str(tree[1])), durative)
    elif head in _FORMS:
        reason = f'"{as_text(tree)[:80]}" is no effect: write {_FORMS[head]}'
        raise InputError(source, reason, tree.line)
    elif head in ('or', 'imply', 'exists'):
        reason = f'"{as_text(tree)[:80]}" is no effect: "{head}" is for conditions only'
        raise InputError(source, reason, tree.line)
    else:
        yield replace(around, change=tree)


def _phases_of(condition: Tree, source: str) -> tuple[set[str], list[Tree]]:
    """Return when the parts of a durative effect's condition must hold, and these parts."""
    phases, conditions = set[str](), list[Tree]()
    for phase, part in timed_conditions(condition, source):
        phases.add(phase)
        conditions.append(part)
    return phases, conditions


def timed_conditions(tree: Tree | None, source: str) -> Iterator[tuple[str, Tree]]:
    """Yield the conditions of a durative action with 'start', 'all' or 'end'."""
    if tree is None:
        return
    head = tree.head if isinstance(tree, Branch) else ''
    if isinstance(tree, Branch) and head in ('and', '') and (head or not tree):
        for part in tree[1:]:
            yield from timed_conditions(part, source)
    elif isinstance(tree, Branch) and head == 'forall' and len(tree) == 3:
        for phase, part in timed_conditions(tree[2], source):
            yield phase, tree.like([tree[0], tree[1], part])
    elif (
        isinstance(tree, Branch)
        and len(tree) == 3
        and (head, tree[1]) in (('at', 'start'), ('at', 'end'), ('over', 'all'))
    ):
        yield str(tree[1]), tree[2]
    else:
        raise InputError(
            source,
            f'"{as_text(tree)[:80]}" does not say when it must hold: write (at start …), '
            '(over all …) or (at end …)',
            tree.line,
        )


def duration_bounds(action: Action, source: str) -> tuple[Tree | None, Tree | None]:
    """Return the least and the most that an action takes, None where it is open.

    Raises InputError for what is no duration.
    """
    tree = action.parts[':duration']
    assert isinstance(tree, Branch)
    least: Tree | None = None
    most: Tree | None = None
    for part in tree[1:] if tree.head == 'and' or not tree else [tree]:
        if isinstance(part, Branch) and part.head == 'at' and len(part) == 3:
            part = part[2]
        if (
            not isinstance(part, Branch)
            or len(part) != 3
            or part[1] != '?duration'
            or part.head not in ('=', '<=', '>=', '<', '>')
        ):
            raise InputError(
                source,
                f'"{as_text(part)[:80]}" is no duration of "{action.name}": write (= ?duration …)',
                part.line,
            )
        if part.head != '<' and part.head != '<=':
            least = part[2]
        if part.head != '>' and part.head != '>=':
            most = part[2]
    if least is None and most is None:  # any time will do
        return word('0', tree), None
    return least, most
