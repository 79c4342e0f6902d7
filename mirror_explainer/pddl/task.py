"""PDDL texts in: the robot's task (Section 4 of the paper), its atoms and goals.

Each text is read once, into a tree (`pddl.text`); from the trees are made
unified-planning's problem, in which plans are checked, and the texts that planners take.
Like unified-planning, this must be used from one thread at a time.
"""

import itertools
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import unified_planning.model as up

from mirror_explainer.errors import InputError
from mirror_explainer.input_limits import InputLimits
from mirror_explainer.pddl.atoms import atom_text, conjuncts
from mirror_explainer.pddl.derived.axioms import Axioms, read_axioms
from mirror_explainer.pddl.durative.at_once import at_once
from mirror_explainer.pddl.durative.fixed import with_fixed_durations
from mirror_explainer.pddl.durative.overlap import may_need_overlap
from mirror_explainer.pddl.environment import use_task_environment
from mirror_explainer.pddl.expressions import Expressions, nested_words
from mirror_explainer.pddl.model import build_model
from mirror_explainer.pddl.numbers.arithmetic import Numbers, changed_function, numbers_of
from mirror_explainer.pddl.numbers.costs import with_costs
from mirror_explainer.pddl.numbers.plannable import (
    unsteady,
    with_dependents,
    without_numbers,
)
from mirror_explainer.pddl.text.actions import Action, Parts, read_actions
from mirror_explainer.pddl.text.by_itself import facts_to_come
from mirror_explainer.pddl.text.declarations import Declarations, read_declarations
from mirror_explainer.pddl.text.definition import Definition, read_definition, require_head
from mirror_explainer.pddl.text.for_planners import texts_for_planners
from mirror_explainer.pddl.text.left_out import (
    DERIVED_LATER,
    NUMBERS,
    NUMBERS_IN_EFFECTS,
    OPEN_DURATIONS,
    UNSTEADY,
    LeftOut,
    without_extras,
)
from mirror_explainer.pddl.text.plain_types import with_plain_types
from mirror_explainer.pddl.text.size import require_few
from mirror_explainer.pddl.text.tree import as_text, parse


@dataclass(frozen=True)
class Task:
    """A planning task ⟨P, A, I, G, O⟩: unified-planning's problem, and two texts for planners.

    Nothing in them takes time: durative actions happen at once, and cost what
    they took; `timed` is the problem with them as they are, None if there are none.
    The models have no derived predicates; `axioms` say how their states come by
    them, None if there are none.

    What planners for many beliefs cannot use is left out of the texts, `warnings` say
    what. A `relaxed` task has other plans by that; if it `loses_plans`, a belief without a plan
    may have one in truth.
    Names are in lower case everywhere; `written_objects` and `written_actions` have them as
    the texts do. `facts_to_come` are those that come true by themselves, and count as true;
    `stand_ins` are predicates that stand for types or numbers: the texts do not have them.
    """

    domain: str
    problem: str
    model: up.Problem
    goal_text: str
    goals: tuple[up.FNode, ...]
    timed: up.Problem | None = None
    axioms: Axioms | None = None
    warnings: tuple[str, ...] = ()
    relaxed: bool = False
    loses_plans: bool = False
    written_objects: Mapping[str, str] = field(default_factory=dict, repr=False)
    written_actions: Mapping[str, str] = field(default_factory=dict, repr=False)
    facts_to_come: frozenset[str] = frozenset()
    stand_ins: frozenset[str] = frozenset()

    @cached_property
    def may_need_overlap(self) -> bool:
        """Whether a goal may have plans only with actions that overlap: none of them is found."""
        return self.timed is not None and may_need_overlap(self.timed, self.axioms)

    @property
    def initial_facts(self) -> frozenset[str]:
        """I_R: the atoms that hold initially, as texts."""
        return frozenset(
            atom_text(fluent)
            for fluent, value in self.model.explicit_initial_values.items()
            if value.is_true()
        )

    @property
    def goal(self) -> up.FNode:
        """G_R: the goal as one expression, as far as it is planned for."""
        return self.model.environment.expression_manager.And(self.goals)


def read_task(
    domain: str,
    problem: str,
    domain_source: str = 'domain',
    problem_source: str = 'problem',
    limits: InputLimits | None = None,
    stop: Callable[[], None] | None = None,
) -> Task:
    """Read a PDDL domain and problem.

    The sources name the file or topic in errors; `stop` is called now and then, and may
    raise. Raises InputError for a text that is not PDDL, is inconsistent, or is beyond the limits.
    """
    domain_read = read_definition(domain, 'domain', domain_source, limits, stop)
    problem_read = read_definition(problem, 'problem', problem_source, limits, stop)
    if limits:
        require_few(domain_read, problem_read, limits)
    use_task_environment()
    try:
        return _task(domain_read, problem_read, stop)
    except InputError as error:
        hint = _domain_hint(domain_read, problem_read)
        if not hint or error.source != problem_source:
            raise
        raise InputError(error.source, error.reason + hint, error.line, cure=error.cure) from error


def _task(domain: Definition, problem: Definition, stop: Callable[[], None] | None) -> Task:
    left_out = LeftOut()
    declared = read_declarations(domain, problem)
    domain, problem = without_extras(domain, problem, declared, left_out)
    actions = tuple(read_actions(domain, declared.types))
    to_come = facts_to_come(
        domain, problem, declared, actions, itertools.chain(*left_out.changes.values())
    )
    if to_come:
        init = problem.contents(':init')
        new = [fact for fact in to_come if fact not in init]
        problem = problem.with_contents(':init', [*init, *new])
    written_objects = dict(declared.written)
    written_actions = {str(action.name): action.name.written for action in actions}
    own_predicates = declared.predicates.keys()
    domain, problem, declared, actions = with_plain_types(domain, problem, declared, actions)
    fixed = tuple(_fixed(action, domain.source, left_out) for action in actions)
    written = Parts(domain, problem, fixed)
    numbers = numbers_of(written, declared)
    priced = _steady(with_costs(written, numbers, left_out), numbers, left_out)
    functions = read_declarations(priced.domain, priced.problem).functions
    declared = replace(declared, functions=functions)
    durative = any(action.durative for action in actions)
    timed = build_model(_lasting(priced, actions), declared, stop) if durative else None
    plannable = without_numbers(priced, numbers, left_out)
    planned = replace(plannable, actions=tuple(_at_once(plannable, declared, left_out)))
    if durative:
        declared = read_declarations(planned.domain, planned.problem)
    model = build_model(planned if durative else priced, declared, stop)
    axioms = read_axioms(model, planned.domain, planned.problem)
    goal = planned.problem.contents(':goal')[0]
    _split_goals(model)
    goals = tuple(model.goals)
    if {NUMBERS, NUMBERS_IN_EFFECTS} & left_out.places.keys():
        goals = tuple(conjuncts(Expressions(model).expression(goal, {})))
    return Task(
        *texts_for_planners(planned, declared),
        model,
        as_text(goal),
        goals,
        timed,
        axioms,
        left_out.warnings(),
        left_out.relaxed,
        left_out.loses_plans,
        written_objects,
        written_actions,
        frozenset(map(as_text, to_come)),
        frozenset(f.name for f in model.fluents if f.type.is_bool_type()) - own_predicates,
    )


def _steady(parts: Parts, numbers: Numbers, left_out: LeftOut) -> Parts:
    """Return a task without the functions that change by themselves, or may grow without end."""
    gone = {
        kind: with_dependents(map(changed_function, changes), parts, numbers)
        for kind, changes in left_out.changes.items()
    }
    for kind, functions in {**gone, UNSTEADY: unsteady(parts, numbers)}.items():
        if functions & numbers.declared.functions.keys():
            parts = without_numbers(parts, numbers, left_out, functions, kind)
    return parts


def _lasting(parts: Parts, written: Sequence[Action]) -> Parts:
    """Return a task in which actions take as long as they do in the domain."""
    durations = [action.parts.get(':duration') for action in written]
    lasting = (
        action if duration is None else action.having(duration=duration)
        for action, duration in zip(parts.actions, durations, strict=True)
    )
    return replace(parts, actions=tuple(lasting))


def _fixed(action: Action, source: str, left_out: LeftOut) -> Action:
    """Return an action that takes a certain time, if it takes any."""
    if not action.durative:
        return action
    fixed, was_open = with_fixed_durations(action, source)
    if was_open:
        left_out.note(OPEN_DURATIONS, source, action.parts[':duration'])
    return fixed


def _at_once(parts: Parts, declared: Declarations, left_out: LeftOut) -> Iterator[Action]:
    """Yield the actions of a task so that they take no time."""
    source, derived = parts.domain.source, parts.domain.all(':derived')
    for action in parts.actions:
        if action.durative:
            action, lost = at_once(action, declared, derived, source)
            if lost is not None:
                left_out.note(DERIVED_LATER, source, lost)
        yield action


def _split_goals(model: up.Problem) -> None:
    """Make each conjunct of the goal a goal of its own."""
    goals = conjuncts(model.environment.expression_manager.And(model.goals))
    model.clear_goals()
    for conjunct in goals:
        model.add_goal(conjunct)


def fluent_expression(model: up.Problem, atom: str) -> up.FNode:
    """Return unified-planning's expression of one ground atom, given as text.

    Raises InputError that names every unknown predicate or object in it.
    """
    expressions = Expressions(model)
    expression = expressions.atom(nested_words(atom, 'fact'), {})
    expressions.require_known('fact')
    return expression


def goal_expression(model: up.Problem, goal: str, source: str = 'goal') -> up.FNode:
    """Return unified-planning's expression of a PDDL goal description, given as text.

    Raises InputError that names every unknown predicate, object or type in it.
    """
    expressions = Expressions(model)
    expression = expressions.expression(nested_words(goal, source), {})
    expressions.require_known(source)
    return expression


def require_definition(
    text: str, kind: str, source: str, limits: InputLimits | None = None
) -> None:
    """Raise InputError unless a text is a PDDL domain or problem, as far as can be said alone.

    Also for one that is too long or nested too deeply.
    """
    parse(require_head(text, kind, source, limits), source)


def _domain_hint(domain: Definition, problem: Definition) -> str:
    """Return a remark if the problem says that it belongs to another domain."""
    wanted = next(iter(problem.contents(':domain')), None)
    if wanted is None or wanted == domain.name:
        return ''
    return (
        f' (the problem is for domain "{as_text(wanted)}", and the domain given is '
        f'"{domain.name}")'
    )
