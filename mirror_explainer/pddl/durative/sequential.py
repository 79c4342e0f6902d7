"""Tasks with durative actions as tasks without: each action happens at once, and costs its time.

unified-planning's compiler merges the phases of an action, and drops how long it
takes, which becomes its cost here. Only the durative actions' text is written anew:
no name changes.
"""

import re
from dataclasses import replace

import unified_planning.model as up
from unified_planning.engines import CompilationKind
from unified_planning.engines.compilers.timed_to_sequential import TimedToSequential
from unified_planning.exceptions import UPException
from unified_planning.io.pddl_writer import ConverterToPDDLString

from mirror_explainer.errors import InputError
from mirror_explainer.pddl.derived.axioms import Axioms
from mirror_explainer.pddl.durative.durations import Costs
from mirror_explainer.pddl.durative.durative import (
    as_literal,
    durative_actions,
    effects_of,
    later_conditions,
    require_compilable,
    require_metric_of_costs,
    require_no_timed_facts,
)
from mirror_explainer.pddl.text.sections import (
    line_at,
    section,
    sections,
    without_comments,
    without_values,
)
from mirror_explainer.pddl.text.texts import Texts


def sequential_texts(model: up.Problem, axioms: Axioms | None, texts: Texts) -> Texts:
    """Return the texts of the same task without durative actions.

    `model` and `axioms` are the task as read. An action costs its duration, one without takes
    no time; a metric of the total cost is kept instead. Raises InputError that
    names the place of what cannot be compiled.
    """
    domain, problem, source = texts.domain, texts.problem, texts.domain_source
    places = {name: (start, end) for name, start, end in durative_actions(domain)}
    lines = {name: line_at(domain, start) for name, (start, _) in places.items()}
    require_metric_of_costs(model, problem, texts.problem_source)
    require_no_timed_facts(model, problem, texts.problem_source)
    durative = [action for action in model.actions if isinstance(action, up.DurativeAction)]
    for action in durative:
        require_compilable(action, axioms, source, lines.get(action.name))
    compiler = TimedToSequential()
    compiler.skip_checks = True  # it takes more than it says, such as conditional effects
    try:
        compiled = compiler.compile(model, CompilationKind.TIMED_TO_SEQUENTIAL).problem
    except UPException as error:
        raise InputError(source, f'its durative actions cannot be compiled: {error}') from error
    for action in durative:
        _mend(compiled.action(action.name), action)
    costs = Costs(model, source, lines, _converter(model))
    new_texts = {
        action.name: _action_text(compiled.action(action.name), costs.of(action))
        for action in durative
    }
    for name, (start, end) in reversed(places.items()):
        domain = domain[:start] + new_texts[name] + domain[end:]
    for name in costs.idle(compiled):
        problem = without_values(problem, name)
    return replace(
        texts, domain=_with_functions(domain, costs), problem=_with_costs(problem, costs)
    )


def _mend(compiled: up.InstantaneousAction, action: up.DurativeAction) -> None:
    """Put right what the compiler overlooks: two names in an action may stand for one object.

    What the start makes untrue of one, it makes untrue of the other. Where an
    effect at the start would outlast an opposite one at the end, the two names
    must stand for different objects.
    """
    start, end = effects_of(action)
    later = [literal for part in later_conditions(action) if (literal := as_literal(part))]
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


def _with_functions(domain: str, costs: Costs) -> str:
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


def _with_costs(problem: str, costs: Costs) -> str:
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
