"""How the user model words an action: sentences with places for objects, in three tenses."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from string import Formatter

TYPE = 'type '  # begins a key of `Template.when` that stands for all objects of a type


@dataclass(frozen=True)
class Wording:
    """A sentence for a step that is ahead, going on, or done; '' where it is not given.

    {name} stands for the object of the action's parameter of that name.
    """

    future: str
    present: str = ''
    past: str = ''

    @property
    def given(self) -> tuple[str, ...]:
        """The sentences that are given."""
        return tuple(text for text in (self.future, self.present, self.past) if text)


@dataclass(frozen=True)
class Template:
    """How an action is said: "I will grab {i}.", with other wordings for some arguments.

    `when` maps a parameter's name to wordings by object, or by "type …" for the objects
    of a type and its subtypes: an object's own wording goes before its type's, a type's
    before that of the types above it. The first parameter whose object has a wording decides.
    """

    wording: Wording
    when: Mapping[str, Mapping[str, Wording]] = field(default_factory=dict)

    def chosen(self, objects: Mapping[str, str], types: Mapping[str, tuple[str, ...]]) -> Wording:
        """Return the wording for these objects, by parameter; `types` go from near to far."""
        for parameter, item in objects.items():
            wordings = self.when.get(parameter, {})
            for key in (item, *(TYPE + kind for kind in types.get(item, ()))):
                if key in wordings:
                    return wordings[key]
        return self.wording


def parts(text: str) -> Iterator[tuple[str, str]]:
    """Yield the pieces of a sentence: plain text, and the parameter after it, '' if none."""
    for literal, parameter, _, _ in Formatter().parse(text):
        yield literal, parameter or ''


def listed(things: Sequence[str], joining: str = 'and') -> str:
    """Return things, at least one, as a list in a sentence: "a, b and c"."""
    *most, last = things
    return f'{", ".join(most)} {joining} {last}' if most else last


def plain_name(item: str) -> str:
    """Return an object's name in words, for a place in a user model's sentence or name."""
    return item.replace('-', ' ').replace('_', ' ')


def template_faults(template: Template, parameters: tuple[str, ...]) -> list[str]:
    """Return what is wrong with a template of an action that has these parameters."""
    faults = [
        f'the action has no parameter "{name}"' + _instead(name, parameters, '"%s"')
        for name in template.when
        if name not in parameters
    ]
    wordings = [template.wording, *(w for by in template.when.values() for w in by.values())]
    for text in (text for wording in wordings for text in wording.given):
        faults += _text_faults(text, parameters)
    return faults


def _text_faults(text: str, parameters: tuple[str, ...]) -> Iterator[str]:
    try:
        fields = list(Formatter().parse(text))
    except ValueError as error:
        yield f'"{text}": {error}'
        return
    for _, name, spec, conversion in fields:
        if name is not None and name not in parameters:
            instead = _instead(name, parameters, '{%s}')
            yield f'"{text}": {{{name}}} is no parameter of the action{instead}'
        elif spec or conversion:
            yield f'"{text}": write {{{name}}} without a format'


def _instead(name: str, parameters: tuple[str, ...], form: str) -> str:
    """Say what to write for a name that is no parameter, in this form, or what there is."""
    plain = name.removeprefix('?').lower()
    if plain in parameters:
        return f' (write {form % plain})'
    return f' (it has {", ".join(parameters) or "none"})'
