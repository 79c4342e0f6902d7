"""The metric as what actions cost: one total cost, to be minimised.

Planners for many beliefs know no other metric. Sums with factors and constants come to
that, where what each action adds to them is known from the start; any other is left out.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from mirror_explainer.pddl.expressions import number
from mirror_explainer.pddl.model import TOTAL_COST, duration_bounds
from mirror_explainer.pddl.numbers.arithmetic import (
    CHANGES,
    Numbers,
    TooManyError,
    decimal,
    used_variables,
)
from mirror_explainer.pddl.text.actions import Action, Effect, effects
from mirror_explainer.pddl.text.declarations import Kinds
from mirror_explainer.pddl.text.definition import Definition
from mirror_explainer.pddl.text.left_out import METRIC, LeftOut
from mirror_explainer.pddl.text.tree import Branch, Tree, Word, made, word

TOTAL_TIME = 'total-time'
# Planners add up integers: larger ones are taken less finely.
_LARGEST = 1_000_000

# A function of objects, or the total time: what the metric adds up, with its factor.
_Terms = dict[tuple[str, ...], Fraction]


class _NoSumError(Exception):
    """The metric is no sum of what actions cost."""


@dataclass(frozen=True)
class Priced:
    """A task whose metric, if there is one, is to minimise the total cost or time."""

    domain: Definition
    problem: Definition
    actions: tuple[Action, ...]


def with_costs(
    domain: Definition,
    problem: Definition,
    actions: Sequence[Action],
    numbers: Numbers,
    left_out: LeftOut,
) -> Priced:
    """Return the task with its metric as costs of actions.

    Without a metric, or with one that is left out, there are no costs.
    """
    metric = problem.section(':metric')
    unpriced = Priced(
        _without_total(domain, ':functions'),
        _without_total(problem.without(':metric'), ':init'),
        tuple(_without_changes(action, {TOTAL_COST}, domain.source) for action in actions),
    )
    if metric is None:
        return unpriced
    durative = any(action.durative for action in actions)
    try:
        if len(metric) != 3 or metric[1] not in ('minimize', 'maximize'):
            return Priced(domain, problem, tuple(actions))  # its reader says what is wrong
        terms = _terms(metric[2], Fraction(1 if metric[1] == 'minimize' else -1), numbers)
        if not durative:
            terms.pop((TOTAL_TIME,), None)
        if not terms:
            return unpriced
        if terms.keys() == {(TOTAL_TIME,)} and terms[(TOTAL_TIME,)] > 0:
            return unpriced  # durations are what durative actions cost, if nothing else is
        if terms == {(TOTAL_COST,): 1} and _is_plain(domain, actions, numbers):
            least = made(f'(:metric minimize ({TOTAL_COST}))', metric)
            return Priced(domain, problem.having(':metric', least), tuple(actions))
        return _Pricing(domain, problem, numbers, terms).priced(actions)
    except (_NoSumError, TooManyError):
        left_out.note(METRIC, problem.source, metric)
        return unpriced


def _terms(tree: Tree, factor: Fraction, numbers: Numbers) -> _Terms:
    """Return what a metric adds up. Raises _NoSumError."""
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
        raise _NoSumError
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
            if _changed(effect.change) == TOTAL_COST
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

    def __init__(
        self, domain: Definition, problem: Definition, numbers: Numbers, terms: _Terms
    ) -> None:
        self._domain = domain
        self._problem = problem
        self._numbers = numbers
        self._terms = terms
        self._summed = {term[0] for term in terms}
        self._tables: dict[str, tuple[dict[str, Kinds], dict[tuple[str, ...], Fraction]]] = {}

    def priced(self, actions: Sequence[Action]) -> Priced:
        """Return the task with costs. Raises _NoSumError."""
        costs = [self._cost(action) for action in actions]
        kept = [
            _with_cost(_without_changes(action, {TOTAL_COST}, self._domain.source), cost)
            for action, cost in zip(actions, costs, strict=True)
        ]
        return Priced(self._with_functions(), self._with_values(), tuple(kept))

    def _cost(self, action: Action) -> str:
        """Return the PDDL text of what an action costs, '' for nothing."""
        source = self._domain.source
        parts: list[tuple[Effect, Tree, Fraction]] = []
        for effect in effects(action.parts.get(':effect'), source, action.durative):
            if _changed(effect.change) in self._summed:
                if (
                    effect.change.head not in ('increase', 'decrease')
                    or effect.variables
                    or effect.conditions
                    or not self._numbers.is_static(effect.change[2])
                ):
                    raise _NoSumError
                sign = Fraction(1 if effect.change.head == 'increase' else -1)
                parts.append((effect, effect.change[2], sign))
        duration: Tree | None = None
        if (TOTAL_TIME,) in self._terms and action.durative:
            least, most = duration_bounds(action, source)
            duration = least if least is not None else most
            assert duration is not None
            if not self._numbers.is_static(duration):
                raise _NoSumError
        trees = [duration] if duration is not None else []
        trees += [tree for effect, _, _ in parts for tree in (effect.change[1], effect.change[2])]
        names = dict.fromkeys(name for tree in trees for name in used_variables(tree))
        variables = {name: action.parameters[name] for name in names if name in action.parameters}
        values: dict[tuple[str, ...], Fraction] = {}
        for binding in self._numbers.bindings(variables):
            total = Fraction(0)
            known = True
            for effect, tree, sign in parts:
                target = effect.change[1]
                term = (target,) if isinstance(target, Word) else tuple(target)
                factor = self._terms.get(tuple(binding.get(str(w), str(w)) for w in term))
                value = self._numbers.value(tree, binding)
                known = known and (value is not None or not factor)
                total += sign * (factor or 0) * (value or 0)
            if duration is not None:
                time = self._numbers.value(duration, binding)
                known = known and time is not None
                total += self._terms[(TOTAL_TIME,)] * (time or 0)
            if total < 0:
                raise _NoSumError
            if known:
                values[tuple(binding.values())] = total
        if len(set(values.values())) == 1 and (not variables or len(values) > 1):
            value = next(iter(values.values()))
            return decimal(value) if value else ''
        if not values:
            return ''
        name = f'cost-of-{action.name}'
        while name in self._numbers.declared.functions or name in self._tables:
            name += '-'
        self._tables[name] = (variables, values)
        return f'({" ".join([name, *variables])})'

    def _with_functions(self) -> Definition:
        """Return the domain with the functions that costs need."""
        place = self._domain.section(':functions') or Branch((), self._domain.line)
        contents = self._domain.contents(':functions')
        if TOTAL_COST not in self._numbers.declared.functions:
            contents = [*contents, made(f'({TOTAL_COST})', place)]
        for name, (variables, _) in self._tables.items():
            typed = [f'{v} - {kinds[0]}' for v, kinds in variables.items()]
            contents = [*contents, made(f'({" ".join([name, *typed])})', place)]
        return self._domain.with_contents(':functions', contents)

    def _with_values(self) -> Definition:
        """Return the problem with the values of costs, and their sum to be minimised."""
        metric = self._problem.section(':metric')
        assert metric is not None
        most = max((v for _, values in self._tables.values() for v in values.values()), default=0)
        digits = next((d for d in range(6, 0, -1) if most * 10**d <= _LARGEST), 0)
        place = self._problem.section(':init') or metric
        new: list[Tree] = [
            _equation([name, *objects], decimal(value, digits), place)
            for name, (_, values) in self._tables.items()
            for objects, value in values.items()
        ]
        old = [
            part
            for part in self._problem.contents(':init')
            if not (isinstance(part, Branch) and part.head == '=' and _names_total(part))
        ]
        problem = self._problem.with_contents(
            ':init', [*old, _equation([TOTAL_COST], '0', place), *new]
        )
        least = made(f'(:metric minimize ({TOTAL_COST}))', metric)
        return problem.having(':metric', least)


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


def _changed(change: Branch) -> str:
    """Return the function that an effect changes, '' if it changes none."""
    if change.head not in CHANGES or len(change) != 3:
        return ''
    return change[1].head if isinstance(change[1], Branch) else str(change[1])


def _without_changes(action: Action, functions: set[str], source: str) -> Action:
    """Return an action without effects on some functions."""
    every = [*effects(action.parts.get(':effect'), source, action.durative)]
    kept = [effect for effect in every if _changed(effect.change) not in functions]
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
