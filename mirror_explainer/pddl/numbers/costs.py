"""The metric as what actions cost: one total cost, to be minimised.

Planners for many beliefs know no other metric. Sums with factors and constants come to
that, where what each action adds to them is known from the start; any other is left out.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from mirror_explainer.errors import InputError, did_you_mean
from mirror_explainer.pddl.numbers.arithmetic import (
    Binding,
    Numbers,
    TooManyError,
    changed_function,
    decimal,
    used_variables,
)
from mirror_explainer.pddl.text.actions import (
    TOTAL_COST,
    Action,
    Effect,
    Parts,
    duration_bounds,
    effects,
)
from mirror_explainer.pddl.text.declarations import Kinds
from mirror_explainer.pddl.text.definition import Definition
from mirror_explainer.pddl.text.left_out import CHANGING_DURATIONS, METRIC, METRIC_UNKNOWN, LeftOut
from mirror_explainer.pddl.text.numerals import number
from mirror_explainer.pddl.text.tree import Branch, Tree, Word, as_text, made, word

TOTAL_TIME = 'total-time'
# Planners add up integers: larger ones are taken less finely.
_LARGEST = 1_000_000

# A function of objects, or the total time: what the metric adds up, with its factor.
_Terms = dict[tuple[str, ...], Fraction]
# Effects that change what the metric adds up, with their signs.
_Added = list[tuple[Effect, Fraction]]


@dataclass(frozen=True)
class _Table:
    """What an action costs by the objects for some of its variables.

    `function` is the one of the domain whose value that is, if there is one.
    """

    variables: Mapping[str, Kinds]
    values: Mapping[tuple[str, ...], Fraction]
    function: Tree | None = None


class _NoSumError(Exception):
    """The metric is no sum of what actions cost."""


class _UnknownFunctionError(Exception):
    """The metric names a function that is not declared."""


def with_costs(parts: Parts, numbers: Numbers, left_out: LeftOut) -> Parts:
    """Return the task with its metric, if there is one, as costs of actions.

    It is then to minimise the total cost or time. Without a metric, or with one that is left
    out, there are no costs.
    """
    domain, problem, actions = parts.domain, parts.problem, parts.actions
    metric = problem.section(':metric')
    unpriced = Parts(
        _without_total(domain, ':functions'),
        _without_total(problem.without(':metric'), ':init'),
        tuple(_without_changes(action, {TOTAL_COST}, domain.source) for action in actions),
    )
    durative = any(action.durative for action in actions)
    if metric is None and not durative:
        return unpriced
    try:
        if metric is None:
            terms: _Terms = {(TOTAL_TIME,): Fraction(1)}
            return _Pricing(unpriced, numbers, terms, left_out).priced()
        if len(metric) != 3 or metric[1] not in ('minimize', 'maximize'):
            return parts  # its reader says what is wrong
        terms = _terms(metric[2], Fraction(1 if metric[1] == 'minimize' else -1), numbers)
        if not durative:
            terms.pop((TOTAL_TIME,), None)
        if not terms:
            return unpriced
        if terms == {(TOTAL_COST,): 1} and _is_plain(domain, actions, numbers):
            least = made(f'(:metric minimize ({TOTAL_COST}))', metric)
            return replace(parts, problem=problem.having(':metric', least))
        return _Pricing(parts, numbers, terms, left_out).priced()
    except (_NoSumError, TooManyError):
        left_out.note(METRIC, problem.source, metric)
    except _UnknownFunctionError as unknown:
        left_out.note(METRIC_UNKNOWN, problem.source, metric, str(unknown))
    return unpriced


def _terms(tree: Tree, factor: Fraction, numbers: Numbers) -> _Terms:
    """Return what a metric adds up. Raises _NoSumError, _UnknownFunctionError."""
    head = tree.head if isinstance(tree, Branch) else str(tree)
    parts = tree[1:] if isinstance(tree, Branch) else []
    if isinstance(tree, Word) and number(tree) is not None:
        return {}
    if head == 'is-violated':
        return {}
    if head in ('+', '-') and parts:
        found: _Terms = {}
        for index, part in enumerate(parts):
            negative = head == '-' and (index > 0 or len(parts) == 1)
            for term, value in _terms(part, -factor if negative else factor, numbers).items():
                found[term] = found.get(term, Fraction(0)) + value
        return {term: value for term, value in found.items() if value}
    if head in ('*', '/') and len(parts) == 2:
        left, right = (_constant(part, numbers) for part in parts)
        if right is not None and (head == '*' or right != 0):
            return _terms(parts[0], factor * right if head == '*' else factor / right, numbers)
        if left is not None and head == '*':
            return _terms(parts[1], factor * left, numbers)
        raise _NoSumError
    name = (head, *(str(part) for part in parts if isinstance(part, Word)))
    if head == TOTAL_TIME and not parts:
        return {name: factor}
    if head not in numbers.declared.functions:
        raise _UnknownFunctionError(as_text(tree) + did_you_mean(head, numbers.declared.functions))
    return {name: factor} if head in {*numbers.changing, TOTAL_COST} else {}


def _constant(tree: Tree, numbers: Numbers) -> Fraction | None:
    """Return the value of what stays the same, None if it does not."""
    return numbers.value(tree, {}) if numbers.is_static(tree) else None


def _is_plain(domain: Definition, actions: Sequence[Action], numbers: Numbers) -> bool:
    """Say whether each action adds a number, or a function's value, to the total cost."""
    for action in actions:
        found = [
            effect
            for effect in effects(action.parts.get(':effect'), domain.source, action.durative)
            if changed_function(effect.change) == TOTAL_COST
        ]
        for effect in found:
            value = effect.change[2]
            simple = isinstance(value, Word) or value.head in numbers.declared.functions
            if (
                len(found) > 1
                or effect.variables
                or effect.conditions
                or effect.change.head != 'increase'
                or not simple
                or not numbers.is_static(value)
            ):
                return False
            name = value.head if isinstance(value, Branch) else str(value)
            costs = [number(name), *(v for k, v in numbers.values.items() if k[0] == name)]
            if any(cost is not None and cost < 0 for cost in costs):
                return False
    return True


class _Pricing:
    """Works out what each action adds to a metric."""

    def __init__(self, parts: Parts, numbers: Numbers, terms: _Terms, left_out: LeftOut) -> None:
        self._domain, self._problem, self._actions = parts.domain, parts.problem, parts.actions
        self._numbers = numbers
        self._terms = terms
        self._left_out = left_out
        self._summed = {term[0] for term in terms}
        self._tables: dict[str, _Table] = {}
        self._digits = 0

    def priced(self) -> Parts:
        """Return the task with costs. Raises _NoSumError, TooManyError and InputError."""
        tables = [self._table(action) for action in self._actions]
        most = max((v for table in tables for v in table.values.values()), default=Fraction(0))
        self._digits = next((d for d in range(6, 0, -1) if most * 10**d <= _LARGEST), 0)
        kept = [
            _with_cost(
                _without_changes(action, {TOTAL_COST}, self._domain.source),
                self._cost(action, table),
            )
            for action, table in zip(self._actions, tables, strict=True)
        ]
        return Parts(self._with_functions(), self._with_values(), tuple(kept))

    def _cost(self, action: Action, table: '_Table') -> str:
        """Return the PDDL text of what an action costs, '' for nothing."""
        values = set(table.values.values())
        if not values:
            return ''
        if len(values) == 1 and (not table.variables or len(table.values) > 1):
            value = next(iter(values))
            return decimal(value, self._digits) if value else ''
        if table.function and all(v * 10**self._digits % 1 == 0 for v in values):
            return as_text(table.function)
        name = f'cost-of-{action.name}'
        while name in self._numbers.declared.functions or name in self._tables:
            name += '-'
        self._tables[name] = table
        return f'({" ".join([name, *table.variables])})'

    def _table(self, action: Action) -> '_Table':
        """Return what an action costs for the objects that it depends on."""
        parts = self._parts(action)
        duration: Tree | None = None
        if (TOTAL_TIME,) in self._terms and action.durative:
            least, most = duration_bounds(action, self._domain.source)
            duration = least if least is not None else most
            assert duration is not None
            if not self._numbers.is_static(duration):
                self._left_out.note(CHANGING_DURATIONS, self._domain.source, duration)
        trees = [duration] if duration is not None else []
        trees += [tree for effect, _ in parts for tree in effect.change[1:]]
        names = dict.fromkeys(name for tree in trees for name in used_variables(tree))
        variables = {name: action.parameters[name] for name in names if name in action.parameters}
        values: dict[tuple[str, ...], Fraction] = {}
        for binding in self._numbers.bindings(variables):
            added = [self._added(effect, factor, binding) for effect, factor in parts]
            if duration is not None:
                added.append(self._lasting(action, duration, binding))
            known = [value for value in added if value is not None]
            if sum(known) < 0:
                raise _NoSumError
            if len(known) == len(added):
                values[tuple(binding.values())] = sum(known, Fraction(0))
        return _Table(variables, values, self._function(parts, duration))

    def _function(self, parts: _Added, duration: Tree | None) -> Tree | None:
        """Return the function whose value is all that an action adds, if there is one."""
        if duration is not None:
            alone, factor = not parts, self._terms[(TOTAL_TIME,)]
        elif len(parts) == 1 and isinstance(parts[0][0].change[1], Branch):
            (effect, sign), alone = parts[0], True
            duration, target = effect.change[2], effect.change[1]
            factor = sign * self._terms.get(tuple(map(str, target)), Fraction(0))
        else:
            return None
        plain = isinstance(duration, Branch) and duration.head in self._numbers.declared.functions
        return duration if alone and plain and factor == 1 else None

    def _parts(self, action: Action) -> _Added:
        """Return the effects on what the metric adds up, with their signs."""
        parts: _Added = []
        for effect in effects(action.parts.get(':effect'), self._domain.source, action.durative):
            if changed_function(effect.change) in self._summed:
                if (
                    effect.change.head not in ('increase', 'decrease')
                    or effect.variables
                    or effect.conditions
                    or not self._numbers.is_static(effect.change[2])
                ):
                    raise _NoSumError
                parts.append((effect, Fraction(1 if effect.change.head == 'increase' else -1)))
        return parts

    def _added(self, effect: Effect, sign: Fraction, binding: Binding) -> Fraction | None:
        """Return what an effect adds to the metric, None where a number has no value."""
        target, tree = effect.change[1:]
        term = (target,) if isinstance(target, Word) else tuple(target)
        factor = self._terms.get(tuple(binding.get(str(w), str(w)) for w in term))
        if not factor:
            return Fraction(0)
        try:
            value = self._numbers.value(tree, binding)
        except ZeroDivisionError:
            raise _NoSumError from None
        return None if value is None else sign * factor * value

    def _lasting(self, action: Action, duration: Tree, binding: Binding) -> Fraction | None:
        """Return what the time that an action takes adds to the metric."""
        fault = 'takes a time that divides by zero'
        try:
            time = self._numbers.value(duration, binding)
            if time is None or time >= 0:
                return None if time is None else self._terms[(TOTAL_TIME,)] * time
            fault = 'takes a time below zero'
        except ZeroDivisionError:
            pass
        named = f' (for {", ".join(binding.values())})' if binding else ''
        raise InputError(self._domain.source, f'"{action.name}" {fault}{named}', duration.line)

    def _with_functions(self) -> Definition:
        """Return the domain with the functions that costs need."""
        place = self._domain.section(':functions') or Branch((), self._domain.line)
        contents = self._domain.contents(':functions')
        if not any(isinstance(part, Branch) and part.head == TOTAL_COST for part in contents):
            contents = [*contents, made(f'({TOTAL_COST})', place)]
        for name, table in self._tables.items():
            typed = [f'{v} - {kinds[0]}' for v, kinds in table.variables.items()]
            contents = [*contents, made(f'({" ".join([name, *typed])})', place)]
        return self._domain.with_contents(':functions', contents)

    def _with_values(self) -> Definition:
        """Return the problem with the values of costs, and their sum to be minimised."""
        place = self._problem.section(':init') or Branch((), self._problem.line)
        new: list[Tree] = [
            _equation([name, *objects], decimal(value, self._digits), place)
            for name, table in self._tables.items()
            for objects, value in table.values.items()
        ]
        old = [
            part
            for part in self._problem.contents(':init')
            if not (isinstance(part, Branch) and part.head == '=' and _names_total(part))
        ]
        problem = self._problem.with_contents(
            ':init', [*old, _equation([TOTAL_COST], '0', place), *new]
        )
        least = self._problem.section(':metric') or place
        return problem.having(':metric', made(f'(:metric minimize ({TOTAL_COST}))', least))


def _without_total(definition: Definition, keyword: str) -> Definition:
    """Return a definition that does not declare the total cost, or give it a value."""
    contents = definition.contents(keyword)
    kept = [
        part
        for part in contents
        if not isinstance(part, Branch)
        or not (part.head == TOTAL_COST or (part.head == '=' and _names_total(part)))
    ]
    if len(kept) == len(contents):
        return definition
    return definition.with_contents(
        keyword, kept if any(isinstance(part, Branch) for part in kept) else []
    )


def _names_total(part: Branch) -> bool:
    function = part[1] if len(part) > 1 else ''
    return (function.head if isinstance(function, Branch) else str(function)) == TOTAL_COST


def _equation(names: Sequence[str], value: str, place: Tree) -> Branch:
    function = Branch((word(name, place) for name in names), place.line, place.column)
    parts: list[Tree] = [word('=', place), function, word(value, place)]
    return Branch(parts, place.line, place.column)


def _without_changes(action: Action, functions: set[str], source: str) -> Action:
    """Return an action without effects on some functions."""
    every = [*effects(action.parts.get(':effect'), source, action.durative)]
    kept = [effect for effect in every if changed_function(effect.change) not in functions]
    return action if len(kept) == len(every) else with_effects(action, kept)


def _with_cost(action: Action, cost: str) -> Action:
    if not cost:
        return action
    place = action.section
    increase = made(f'(increase ({TOTAL_COST}) {cost})', place)
    if action.durative:
        increase = place.like([word('at', place), word('end', place), increase])
    effect = action.parts.get(':effect', place.like([word('and', place)]))
    return action.having(effect=place.like([word('and', place), effect, increase]))


def with_effects(action: Action, changes: Sequence[Effect]) -> Action:
    """Return an action with other effects."""
    place = action.parts.get(':effect', action.section)
    parts: list[Tree] = [word('and', place), *(effect.tree() for effect in changes)]
    effect = Branch(parts, place.line, place.column)
    return replace(action, parts={**action.parts, ':effect': effect})
