"""Tasks with durative actions as tasks without: each action happens at once, and costs its time.

unified-planning's compiler merges what an action needs and does at its start, all
the while, and at its end. It drops durations, and gets some rare actions wrong;
so here durations become costs, and actions that it would get wrong are refused.
Only the durative actions' text is written anew: no name changes.
"""

import itertools
import re
from collections.abc import Iterator
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction

import unified_planning.model as up
from unified_planning.engines import CompilationKind
from unified_planning.engines.compilers.timed_to_sequential import TimedToSequential
from unified_planning.exceptions import UPException
from unified_planning.io.pddl_writer import ConverterToPDDLString
from unified_planning.model.metrics import MinimizeActionCosts, MinimizeSequentialPlanLength

from mirror_explainer.errors import InputError
from mirror_explainer.pddl.derived import Axioms
from mirror_explainer.pddl.sections import (
    line_at,
    section,
    sections,
    without_comments,
    without_values,
)

_DURATIVE = ':durative-action'
# Planners add up integers: larger ones are taken less finely.
_LARGEST = 1_000_000
_ANOTHER_WAY = 'so it cannot be taken as an action that happens at once'


def is_durative(domain: str) -> bool:
    """Say whether the domain has durative actions."""
    return section(domain, _DURATIVE) is not None


def require_fixed_durations(domain: str, source: str) -> None:
    """Raise InputError, with its line, for what no compiler makes an action without duration."""
    plain = without_comments(domain)
    for name, start, end in _durative_actions(domain):
        text = plain[start:end]
        duration = re.search(r':duration\b\s*(\(\s*=\s*\?duration\b)?', text, re.IGNORECASE)
        if duration and not duration[1]:
            raise InputError(
                source,
                f'the duration of "{name}" is not of the form (= ?duration …): duration '
                'inequalities leave the time an action takes open, and cannot be compiled',
                line_at(domain, start + duration.start()),
            )
        continuous = re.search(r'#t\b', text, re.IGNORECASE)
        if continuous:
            raise InputError(
                source,
                f'"{name}" has a continuous effect (#t), {_ANOTHER_WAY}',
                line_at(domain, start + continuous.start()),
            )
        uses = [*re.finditer(r'\?duration\b', text, re.IGNORECASE)]
        if len(uses) > 1:
            raise InputError(
                source,
                f'"{name}" uses ?duration outside :duration, {_ANOTHER_WAY}',
                line_at(domain, start + uses[1].start()),
            )


def sequential_texts(
    model: up.Problem,
    axioms: Axioms | None,
    domain: str,
    problem: str,
    domain_source: str,
    problem_source: str,
) -> tuple[str, str]:
    """Return the texts of the same task without durative actions.

    `model` and `axioms` are the task as read. An action costs its duration, one without takes
    no time; a metric of the total cost is kept instead. Raises InputError that
    names the place of what cannot be compiled.
    """
    places = {name: (start, end) for name, start, end in _durative_actions(domain)}
    lines = {name: line_at(domain, start) for name, (start, _) in places.items()}
    _require_metric_of_costs(model, problem, problem_source)
    _require_no_timed_facts(model, problem, problem_source)
    durative = [action for action in model.actions if isinstance(action, up.DurativeAction)]
    for action in durative:
        reason = _why_not(action, axioms)
        if reason:
            raise InputError(
                domain_source, f'"{action.name}" has {reason}, {_ANOTHER_WAY}', lines[action.name]
            )
    compiler = TimedToSequential()
    compiler.skip_checks = True  # it takes more than it says, such as conditional effects
    try:
        compiled = compiler.compile(model, CompilationKind.TIMED_TO_SEQUENTIAL).problem
    except UPException as error:
        raise InputError(domain_source, f'its durative actions cannot be compiled: {error}') from (
            error
        )
    for action in durative:
        _mend(compiled.action(action.name), action)
    _require_no_concurrency(model, compiled, domain_source, lines)
    costs = _Costs(model, domain_source, lines)
    new_texts = {
        action.name: _action_text(compiled.action(action.name), costs.of(action))
        for action in durative
    }
    for name, (start, end) in reversed(places.items()):
        domain = domain[:start] + new_texts[name] + domain[end:]
    for name in costs.idle(compiled):
        problem = without_values(problem, name)
    return _with_functions(domain, costs), _with_costs(problem, costs)


def _durative_actions(domain: str) -> Iterator[tuple[str, int, int]]:
    """Yield each durative action's name in lower case, and where its text starts and ends."""
    plain = without_comments(domain)
    for part in sections(domain):
        if part.keyword == _DURATIVE:
            words = re.match(r'\(\s*\S+\s+([^\s():]+)', plain[part.start : part.end])
            yield words[1].lower() if words else '', part.start, part.end


def _require_metric_of_costs(model: up.Problem, problem: str, source: str) -> None:
    metrics = model.quality_metrics
    if metrics and not isinstance(metrics[0], MinimizeActionCosts | MinimizeSequentialPlanLength):
        part = section(problem, ':metric')
        raise InputError(
            source,
            'with durative actions, the metric can be to minimize (total-time) or (total-cost) '
            'only',
            line_at(problem, part.start) if part else None,
        )


def _require_no_timed_facts(model: up.Problem, problem: str, source: str) -> None:
    if model.timed_effects:
        found = re.search(r'\(\s*at\s+[\d.]+\s*\(', without_comments(problem), re.IGNORECASE)
        raise InputError(
            source,
            'it has timed initial literals, (at TIME …): what happens by itself while the robot '
            'acts cannot be explained',
            line_at(problem, found.start()) if found else None,
        )


def _parts(condition: up.FNode) -> Iterator[up.FNode]:
    """Yield the conditions that one condition asks for together."""
    if condition.is_and():
        for part in condition.args:
            yield from _parts(part)
    elif not condition.is_true():
        yield condition


def _literal(condition: up.FNode) -> tuple[up.FNode, bool] | None:
    """Return a literal's atom and whether it must hold, None for other conditions."""
    atom = condition.arg(0) if condition.is_not() else condition
    return (atom, not condition.is_not()) if atom.is_fluent_exp() else None


def _effects(action: up.DurativeAction) -> tuple[list[up.Effect], list[up.Effect]]:
    """Return the effects at the start and those at the end."""
    return (
        list(action.effects.get(up.StartTiming(), [])),
        list(action.effects.get(up.EndTiming(), [])),
    )


def _later_conditions(action: up.DurativeAction) -> list[up.FNode]:
    """Return the conditions over all and at end."""
    return [
        part
        for interval, conditions in action.conditions.items()
        if interval.upper == up.EndTiming()
        for condition in conditions
        for part in _parts(condition)
    ]


def _why_not(action: up.DurativeAction, axioms: Axioms | None) -> str:
    """Say in a few words what of the action the compiler gets wrong, "" if nothing."""
    start, end = _effects(action)
    later = _later_conditions(action)

    def used(*expressions: up.FNode) -> set[up.Fluent]:
        extractor = action.environment.free_vars_extractor
        return {atom.fluent() for e in expressions for atom in extractor.get(e)}

    if any(effect.is_forall() for effect in [*start, *end]):
        return 'an effect for all objects of a type (forall)'
    if any(effect.is_decrease() for effect in start):
        return 'a number that decreases at its start'
    at_end = used(*(e for effect in end for e in (effect.fluent, effect.value, effect.condition)))
    if any(
        effect.is_conditional() and effect.fluent.fluent() in at_end | used(*later)
        for effect in start
    ):
        return 'a conditional effect at its start on what matters again later'
    changed = {effect.fluent.fluent() for effect in start}
    if any(effect.is_conditional() and effect.fluent.fluent() in changed for effect in end):
        return 'a conditional effect at its end on what changes at its start'
    if any(_literal(condition) is None and changed & used(condition) for condition in later):
        return 'a condition later than its start, and no plain fact, on what its start changes'
    derived = axioms.fluents & (at_end | used(*later)) if axioms else frozenset()
    if axioms and changed & axioms.basis(derived):
        return 'a derived condition later than its start on what its start changes'
    return ''


def _mend(compiled: up.InstantaneousAction, action: up.DurativeAction) -> None:
    """Put right what the compiler overlooks: two names in an action may stand for one object.

    What the start makes untrue of one, it makes untrue of the other. Where an
    effect at the start would outlast an opposite one at the end, the two names
    must stand for different objects.
    """
    start, end = _effects(action)
    later = [literal for part in _later_conditions(action) if (literal := _literal(part))]
    removed_later = [(e.fluent, False) for e in end if e.value.is_false()]
    for effect in start:
        for atom, value in [*later, *(removed_later if effect.value.is_true() else [])]:
            if atom.fluent() != effect.fluent.fluent() or atom == effect.fluent:
                continue
            opposite = effect.value.is_false() if value else effect.value.is_true()
            if opposite:
                different = _different(effect.fluent, atom)
                if not different.is_true():
                    compiled.add_precondition(different)
        for added in end:
            same = added.fluent.fluent() == effect.fluent.fluent()
            kept = any(other.fluent == added.fluent for other in compiled.effects)
            if same and added.value.is_true() and added.fluent != effect.fluent and not kept:
                compiled.add_effect(added.fluent, True, added.condition)


def _different(one: up.FNode, other: up.FNode) -> up.FNode:
    """Return the condition that two atoms of a predicate are different: true if it is certain."""
    manager = one.environment.expression_manager
    equal = []
    for left, right in zip(one.args, other.args, strict=True):
        if left == right:
            continue
        related = left.type.is_compatible(right.type) or right.type.is_compatible(left.type)
        if not related or (left.is_object_exp() and right.is_object_exp()):
            return manager.TRUE()
        equal.append(manager.Equals(left, right))
    return manager.Not(manager.And(equal))


def _require_no_concurrency(
    model: up.Problem, compiled: up.Problem, source: str, lines: dict[str, int]
) -> None:
    """Raise InputError if an action needs a fact that holds only while another action runs."""
    lasting = {
        e.fluent.fluent() for a in compiled.actions for e in a.effects if not e.value.is_false()
    } | {atom.fluent() for atom, value in model.explicit_initial_values.items() if value.is_true()}
    passing = {
        effect.fluent.fluent(): action.name
        for action in model.actions
        if isinstance(action, up.DurativeAction)
        for effect in _effects(action)[0]
        if effect.value.is_true() and effect.fluent.fluent() not in lasting
    }
    for action in compiled.actions:
        for condition in itertools.chain.from_iterable(map(_parts, action.preconditions)):
            fact = condition.fluent() if condition.is_fluent_exp() else None
            if fact and passing.get(fact, action.name) != action.name:
                raise InputError(
                    source,
                    f'"{action.name}" needs "{fact.name}", which holds only while '
                    f'"{passing[fact]}" is going on: plans whose actions must overlap cannot be '
                    'explained',
                    lines.get(action.name),
                )


@dataclass(frozen=True)
class _Table:
    """A function made up for a duration that is calculated: its name, parameters and values."""

    name: str
    parameters: tuple[up.Parameter, ...]
    values: dict[tuple[str, ...], Fraction]


class _Costs:
    """Durations as costs, in the one form that planners take: a number, or a function's value."""

    def __init__(self, model: up.Problem, source: str, lines: dict[str, int]) -> None:
        self._model = model
        self._source = source
        self._lines = lines
        self._static = model.get_static_fluents()
        self._converter = _converter(model)
        self.by_duration = not model.quality_metrics
        self.tables: list[_Table] = []
        self._kept: set[str] = set()

    def of(self, action: up.DurativeAction) -> str:
        """Return the cost's PDDL text, "" for no cost."""
        metric = self._model.quality_metrics[0] if self._model.quality_metrics else None
        if isinstance(metric, MinimizeSequentialPlanLength):
            return '1'
        if metric:
            cost = metric.get_action_cost(action)
            return self._text(action, cost) if cost is not None else ''
        return self._text(action, action.duration.lower)

    def _text(self, action: up.DurativeAction, cost: up.FNode) -> str:
        cost = cost.simplify()
        fluents = self._model.environment.free_vars_extractor.get(cost)
        moving = [atom for atom in fluents if atom.fluent() not in self._static]
        if moving:
            raise self._refusal(
                action, f'takes a time, {moving[0]}, that changes as the plan runs'
            )
        if cost.is_constant():
            return self._number(action, Fraction(cost.constant_value()))
        if cost.is_fluent_exp() and not (self.by_duration and self._is_finer(cost.fluent())):
            self._kept.add(cost.fluent().name)
            return str(self._converter.convert(cost))
        table = self._table(action, cost)
        self.tables.append(table)
        return f'({" ".join([table.name, *(f"?{p.name}" for p in table.parameters)])})'

    def _is_finer(self, function: up.Fluent) -> bool:
        """Say whether the function has values with more than three decimals."""
        return any(
            Fraction(value.constant_value()) * 1000 % 1
            for atom, value in self._model.explicit_initial_values.items()
            if atom.fluent() == function
        )

    def idle(self, compiled: up.Problem) -> set[str]:
        """Return the functions that nothing depends on any more."""
        extractor = compiled.environment.free_vars_extractor
        needed = [*compiled.goals]
        for action in compiled.actions:
            needed += action.preconditions
            for effect in action.effects:
                needed += [effect.fluent, effect.value, effect.condition]
        used = {atom.fluent().name for e in needed for atom in extractor.get(e)} | self._kept
        numbers = {f.name for f in compiled.fluents if not f.type.is_bool_type()}
        return numbers - used if self.by_duration else set()

    def values(self) -> Iterator[str]:
        """Yield the values of the functions made up, for a problem's initial state."""
        most = max((n for table in self.tables for n in table.values.values()), default=0)
        digits = next((d for d in (3, 2, 1) if most * 10**d <= _LARGEST), 0)
        for table in self.tables:
            for names, number in table.values.items():
                yield f'(= ({" ".join([table.name, *names])}) {number_text(number, digits)})'

    def _table(self, action: up.DurativeAction, cost: up.FNode) -> _Table:
        """Work the expression out for all objects that it may be about."""
        manager = self._model.environment.expression_manager
        extractor = self._model.environment.free_vars_extractor
        named = {
            argument.parameter()
            for atom in extractor.get(cost)
            for argument in atom.args
            if argument.is_parameter_exp()
        }
        parameters = tuple(p for p in action.parameters if p in named)
        values = {}
        for objects in itertools.product(*(self._model.objects(p.type) for p in parameters)):
            bound = dict(
                zip(
                    map(manager.ParameterExp, parameters),
                    map(manager.ObjectExp, objects),
                    strict=True,
                )
            )
            ground = cost.substitute(bound)
            known = self._model.explicit_initial_values
            atoms = extractor.get(ground)
            if all(atom in known for atom in atoms):
                try:
                    value = ground.substitute({atom: known[atom] for atom in atoms}).simplify()
                    number = Fraction(value.constant_value())
                except ZeroDivisionError:
                    raise self._refusal(action, 'takes a time that divides by zero') from None
                self._number(action, number)  # it must be one that can be written
                values[tuple(item.name for item in objects)] = number
        name = f'duration-of-{action.name}'
        while self._model.has_fluent(name) or self._model.has_name(name):
            name += '-'
        return _Table(name, parameters, values)

    def _number(self, action: up.DurativeAction, number: Fraction) -> str:
        if number < 0:
            raise self._refusal(action, 'takes a time below zero')
        if not self.by_duration:
            return str(Decimal(number.numerator) / Decimal(number.denominator))
        return number_text(number, 3)

    def _refusal(self, action: up.DurativeAction, reason: str) -> InputError:
        return InputError(self._source, f'"{action.name}" {reason}', self._lines.get(action.name))


def number_text(number: Fraction, digits: int) -> str:
    """Return a number with at most so many decimals, exactly where they are enough."""
    rounded = Fraction(round(number * 10**digits), 10**digits)
    whole, rest = divmod(rounded, 1)
    decimals = str(int(rest * 10**digits)).zfill(digits).rstrip('0')
    return f'{whole}.{decimals}' if decimals else str(whole)


def _converter(model: up.Problem) -> ConverterToPDDLString:
    """Return unified-planning's writer of expressions, with names as they are."""

    def name(item: up.Parameter | up.Variable | up.Fluent | up.Object | up.Type) -> str:
        bound = isinstance(item, up.Parameter | up.Variable)
        return f'?{item.name}' if bound else str(item.name)

    return ConverterToPDDLString(model.environment, name)


def _action_text(action: up.InstantaneousAction, cost: str) -> str:
    converter = _converter(action)
    parameters = ' '.join(f'?{p.name} - {p.type.name}' for p in action.parameters)
    conditions = [condition.simplify() for condition in action.preconditions]
    needs = [
        '(or)' if condition.is_false() else converter.convert(condition)
        for condition in conditions
        if not condition.is_true()
    ]
    effects = [text for effect in action.effects if (text := _effect_text(effect, converter))]
    if cost:
        effects.append(f'(increase (total-cost) {cost})')
    return (
        f'(:action {action.name}\n    :parameters ({parameters})\n'
        f'    :precondition (and {" ".join(needs)})\n    :effect (and {" ".join(effects)}))'
    )


def _effect_text(effect: up.Effect, converter: ConverterToPDDLString) -> str:
    """Return an effect's PDDL text, "" if it never happens."""
    condition, value = effect.condition.simplify(), effect.value.simplify()
    if condition.is_false():
        return ''
    atom = converter.convert(effect.fluent)
    if value.is_bool_constant():
        text = atom if value.is_true() else f'(not {atom})'
    else:
        change = 'increase' if effect.is_increase() else 'assign'
        text = f'({change} {atom} {converter.convert(value)})'
    return text if condition.is_true() else f'(when {converter.convert(condition)} {text})'


def _with_functions(domain: str, costs: _Costs) -> str:
    """Return the domain with the functions that its costs need."""
    functions = section(domain, ':functions')
    plain = without_comments(domain)
    declared = plain[functions.start : functions.end].lower() if functions else ''
    new = [] if re.search(r'\(\s*total-cost\s*\)', declared) else ['(total-cost)']
    for table in costs.tables:
        typed = [f'?{p.name} - {p.type.name}' for p in table.parameters]
        new.append(f'({" ".join([table.name, *typed])})')
    if functions:
        place = plain.lower().index(':functions', functions.start) + len(':functions')
        return f'{domain[:place]} {" ".join(new)}{domain[place:]}'
    first = next(part.start for part in sections(domain) if part.keyword == ':action')
    return f'{domain[:first]}(:functions {" ".join(new)})\n  {domain[first:]}'


def _with_costs(problem: str, costs: _Costs) -> str:
    """Return the problem with the values of costs, and their sum to be minimized."""
    if costs.by_duration:
        end = problem.rindex(')', 0, len(without_comments(problem).rstrip()))
        problem = f'{problem[:end]}(:metric minimize (total-cost))\n{problem[end:]}'
    values = [*costs.values()]
    init = section(problem, ':init')
    assert init is not None  # the reader asks for one
    plain = without_comments(problem)
    if not re.search(r'\(\s*=\s*\(\s*total-cost\s*\)', plain[init.start : init.end].lower()):
        values.append('(= (total-cost) 0)')
    place = plain.lower().index(':init', init.start) + len(':init')
    return f'{problem[:place]} {" ".join(values)}{problem[place:]}'
