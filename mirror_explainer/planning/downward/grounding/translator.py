"""Ground once for all beliefs, with Fast Downward's translator (GPLv3).

To be imported in a worker process only: the translator's options are global,
and the worker keeps its program apart from this one. Fixing every belief's
facts in one initial state would be unsound, since what never changes is compiled
away; so the translator sees actions that switch each uncertain fact, and an
action for each goal, and they are taken out again afterwards.
"""

import contextlib
import io
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

from fast_downward.translate import (
    fact_groups,
    instantiate,
    main,
    normalize,
    options,
    pddl,
    sas_tasks,
    simplify,
    variable_order,
)
from fast_downward.translate.pddl_parser import lisp_parser, parsing_functions
from fast_downward.translate.pddl_parser.parse_error import ParseError

from mirror_explainer.planning.beliefs import Belief, BeliefSpace
from mirror_explainer.planning.downward.ground_task import (
    Fact,
    GroundTask,
    Operator,
    canonical,
)
from mirror_explainer.planning.downward.grounding.ground_once import Grounding, atom_name
from mirror_explainer.planning.downward.grounding.pddl_lists import (
    FACT_ACTION,
    GOAL_ACTION,
    Lists,
    UnfitError,
    edited_domain,
    edited_problem,
    read_lists,
)
from mirror_explainer.planning.downward.portfolio import AXIOMS, CONDITIONAL, PLAIN

_INVARIANT_SECONDS = 30


@dataclass(frozen=True)
class Translation:
    """One belief's task, translated by itself: the search's input, and which searches to try."""

    task: sas_tasks.SASTask
    text: bytes
    searches: tuple[str, ...]

    @cached_property
    def costs(self) -> dict[str, int]:
        """What each action costs."""
        return {canonical(operator.name): operator.cost for operator in self.task.operators}


@contextlib.contextmanager
def _refusals() -> Iterator[None]:
    """Raise UnfitError for what the translator raises about texts that it does not take."""
    try:
        yield
    except (ParseError, SystemExit, AssertionError) as error:
        raise UnfitError(f'{type(error).__name__}: {error}') from error


@_refusals()
def parse(space: BeliefSpace) -> Lists:
    """Return the space's texts as nested lists. Raises UnfitError."""
    return read_lists(
        _nested(space.domain),
        _nested(space.problem),
        [_nested(goal) for goal in space.goals],
        [_nested(fact) for fact in space.uncertain_facts],
    )


def _nested(text: str) -> list[Any]:
    words: list[Any] = lisp_parser.parse_nested_list(text.splitlines())
    return words


@_refusals()
def ground(lists: Lists) -> Grounding | str:
    """Return the grounding, or in a few words why each belief must be translated by itself.

    Raises UnfitError.
    """
    problem = edited_problem(lists, [*lists.certain_facts, *lists.facts])
    goals = [*range(len(lists.goals))]
    task = _parsed(edited_domain(lists, goals, free_facts=True), problem)
    if task.axioms:  # of goals that hold for all objects, perhaps: these go apart
        goals = [goal for goal in goals if not _is_quantified(lists.goals[goal])]
        task = _parsed(edited_domain(lists, goals, free_facts=True), problem)
    if task.axioms or not goals:
        return 'derived predicates or universal conditions'
    apart = frozenset(range(len(lists.goals))) - frozenset(goals)
    reachable, atoms, actions, _, _, parameters = instantiate.explore(task)
    if not reachable:
        return _without_any_plan(lists, apart)
    if any(condition for a in actions for condition, _ in [*a.add_effects, *a.del_effects]):
        return 'conditional effects'
    task.actions = [a for a in task.actions if not a.name.startswith(FACT_ACTION)]
    sas, groups = _encode(task, atoms, actions, parameters)
    if _conditional([o for o in sas.operators if not _is_switch(o.name)]):
        # Only variables of two values express every deletion without a condition.
        options.options.invariant_generation_max_candidates = 0
        sas, groups = _encode(task, atoms, actions, parameters)
    return _grounding(lists, sas, groups, actions, apart)


def _is_quantified(goal: Any) -> bool:
    if isinstance(goal, list):
        return any(map(_is_quantified, goal))
    return goal in ('forall', 'exists')


@_refusals()
def translate(lists: Lists, belief: Belief, facts: Sequence[str]) -> Translation:
    """Translate one belief by itself; `facts` are the texts of the space's uncertain facts.

    Raises UnfitError.
    """
    named = zip(lists.facts, facts, strict=True)
    true = [fact for fact, text in named if text in belief.true_facts]
    task = _parsed(
        edited_domain(lists, [belief.goal], free_facts=False),
        edited_problem(lists, [*lists.certain_facts, *true]),
    )
    sas = main.pddl_to_sas(task)
    text = io.StringIO()
    sas.output(text)
    fit = AXIOMS if sas.axioms else CONDITIONAL if _conditional(sas.operators) else PLAIN
    return Translation(sas, text.getvalue().encode(), fit)


def _parsed(domain: list[Any], problem: list[Any]) -> pddl.Task:
    options.set_options(['-', '-', '--invariant-generation-max-time', str(_INVARIANT_SECONDS)])
    task = parsing_functions.parse_task(domain, problem)
    normalize.normalize(task)
    return task


def _encode(
    task: pddl.Task, atoms: set[Any], actions: list[Any], parameters: Any
) -> tuple[sas_tasks.SASTask, list[list[Any]]]:
    """Return the task in finite-domain variables, and the mutex groups it rests on.

    `task` has no actions for the uncertain facts any more, and an initial state
    with all of them, so that a group with one initial atom at most has so in every
    belief. `actions` still has them.
    """
    negative = {
        literal.negate()
        for action in actions
        if _is_goal(action.name)
        for literal in action.precondition
        if literal.negated
    }
    groups, mutex_groups, names = fact_groups.compute_groups(task, atoms, parameters, negative)
    ranges, places = main.strips_to_sas_dictionary(groups, assert_partial=True)
    mutex_ranges, mutex_places = main.strips_to_sas_dictionary(mutex_groups, assert_partial=False)
    sas = main.translate_task(
        places,
        ranges,
        names,
        mutex_places,
        mutex_ranges,
        main.build_mutex_key(places, mutex_groups),
        task.init,
        [task.goal],
        actions,
        [],
        task.use_min_cost_metric,
        {},
    )
    return sas, mutex_groups


def _grounding(
    lists: Lists,
    sas: sas_tasks.SASTask,
    mutex_groups: list[list[Any]],
    actions: list[Any],
    apart: frozenset[int],
) -> Grounding:
    """Return the grounding of a task that lacks the goals `apart`."""
    try:
        simplify.filter_unreachable_propositions(sas)
    except simplify.Impossible:
        return _without_any_plan(lists, apart)
    mutexes = tuple(frozenset(map(str, group)) for group in mutex_groups if len(group) > 1)
    negative = frozenset(
        str(literal.negate()) for a in actions for literal in a.precondition if literal.negated
    )
    sas.operators = [o for o in sas.operators if not _is_switch(o.name)]
    variables = tuple(tuple(names) for names in sas.variables.value_names)
    variable_order.find_and_apply_variable_order(sas)
    numbers = {names: number for number, names in enumerate(variables)}
    kept = tuple(numbers[tuple(names)] for names in sas.variables.value_names)
    goals, hard_goals = _goals(sas, len(lists.goals))
    sas.operators = [o for o in sas.operators if not _is_goal(o.name)]
    return replace(
        _without_any_plan(lists, apart | hard_goals),
        goals=goals,
        task=_ground_task(sas),
        negative=negative,
        variables=variables,
        kept=kept,
        mutexes=mutexes,
    )


def _without_any_plan(lists: Lists, apart: frozenset[int]) -> Grounding:
    """Return the grounding of a task in which no goal but those `apart` can be reached."""
    return Grounding(
        goals=(None,) * len(lists.goals),
        hard_goals=apart,
        initial=initial_atoms(lists),
        uncertain=tuple(atom_name(fact) for fact in lists.facts),
        objects=lists.objects,
    )


def initial_atoms(lists: Lists) -> frozenset[str]:
    """Return the atoms that hold initially, by the translator's names."""
    return frozenset(atom_name(fact) for fact in lists.initial_facts)


def _is_goal(action_name: str) -> bool:
    return action_name.startswith(f'({GOAL_ACTION}')


def _is_switch(action_name: str) -> bool:
    return action_name.startswith(f'({FACT_ACTION}')


def _conditional(operators: Iterable[sas_tasks.SASOperator]) -> bool:
    return any(condition for o in operators for _, _, _, condition in o.pre_post)


def _goals(
    sas: sas_tasks.SASTask, count: int
) -> tuple[tuple[tuple[Fact, ...] | None, ...], frozenset[int]]:
    """Return what each goal action requires, and the goals that have several such actions."""
    goals: list[tuple[Fact, ...] | None] = [None] * count
    hard_goals = set()
    for operator in sas.operators:
        if _is_goal(operator.name):
            index = int(operator.name[len(GOAL_ACTION) + 1 : -1])
            if goals[index] is not None:
                hard_goals.add(index)
            goals[index] = tuple(operator.get_applicability_conditions())
    return tuple(goals), frozenset(hard_goals)


def _ground_task(sas: sas_tasks.SASTask) -> GroundTask:
    operators = (
        Operator(
            canonical(operator.name),
            tuple(operator.get_applicability_conditions()),
            tuple(dict.fromkeys((variable, post) for variable, _, post, _ in operator.pre_post)),
            operator.cost,
        )
        for operator in sas.operators
    )
    mutexes = tuple(frozenset(group.facts) for group in sas.mutexes)
    return GroundTask(tuple(operators), tuple(sas.variables.ranges), mutexes)
