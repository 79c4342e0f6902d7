"""What of a user model only the domain can tell: whether it has its goals, facts and actions."""

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from mirror_explainer.errors import InputError, did_you_mean
from mirror_explainer.listener.phrases import phrase_faults
from mirror_explainer.listener.user_model_file import Fault, GoalEntry
from mirror_explainer.listener.wording import TYPE, Template, Wording, template_faults
from mirror_explainer.pddl import Task, fluent_expression, goal_expression


@dataclass(frozen=True)
class _Candidate:
    """A candidate goal, and where it stands: a path in the YAML, and a line of another file.

    `entry` is None where the schema, which reports that, finds it malformed.
    """

    path: tuple[str | int, ...]
    text: str
    entry: GoalEntry | None
    where: str = ''


def candidate_goals(
    data: Mapping[str, Any], path: Path, task: Task | None, read: Callable[[str], str]
) -> tuple[list[GoalEntry], list[Fault]]:
    """Return the candidate goals, of the list or of the PUCRS file, and their faults.

    `path` is the user model's own.
    """
    candidates: list[_Candidate] = []
    faults: list[Fault] = []
    if ('goals' in data) == ('hyps_file' in data):
        faults.append(Fault((), 'give the candidate goals either as "goals" or as "hyps_file"'))
    if isinstance(data.get('goals'), list):
        candidates = list(_listed(data['goals']))
    elif isinstance(data.get('hyps_file'), str) and data['hyps_file'].strip():
        hypotheses = path.parent / data['hyps_file']
        try:
            candidates = list(_lines_of(hypotheses, read))
        except InputError as error:
            return [], [*faults, Fault(('hyps_file',), str(error))]
        if not candidates:
            faults.append(Fault(('hyps_file',), f'{hypotheses} has no goals'))
    for candidate in candidates:
        faults += _goal_faults(candidate, task)
    goals = [candidate.entry for candidate in candidates if candidate.entry]
    return goals, [*faults, *_name_faults(candidates), *_weight_faults(candidates)]


def _listed(goals: Sequence[Any]) -> Iterator[_Candidate]:
    """Yield the candidates that stand in the user model itself."""
    for index, values in enumerate(goals):
        try:
            entry = GoalEntry.model_validate(values)
            yield _Candidate(('goals', index), entry.goal, entry)
        except ValidationError:
            text = values.get('goal') if isinstance(values, dict) else None
            if isinstance(text, str) and text.strip():
                yield _Candidate(('goals', index), text, None)


def _lines_of(hypotheses: Path, read: Callable[[str], str]) -> Iterator[_Candidate]:
    """Yield the candidates of a PUCRS file: one a line, atoms with commas or blanks between.

    A name may follow after a semicolon.
    """
    for number, line in enumerate(read(str(hypotheses)).split('\n'), start=1):
        atoms, _, name = line.partition(';')
        if atoms.strip():
            goal = f'(and {atoms.replace(",", " ")})'
            entry = GoalEntry(goal=goal, name=name.strip() or atoms.strip())
            where = f'{hypotheses.name}, line {number}: '
            yield _Candidate(('hyps_file',), entry.goal, entry, where)


def _goal_faults(candidate: _Candidate, task: Task | None) -> Iterator[Fault]:
    """Find what the domain does not have in a goal that is no pattern."""
    if task is None or '{' in candidate.text:
        return
    try:
        goal_expression(task.model, candidate.text)
    except InputError as error:
        path = candidate.path if candidate.where else (*candidate.path, 'goal')
        yield Fault(path, candidate.where + error.reason)


def _name_faults(candidates: Sequence[_Candidate]) -> Iterator[Fault]:
    names: set[str] = set()
    for candidate in candidates:
        if candidate.entry:
            name = candidate.entry.name or candidate.entry.goal
            if name in names:
                reason = f'{candidate.where}another candidate is named "{name}" too'
                yield Fault(candidate.path, reason)
            names.add(name)


def _weight_faults(candidates: Sequence[_Candidate]) -> Iterator[Fault]:
    weights = {c.path: c.entry.probability for c in candidates if c.entry}
    missing = [path for path, weight in weights.items() if weight is None]
    if missing and len(missing) < len(weights):
        for path in missing:
            yield Fault(path, 'it has no probability: give every goal one, or none')
    elif weights and not missing and not any(weights.values()):
        yield Fault(('goals',), 'every goal has probability 0')


def fact_faults(data: Mapping[str, Any], task: Task | None) -> Iterator[Fault]:
    """Find atoms that the domain does not have, atoms named twice, and empty groups.

    Not of patterns.
    """
    seen: set[str] = set()
    for path, atom in ((path, atom) for path, atom in atoms(data) if '{' not in atom):
        if canonical(atom) in seen:
            yield Fault(path, f'{atom} is named more than once')
        seen.add(canonical(atom))
        if task is not None:
            try:
                fluent = fluent_expression(task.model, atom).fluent()
            except InputError as error:
                bare = not atom.strip().startswith('(')
                yield Fault(path, f'write {canonical(atom)}' if bare else error.reason)
            else:
                if task.axioms and fluent.name in task.axioms.names:
                    reason = f'{atom} is derived from other facts: name those that are uncertain'
                    yield Fault(path, reason)
    for index, group in enumerate(_list(data, 'one_of')):
        facts = group.get('facts') if isinstance(group, dict) else None
        weights = list(facts.values()) if isinstance(facts, dict) else []
        if weights and all(weight == 0 for weight in weights):
            yield Fault(('one_of', index), 'every fact of the group has probability 0')


def atoms(data: Mapping[str, Any]) -> Iterator[tuple[tuple[str | int, ...], str]]:
    """Yield path and text of every atom whose probability the file gives."""
    for index, entry in enumerate(_list(data, 'uncertain_facts')):
        if isinstance(entry, dict) and isinstance(entry.get('fact'), str):
            yield ('uncertain_facts', index, 'fact'), entry['fact']
    for index, group in enumerate(_list(data, 'one_of')):
        facts = group.get('facts') if isinstance(group, dict) else None
        for atom in facts if isinstance(facts, dict) else ():
            if isinstance(atom, str):
                yield ('one_of', index, 'facts', atom), atom


def sentence_faults(
    data: Mapping[str, Any], parameters: Mapping[str, tuple[str, ...]], types: Collection[str]
) -> Iterator[Fault]:
    """Find sentences for actions, parameters or types that the domain does not have."""
    sentences = data.get('sentences')
    for action, entry in sentences.items() if isinstance(sentences, dict) else ():
        path = ('sentences', action)
        if not isinstance(action, str) or action.lower() not in parameters:
            hint = did_you_mean(str(action).lower(), parameters)
            yield Fault(path, f'the domain has no action "{action}"{hint}')
            continue
        template = _template(entry)
        for reason in template_faults(template, parameters[action.lower()]):
            yield Fault(path, reason)
        for parameter, wordings in template.when.items():
            for key in wordings:
                if key.startswith(TYPE) and key.removeprefix(TYPE).lower() not in types:
                    kind = key.removeprefix(TYPE)
                    hint = did_you_mean(kind.lower(), types)
                    yield Fault(
                        (*path, 'when', parameter, key), f'the domain has no type "{kind}"{hint}'
                    )


def phrase_text_faults(data: Mapping[str, Any]) -> Iterator[Fault]:
    """Find phrases that there are not, and such that lack what they must say."""
    phrases = data.get('phrases')
    for name, reason in phrase_faults(phrases) if isinstance(phrases, dict) else ():
        yield Fault(('phrases', name), reason)


def _template(entry: object) -> Template:
    """Return as much of an action's sentences as is well-formed; the schema reports the rest."""
    parts = entry if isinstance(entry, dict) else {'template': entry}
    when = parts.get('when')
    return Template(
        _wording(parts.get('template', parts)),
        {
            name: {item: _wording(said) for item, said in by.items() if isinstance(item, str)}
            for name, by in (when.items() if isinstance(when, dict) else ())
            if isinstance(name, str) and isinstance(by, dict)
        },
    )


def _wording(entry: object) -> Wording:
    tenses = entry if isinstance(entry, dict) else {'future': entry}
    texts = [tenses.get(tense) for tense in ('future', 'present', 'past')]
    return Wording(*(text if isinstance(text, str) else '' for text in texts))


def canonical(atom: str) -> str:
    """Return an atom's text in lower case with single spaces."""
    return f'({" ".join(atom.strip().strip("()").lower().split())})'


def _list(data: Mapping[str, Any], key: str) -> list[Any]:
    value = data.get(key)
    return value if isinstance(value, list) else []
