"""What a state was before some of a plan happened: effects taken back, as conditions tell.

For whoever hears of a robot when it is on its way.
"""

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction

import unified_planning.model as up

from mirror_explainer.pddl.atoms import conjuncts, effects_in, words_of
from mirror_explainer.pddl.durative.overlap import as_literal
from mirror_explainer.pddl.happenings import GroundStep, Happening
from mirror_explainer.pddl.states import (
    Binding,
    ConflictError,
    Evaluator,
    State,
    UnknownNumberError,
)


def taken_back(
    state: State,
    happened: Sequence[Happening],
    steps: Sequence[GroundStep],
    evaluator: Evaluator,
) -> State | None:
    """Return a state from which what happened may have led to this one.

    What a condition does not tell is taken to have been changed by the effect. Returns
    None where an effect has not come about, a condition contradicts another, or a number
    cannot be told. That the plan can be carried out from the state is not yet said.
    """
    guessed: set[str] = set()
    for happening in reversed(happened):
        step = steps[happening.step]
        effects = step.effects(happening)
        try:
            changes = evaluator.changes(
                [e for e in effects if e.fluent.fluent().type.is_bool_type()], state, step.binding
            )
            numbers = dict(_numbers_before(effects, state, step.binding, evaluator))
        except (ConflictError, UnknownNumberError, ValueError):
            return None
        if any(evaluator.value_of(atom, state) != value for atom, value in changes.items()):
            return None
        conditions = step.conditions(happening)
        needed = dict(
            _literals(
                conditions if happening.starts else [*conditions, *step.invariants],
                step.binding,
                evaluator,
            )
        )
        before = {atom: needed.get(atom, not value) for atom, value in changes.items()}
        guessed |= changes.keys() - needed.keys()
        state = state.after({**before, **numbers})
        lacking = {
            atom: value
            for atom, value in needed.items()
            if evaluator.value_of(atom, state) != value
        }
        if not lacking.keys() <= guessed:
            return None
        guessed -= needed.keys()
        state = state.after(lacking)
    return state


def _numbers_before(
    effects: Iterable[up.Effect], state: State, binding: Binding, evaluator: Evaluator
) -> Iterator[tuple[str, Fraction]]:
    """Yield what numbers were before. Raises ValueError for one that was set."""
    for effect in effects:
        if effect.fluent.fluent().type.is_bool_type():
            continue
        for own in evaluator.bindings(effect.forall, binding):
            atom = evaluator.atom(effect.fluent, own)
            if atom not in state.numbers or not evaluator.holds(effect.condition, state, own):
                continue
            if effect.is_assignment():
                raise ValueError(atom)
            change = evaluator.value(effect.value, state, own)
            assert isinstance(change, Fraction)
            yield atom, state.numbers[atom] + (-change if effect.is_increase() else change)


def _literals(
    conditions: Iterable[up.FNode], binding: Binding, evaluator: Evaluator
) -> Iterator[tuple[str, bool]]:
    """Yield the ground literals that conditions ask for; what is derived cannot be set."""
    for condition in conditions:
        for part in conjuncts(condition):
            literal = as_literal(part)
            if literal and literal[0].fluent().name not in evaluator.derived.names:
                yield evaluator.atom(literal[0], binding), literal[1]


def is_plausible(state: State, model: up.Problem) -> bool:
    """Say whether nothing is in two places at once, as far as actions tell places by moves."""
    groups = Counter(
        (name, position, *words[:position], *words[position + 1 :])
        for name, position in _single(model)
        for fact in state.facts
        for head, *words in [words_of(fact)]
        if head == name
    )
    return all(count == 1 for count in groups.values())


def _single(model: up.Problem) -> set[tuple[str, int]]:
    """Return predicates, with an argument's index, that every action moves from object to object.

    What adds such an atom deletes another that differs in this argument only.
    """
    single = {
        (fluent.name, position)
        for fluent in model.fluents
        if fluent.type.is_bool_type()
        for position in range(fluent.arity)
    }
    moved: set[tuple[str, int]] = set()
    for action in model.actions:
        effects = effects_in(action)
        for name, position in single.copy():
            own = [effect for effect in effects if effect.fluent.fluent().name == name]
            added = Counter(_rest(e, position) for e in own if not e.value.is_false())
            deleted = Counter(
                _rest(e, position)
                for e in own
                if e.value.is_false() and not e.is_conditional() and not e.is_forall()
            )
            if added and added <= deleted:
                moved.add((name, position))
            elif added:
                single.discard((name, position))
    return single & moved


def _rest(effect: up.Effect, position: int) -> tuple[up.FNode, ...]:
    """Return the arguments of what an effect changes, but one."""
    args = effect.fluent.args
    return (*args[:position], *args[position + 1 :])
