"""What is taken of durative actions, and what is refused as they could not happen at once.

unified-planning's compiler merges what an action needs and does at its start, all
the while, and at its end; it gets some rare actions wrong, which are refused as well.
"""

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property

import unified_planning.model as up
from unified_planning.model.metrics import MinimizeActionCosts, MinimizeSequentialPlanLength

from mirror_explainer.errors import InputError
from mirror_explainer.pddl.atoms import conjuncts, fluents_in
from mirror_explainer.pddl.derived.axioms import Axioms
from mirror_explainer.pddl.text.sections import (
    line_at,
    line_of,
    section,
    sections,
    without_comments,
)

_DURATIVE = ':durative-action'
_ANOTHER_WAY = 'so it cannot be taken as an action that happens at once'


def is_durative(domain: str) -> bool:
    """Say whether the domain has durative actions."""
    return section(domain, _DURATIVE) is not None


def require_fixed_durations(domain: str, source: str) -> None:
    """Raise InputError, with its line, for what no compiler makes an action without duration."""
    plain = without_comments(domain)
    for name, start, end in durative_actions(domain):
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


def durative_actions(domain: str) -> Iterator[tuple[str, int, int]]:
    """Yield each durative action's name in lower case, and where its text starts and ends."""
    plain = without_comments(domain)
    for part in sections(domain):
        if part.keyword == _DURATIVE:
            words = re.match(r'\(\s*\S+\s+([^\s():]+)', plain[part.start : part.end])
            yield words[1].lower() if words else '', part.start, part.end


def require_metric_of_costs(model: up.Problem, problem: str, source: str) -> None:
    """Raise InputError for a metric that is neither of costs nor of time."""
    metrics = model.quality_metrics
    if metrics and not isinstance(metrics[0], MinimizeActionCosts | MinimizeSequentialPlanLength):
        part = section(problem, ':metric')
        raise InputError(
            source,
            'with durative actions, the metric can be to minimize (total-time) or (total-cost) '
            'only',
            line_at(problem, part.start) if part else None,
        )


def require_no_timed_facts(model: up.Problem, problem: str, source: str) -> None:
    """Raise InputError for facts that become true or false by themselves."""
    if model.timed_effects:
        raise InputError(
            source,
            'it has timed initial literals, (at TIME …): what happens by itself while the robot '
            'acts cannot be explained',
            line_of(r'\(\s*at\s+[\d.]+\s*\(', problem),
        )


@dataclass(frozen=True)
class _Phases:
    """A durative action by what happens when: at its start, and later on."""

    start: list[up.Effect]
    end: list[up.Effect]
    later: list[up.FNode]
    axioms: Axioms | None

    @cached_property
    def changed(self) -> set[up.Fluent]:
        """What the start changes."""
        return {effect.fluent.fluent() for effect in self.start}

    @cached_property
    def at_end(self) -> set[up.Fluent]:
        """What the effects at the end are about, or depend on."""
        return fluents_in(*(part for e in self.end for part in (e.fluent, e.value, e.condition)))

    @cached_property
    def needed_later(self) -> set[up.Fluent]:
        """What the conditions later than the start are about."""
        return fluents_in(*self.later)

    @property
    def derived_later(self) -> frozenset[str]:
        """What derived predicates that matter later depend on."""
        if not self.axioms:
            return frozenset()
        later = {fluent.name for fluent in self.at_end | self.needed_later}
        return self.axioms.basis(self.axioms.names & later)


# What of an action the compiler gets wrong, each with the words for it.
_MISTAKEN: tuple[tuple[str, Callable[[_Phases], object]], ...] = (
    (
        'an effect for all objects of a type (forall)',
        lambda action: any(effect.is_forall() for effect in (*action.start, *action.end)),
    ),
    (
        'a number that decreases at its start',
        lambda action: any(effect.is_decrease() for effect in action.start),
    ),
    (
        'a conditional effect at its start on what matters again later',
        lambda action: any(
            effect.is_conditional()
            and effect.fluent.fluent() in action.at_end | action.needed_later
            for effect in action.start
        ),
    ),
    (
        'a conditional effect at its end on what changes at its start',
        lambda action: any(
            effect.is_conditional() and effect.fluent.fluent() in action.changed
            for effect in action.end
        ),
    ),
    (
        'a condition later than its start, and no plain fact, on what its start changes',
        lambda action: any(
            as_literal(condition) is None and action.changed & fluents_in(condition)
            for condition in action.later
        ),
    ),
    (
        'a derived condition later than its start on what its start changes',
        lambda action: {f.name for f in action.changed} & action.derived_later,
    ),
)


def require_compilable(
    action: up.DurativeAction, axioms: Axioms | None, source: str, line: int | None
) -> None:
    """Raise InputError if the compiler would get an action wrong."""
    phases = _Phases(*effects_of(action), later_conditions(action), axioms)
    for words, is_mistaken in _MISTAKEN:
        if is_mistaken(phases):
            raise InputError(source, f'"{action.name}" has {words}, {_ANOTHER_WAY}', line)


def as_literal(condition: up.FNode) -> tuple[up.FNode, bool] | None:
    """Return a literal's atom and whether it must hold, None for other conditions."""
    atom = condition.arg(0) if condition.is_not() else condition
    return (atom, not condition.is_not()) if atom.is_fluent_exp() else None


def effects_of(action: up.DurativeAction) -> tuple[list[up.Effect], list[up.Effect]]:
    """Return the effects at the start and those at the end."""
    return (
        list(action.effects.get(up.StartTiming(), [])),
        list(action.effects.get(up.EndTiming(), [])),
    )


def later_conditions(action: up.DurativeAction) -> list[up.FNode]:
    """Return the conditions over all and at end."""
    return [
        part
        for interval, conditions in action.conditions.items()
        if interval.upper == up.EndTiming()
        for condition in conditions
        for part in conjuncts(condition)
    ]
