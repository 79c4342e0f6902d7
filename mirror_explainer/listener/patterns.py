"""Entries by pattern: one of the user model's that stands for one for each choice of objects.

    - {goal: "(delivered {i} {p})", for: {i: item, p: place}, where: "(free {p})"}

They are written out before anything else is made of the file, so that all else knows
plain entries only.
"""

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

from mirror_explainer.errors import InputError, did_you_mean
from mirror_explainer.listener.goals import parts_of
from mirror_explainer.listener.user_model_file import Fault
from mirror_explainer.listener.wording import plain_name
from mirror_explainer.pddl import Task, goal_expression
from mirror_explainer.pddl.expressions import text_conjuncts
from mirror_explainer.pddl.states import Evaluator

Path = tuple[str | int, ...]

# Choices that are looked at for one pattern; in a second or so.
MOST_CHOICES = 20_000
_VARIABLE = re.compile(r'\{([^{}]*)\}')
_NAME = re.compile(r'[\w-]+')
_KEYS = ('for', 'where')


@dataclass
class WrittenOut:
    """The file's values without patterns, and where each of their list's entries stood."""

    data: dict[str, Any]
    faults: list[Fault] = field(default_factory=list)
    places: dict[Path, Path] = field(default_factory=dict)

    def placed(self, fault: Fault) -> Fault:
        """Return a fault with the path that its entry has in the file."""
        place = self.places.get(fault.path[:2])
        return replace(fault, path=(*place, *fault.path[2:])) if place else fault


def written_out(data: Mapping[str, Any], task: Task | None) -> WrittenOut:
    """Return the values of a user model with each pattern written out.

    Without a task there are no objects to choose: patterns are left as they are found
    with their variables, to be checked in form only.
    """
    result = WrittenOut(dict(data))
    choices = Choices(task) if task else None
    written_goals = _Goals(_called(data.get('objects')))
    for section, text in (('goals', 'goal'), ('uncertain_facts', 'fact'), ('one_of', 'facts')):
        entries = data.get(section)
        if not isinstance(entries, list):
            continue
        plain: list[Any] = []
        for index, entry in enumerate(entries):
            place: Path = (section, index)
            try:
                written = _entries(entry, text, choices, written_goals)
            except InputError as error:
                result.faults.append(Fault((*place, error.source), error.reason))
                written = []
            for one in written:
                result.places[(section, len(plain))] = place
                plain.append(one)
        result.data[section] = plain
    return result


def _entries(
    entry: Any, key: str, choices: 'Choices | None', written_goals: '_Goals'
) -> list[Any]:
    """Return what an entry stands for: itself, or one for each choice of its pattern.

    Raises InputError, whose source is the key that is at fault.
    """
    if not isinstance(entry, dict) or not entry.keys() & set(_KEYS):
        loose = _VARIABLE.search(str(entry.get(key, ''))) if isinstance(entry, dict) else None
        if loose and _NAME.fullmatch(loose[1]):
            reason = f'{loose[0]} needs a type, by for: {{{loose[1]}: the type}} in the same entry'
            raise InputError(key, reason)
        if choices and key == 'goal':
            written_goals.note(entry, choices.task)
        return [entry]
    rest = {name: value for name, value in entry.items() if name not in _KEYS}
    kinds, where, text = entry.get('for'), entry.get('where', ''), entry.get(key)
    if not isinstance(kinds, dict) or not kinds or not all(map(_is_text, kinds.items())):
        raise InputError('for', 'this should name a type for each variable: {i: item, p: place}')
    if not isinstance(where, str):
        raise InputError('where', 'this should be a condition as a text')
    if not isinstance(text, str):
        raise InputError(key, 'with "for" this should be a text with variables in braces')
    for name, value in {**rest, 'where': where}.items():
        for variable in _VARIABLE.findall(value) if isinstance(value, str) else ():
            if variable not in kinds:
                meant = did_you_mean(variable, kinds)
                raise InputError(name, f'"for" has no variable "{variable}"{meant}')
    if choices is None and key == 'goal':
        name = f'{rest.get("name") or text} {kinds} {where}'  # goals of one text may differ here
        return [rest | {'name': name}]
    if choices is None:
        return [rest] if key != 'facts' else [rest | {'facts': {text: 1.0}}]
    chosen = list(choices.of(kinds, where))
    if not chosen:
        if where and next(choices.of(kinds, ''), None):
            constant = '' if _VARIABLE.search(where) else ': it names no variable in braces'
            reason = f'{where} holds initially for no choice of objects{constant}'
            raise InputError('where', reason)
        raise InputError('for', 'the problem has too few objects of these types')
    if key == 'goal':
        return written_goals.of(rest, chosen, choices.task)
    texts = list(dict.fromkeys(filled(text, choice) for choice in chosen))
    if key == 'facts':
        return [rest | {'facts': dict.fromkeys(texts, 1.0)}]
    return [rest | {'fact': fact} for fact in texts]


def _is_text(item: tuple[Any, Any]) -> bool:
    return all(isinstance(part, str) and part.strip() for part in item)


@dataclass
class _Goals:
    """The goals written out so far: what several entries stand for is one, and gets all shares.

    `called` is what objects are called in names; where that is the same for two choices of an
    entry, they are named by the objects.
    """

    called: Mapping[str, str]
    by_meaning: dict[Any, dict[str, Any]] = field(default_factory=dict)

    def note(self, entry: Any, task: Task) -> None:
        """Take note of an entry that is no pattern, if it has a goal of this task."""
        if isinstance(entry, dict) and isinstance(entry.get('goal'), str):
            with suppress(InputError):  # told where entries are checked
                expression = goal_expression(task.model, entry['goal'])
                self.by_meaning.setdefault(frozenset(parts_of(expression, task.model)), entry)

    def of(
        self, entry: Mapping[str, Any], chosen: Sequence[Mapping[str, str]], task: Task
    ) -> list[Any]:
        """Return a goal for each choice that means another one, with equal shares."""
        meant: dict[Any, Mapping[str, str]] = {}
        for choice in chosen:
            try:
                expression = goal_expression(task.model, filled(entry['goal'], choice))
            except InputError as error:
                raise InputError('goal', error.reason) from error
            meant.setdefault(frozenset(parts_of(expression, task.model)), choice)
        goals: dict[Any, dict[str, Any]] = {
            meaning: {**entry, 'goal': filled(entry['goal'], choice)}
            for meaning, choice in meant.items()
        }
        if isinstance(entry.get('name'), str):
            name = _telling(entry['name'], [*meant.values()])
            called = self._naming(name, chosen)
            for meaning, choice in meant.items():
                goals[meaning]['name'] = filled(name, called(choice))
        weight: Any = entry.get('probability')
        weighted = isinstance(weight, int | float) and not isinstance(weight, bool)
        new = []
        for meaning, goal in goals.items():
            if weighted:
                goal['probability'] = weight / len(goals)
            known = self.by_meaning.get(meaning)
            if known is None:
                self.by_meaning[meaning] = goal
                new.append(goal)
            elif weighted and isinstance(known.get('probability'), int | float):
                known['probability'] += goal['probability']
        return new

    def _naming(
        self, name: str, chosen: Sequence[Mapping[str, str]]
    ) -> Callable[[Mapping[str, str]], dict[str, str]]:
        """Return what says how the objects of a choice are called in names."""

        def plainly(choice: Mapping[str, str]) -> dict[str, str]:
            return {v: plain_name(o) for v, o in choice.items()}

        def in_words(choice: Mapping[str, str]) -> dict[str, str]:
            known = {v: self.called[o] for v, o in choice.items() if o in self.called}
            return plainly(choice) | known

        names = {filled(name, in_words(choice)) for choice in chosen}
        plain = {filled(name, plainly(choice)) for choice in chosen}
        return in_words if len(names) == len(plain) else plainly


def _telling(name: str, chosen: Sequence[Mapping[str, str]]) -> str:
    """Return a name with the variables that it lacks, where it does not tell choices apart."""
    lacking = [f'{{{variable}}}' for variable in chosen[0] if f'{{{variable}}}' not in name]
    if not lacking or len({filled(name, choice) for choice in chosen}) == len(chosen):
        return name
    return f'{name} ({", ".join(lacking)})'


def _called(objects: Any) -> dict[str, str]:
    """Return what the objects' section calls which object, as far as it is well-formed."""
    if not isinstance(objects, dict):
        return {}
    return {
        name.lower(): called
        for name, called in objects.items()
        if isinstance(name, str) and isinstance(called, str)
    }


def filled(text: str, choice: Mapping[str, str]) -> str:
    """Return a text with its variables replaced by the objects chosen."""
    return _VARIABLE.sub(lambda found: choice.get(found[1], found[0]), text)


@dataclass(frozen=True)
class Choices:
    """Chooses a task's objects for variables of types: different objects, all conditions met."""

    task: Task

    @cached_property
    def _of_type(self) -> dict[str, list[str]]:
        model = self.task.model
        found = {'object': [item.name for item in model.all_objects]}
        for kind in model.user_types:
            found[kind.name.lower()] = [item.name for item in model.objects(kind)]
        return found

    @cached_property
    def _evaluator(self) -> Evaluator:
        return Evaluator(self.task)

    @cached_property
    def _known(self) -> dict[str, bool]:
        return {}

    def of(self, kinds: Mapping[str, str], where: str = '') -> Iterator[dict[str, str]]:
        """Yield each choice of objects for variables by type for which `where` holds initially.

        Raises InputError with the source 'for' or 'where'.
        """
        for kind in kinds.values():
            if kind.lower() not in self._of_type:
                meant = did_you_mean(kind.lower(), self._of_type)
                raise InputError('for', f'the domain has no type "{kind}"{meant}')
        variables = list(kinds)
        conditions = text_conjuncts(where, 'where')
        looked_at = 0

        def choose(choice: dict[str, str]) -> Iterator[dict[str, str]]:
            nonlocal looked_at
            if len(choice) == len(variables):
                yield dict(choice)
                return
            variable = variables[len(choice)]
            for item in self._of_type[kinds[variable].lower()]:
                if item in choice.values():
                    continue
                looked_at += 1
                if looked_at > MOST_CHOICES:
                    raise InputError(
                        'for', f'more than {MOST_CHOICES} choices: narrow them by "where"'
                    )
                more = choice | {variable: item}
                if all(self._may_hold(condition, more) for condition in conditions):
                    yield from choose(more)

        yield from choose({})

    def _may_hold(self, condition: str, choice: Mapping[str, str]) -> bool:
        """Say whether a condition holds initially, or has variables that are not chosen yet."""
        text = filled(condition, choice)
        if _VARIABLE.search(text):
            return True
        if text not in self._known:
            try:
                expression = goal_expression(self.task.model, text)
            except InputError as error:
                raise InputError('where', error.reason) from error
            evaluator = self._evaluator
            self._known[text] = evaluator.holds(expression, evaluator.first_state())
        return self._known[text]
