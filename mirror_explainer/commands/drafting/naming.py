"""What drafted goals are called: what the robot will do that brings their parts about."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

from mirror_explainer.commands.drafting.patterns import Pattern
from mirror_explainer.commands.drafting.words import Words
from mirror_explainer.listener.verb_phrase import PREPOSITIONS
from mirror_explainer.listener.wording import parts, plain_name
from mirror_explainer.pddl import Task, words_of
from mirror_explainer.pddl.atoms import effects_in

_LITERAL = re.compile(r'(\(not )?(\([^()]+\))\)?')
_SENTENCE = re.compile(r'I will (.+)\.')


@dataclass(frozen=True)
class Naming:
    """Names goals by the sentences of actions; those of the robot's plan are asked first."""

    task: Task
    words: Words
    plan: Sequence[str]

    def of(self, pattern: Pattern) -> str:
        """Return a name with the pattern's variables: "feed {horse} and rinse the pan".

        '' where a part cannot be said so that each object is named, or where two objects
        are called the same.
        """
        phrases = [self._phrase(part) for part in pattern.parts]
        if not all(phrases) or len(set(self._called.values())) < len(self._called):
            return ''
        *first, last = phrases
        return f'{", ".join(first)} and {last}' if first else last

    @cached_property
    def _called(self) -> dict[str, str]:
        """What is said for each object."""
        names = (item.name.lower() for item in self.task.model.all_objects)
        return {name: self.words.objects.get(name, plain_name(name)) for name in names}

    @cached_property
    def _meant(self) -> dict[str, tuple[str, bool]]:
        """What each form of a phrase stands for: the first literal that is named so."""
        return {}

    def _phrase(self, part: str) -> str:
        """Return what brings a part about, '' if no sentence says just that."""
        literal = _LITERAL.fullmatch(part)
        if not literal:
            return ''
        predicate, *objects = words_of(literal[2])
        kind = (predicate, not literal[1])
        for phrase, arguments in self._phrases(*kind):
            said = dict(zip(arguments, (self._called.get(o, o) for o in objects), strict=True))
            form = re.sub(r'\{.*?\}', '{}', phrase)
            is_own = self._meant.setdefault(form, kind) == kind
            named = {name for _, name in parts(phrase) if name}
            if is_own and named == said.keys() and len(said) == len(objects):
                return ''.join(text + said.get(name, '') for text, name in parts(phrase))
        return ''

    def _phrases(self, predicate: str, value: bool) -> Iterator[tuple[str, list[str]]]:
        """Yield for each action that makes this so its phrase, and the predicate's parameters.

        What a phrase says of other objects is left out, such as where a thing is sent.
        """
        steps = [words_of(step)[0] for step in self.plan]
        for action in sorted(self.task.model.actions, key=lambda a: a.name.lower() not in steps):
            name = action.name.lower()
            sentence = self.words.sentences.get(name) or self.words.unsure.get(name, '')
            told = _SENTENCE.fullmatch(sentence)
            for effect in effects_in(action):
                is_so = effect.value.is_true() if value else effect.value.is_false()
                if told and is_so and effect.fluent.fluent().name.lower() == predicate:
                    arguments = [str(argument).lower() for argument in effect.fluent.args]
                    yield _without_others(told[1], arguments), arguments


def _without_others(phrase: str, arguments: Sequence[str]) -> str:
    """Return a phrase without "from {p}" and the like where {p} is none of these parameters."""
    for _, name in parts(phrase):
        if name and name not in arguments:
            others = '|'.join(sorted(PREPOSITIONS))
            phrase = re.sub(rf' (?:{others}) \{{{re.escape(name)}\}}', '', phrase)
    return phrase
