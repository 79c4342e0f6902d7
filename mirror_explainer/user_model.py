"""The user model's YAML in: what the listener believes about the robot, P(B) of P_R^H.

All faults of a file are reported in one error, each with its line.
"""

import math
import os
import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any

import yaml
from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationError

from mirror_explainer.errors import InputError
from mirror_explainer.pddl import Task, fluent_expression, goal_expression
from mirror_explainer.sentences import Template, action_parameters, template_faults
from mirror_explainer.text_files import read_text


@dataclass(frozen=True)
class CandidateGoal:
    """A goal that the user thinks the robot may have: P(G = goal) = probability."""

    name: str
    goal: str
    probability: float


@dataclass(frozen=True)
class UserModel:
    """P(B) = P(I) P(G) of the second-order theory of mind, and how actions are said.

    `uncertain_facts` are independent Bernoulli variables, atom → P(atom holds).
    Of each group in `one_of` exactly one fact holds, atom → probability.
    `rationality` is β of R(π, b), in 1/cost unit.
    """

    goals: tuple[CandidateGoal, ...]
    uncertain_facts: Mapping[str, float] = field(default_factory=dict)
    one_of: tuple[Mapping[str, float], ...] = ()
    rationality: float = 1.0
    unlisted_goal_probability: float = 0.05
    templates: Mapping[str, Template] = field(default_factory=dict)
    objects: Mapping[str, str] = field(default_factory=dict)


class _Section(BaseModel):
    model_config = ConfigDict(extra='forbid', strict=True, frozen=True)


_Weight = Annotated[float, Field(ge=0, allow_inf_nan=False)]
_Probability = Annotated[float, Field(ge=0, le=1, allow_inf_nan=False)]
_Text = Annotated[str, Field(min_length=1, pattern=r'\S')]


class _Goal(_Section):
    goal: _Text
    name: _Text | None = None
    probability: _Weight | None = None


class _UncertainFact(_Section):
    fact: _Text
    probability: _Probability


class _OneOf(_Section):
    facts: Annotated[dict[_Text, _Weight], Field(min_length=1)]


class _Wording(_Section):
    template: _Text
    when: dict[str, dict[str, _Text]] = {}


class _File(_Section):
    """The file's schema; what only the domain can tell is checked afterwards."""

    goals: Annotated[list[_Goal], Field(min_length=1)] = []
    hyps_file: _Text = ''
    uncertain_facts: list[_UncertainFact] = []
    one_of: list[_OneOf] = []
    rationality: _Weight = 1.0
    unlisted_goal_probability: Annotated[float, Field(ge=0, lt=1, allow_inf_nan=False)] = 0.05
    sentences: dict[
        str,
        Annotated[
            _Wording, BeforeValidator(lambda v: {'template': v} if isinstance(v, str) else v)
        ],
    ] = {}
    objects: dict[str, _Text] = {}


@dataclass(frozen=True)
class _Fault:
    """Something wrong, with the keys and indices that lead to it in the YAML."""

    path: tuple[str | int, ...]
    reason: str


def read_user_model(
    path: str | os.PathLike[str],
    task: Task | None = None,
    read: Callable[[str], str] = read_text,
) -> UserModel:
    """Read a user model's YAML file, and check it against the task's domain if one is given.

    `read` reads the file, and the `hyps_file` that it may name. Raises InputError
    with all faults: unknown keys, wrong types, atoms, actions or parameters that
    the domain does not have.
    """
    source = os.fspath(path)
    root, data = _parsed(read(source), source)
    faults = [*_repeated_keys(root)]
    try:
        file: _File | None = _File.model_validate(data)
    except ValidationError as error:
        file = None
        faults += [_Fault(detail['loc'], _schema_reason(detail)) for detail in error.errors()]
    goals, goal_faults = _goals(data, Path(path).parent, task, read)
    faults += goal_faults
    faults += _fact_faults(data, task)
    if task is not None:
        faults += _sentence_faults(data, action_parameters(task))
    if faults or file is None:
        raise InputError(source, *_report(faults, root))
    return _user_model(file, goals)


def _parsed(text: str, source: str) -> tuple[yaml.Node, dict[str, Any]]:
    """Return the YAML mapping twice: as nodes, which know their lines, and as plain values."""
    try:
        loader = yaml.SafeLoader(text)
        root = loader.get_single_node()
        data = loader.construct_document(root) if root else None
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        reason = f'no YAML that can be read: {error.problem or error.context}'
        raise InputError(source, reason, mark.line + 1 if mark else None) from error
    except (yaml.YAMLError, RecursionError, ValueError, LookupError, AttributeError) as error:
        # The last three: PyYAML's constructors meet a tag such as !!int on a text that is none.
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise InputError(source, f'no YAML that can be read: {reason}') from error
    if root is None or not isinstance(data, dict):
        raise InputError(source, 'the user model must be a mapping with "goals" or "hyps_file"', 1)
    return root, data


def _user_model(file: _File, goals: Sequence[_Goal]) -> UserModel:
    """Return the normalised values of a file without faults."""
    weights = [1.0 if goal.probability is None else goal.probability for goal in goals]
    return UserModel(
        goals=tuple(
            CandidateGoal(goal.name or goal.goal, goal.goal, probability)
            for goal, probability in zip(goals, _normalised(weights), strict=True)
        ),
        uncertain_facts={_canonical(f.fact): f.probability for f in file.uncertain_facts},
        one_of=tuple(
            dict(zip(map(_canonical, group.facts), _normalised(group.facts.values()), strict=True))
            for group in file.one_of
        ),
        rationality=file.rationality,
        unlisted_goal_probability=file.unlisted_goal_probability,
        templates={
            action.lower(): Template(
                wording.template,
                {
                    parameter: {item.lower(): said for item, said in by_object.items()}
                    for parameter, by_object in wording.when.items()
                },
            )
            for action, wording in file.sentences.items()
        },
        objects={name.lower(): called for name, called in file.objects.items()},
    )


def _normalised(weights: Collection[float]) -> list[float]:
    """Return the weights as probabilities; their sum may be beyond what a float can hold."""
    largest = max(weights)
    total = math.fsum(weight / largest for weight in weights)
    return [weight / largest / total for weight in weights]


def _goals(
    data: Mapping[str, Any], folder: Path, task: Task | None, read: Callable[[str], str]
) -> tuple[list[_Goal], list[_Fault]]:
    """Return the candidate goals, of the list or of the PUCRS file, and their faults."""
    faults: list[_Fault] = []
    placed: list[tuple[tuple[str | int, ...], str, _Goal]] = []
    if ('goals' in data) == ('hyps_file' in data):
        faults.append(_Fault((), 'give the candidate goals either as "goals" or as "hyps_file"'))
    if isinstance(data.get('goals'), list):
        for index, entry in enumerate(data['goals']):
            try:
                placed.append((('goals', index), '', _Goal.model_validate(entry)))
            except ValidationError:  # the whole file's validation reports it
                text = entry.get('goal') if isinstance(entry, dict) else None
                if isinstance(text, str) and text.strip():
                    faults += _expression_faults(task, text, ('goals', index, 'goal'))
    elif isinstance(data.get('hyps_file'), str) and data['hyps_file'].strip():
        path = folder / data['hyps_file']
        try:
            lines = read(str(path)).splitlines()
        except InputError as error:
            return [], [*faults, _Fault(('hyps_file',), str(error))]
        for number, line in enumerate(lines, start=1):
            if line.strip():
                goal = _Goal(goal=f'(and {line.replace(",", " ")})', name=line.strip())
                placed.append((('hyps_file',), f'{path.name}, line {number}: ', goal))
        if not placed:
            faults.append(_Fault(('hyps_file',), f'{path} has no goals'))
    names: set[str] = set()
    for place, where, goal in placed:
        name = goal.name or goal.goal
        if name in names:
            faults.append(_Fault(place, f'{where}another candidate is named "{name}" too'))
        names.add(name)
        faults += _expression_faults(task, goal.goal, place if where else (*place, 'goal'), where)
    weights = [goal.probability for _, _, goal in placed]
    if None in weights and any(weight is not None for weight in weights):
        faults.append(_Fault(('goals',), 'give every goal a probability, or none'))
    elif weights and None not in weights and not any(weights):
        faults.append(_Fault(('goals',), 'every goal has probability 0'))
    return [goal for _, _, goal in placed], faults


def _expression_faults(
    task: Task | None, goal: str, path: tuple[str | int, ...], where: str = ''
) -> Iterator[_Fault]:
    """Find what the domain does not have in a goal."""
    if task is not None:
        try:
            goal_expression(task.model, goal)
        except InputError as error:
            yield _Fault(path, where + error.reason)


def _fact_faults(data: Mapping[str, Any], task: Task | None) -> Iterator[_Fault]:
    """Find atoms that the domain does not have, atoms named twice, and empty groups."""
    seen: set[str] = set()
    for path, atom in _atoms(data):
        if _canonical(atom) in seen:
            yield _Fault(path, f'{atom} is named more than once')
        seen.add(_canonical(atom))
        if task is not None:
            try:
                fluent = fluent_expression(task.model, atom).fluent()
            except InputError as error:
                yield _Fault(path, error.reason)
            else:
                if task.axioms and fluent in task.axioms.fluents:
                    reason = f'{atom} is derived from other facts: name those that are uncertain'
                    yield _Fault(path, reason)
    for index, group in enumerate(_list(data, 'one_of')):
        facts = group.get('facts') if isinstance(group, dict) else None
        weights = list(facts.values()) if isinstance(facts, dict) else []
        if weights and all(weight == 0 for weight in weights):
            yield _Fault(('one_of', index), 'every fact of the group has probability 0')


def _atoms(data: Mapping[str, Any]) -> Iterator[tuple[tuple[str | int, ...], str]]:
    """Yield path and text of every atom whose probability the file gives."""
    for index, entry in enumerate(_list(data, 'uncertain_facts')):
        if isinstance(entry, dict) and isinstance(entry.get('fact'), str):
            yield ('uncertain_facts', index, 'fact'), entry['fact']
    for index, group in enumerate(_list(data, 'one_of')):
        facts = group.get('facts') if isinstance(group, dict) else None
        for atom in facts if isinstance(facts, dict) else ():
            if isinstance(atom, str):
                yield ('one_of', index, 'facts', atom), atom


def _sentence_faults(
    data: Mapping[str, Any], parameters: Mapping[str, tuple[str, ...]]
) -> Iterator[_Fault]:
    """Find sentences for actions or parameters that the domain does not have."""
    sentences = data.get('sentences')
    for action, entry in sentences.items() if isinstance(sentences, dict) else ():
        path = ('sentences', action)
        if not isinstance(action, str) or action.lower() not in parameters:
            yield _Fault(path, f'the domain has no action "{action}"')
            continue
        for reason in template_faults(_wording(entry), parameters[action.lower()]):
            yield _Fault(path, reason)


def _wording(entry: object) -> Template:
    """Return as much of an action's sentences as is well-formed; the schema reports the rest."""
    parts = entry if isinstance(entry, dict) else {'template': entry}
    template, when = parts.get('template'), parts.get('when')
    return Template(
        template if isinstance(template, str) else '',
        {
            name: {item: said for item, said in by_object.items() if isinstance(said, str)}
            for name, by_object in (when.items() if isinstance(when, dict) else ())
            if isinstance(by_object, dict)
        },
    )


def _canonical(atom: str) -> str:
    """Return an atom's text in lower case with single spaces."""
    return f'({" ".join(atom.strip().strip("()").lower().split())})'


def _list(data: Mapping[str, Any], key: str) -> list[Any]:
    value = data.get(key)
    return value if isinstance(value, list) else []


def _repeated_keys(root: yaml.Node) -> Iterator[_Fault]:
    """Find keys that stand twice in one mapping, of which YAML would silently drop one."""
    waiting: list[tuple[tuple[str | int, ...], yaml.Node]] = [((), root)]
    visited: set[int] = set()
    while waiting:
        path, node = waiting.pop()
        if id(node) in visited:
            continue
        visited.add(id(node))
        if isinstance(node, yaml.SequenceNode):
            waiting += [((*path, index), item) for index, item in enumerate(node.value)]
        elif isinstance(node, yaml.MappingNode):
            keys: set[str] = set()
            for key, value in node.value:
                if key.value in keys:
                    yield _Fault((*path, key.value), f'the key "{key.value}" stands here twice')
                elif isinstance(key, yaml.ScalarNode):
                    keys.add(key.value)
                waiting.append(((*path, key.value), value))


def _schema_reason(detail: Mapping[str, Any]) -> str:
    """Return a validation error in plain words."""
    if detail['type'] == 'extra_forbidden':
        return 'unknown key'
    if detail['type'] == 'missing':
        return 'this key is missing'
    if detail['type'] == 'float_type' and isinstance(detail['input'], str):
        exponential = re.fullmatch(r'[-+]?\d+e[-+]?\d+', detail['input'], re.IGNORECASE)
        hint = ' (YAML wants a point in 1.0e-3)' if exponential else ''
        return f'"{detail["input"]}" is a text, not a number{hint}'
    if detail['type'] in ('model_type', 'dict_type'):
        return 'this should be a mapping: "key: value" lines, or {key: value}'
    if detail['type'] == 'list_type':
        return 'this should be a list: lines that begin with "- ", or [one, another]'
    if detail['type'] == 'too_short':
        return 'there is nothing in it'
    if detail['type'] in ('string_too_short', 'string_pattern_mismatch'):
        return 'this text is blank'
    return str(detail['msg']).replace('Input should be', 'this should be')


def _report(faults: Sequence[_Fault], root: yaml.Node) -> tuple[str, int | None]:
    """Return all faults as one sentence in the order of the file, and the line of a single one."""
    lines = sorted({(_line(root, fault.path), _named(fault)) for fault in faults})
    if len(lines) == 1:
        return lines[0][1], lines[0][0]
    listed = '; '.join(f'line {line}: {reason}' for line, reason in lines)
    return f'{len(lines)} faults: {listed}', None


def _named(fault: _Fault) -> str:
    place = ''.join(f'[{p}]' if isinstance(p, int) else f'.{p}' for p in fault.path).lstrip('.')
    return f'{place}: {fault.reason}' if place else fault.reason


def _line(root: yaml.Node, path: Iterable[str | int]) -> int:
    """Return the line (from 1) of what the path leads to, or of the nearest thing above it."""
    node, line = root, root.start_mark.line
    for step in path:
        if isinstance(node, yaml.SequenceNode) and isinstance(step, int):
            node = node.value[step]
            line = node.start_mark.line
        elif isinstance(node, yaml.MappingNode):
            # Of equal keys the last counts: YAML keeps that one.
            found = [pair for pair in node.value if pair[0].value == str(step)]
            if found:
                key, node = found[-1]
                line = key.start_mark.line
    return line + 1
