"""PDDL texts in: the robot's task (Section 4 of the paper), its atoms and goals.

unified-planning reads the texts; this file turns what goes wrong into errors
that name the place. Like unified-planning, it must be used from one thread at a time.
"""

import re
from collections.abc import Iterable
from dataclasses import dataclass

import pyparsing
import unified_planning.model as up
from unified_planning import environment
from unified_planning.exceptions import UPException
from unified_planning.io import PDDLReader

from mirror_explainer.errors import InputError
from mirror_explainer.input_limits import InputLimits
from mirror_explainer.pddl.derived import Axioms, read_axioms, without_axioms
from mirror_explainer.pddl.durative import is_durative, require_fixed_durations
from mirror_explainer.pddl.either_types import with_common_supertypes
from mirror_explainer.pddl.expressions import NESTED, Expressions, as_text, nested_words
from mirror_explainer.pddl.sections import (
    require_readable,
    section,
    types_in_alternatives,
    with_plain_predicates,
    without_costs,
    without_total_time,
)
from mirror_explainer.pddl.sequential import sequential_texts
from mirror_explainer.pddl.size import require_few, require_shallow, require_steady_numbers
from mirror_explainer.pddl.state import add_facts, without_plain_facts
from mirror_explainer.text_files import plain_text

# What unified-planning's reader raises for a text that is no good, besides a bare
# AssertionError or a Python error from deep inside it for the odder ones.
_READER_ERRORS = (
    pyparsing.ParseBaseException,
    SyntaxError,
    UPException,
    AssertionError,
    AttributeError,
    IndexError,
    KeyError,
    TypeError,
    ValueError,
    RecursionError,
)

_UNREADABLE = (
    'See whether the text was cut off, its parentheses match, and all its names are declared.'
)


@dataclass(frozen=True)
class Task:
    """A planning task ⟨P, A, I, G, O⟩ as read: the two texts, and unified-planning's problem.

    Nothing in them takes time: durative actions happen at once, and cost what
    they took. `durative` says that there were some. The model has no derived
    predicates; `axioms` say how its states come by them, None if there are none.
    """

    domain: str
    problem: str
    model: up.Problem
    durative: bool = False
    axioms: Axioms | None = None

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
        text = re.sub(r';[^\n]*', '', self.problem).lower()
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
    domain, problem = plain_text(domain), plain_text(problem)
    require_definition(domain, 'domain', domain_source, limits)
    require_definition(problem, 'problem', problem_source, limits)
    if limits:
        rest, _ = without_plain_facts(problem)
        require_few(domain, rest, limits, domain_source, problem_source)
    domain, problem = with_common_supertypes(domain, problem)
    require_readable(domain, problem, domain_source, problem_source)
    problem = without_total_time(problem)
    durative = is_durative(domain)
    if durative:
        require_fixed_durations(domain, domain_source)
        if section(problem, ':metric') is None:
            domain = without_costs(domain)
    model = _read_model(domain, problem, domain_source, problem_source)
    axioms = read_axioms(model, domain, problem, domain_source, problem_source)
    if durative:
        domain, problem = sequential_texts(
            model, axioms, domain, problem, domain_source, problem_source
        )
        model = _read_model(domain, problem, domain_source, problem_source)
        axioms = read_axioms(model, domain, problem, domain_source, problem_source)
    if not all(isinstance(action, up.InstantaneousAction) for action in model.actions):
        raise InputError(domain_source, 'it has actions other than :action and :durative-action')
    require_steady_numbers(model, domain_source)
    goals = conjuncts(model.environment.expression_manager.And(model.goals))
    model.clear_goals()
    for conjunct in goals:
        model.add_goal(conjunct)
    return Task(domain, problem, model, durative, axioms)


def _read_model(domain: str, problem: str, domain_source: str, problem_source: str) -> up.Problem:
    """Return unified-planning's problem. Raises InputError with lines of the texts given."""
    readable = with_plain_predicates(without_axioms(domain))
    rest, facts = without_plain_facts(problem)
    try:
        model = PDDLReader().parse_problem_string(readable, rest)
    except _READER_ERRORS as error:
        _raise_for_domain_alone(readable, domain_source)
        raise _input_error(
            error, problem, problem_source, _domain_hint(domain, problem)
        ) from error
    for name, line in types_in_alternatives(domain):
        if name != 'object' and name not in {item.name for item in model.user_types}:
            raise InputError(domain_source, f'the type {name} is not declared', line)
    try:
        add_facts(model, facts, problem_source)
    except InputError as error:
        hint = _domain_hint(domain, problem)
        raise InputError(error.source, error.reason + hint, error.line) from error
    return model


def atom_text(atom: up.FNode) -> str:
    """Return a ground atom as PDDL text in lower case: "(item-at red_circle red_room)"."""
    return ground_text(atom.fluent().name, [str(argument) for argument in atom.args])


def ground_text(name: str, arguments: Iterable[str]) -> str:
    """Return a ground atom or action as canonical text, "(name argument …)", lower case."""
    return f'({" ".join([name, *arguments])})'.lower()


def conjuncts(goal: up.FNode) -> list[up.FNode]:
    """Return the conditions that a goal or precondition asks for together, in order."""
    if goal.is_and():
        return [literal for part in goal.args for literal in conjuncts(part)]
    return [] if goal.is_true() else [goal]


def literals(goal: up.FNode) -> frozenset[up.FNode]:
    """Return the conjuncts of a goal. Two goals are equal when these sets are equal."""
    return frozenset(conjuncts(goal))


def fluent_expression(model: up.Problem, atom: str, source: str = 'fact') -> up.FNode:
    """Return unified-planning's expression of one ground atom, given as text.

    Raises InputError that names every unknown predicate or object in it.
    """
    tree, faults = nested_words(atom, source), list[str]()
    expression = Expressions(model, faults).atom(tree, {})
    if faults:
        raise InputError(source, '; '.join(faults))
    return expression


def goal_expression(model: up.Problem, goal: str, source: str = 'goal') -> up.FNode:
    """Return unified-planning's expression of a PDDL goal description, given as text.

    Raises InputError that names every unknown predicate, object or type in it.
    """
    tree, faults = nested_words(goal, source), list[str]()
    try:
        expression = Expressions(model, faults).expression(tree, {})
    except RecursionError as error:
        raise InputError(source, 'the goal is nested too deeply') from error
    if faults:
        raise InputError(source, '; '.join(faults))
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
            text.count('\n', 0, found.end()) + 1,
            cure='Check which is which: the files, or the names and remappings of the topics.',
        )
    require_shallow(text, source)


def _raise_for_domain_alone(domain: str, source: str) -> None:
    """Raise InputError if the domain can't be read even without a problem."""
    try:
        PDDLReader().parse_problem_string(domain)
    except _READER_ERRORS as error:
        raise _input_error(error, domain, source, '') from error


def _domain_hint(domain: str, problem: str) -> str:
    """Return a remark if the problem says that it belongs to another domain."""
    own = re.search(r'\(\s*domain\s+([^\s()]+)', domain, re.IGNORECASE)
    wanted = re.search(r'\(\s*:domain\s+([^\s()]+)', problem, re.IGNORECASE)
    if own and wanted and own[1].lower() != wanted[1].lower():
        return f' (the problem is for domain "{wanted[1]}", and the domain given is "{own[1]}")'
    return ''


def _input_error(error: Exception, text: str, source: str, hint: str) -> InputError:
    """Return the reader's error in plain words, with the line where it can be known."""
    if isinstance(error, pyparsing.ParseBaseException):
        found = str(error).split('  (at char')[0]
        near = f'in "{error.line.strip()[:60]}"' if error.line.strip() else 'at the end'
        reason = f'no PDDL that can be read: {found} {near}{hint}'
        return InputError(source, reason, error.lineno, cure=_UNREADABLE)
    if isinstance(error, RecursionError):
        return InputError(source, 'the text is nested too deeply')
    if isinstance(error, (AssertionError, AttributeError, IndexError, TypeError)) and not (
        isinstance(error, UPException)
    ):
        # Python's words about the reader's inside; only its assertions may say something.
        reason = (
            'one of its expressions is malformed: are all its parts there, and its names known?'
        )
        detail = f' ({error})' if isinstance(error, AssertionError) and str(error) else ''
        return InputError(source, reason + detail + hint, cure=_UNREADABLE)
    message = str(error).strip() or type(error).__name__
    said = re.search(r'line:? (\d+)', message)
    message = re.split(
        r'[,.\s]*(?:found at|error from|error in expression from|from|\bline:)(?= line| ?\d)',
        message.replace('\\n', '\n'),
        flags=re.IGNORECASE,
    )[0]
    message = re.sub(r'^UP\w+\(["\'](.*?)["\']\)$', r'\1', message.strip())
    message = re.sub(
        r'^(Not able to handle|Found invalid expression): ', 'unknown name in ', message
    )
    message = re.sub(r'^unknown name in ([\w-]+)$', r'unknown name "\1"', message)
    message = message.split(' Different elements')[0].rstrip('.!').removeprefix('In FluentExp, ')
    message = message.replace(
        'is not well-formed', 'does not fit its declaration: are its arguments of the right types?'
    )
    if isinstance(error, KeyError):
        message = f'{message} is not declared'
    name = re.search(r"'([\w-]+)'|Name ([\w-]+)", message)
    line = int(said[1]) if said else _line_of(name[1] or name[2], text) if name else None
    return InputError(source, message + hint, line, cure=_UNREADABLE)


def _line_of(word: str, text: str) -> int | None:
    """Return the first line (from 1) in which the word stands outside comments, None if none."""
    text = re.sub(r';[^\n]*', '', text)
    found = re.search(rf'(?<![\w-]){re.escape(word)}(?![\w-])', text, re.IGNORECASE)
    return text.count('\n', 0, found.start()) + 1 if found else None
