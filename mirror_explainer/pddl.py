"""PDDL texts in: the robot's task (Section 4 of the paper), its atoms and goals.

unified-planning reads the texts; this file turns what goes wrong into errors
that name the place. Like unified-planning, it must be used from one thread at a time.
"""

import difflib
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import pyparsing
import unified_planning.model as up
from unified_planning.exceptions import UPException
from unified_planning.io import PDDLReader

from mirror_explainer.errors import InputError
from mirror_explainer.pddl_sections import (
    require_readable,
    section,
    types_in_alternatives,
    with_plain_predicates,
    without_costs,
    without_total_time,
)
from mirror_explainer.sequential import is_durative, require_fixed_durations, sequential_texts

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


# "(a (b c))" as nested lists of words. Without quoted strings, which PDDL does not have, it is
# ten times faster.
_NESTED = pyparsing.nested_expr(content=pyparsing.Regex(r'[^\s()]+'), ignore_expr=None)


@dataclass(frozen=True)
class Task:
    """A planning task ⟨P, A, I, G, O⟩ as read: the two texts, and unified-planning's problem.

    Nothing in them takes time: durative actions happen at once, and cost what
    they took. `durative` says that there were some.
    """

    domain: str
    problem: str
    model: up.Problem
    durative: bool = False

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
        return _text(_NESTED.parse_string(text[start.start() :]).as_list()[0][1])


def read_task(
    domain: str, problem: str, domain_source: str = 'domain', problem_source: str = 'problem'
) -> Task:
    """Read a PDDL domain and problem.

    The sources name the file or topic in errors. Raises InputError for a text
    that is not PDDL, is inconsistent, or has more of PDDL than can be explained.
    """
    domain, problem = domain.removeprefix('\ufeff'), problem.removeprefix('\ufeff')
    require_definition(domain, 'domain', domain_source)
    require_definition(problem, 'problem', problem_source)
    require_readable(domain, problem, domain_source, problem_source)
    problem = without_total_time(problem)
    durative = is_durative(domain)
    if durative:
        require_fixed_durations(domain, domain_source)
        if section(problem, ':metric') is None:
            domain = without_costs(domain)
    model = _read_model(domain, problem, domain_source, problem_source)
    if durative:
        domain, problem = sequential_texts(model, domain, problem, domain_source, problem_source)
        model = _read_model(domain, problem, domain_source, problem_source)
    if not all(isinstance(action, up.InstantaneousAction) for action in model.actions):
        raise InputError(domain_source, 'it has actions other than :action and :durative-action')
    goals = conjuncts(model.environment.expression_manager.And(model.goals))
    model.clear_goals()
    for conjunct in goals:
        model.add_goal(conjunct)
    return Task(domain, problem, model, durative)


def _read_model(domain: str, problem: str, domain_source: str, problem_source: str) -> up.Problem:
    """Return unified-planning's problem. Raises InputError with lines of the texts given."""
    readable = with_plain_predicates(domain)
    try:
        model = PDDLReader().parse_problem_string(readable, problem)
    except _READER_ERRORS as error:
        _raise_for_domain_alone(readable, domain_source)
        raise _input_error(
            error, problem, problem_source, _domain_hint(domain, problem)
        ) from error
    for name, line in types_in_alternatives(domain):
        if name != 'object' and name not in {item.name for item in model.user_types}:
            raise InputError(domain_source, f'the type {name} is not declared', line)
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
    tree, faults = _tree(atom, source), list[str]()
    expression = _Expressions(model, faults).atom(tree, {})
    if faults:
        raise InputError(source, '; '.join(faults))
    return expression


def goal_expression(model: up.Problem, goal: str, source: str = 'goal') -> up.FNode:
    """Return unified-planning's expression of a PDDL goal description, given as text.

    Raises InputError that names every unknown predicate, object or type in it.
    """
    tree, faults = _tree(goal, source), list[str]()
    try:
        expression = _Expressions(model, faults).expression(tree, {})
    except RecursionError as error:
        raise InputError(source, 'the goal is nested too deeply') from error
    if faults:
        raise InputError(source, '; '.join(faults))
    return expression


class _Expressions:
    """Builds expressions from nested lists of words, and collects the faults it meets."""

    def __init__(self, model: up.Problem, faults: list[str]) -> None:
        self._model = model
        self._manager = model.environment.expression_manager
        self._faults = faults

    def expression(self, tree: Any, variables: dict[str, up.Variable]) -> up.FNode:
        if isinstance(tree, str) or (tree and not isinstance(tree[0], str)):
            return self._fault(f'"{_text(tree)}" is no PDDL condition')
        head = tree[0].lower() if tree else 'and'
        parts = tree[1:]
        connectives = {'and': self._manager.And, 'or': self._manager.Or}
        if head in connectives:
            return connectives[head](*[self.expression(part, variables) for part in parts])
        if head == 'not' and len(parts) == 1:
            return self._manager.Not(self.expression(parts[0], variables))
        if head == 'imply' and len(parts) == 2:
            return self._manager.Implies(*[self.expression(part, variables) for part in parts])
        if head in ('forall', 'exists') and len(parts) == 2 and not isinstance(parts[0], str):
            bound = self._variables(parts[0])
            body = self.expression(parts[1], variables | bound)
            quantifier = self._manager.Forall if head == 'forall' else self._manager.Exists
            return quantifier(body, *bound.values()) if bound else body
        if head == '=' and len(parts) == 2:
            left, right = (self._term(part, variables) for part in parts)
            return self._manager.Equals(left, right) if left and right else self._manager.TRUE()
        return self.atom(tree, variables)

    def atom(self, tree: Any, variables: dict[str, up.Variable]) -> up.FNode:
        if isinstance(tree, str) or not tree or not all(isinstance(word, str) for word in tree):
            return self._fault(f'"{_text(tree)}" is no atom such as (predicate object)')
        name = tree[0].lower()
        if not self._model.has_fluent(name):
            names = [fluent.name for fluent in self._model.fluents]
            return self._fault(f'{_text(tree)}: the domain has no predicate "{name}"', name, names)
        fluent = self._model.fluent(name)
        if not fluent.type.is_bool_type():
            return self._fault(f'{_text(tree)}: "{name}" is a number, not a fact')
        if len(tree) - 1 != fluent.arity:
            return self._fault(
                f'{_text(tree)}: "{name}" takes {fluent.arity} arguments, not {len(tree) - 1}'
            )
        terms = [self._term(word, variables) for word in tree[1:]]
        for word, term, parameter in zip(tree[1:], terms, fluent.signature, strict=True):
            if term is not None and not parameter.type.is_compatible(term.type):
                self._fault(
                    f'{_text(tree)}: {word.lower()} is of type {term.type.name}, '
                    f'but "{name}" takes a {parameter.type.name} there'
                )
                return self._manager.TRUE()
        if any(term is None for term in terms):
            return self._manager.TRUE()
        return self._manager.FluentExp(fluent, terms)

    def _term(self, word: Any, variables: dict[str, up.Variable]) -> up.FNode | None:
        name = word.lower() if isinstance(word, str) else _text(word)
        if name in variables:
            return self._manager.VariableExp(variables[name])
        if self._model.has_object(name):
            return self._manager.ObjectExp(self._model.object(name))
        names = [item.name for item in self._model.all_objects]
        self._fault(f'the problem has no object "{name}"', name, names)
        return None

    def _variables(self, words: Sequence[Any]) -> dict[str, up.Variable]:
        """Return the variables of "(?a ?b - type …)" by name, question mark included."""
        bound: dict[str, up.Variable] = {}
        for names, type_name in re.findall(
            r'((?:\?\S+\s*)+)(?:-\s*(\S+))?', _text(words).lower()[1:-1]
        ):
            try:
                variable_type = self._model.user_type(type_name or 'object')
            except UPException:
                self._fault(f'the domain has no type "{type_name or "object"}"')
                continue
            for name in names.split():
                bound[name] = up.Variable(name[1:], variable_type, self._model.environment)
        return bound

    def _fault(self, reason: str, name: str = '', names: Iterable[str] = ()) -> up.FNode:
        close = difflib.get_close_matches(name, names, n=1)
        self._faults.append(f'{reason} (did you mean "{close[0]}"?)' if close else reason)
        return self._manager.TRUE()


def _tree(text: str, source: str) -> Any:
    """Return "(a (b c))" as nested lists of words."""
    try:
        return _NESTED.parse_string(text, parse_all=True).as_list()[0]
    except pyparsing.ParseBaseException as error:
        shown = text.strip()[:80]
        raise InputError(
            source, f'"{shown}" is not one expression in balanced parentheses'
        ) from error
    except RecursionError as error:
        raise InputError(source, 'the text is nested too deeply') from error


def _text(tree: Any) -> str:
    return tree if isinstance(tree, str) else f'({" ".join(_text(part) for part in tree)})'


def require_definition(text: str, kind: str, source: str) -> None:
    """Raise InputError unless the text begins as a PDDL domain or problem should."""
    if not text.strip():
        raise InputError(source, f'the text is empty; a PDDL {kind} is expected')
    found = re.match(
        r'(?:\s|;[^\n]*(?:\n|$))*\(\s*define\s*\(\s*(domain|problem)\b', text, re.IGNORECASE
    )
    if found is None:
        raise InputError(
            source, f'this is no PDDL {kind}: it must begin with (define ({kind} …)', 1
        )
    if found[1].lower() != kind:
        raise InputError(
            source,
            f'this is a PDDL {found[1].lower()}, but a {kind} is expected here: '
            'are the two mixed up?',
            text.count('\n', 0, found.end()) + 1,
        )


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
        return InputError(source, f'no PDDL that can be read: {found} {near}{hint}', error.lineno)
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
        return InputError(source, reason + detail + hint)
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
    message = message.split(' Different elements')[0].rstrip('.!').removeprefix('In FluentExp, ')
    message = message.replace(
        'is not well-formed', 'does not fit its declaration: are its arguments of the right types?'
    )
    if isinstance(error, KeyError):
        message = f'{message} is not declared'
    name = re.search(r"'([\w-]+)'|Name ([\w-]+)", message)
    line = int(said[1]) if said else _line_of(name[1] or name[2], text) if name else None
    return InputError(source, message + hint, line)


def _line_of(word: str, text: str) -> int | None:
    """Return the first line (from 1) in which the word stands outside comments, None if none."""
    text = re.sub(r';[^\n]*', '', text)
    found = re.search(rf'(?<![\w-]){re.escape(word)}(?![\w-])', text, re.IGNORECASE)
    return text.count('\n', 0, found.start()) + 1 if found else None
