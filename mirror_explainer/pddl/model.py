"""A task as unified-planning's problem, made of the trees of its texts.

Made here and not by unified-planning's reader, which refuses legal texts, takes some
ten times longer, and tells what is wrong without names or lines.
"""

import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from fractions import Fraction

import unified_planning.exceptions as up_exceptions
import unified_planning.model as up
from unified_planning.model.metrics import (
    MaximizeExpressionOnFinalState,
    MinimizeActionCosts,
    MinimizeExpressionOnFinalState,
    MinimizeMakespan,
    MinimizeSequentialPlanLength,
)

from mirror_explainer.errors import InputError
from mirror_explainer.pddl.atoms import effects_in
from mirror_explainer.pddl.expressions import Bound, Expressions
from mirror_explainer.pddl.text.actions import (
    CHANGES,
    TOTAL_COST,
    Action,
    Effect,
    Parts,
    duration_bounds,
    effects,
    timed_conditions,
)
from mirror_explainer.pddl.text.declarations import Declarations, Declared
from mirror_explainer.pddl.text.initial import initial_values
from mirror_explainer.pddl.text.tree import Branch, Tree, Word, as_text


class Model(up.Problem):
    """A problem whose names were checked as they were read: kinds may share them, as in PDDL."""

    def has_name(self, name: str) -> bool:
        """Say no: unified-planning would look through all objects for each that is added."""
        return False


def build_model(
    parts: Parts, declared: Declarations, stop: Callable[[], None] | None = None
) -> up.Problem:
    """Return unified-planning's problem of a task in which each type is a single name.

    `stop` is called now and then, and may raise. Raises InputError with the line of
    what does not fit the declarations.
    """
    return _Builder(parts, declared, stop).build()


class _Builder:
    """Builds one model."""

    def __init__(
        self, parts: Parts, declared: Declarations, stop: Callable[[], None] | None
    ) -> None:
        self._domain, self._problem, self._actions = parts.domain, parts.problem, parts.actions
        self._declared = declared
        self._stop = stop
        self._model = Model(self._problem.name)
        self._environment = self._model.environment
        self._environment.error_used_name = False  # in what compilers make of it, too
        self._manager = self._environment.expression_manager
        self._expressions = Expressions(self._model)
        self._types: dict[str, up.Type] = {}

    def build(self) -> up.Problem:
        manager = self._environment.type_manager
        with warnings.catch_warnings():
            warnings.simplefilter('ignore')
            for name in self._declared.types:
                self._model._add_user_type(self._type(name))
            boolean, real = manager.BoolType(), manager.RealType()
            for predicate in self._declared.predicates.values():
                fluent = self._fluent(predicate, boolean)
                self._model.add_fluent(fluent, default_initial_value=False)
            for function in self._declared.functions.values():
                self._model.add_fluent(self._fluent(function, real))
            for name, kinds in self._declared.objects.items():
                self._model.add_object(up.Object(name, self._type(kinds[0]), self._environment))
            for action in self._actions:
                self._model.add_action(
                    self._durative(action) if action.durative else self._instantaneous(action)
                )
            self._add_initial_values()
            self._add_goal()
            self._add_metric()
        return self._model

    def _type(self, name: str) -> up.Type:
        if name not in self._types:
            above = self._declared.types[name]
            father = self._type(above[0]) if above else None
            self._types[name] = self._environment.type_manager.UserType(name, father)
        return self._types[name]

    def _fluent(self, declared: Declared, kind: up.Type) -> up.Fluent:
        # PDDL lets a predicate name two parameters alike.
        parameters = [
            up.Parameter(name[1:], self._type(kinds[0]), self._environment)
            for name, kinds in declared.parameters
        ]
        return up.Fluent(str(declared.name), kind, parameters, self._environment)

    def _bound(self, action: up.Action) -> dict[str, up.Parameter]:
        return {f'?{parameter.name}': parameter for parameter in action.parameters}

    def _parameters(self, action: Action) -> dict[str, up.Type]:
        return {name[1:]: self._type(kinds[0]) for name, kinds in action.parameters.items()}

    def _instantaneous(self, action: Action) -> up.InstantaneousAction:
        made = up.InstantaneousAction(
            str(action.name), self._parameters(action), self._environment
        )
        bound = self._bound(made)
        condition = action.parts.get(':precondition')
        if condition is not None:
            made.add_precondition(self._condition(condition, bound))
        self._add_effects(made, action, bound)
        return made

    def _durative(self, action: Action) -> up.DurativeAction:
        source = self._domain.source
        made = up.DurativeAction(str(action.name), self._parameters(action), self._environment)
        bound = self._bound(made)
        lower, upper = duration_bounds(action, source)
        try:
            made.set_closed_duration_interval(
                self._number(upper if lower is None else lower, bound),
                self._number(lower if upper is None else upper, bound),
            )
        except up_exceptions.UPException:
            reason = f'"{action.name}" must take longer than it may'
            raise InputError(source, reason, action.parts[':duration'].line) from None
        start, end = up.StartTiming(), up.EndTiming()
        intervals = {'start': start, 'end': end, 'all': up.OpenTimeInterval(start, end)}
        for phase, condition in timed_conditions(action.parts.get(':condition'), source):
            made.add_condition(intervals[phase], self._condition(condition, bound))
        self._add_effects(made, action, bound)
        return made

    def _add_effects(
        self, made: up.InstantaneousAction | up.DurativeAction, action: Action, bound: Bound
    ) -> None:
        source = self._domain.source
        timings = {'': [], 'start': [up.StartTiming()], 'end': [up.EndTiming()]}
        for effect in effects(action.parts.get(':effect'), source, action.durative):
            if action.durative and not effect.phase:
                raise InputError(
                    source,
                    f'"{as_text(effect.change)[:80]}" does not say when it happens: write '
                    '(at start …) or (at end …)',
                    effect.change.line,
                )
            variables, fluent, kind, value, when = self._effect(effect, bound, action)
            add = {
                'increase': made.add_increase_effect,
                'decrease': made.add_decrease_effect,
            }.get(kind, made.add_effect)
            with self._clashes(effect):
                add(*timings[effect.phase], fluent, value, when, forall=variables)

    @contextmanager
    def _clashes(self, effect: Effect) -> Iterator[None]:
        """Raise what unified-planning says about an effect as InputError, with its line."""
        try:
            yield
        except (AssertionError, up_exceptions.UPException) as error:
            reason = f'"{as_text(effect.change)[:80]}" cannot be an effect: {error}'
            raise InputError(self._domain.source, reason, effect.change.line) from error

    def _effect(
        self, effect: Effect, bound: Bound, action: Action
    ) -> tuple[tuple[up.Variable, ...], up.FNode, str, up.FNode, up.FNode]:
        """Return an effect's variables, what it changes, how, and under which condition."""
        names: dict[str, up.Variable] = {}
        for variables in effect.variables:
            names |= self._expressions.variables(variables)
        every = {**bound, **names}
        conditions = [self._expressions.expression(c, every) for c in effect.conditions]
        when = self._manager.And(conditions) if conditions else self._manager.TRUE()
        change = effect.change
        if change.head in CHANGES and len(change) != 3:
            reason = (
                f'"{as_text(change)[:80]}" is wrong: write ({change.head} (function …) number)'
            )
            raise InputError(self._domain.source, reason, change.line)
        kind, value = '', self._manager.TRUE()
        if change.head in CHANGES:
            kind, value = change.head, self._expressions.number(change[2], every)
            fluent = self._expressions.number(change[1], every)
        elif change.head == 'not' and len(change) == 2:
            value = self._manager.FALSE()
            fluent = self._expressions.atom(change[1], every)
        else:
            fluent = self._expressions.atom(change, every)
        self._expressions.require_known(self._domain.source, lines=True)
        if not fluent.is_fluent_exp():
            reason = f'"{as_text(change)[:80]}" of "{action.name}" is no effect'
            raise InputError(self._domain.source, reason, change.line)
        return tuple(names.values()), fluent, kind, value, when

    def _condition(self, tree: Tree, bound: Bound, source: str = '') -> up.FNode:
        """Return a condition of the domain, or of another source."""
        found = self._expressions.expression(tree, bound)
        self._expressions.require_known(source or self._domain.source, lines=True)
        return found

    def _number(self, tree: Tree | None, bound: Bound, source: str = '') -> up.FNode:
        """Return a number of the domain, or of another source."""
        found = self._expressions.number(tree, bound)
        self._expressions.require_known(source or self._domain.source, lines=True)
        return found

    def _add_goal(self) -> None:
        """Add the goal, as one condition."""
        goal = self._problem.section(':goal')
        source = self._problem.source
        if goal is None:
            raise InputError(source, 'the problem has no (:goal …)')
        if len(goal) != 2:
            reason = '(:goal …) takes one condition: join several by (and …)'
            raise InputError(source, reason, goal.line)
        self._model.add_goal(self._condition(goal[1], {}, source))

    def _add_metric(self) -> None:
        """Add what is to be minimised; costs of actions become unified-planning's own metric."""
        metric = self._problem.section(':metric')
        if metric is None:
            return
        source = self._problem.source
        if len(metric) != 3 or metric[1] not in ('minimize', 'maximize'):
            raise InputError(
                source, '(:metric …) takes minimize or maximize, and one number', metric.line
            )
        what = metric[2]
        name = what.head if isinstance(what, Branch) else str(what)
        least = metric[1] == 'minimize'
        if name == 'total-time' and least:
            self._model.add_quality_metric(MinimizeMakespan())
        elif name == TOTAL_COST and least and self._model.has_fluent(TOTAL_COST):
            self._add_costs()
        else:
            kind = MinimizeExpressionOnFinalState if least else MaximizeExpressionOnFinalState
            self._model.add_quality_metric(kind(self._number(what, {}, source)))

    def _add_costs(self) -> None:
        """Take the effects on the total cost out of the actions, into a metric."""
        total = self._manager.FluentExp(self._model.fluent(TOTAL_COST))
        costs: dict[up.Action, up.FNode] = {}
        for action in self._model.actions:
            for effect in effects_in(action):
                if effect.fluent == total:
                    if effect.is_conditional() or effect.is_forall() or action in costs:
                        return
                    costs[action] = effect.value
        for action in costs:
            kept = (
                [(t, e) for t, all_of in action.effects.items() for e in all_of]
                if isinstance(action, up.DurativeAction)
                else [(e,) for e in action.effects]
            )
            action.clear_effects()
            for *timing, effect in kept:
                if effect.fluent != total:
                    action._add_effect_instance(*timing, effect)
        self._model._fluents.remove(total.fluent())
        self._model.explicit_initial_values.pop(total, None)
        units = len(costs) == len(self._model.actions) and all(
            cost.is_int_constant() and cost.constant_value() == 1 for cost in costs.values()
        )
        self._model.add_quality_metric(
            MinimizeSequentialPlanLength()
            if units
            else MinimizeActionCosts(costs, self._manager.Int(0))
        )

    def _add_initial_values(self) -> None:
        """Set what holds initially, and the numbers' values."""
        fluents = {fluent.name: fluent for fluent in self._model.fluents}
        objects = {
            item.name: (item.type, self._manager.ObjectExp(item))
            for item in self._model.all_objects
        }
        # Which types may stand where a type is asked for.
        fits = {
            (one, other): one.is_compatible(other)
            for one in self._types.values()
            for other in self._types.values()
        }
        values = self._model.explicit_initial_values
        for count, (atom, value) in enumerate(initial_values(self._problem)):
            if self._stop and count % 1000 == 0:
                self._stop()
            fluent = fluents.get(atom.head)
            arguments = [objects.get(word) for word in atom[1:] if isinstance(word, Word)]
            if (
                fluent is None
                or len(arguments) != fluent.arity
                or len(atom) != fluent.arity + 1
                or fluent.type.is_bool_type() != isinstance(value, bool)
                or not all(
                    known and fits[parameter.type, known[0]]
                    for known, parameter in zip(arguments, fluent.signature, strict=True)
                )
            ):
                raise self._misfit(atom, value)
            expression = self._manager.FluentExp(
                fluent, [known[1] for known in arguments if known]
            )
            values[expression] = self._constant(value)

    def _constant(self, value: bool | Fraction) -> up.FNode:
        if isinstance(value, bool):
            return self._manager.Bool(value)
        if value.denominator == 1:
            return self._manager.Int(value.numerator)
        return self._manager.Real(value)

    def _misfit(self, atom: Branch, value: bool | Fraction) -> InputError:
        """Say in what an initial value does not fit the declarations."""
        source = self._problem.source
        if not isinstance(value, bool):
            self._expressions.number(atom, {})
        elif atom.head in self._declared.functions:
            reason = f'{as_text(atom)}: "{atom.head}" is a number: write (= {as_text(atom)} 1)'
            return InputError(source, reason, atom.line)
        else:
            self._expressions.atom(atom, {})
        reason = '; '.join(self._expressions.faults)
        return InputError(source, reason or f'{as_text(atom)} does not fit', atom.line)
