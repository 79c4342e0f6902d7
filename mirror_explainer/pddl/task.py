"""PDDL texts in: the robot's task (Section 4 of the paper), its atoms and goals.

unified-planning reads the texts; this file turns what goes wrong into errors
that name the place. Like unified-planning, it must be used from one thread at a time.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import unified_planning.model as up
from unified_planning import environment
from unified_planning.io import PDDLReader

from mirror_explainer.errors import InputError
from mirror_explainer.input_limits import InputLimits
from mirror_explainer.pddl.atoms import atom_text, conjuncts
from mirror_explainer.pddl.derived.axioms import Axioms, read_axioms, without_axioms
from mirror_explainer.pddl.durative.durative import is_durative, require_fixed_durations
from mirror_explainer.pddl.durative.overlap import may_need_overlap
from mirror_explainer.pddl.durative.sequential import sequential_texts
from mirror_explainer.pddl.expressions import NESTED, Expressions, as_text, nested_words
from mirror_explainer.pddl.initial_state import PlainFact, add_facts, without_plain_facts
from mirror_explainer.pddl.text.either_types import (
    types_in_predicates,
    with_common_supertypes,
    with_plain_predicates,
)
from mirror_explainer.pddl.text.readable import require_readable
from mirror_explainer.pddl.text.reader_errors import (
    READER_ERRORS,
    declared_names,
    input_error,
    require_known_requirements,
)
from mirror_explainer.pddl.text.sections import (
    line_at,
    section,
    without_comments,
    without_costs,
    without_total_time,
)
from mirror_explainer.pddl.text.size import require_few, require_shallow, require_steady_numbers
from mirror_explainer.pddl.text.texts import Texts
from mirror_explainer.text_files import plain_text


@dataclass(frozen=True)
class Task:
    """A planning task ⟨P, A, I, G, O⟩ as read: the two texts, and unified-planning's problem.

    Nothing in them takes time: durative actions happen at once, and cost what
    they took; `timed` is the problem with them as they are, None if there are none.
    The models have no derived predicates; `axioms` say how their states come by
    them, None if there are none.
    """

    domain: str
    problem: str
    model: up.Problem
    timed: up.Problem | None = None
    axioms: Axioms | None = None

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
        """G_R: the goal as one expression."""
        return self.model.environment.expression_manager.And(self.model.goals)

    @property
    def goal_text(self) -> str:
        """G_R as it stands in the problem, in lower case with single spaces."""
        text = without_comments(self.problem).lower()
        start = re.search(r'\(\s*:goal\b', text)
        assert start is not None  # a problem without a goal is not read
        return as_text(NESTED.parse_string(text[start.start() :]).as_list()[0][1])


def forget_expressions() -> None:
    """Let unified-planning start afresh; tasks read before can't be worked with any more.

    It keeps every expression that was ever read, which a process that runs for
    weeks can't afford. (Environments of one's own are not for use: in 1.3 its reader
    and its engines still make parts of a problem in the default one.)
    """
    environment.GLOBAL_ENVIRONMENT = None


def read_task(
    domain: str,
    problem: str,
    domain_source: str = 'domain',
    problem_source: str = 'problem',
    limits: InputLimits | None = None,
) -> Task:
    """Read a PDDL domain and problem.

    The sources name the file or topic in errors. Raises InputError for a text
    that is not PDDL, is inconsistent, is beyond the limits, or has more of PDDL
    than can be explained.
    """
    given = Texts(plain_text(domain), plain_text(problem), domain_source, problem_source)
    require_definition(given.domain, 'domain', domain_source, limits)
    require_definition(given.problem, 'problem', problem_source, limits)
    rest, facts = without_plain_facts(given.problem)
    if limits:
        require_few(replace(given, problem=rest), limits)
    texts = with_common_supertypes(given)
    require_readable(texts)
    texts = replace(texts, problem=without_total_time(texts.problem))
    if texts.problem != given.problem:
        rest, facts = without_plain_facts(texts.problem)
    durative = is_durative(texts.domain)
    if durative:
        require_fixed_durations(texts.domain, domain_source)
        if section(texts.problem, ':metric') is None:
            texts = replace(texts, domain=without_costs(texts.domain))
    model = _read_model(texts, rest, facts)
    axioms = read_axioms(model, texts)
    timed = model if durative else None
    if durative:
        texts = sequential_texts(model, axioms, texts)
        model = _read_model(texts, *without_plain_facts(texts.problem))
        axioms = read_axioms(model, texts)
    if not all(isinstance(action, up.InstantaneousAction) for action in model.actions):
        raise InputError(domain_source, 'it has actions other than :action and :durative-action')
    require_steady_numbers(model, domain_source)
    goals = conjuncts(model.environment.expression_manager.And(model.goals))
    model.clear_goals()
    for conjunct in goals:
        model.add_goal(conjunct)
    return Task(texts.domain, texts.problem, model, timed, axioms)


def _read_model(texts: Texts, rest: str, facts: Sequence[PlainFact]) -> up.Problem:
    """Return unified-planning's problem. Raises InputError with lines of the texts given.

    `rest` is the problem without its plain `facts`.
    """
    readable = with_plain_predicates(without_axioms(texts.domain))
    try:
        model = PDDLReader().parse_problem_string(readable, rest)
    except READER_ERRORS as error:
        _raise_for_domain_alone(readable, texts.domain_source)
        hint = _domain_hint(texts)
        names = declared_names(readable, texts.problem)
        raise input_error(error, texts.problem, texts.problem_source, hint, names) from error
    for name, line in types_in_predicates(texts.domain):
        if name != 'object' and name not in {item.name for item in model.user_types}:
            raise InputError(texts.domain_source, f'the type {name} is not declared', line)
    try:
        add_facts(model, facts, texts.problem_source)
    except InputError as error:
        reason = error.reason + _domain_hint(texts)
        raise InputError(error.source, reason, error.line) from error
    return model


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
    """Raise InputError unless a text begins as a PDDL domain or problem should.

    Also for one that is too long or nested too deeply: all that can be said of it at once.
    """
    if limits:
        limits.require_bytes(text, source)
    text = plain_text(text)
    if not text.strip():
        raise InputError(
            source,
            f'the text is empty; a PDDL {kind} is expected',
            cure='Give the whole text; only a plan may be empty.',
        )
    found = re.match(
        r'(?:\s|;[^\n]*(?:\n|$))*\(\s*define\s*\(\s*(domain|problem)\b', text, re.IGNORECASE
    )
    if found is None:
        raise InputError(
            source,
            f'this is no PDDL {kind}: it must begin with (define ({kind} …)',
            1,
            cure=f'Give the text of the {kind} here, not the name of a file or another text.',
        )
    if found[1].lower() != kind:
        raise InputError(
            source,
            f'this is a PDDL {found[1].lower()}, but a {kind} is expected here: '
            'are the two mixed up?',
            line_at(text, found.end()),
            cure='Check which is which: the files, or the names and remappings of the topics.',
        )
    require_shallow(text, source)


def _raise_for_domain_alone(domain: str, source: str) -> None:
    """Raise InputError if the domain can't be read even without a problem."""
    try:
        PDDLReader().parse_problem_string(domain)
    except READER_ERRORS as error:
        require_known_requirements(domain, source)
        raise input_error(error, domain, source, '', declared_names(domain)) from error


def _domain_hint(texts: Texts) -> str:
    """Return a remark if the problem says that it belongs to another domain."""
    own = re.search(r'\(\s*domain\s+([^\s()]+)', texts.domain, re.IGNORECASE)
    wanted = re.search(r'\(\s*:domain\s+([^\s()]+)', texts.problem, re.IGNORECASE)
    if own and wanted and own[1].lower() != wanted[1].lower():
        return f' (the problem is for domain "{wanted[1]}", and the domain given is "{own[1]}")'
    return ''
