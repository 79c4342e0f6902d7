"""What goals without a name are called: what the robot will do that brings their parts about."""

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import unified_planning.model as up

from mirror_explainer.listener.sentences import Sentences, with_names
from mirror_explainer.listener.verb_phrase import PREPOSITIONS
from mirror_explainer.listener.wording import listed, parts
from mirror_explainer.pddl import Task, words_of
from mirror_explainer.pddl.atoms import effects_in

_LITERAL = re.compile(r'(\(not )?(\([^()]+\))\)?')
_SENTENCE = re.compile(r'I will (.+)\.')


@dataclass(frozen=True)
class _Phrase:
    """A phrase with parameters in braces, and what is said for each: several things for one."""

    text: str
    called: Mapping[str, tuple[str, ...]]

    def __str__(self) -> str:
        return with_names(self.text, {p: listed(things) for p, things in self.called.items()})

    @property
    def together(self) -> set[str]:
        """The parameters for which several things are said."""
        return {name for name, things in self.called.items() if len(things) > 1}

    def joined(self, other: '_Phrase') -> '_Phrase | None':
        """Return both as one phrase, None where they differ in more than one place."""
        if self.text != other.text:
            return None
        differing = {name for name in self.called if self.called[name] != other.called[name]}
        if len(differing) != 1 or not self.together <= differing:
            return None
        [name] = differing
        return _Phrase(self.text, {**self.called, name: self.called[name] + other.called[name]})


@dataclass(frozen=True)
class GoalNames:
    """Names goals by the sentences of actions.

    What the robot's plan does goes first: a step that makes it so, then actions that it has.
    `called` returns what is said for an object in the sentence of an action, in a place of it.
    """

    task: Task
    sentences: Mapping[str, str]
    called: Callable[[str, str, str], str]
    plan: Sequence[str]

    def of(self, goal: Sequence[str]) -> str:
        """Return a name for a goal's parts, as PDDL: "feed the horse and rinse the pan".

        Neighbours that differ in one object are one phrase: "feed the horse and the cow".
        Variables in braces stay. '' where a part cannot be said so that each object is named
        but those that are the only ones of their types, and of a goal without parts.
        """
        phrases: list[_Phrase] = []
        for part in goal:
            phrase = self._phrase(part)
            if phrase is None:
                return ''
            joined = phrases[-1].joined(phrase) if phrases else None
            phrases = [*phrases[:-1], joined] if joined else [*phrases, phrase]
        told = [str(phrase) for phrase in phrases]
        if len(told) > 1 and any(phrase.together for phrase in phrases):
            return f'{", ".join(told[:-1])}, and {told[-1]}'
        return listed(told) if told else ''

    @cached_property
    def _meant(self) -> dict[str, tuple[str, bool]]:
        """What each form of a phrase stands for: the first literal that is named so."""
        return {}

    @cached_property
    def _found(self) -> dict[str, '_Phrase | None']:
        """The phrases by parts: goals share these, and each answer names the goals anew."""
        return {}

    def _phrase(self, part: str) -> '_Phrase | None':
        """Return what brings a part about, None if no sentence says just that."""
        if part not in self._found:
            self._found[part] = self._find(part)
        return self._found[part]

    def _find(self, part: str) -> '_Phrase | None':
        literal = _LITERAL.fullmatch(part)
        if not literal:
            return None
        predicate, *objects = words_of(literal[2])
        kind = (predicate, not literal[1])
        for action, phrase, arguments in sorted(
            self._phrases(*kind), key=lambda by: not self._is_done(by[0], by[2], objects)
        ):
            given = dict(zip(arguments, objects, strict=True))
            if not self._fits(action, given):
                continue
            form = re.sub(r'\{.*?\}', '{}', phrase)
            is_own = self._meant.setdefault(form, kind) == kind
            named = {name for _, name in parts(phrase) if name}
            unnamed = {given[name] for name in given.keys() - named}
            is_whole = named <= given.keys() and len(given) == len(objects)
            if is_own and is_whole and unnamed <= self._alone:
                said = {name: (self.called(action, name, given[name]),) for name in named}
                return _Phrase(phrase, said)
        return None

    def _is_done(self, action: str, arguments: Sequence[str], objects: Sequence[str]) -> bool:
        """Say whether a step of the plan is this action of these objects."""
        names = self._parameters[action]
        steps = (dict(zip(names, step, strict=True)) for step in self._steps.get(action, ()))
        return any([step.get(name) for name in arguments] == [*objects] for step in steps)

    @cached_property
    def _parameters(self) -> dict[str, dict[str, up.Type]]:
        """The types of parameters by their names, in order, by action."""
        return {
            action.name.lower(): {p.name.lower(): p.type for p in action.parameters}
            for action in self._actions
        }

    @cached_property
    def _steps(self) -> dict[str, list[list[str]]]:
        """The arguments of the plan's steps, by action."""
        steps: dict[str, list[list[str]]] = {}
        for step in self.plan:
            name, *arguments = words_of(step)
            steps.setdefault(name, []).append(arguments)
        return steps

    def _fits(self, action: str, given: Mapping[str, str]) -> bool:
        """Say whether an action takes these objects, or variables such as {cup2}."""
        parameters = self._parameters[action]
        kinds = {name: self._kinds.get(re.sub(r'\d*\}', '}', of)) for name, of in given.items()}
        return all(
            kind is None or name not in parameters or parameters[name].is_compatible(kind)
            for name, kind in kinds.items()
        )

    @cached_property
    def _kinds(self) -> dict[str, up.Type]:
        """The types of objects, and of variables that are named by their types."""
        model = self.task.model
        objects = {item.name.lower(): item.type for item in model.all_objects}
        return objects | {f'{{{kind.name.lower()}}}': kind for kind in model.user_types}

    @cached_property
    def _alone(self) -> frozenset[str]:
        """The objects that are the only ones of their types: nobody asks which is meant."""
        model = self.task.model
        kinds = (tuple(model.objects(kind)) for kind in model.user_types)
        return frozenset(items[0].name.lower() for items in kinds if len(items) == 1)

    def _phrases(self, predicate: str, value: bool) -> Iterator[tuple[str, str, list[str]]]:
        """Yield actions that make this so, with their phrases, and the predicate's parameters.

        What a phrase says of other objects is left out, such as where a thing is sent.
        """
        for action in self._actions:
            name = action.name.lower()
            told = _SENTENCE.fullmatch(self.sentences.get(name, ''))
            for effect in effects_in(action):
                is_so = effect.value.is_true() if value else effect.value.is_false()
                if told and is_so and effect.fluent.fluent().name.lower() == predicate:
                    arguments = [str(argument).lower() for argument in effect.fluent.args]
                    yield name, _without_others(told[1], arguments), arguments

    @cached_property
    def _actions(self) -> list[up.Action]:
        steps = {words_of(step)[0] for step in self.plan}
        return sorted(self.task.model.actions, key=lambda a: a.name.lower() not in steps)


def goal_names(task: Task, sentences: Sentences, plan: Sequence[str]) -> GoalNames:
    """Return the names that goals have in the words of an answer."""
    usual = {
        action.name.lower(): sentences.usual(action.name.lower()) for action in task.model.actions
    }
    return GoalNames(task, usual, sentences.called_in, plan)


def _without_others(phrase: str, arguments: Sequence[str]) -> str:
    """Return a phrase without "from {p}" and the like where {p} is none of these parameters."""
    for _, name in parts(phrase):
        if name and name not in arguments:
            place = rf'\{{{re.escape(name)}\}}'
            # "With the cream and the cherry" without the cream is "with the cherry".
            phrase = re.sub(rf'{place} and (?=\{{)', '', phrase)
            others = '|'.join(sorted({*PREPOSITIONS, 'and'}))
            phrase = re.sub(rf' (?:{others}) {place}', '', phrase)
    return phrase
