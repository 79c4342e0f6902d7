"""Slips in a user model's YAML that its schema would puzzle over: told with the right form."""

from collections.abc import Iterator, Mapping
from typing import Any

from mirror_explainer.listener.user_model_file import Fault


def slips(data: Mapping[str, Any]) -> Iterator[Fault]:
    """Find entries whose form is a slip; what else the schema says of these can be passed over."""
    if 'goals' not in data and isinstance(goal := data.get('goal'), str):
        yield Fault(('goal',), f'write goals: [{{goal: "{goal}"}}]')
    for index, entry in enumerate(_list(data, 'uncertain_facts')):
        path = ('uncertain_facts', index)
        if isinstance(entry, dict) and (atom := _atom_key(entry)):
            number = entry[atom]
            yield Fault(path, f'write {{fact: {atom}, probability: {_shown(number)}}} here')
        elif isinstance(entry, str) and entry.strip().startswith('('):
            yield Fault(path, f'write {{fact: {entry.strip()}, probability: 0.5}} here')
    for index, entry in enumerate(_list(data, 'one_of')):
        path = ('one_of', index)
        if isinstance(entry, dict) and _atom_key(entry) and 'facts' not in entry:
            listed = ', '.join(f'{atom}: {_shown(number)}' for atom, number in entry.items())
            yield Fault(path, f'"facts:" is missing: write {{facts: {{{listed}}}}} here')
        elif isinstance(entry, list) and all(isinstance(atom, str) for atom in entry):
            listed = ', '.join(f'{atom}: 1' for atom in entry)
            yield Fault(path, f'write {{facts: {{{listed}}}}} here')
    for index, entry in enumerate(_list(data, 'goals')):
        if isinstance(entry, str):
            goal = entry if entry.strip().startswith('(') else f'({entry})'
            yield Fault(('goals', index), f'write {{goal: "{goal}"}} here')
        elif isinstance(entry, dict):
            known = ('name', 'goal', 'probability', 'for', 'where')
            keys = [*entry]
            for before, key in zip(keys, keys[1:], strict=False):
                if key not in known and entry[key] is None and isinstance(entry[before], str):
                    text = f'"{entry[before]}, {key}"'
                    reason = f'a text with a comma needs quotes here: {before}: {text}'
                    yield Fault(('goals', index, str(key)), reason)


def _atom_key(entry: Mapping[Any, Any]) -> str:
    """Return the first key that is an atom, '' if none is."""
    atoms = (key for key in entry if isinstance(key, str) and key.strip().startswith('('))
    return next(atoms, '')


def _shown(value: object) -> str:
    return f'{value:g}' if isinstance(value, int | float) else '0.5'


def _list(data: Mapping[str, Any], key: str) -> list[Any]:
    value = data.get(key)
    return value if isinstance(value, list) else []
