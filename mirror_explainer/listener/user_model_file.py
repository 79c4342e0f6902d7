"""The form of a user model's YAML file: its keys and types, and the place of what is wrong."""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, Literal, Self

import yaml
from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, model_validator
from pydantic_core import PydanticCustomError

from mirror_explainer.errors import InputError, meant_or_known


class _Section(BaseModel):
    model_config = ConfigDict(extra='forbid', strict=True, frozen=True)


_Weight = Annotated[float, Field(ge=0, allow_inf_nan=False)]
_Probability = Annotated[float, Field(ge=0, le=1, allow_inf_nan=False)]
_Text = Annotated[str, Field(min_length=1, pattern=r'\S')]


class GoalEntry(_Section):
    """One of the candidate goals."""

    goal: _Text
    name: _Text | None = None
    probability: _Weight | None = None


class _UncertainFact(_Section):
    fact: _Text
    probability: _Probability


class _OneOf(_Section):
    facts: Annotated[dict[_Text, _Weight], Field(min_length=1)]


class Tenses(_Section):
    """A sentence in its tenses, or the future alone."""

    future: _Text
    present: _Text = ''
    past: _Text = ''


def _as_future(value: object) -> object:
    """Let a text alone stand for the future."""
    if isinstance(value, str) and not value.strip():
        raise PydanticCustomError('string_too_short', 'blank')
    return {'future': value} if isinstance(value, str) else value


_Sentence = Annotated[Tenses, BeforeValidator(_as_future)]


class SentenceEntry(_Section):
    """How an action is said: `template`, or the tenses themselves, and exceptions."""

    template: _Sentence | None = None
    future: _Text | None = None
    present: _Text = ''
    past: _Text = ''
    when: dict[str, dict[str, _Sentence]] = {}

    @model_validator(mode='after')
    def _one_sentence(self) -> Self:
        tenses = self.future or self.present or self.past
        if self.template is None and self.future is None or self.template and tenses:
            raise PydanticCustomError('sentence', 'give either "template", or "future" here')
        return self


class _ListenerEntry(_Section):
    """Who listens: a kind, and numbers that differ from those of its kind."""

    kind: Literal['open', 'planner'] = 'open'
    unforeseen: Annotated[float, Field(ge=0, lt=1, allow_inf_nan=False)] | None = None
    partial_goals: _Probability | None = None
    other_ends: Annotated[float, Field(gt=0, le=1, allow_inf_nan=False)] | None = None
    interest_in_facts: _Probability | None = None
    interest_in_way: _Probability | None = None
    min_gain: _Weight | None = None


class UserModelFile(_Section):
    """The file's schema; what only the domain can tell is checked afterwards."""

    goals: Annotated[list[GoalEntry], Field(min_length=1)] = []
    hyps_file: _Text = ''
    uncertain_facts: list[_UncertainFact] = []
    one_of: list[_OneOf] = []
    rationality: _Weight = 1.0
    unlisted_goal_probability: Annotated[float, Field(ge=0, lt=1, allow_inf_nan=False)] = 0.05
    goals_seen: bool = False
    sentences: dict[
        str,
        Annotated[
            SentenceEntry, BeforeValidator(lambda v: {'template': v} if isinstance(v, str) else v)
        ],
    ] = {}
    objects: dict[str, _Text] = {}
    phrases: dict[str, str] = {}
    listener: Annotated[
        _ListenerEntry, BeforeValidator(lambda v: {'kind': v} if isinstance(v, str) else v)
    ] = _ListenerEntry()


_FIELDS = {
    'goals': GoalEntry.model_fields,
    'uncertain_facts': _UncertainFact.model_fields,
    'one_of': _OneOf.model_fields,
    'sentences': SentenceEntry.model_fields,
    'listener': _ListenerEntry.model_fields,
}
# Far more than a model without aliases has.
_MOST_NODES = 100_000
_SPACES = 'Indent with spaces: YAML takes no tabs at the beginning of a line.'
_QUOTES = 'Put texts with { or a colon anywhere in them in quotes.'
# Control characters and halves of characters, but for white space, which a sentence has anyhow.
_CONTROL = re.compile('[\0-\x08\x0e-\x1b\x7f-\x84\x86-\x9f\ud800-\udfff]')


# The pairs of mapping nodes by key, by the nodes' ids.
_Pairs = dict[int, dict[str, tuple[yaml.Node, yaml.Node]]]


@dataclass(frozen=True)
class Fault:
    """Something wrong, with the keys and indices that lead to it in the YAML.

    `line` (from 1) is where it stands, None where the path says so. It need not: of equal keys
    the path means the last.
    """

    path: tuple[str | int, ...]
    reason: str
    line: int | None = None


def parse_yaml(
    text: str,
    source: str,
    wanted: str = 'the user model must be a mapping with "goals" or "hyps_file"',
) -> tuple[yaml.Node, dict[str, Any]]:
    """Return the YAML mapping twice: as nodes, which know their lines, and as plain values.

    `wanted` is told where it is none.
    """
    try:
        loader = yaml.SafeLoader(text)
        root = loader.get_single_node()
        if root:
            _require_few_nodes(root, source)
        data = loader.construct_document(root) if root else None
    except InputError:
        raise
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        reason = f'no YAML that can be read: {error.problem or error.context}'
        line = mark.line + 1 if mark else None
        cure = _SPACES if mark and _has_tab_indent(text, mark.line) else _QUOTES
        if "but got '?'" in f'{error.problem}':
            cure = 'A text with a ? in it needs quotes here, such as "(forall (?x - type) …)".'
        raise InputError(source, reason, line, cure=cure) from error
    except (yaml.YAMLError, RecursionError, ValueError, LookupError, AttributeError) as error:
        # The last three: PyYAML's constructors meet a tag such as !!int on a text that is none.
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise InputError(source, f'no YAML that can be read: {reason}') from error
    if root is None or not isinstance(data, dict):
        raise InputError(source, wanted, 1)
    return root, data


def _has_tab_indent(text: str, row: int) -> bool:
    """Say whether a line, counted from 0, begins with white space that has a tab."""
    lines = text.split('\n')
    return row < len(lines) and re.match(r' *\t', lines[row]) is not None


def _require_few_nodes(root: yaml.Node, source: str) -> None:
    """Raise InputError for aliases that stand for more than they could say in full.

    Aliases of aliases double with every line what they stand for, and one inside
    of what it stands for has no end.
    """
    sizes: dict[int, int] = {}  # by node; 0 until all that is inside is known
    waiting = [root]
    while waiting:
        node, inside = waiting[-1], _inside(waiting[-1])
        if id(node) not in sizes:
            sizes[id(node)] = 0
            waiting += [part for part in inside if id(part) not in sizes]
            continue
        waiting.pop()
        if not all(sizes[id(part)] for part in inside):
            raise InputError(source, 'an alias stands inside of what it stands for', _row(node))
        sizes[id(node)] = 1 + sum(sizes[id(part)] for part in inside)
        if sizes[id(node)] > max(_MOST_NODES, 2 * len(sizes)):
            raise InputError(source, 'its aliases stand for too much', _row(node))


def _inside(node: yaml.Node) -> list[yaml.Node]:
    if isinstance(node, yaml.MappingNode):
        return [part for pair in node.value for part in pair]
    return node.value if isinstance(node, yaml.SequenceNode) else []


def _row(node: yaml.Node) -> int:
    return int(node.start_mark.line) + 1


def text_faults(root: yaml.Node) -> Iterator[Fault]:
    """Find what YAML lets pass: keys that stand twice in one mapping, and control characters.

    Of equal keys YAML would silently drop one; and no sentence may tell a terminal what to do.
    """
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
                waiting += [((*path, key.value), key), ((*path, key.value), value)]
                if key.value in keys:
                    reason = f'the key "{key.value}" stands here twice'
                    yield Fault((*path, key.value), reason, _row(key))
                elif isinstance(key, yaml.ScalarNode):
                    keys.add(key.value)
        elif found := _CONTROL.search(node.value):
            character = f'U+{ord(found[0]):04X}'
            reason = f'this text has a character that is no text: {character}'
            yield Fault(path, reason, _row(node))


def schema_fault(detail: Mapping[str, Any]) -> Fault:
    """Return a validation error in plain words, and its place."""
    path = detail['loc']
    if detail['type'] == 'invalid_key' or path[-1] == '[key]':
        above = path[:-1] if detail['type'] == 'invalid_key' else path[:-2]
        return Fault((*above, str(detail['input'])), _key_reason(detail['input']))
    return Fault(path, _schema_reason(detail))


def _key_reason(key: object) -> str:
    """Say what may be meant by something that is no text, but stands where a key should."""
    if isinstance(key, int) and not isinstance(key, bool):
        return 'a number stands here as a key; decimals have a point: 0.5, not 0,5'
    return 'to YAML this key is no text: put it in quotes'


def _schema_reason(detail: Mapping[str, Any]) -> str:
    """Return a validation error that is not of a key in plain words."""
    if detail['type'] == 'extra_forbidden':
        section, *inside = detail['loc']
        fields = _FIELDS[section] if inside else UserModelFile.model_fields
        fields = Tenses.model_fields if section == 'sentences' and len(inside) > 2 else fields
        return 'unknown key' + meant_or_known(str(detail['loc'][-1]), fields)
    if detail['type'] == 'missing':
        return 'this key is missing'
    if detail['type'] == 'float_type' and isinstance(detail['input'], str):
        exponential = re.fullmatch(r'[-+]?\d+e[-+]?\d+', detail['input'], re.IGNORECASE)
        decimal = re.fullmatch(r'([-+]?\d*),(\d+)', detail['input'])
        hint = ' (YAML wants a point in 1.0e-3)' if exponential else ''
        hint = f' (a decimal has a point: {decimal[1] or 0}.{decimal[2]})' if decimal else hint
        return f'"{detail["input"]}" is a text, not a number{hint}'
    if detail['type'] == 'model_type' and detail['loc'][0] == 'sentences':
        keys = ['"template" and "when"'] if len(detail['loc']) == 2 else []
        mappings = ', or '.join([*keys, '"future", "present" and "past"'])
        return f'this should be the sentence as a text, or a mapping with {mappings}'
    if detail['type'] == 'model_type' and detail['loc'][0] == 'listener':
        return 'this should be open or planner, or a mapping with "kind" and numbers'
    if detail['type'] in ('model_type', 'dict_type'):
        return 'this should be a mapping: "key: value" lines, or {key: value}'
    if detail['type'] == 'list_type':
        return 'this should be a list: lines that begin with "- ", or [one, another]'
    if detail['type'] == 'too_short':
        return 'there is nothing in it'
    if detail['type'] in ('string_too_short', 'string_pattern_mismatch'):
        return 'this text is blank'
    return str(detail['msg']).replace('Input should be', 'this should be')


def faults_error(source: str, faults: Sequence[Fault], root: yaml.Node) -> InputError:
    """Return one error with all faults in the order of the file; in brief, the first of them."""
    known: _Pairs = {}
    lines = sorted(
        {(fault.line or _line(root, fault.path, known), _named(fault)) for fault in faults}
    )
    (line, reason), *others = lines
    first = InputError(source, reason, line)
    if not others:
        return first
    listed = '; '.join(f'line {line}: {reason}' for line, reason in lines)
    more = f'{len(others)} more {"fault" if len(others) == 1 else "faults"}'
    brief = f'{first}; and {more}: see the log or /diagnostics'
    return InputError(source, f'{len(lines)} faults: {listed}', brief=brief)


def _named(fault: Fault) -> str:
    place = ''.join(f'[{p}]' if isinstance(p, int) else f'.{p}' for p in fault.path).lstrip('.')
    return f'{place}: {fault.reason}' if place else fault.reason


def _line(root: yaml.Node, path: Iterable[str | int], known: _Pairs) -> int:
    """Return the line (from 1) of what the path leads to, or of the nearest thing above it.

    `known` has what was looked up before: a long mapping may have many faults.
    """
    node, line = root, root.start_mark.line
    for step in path:
        if isinstance(node, yaml.SequenceNode) and isinstance(step, int):
            node = node.value[step]
            line = node.start_mark.line
        elif isinstance(node, yaml.MappingNode):
            if id(node) not in known:
                # Of equal keys the last counts: YAML keeps that one.
                known[id(node)] = {str(key.value): (key, value) for key, value in node.value}
            if str(step) in known[id(node)]:
                key, node = known[id(node)][str(step)]
                line = key.start_mark.line
    return line + 1
