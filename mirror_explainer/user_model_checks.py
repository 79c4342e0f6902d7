"""What of a user model only the domain can tell: whether it has its goals, facts and actions."""

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from mirror_explainer.errors import InputError
from mirror_explainer.pddl import Task, fluent_expression, goal_expression
from mirror_explainer.sentences import Template, template_faults
from mirror_explainer.user_model_file import Fault, GoalEntry


def candidate_goals(
    data: Mapping[str, Any], path: Path, task: Task | None, read: Callable[[str], str]
) -> tuple[list[GoalEntry], list[Fault]]:
    """Return the candidate goals, of the list or of the PUCRS file, and their faults.

    `path` is the user model's own.
    """
    faults: list[Fault] = []
    placed: list[tuple[tuple[str | int, ...], str, GoalEntry]] = []
    if ('goals' in data) == ('hyps_file' in data):
        faults.append(Fault((), 'give the candidate goals either as "goals" or as "hyps_file"'))
    if isinstance(data.get('goals'), list):
        for index, entry in enumerate(data['goals']):
            try:
                placed.append((('goals', index), '', GoalEntry.model_validate(entry)))
            except ValidationError:  # the whole file's validation reports it
                text = entry.get('goal') if isinstance(entry, dict) else None
                if isinstance(text, str) and text.strip():
                    faults += _expression_faults(task, text, ('goals', index, 'goal'))
    elif isinstance(data.get('hyps_file'), str) and data['hyps_file'].strip():
        hypotheses = path.parent / data['hyps_file']
        try:
            lines = read(str(hypotheses)).split('\n')
        except InputError as error:
            return [], [*faults, Fault(('hyps_file',), str(error))]
        for number, line in enumerate(lines, start=1):
            if line.strip():
                goal = GoalEntry(goal=f'(and {line.replace(",", " ")})', name=line.strip())
                placed.append((('hyps_file',), f'{hypotheses.name}, line {number}: ', goal))
        if not placed:
            faults.append(Fault(('hyps_file',), f'{hypotheses} has no goals'))
    names: set[str] = set()
    for place, where, goal in placed:
        name = goal.name or goal.goal
        if name in names:
            faults.append(Fault(place, f'{where}another candidate is named "{name}" too'))
        names.add(name)
        faults += _expression_faults(task, goal.goal, place if where else (*place, 'goal'), where)
    weights = [goal.probability for _, _, goal in placed]
    if None in weights and any(weight is not None for weight in weights):
        faults.append(Fault(('goals',), 'give every goal a probability, or none'))
    elif weights and None not in weights and not any(weights):
        faults.append(Fault(('goals',), 'every goal has probability 0'))
    return [goal for _, _, goal in placed], faults


def _expression_faults(
    task: Task | None, goal: str, path: tuple[str | int, ...], where: str = ''
) -> Iterator[Fault]:
    """Find what the domain does not have in a goal."""
    if task is not None:
        try:
            goal_expression(task.model, goal)
        except InputError as error:
            yield Fault(path, where + error.reason)


def fact_faults(data: Mapping[str, Any], task: Task | None) -> Iterator[Fault]:
    """Find atoms that the domain does not have, atoms named twice, and empty groups."""
    seen: set[str] = set()
    for path, atom in atoms(data):
        if canonical(atom) in seen:
            yield Fault(path, f'{atom} is named more than once')
        seen.add(canonical(atom))
        if task is not None:
            try:
                fluent = fluent_expression(task.model, atom).fluent()
            except InputError as error:
                yield Fault(path, error.reason)
            else:
                if task.axioms and fluent in task.axioms.fluents:
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
    data: Mapping[str, Any], parameters: Mapping[str, tuple[str, ...]]
) -> Iterator[Fault]:
    """Find sentences for actions or parameters that the domain does not have."""
    sentences = data.get('sentences')
    for action, entry in sentences.items() if isinstance(sentences, dict) else ():
        path = ('sentences', action)
        if not isinstance(action, str) or action.lower() not in parameters:
            yield Fault(path, f'the domain has no action "{action}"')
            continue
        for reason in template_faults(_wording(entry), parameters[action.lower()]):
            yield Fault(path, reason)


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


def canonical(atom: str) -> str:
    """Return an atom's text in lower case with single spaces."""
    return f'({" ".join(atom.strip().strip("()").lower().split())})'


def _list(data: Mapping[str, Any], key: str) -> list[Any]:
    value = data.get(key)
    return value if isinstance(value, list) else []
