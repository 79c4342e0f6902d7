"""All texts of the study's pages, by language: a catalogue a file, each with the same keys."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

import yaml

_FOLDER = Path(__file__).parent
LANGUAGES = tuple(sorted(file.stem for file in _FOLDER.glob('*.yaml')))


@dataclass(frozen=True)
class Check:
    """A question that shows whether the rules were understood; `right` is an option's index."""

    question: str
    options: tuple[str, ...]
    right: int
    why: str


@dataclass(frozen=True)
class Words:
    """A language's texts.

    `texts` are by key, with `{name}` where something is put in. `things` are what the
    warehouse's names are called, `objects` the same where a sentence wants another form.
    `actions` say what the robot does: a text with `{0}`, `{1}`, … for the names that the
    action has, or one by name; empty where the robot's own sentences are of this language.
    """

    language: str
    called: str
    direction: str
    texts: Mapping[str, str]
    things: Mapping[str, str]
    checks: tuple[Check, ...]
    objects: Mapping[str, str] = field(default_factory=dict)
    actions: Mapping[str, str | Mapping[str, str]] = field(default_factory=dict)

    def text(self, key: str, **values: object) -> str:
        """Return a text, with the values in their places."""
        return self.texts[key].format(**values)

    def thing(self, name: str) -> str:
        """Return what something of the warehouse is called."""
        return self.things.get(name, name.replace('_', ' '))

    def said(self, action: str, sentence: str) -> str:
        """Return how the robot says a ground action; `sentence` is how it does in English."""
        name, *arguments = action.strip('()').split()
        said = self.actions.get(name, sentence)
        if isinstance(said, str):
            return said.format(*(self.objects.get(a, self.thing(a)) for a in arguments))
        return next((said[a] for a in reversed(arguments) if a in said), sentence)


@cache
def words(language: str) -> Words:
    """Return the texts of a language, one of LANGUAGES."""
    data = yaml.safe_load((_FOLDER / f'{language}.yaml').read_text(encoding='utf-8'))
    checks = tuple(Check(**{**c, 'options': tuple(c['options'])}) for c in data.pop('checks'))
    return Words(language=language, checks=checks, **data)
