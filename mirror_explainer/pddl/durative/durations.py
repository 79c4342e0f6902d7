"""How long durative actions take, as what the actions cost that happen at once."""

import itertools
from collections.abc import Iterator
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction

import unified_planning.model as up
from unified_planning.io.pddl_writer import ConverterToPDDLString
from unified_planning.model.metrics import MinimizeSequentialPlanLength

from mirror_explainer.errors import InputError

# Planners add up integers: larger ones are taken less finely.
_LARGEST = 1_000_000


@dataclass(frozen=True)
class Table:
    """A function made up for a duration that is calculated: its name, parameters and values."""

    name: str
    parameters: tuple[up.Parameter, ...]
    values: dict[tuple[str, ...], Fraction]


class Costs:
    """Durations as costs, in the one form that planners take: a number, or a function's value.

    `source` names the domain in errors, `lines` has those of the durative actions;
    `converter` writes expressions. `tables` are the functions that had to be made up.
    """

    def __init__(
        self,
        model: up.Problem,
        source: str,
        lines: dict[str, int],
        converter: ConverterToPDDLString,
    ) -> None:
        self._model = model
        self._source = source
        self._lines = lines
        self._static = model.get_static_fluents()
        self._converter = converter
        self.by_duration = not model.quality_metrics
        self.tables: list[Table] = []
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
            if atom.fluent() == function and value.is_constant()
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
                yield f'(= ({" ".join([table.name, *names])}) {_number_text(number, digits)})'

    def _table(self, action: up.DurativeAction, cost: up.FNode) -> Table:
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
                except ZeroDivisionError:
                    raise self._refusal(action, 'takes a time that divides by zero') from None
                if not value.is_constant():
                    raise self._refusal(action, f'takes a time, {value}, that is no number')
                number = Fraction(value.constant_value())
                self._number(action, number)  # it must be one that can be written
                values[tuple(item.name for item in objects)] = number
        name = f'duration-of-{action.name}'
        while self._model.has_fluent(name) or self._model.has_name(name):
            name += '-'
        return Table(name, parameters, values)

    def _number(self, action: up.DurativeAction, number: Fraction) -> str:
        if number < 0:
            raise self._refusal(action, 'takes a time below zero')
        if not self.by_duration:
            return str(Decimal(number.numerator) / Decimal(number.denominator))
        return _number_text(number, 3)

    def _refusal(self, action: up.DurativeAction, reason: str) -> InputError:
        return InputError(self._source, f'"{action.name}" {reason}', self._lines.get(action.name))


def _number_text(number: Fraction, digits: int) -> str:
    """Return a number with at most so many decimals, exactly where they are enough."""
    rounded = Fraction(round(number * 10**digits), 10**digits)
    whole, rest = divmod(rounded, 1)
    decimals = str(int(rest * 10**digits)).zfill(digits).rstrip('0')
    return f'{whole}.{decimals}' if decimals else str(whole)
