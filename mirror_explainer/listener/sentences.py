"""P(O|Π)'s alphabet: the sentence that verbalizes each ground action.

Two ground actions with the same sentence are one observation to the listener.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from string import Formatter

from mirror_explainer.pddl import Task, words_of


@dataclass(frozen=True)
class Template:
    """How an action is said: "I will grab {i}.", with other wordings for some arguments.

    `when` maps a parameter's name to wordings by object: the first parameter
    whose object has a wording decides. {name} stands for a parameter's object.
    """

    template: str
    when: Mapping[str, Mapping[str, str]] = field(default_factory=dict)


def template_faults(template: Template, parameters: tuple[str, ...]) -> list[str]:
    """Return what is wrong with a template of an action that has these parameters."""
    wordings = [template.template, *(w for by in template.when.values() for w in by.values())]
    faults = [
        f'the action has no parameter "{name}"' + _instead(name, parameters, '"%s"')
        for name in template.when
        if name not in parameters
    ]
    for wording in wordings:
        try:
            fields = list(Formatter().parse(wording))
        except ValueError as error:
            faults.append(f'"{wording}": {error}')
            continue
        for _, name, spec, conversion in fields:
            if name is not None and name not in parameters:
                faults.append(
                    f'"{wording}": {{{name}}} is no parameter of the action'
                    + _instead(name, parameters, '{%s}')
                )
            elif spec or conversion:
                faults.append(f'"{wording}": write {{{name}}} without a format')
    return faults


@dataclass(frozen=True)
class Sentences:
    """Says the ground actions of a domain.

    `parameters` gives the names of each action's parameters, `templates` the
    wording of some actions, `objects` what some objects are called. The rest
    is said by name: (pick-up box1 shelf_2) is "I will pick up box1 shelf 2."
    """

    parameters: Mapping[str, tuple[str, ...]]
    templates: Mapping[str, Template] = field(default_factory=dict)
    objects: Mapping[str, str] = field(default_factory=dict)

    def of(self, action: str) -> str:
        """Return the sentence for a ground action such as "(grab red_circle red_room)"."""
        name, *arguments = words_of(action)
        called = [self.objects.get(argument, _readable(argument)) for argument in arguments]
        if name not in self.templates:
            return f'I will {" ".join([_readable(name), *called])}.'
        template = self.templates[name]
        parameters = self.parameters[name]
        wording = template.template
        for parameter, argument in zip(parameters, arguments, strict=True):
            if argument in template.when.get(parameter, {}):
                wording = template.when[parameter][argument]
                break
        names = dict(zip(parameters, called, strict=True))
        said = ''.join(
            literal + (names[parameter] if parameter else '')
            for literal, parameter, _, _ in Formatter().parse(wording)
        )
        return ' '.join(said.split())


def action_parameters(task: Task) -> dict[str, tuple[str, ...]]:
    """Return the parameters' names of each action of the domain."""
    return {action.name: tuple(p.name for p in action.parameters) for action in task.model.actions}


def _readable(name: str) -> str:
    return name.replace('-', ' ').replace('_', ' ')


def _instead(name: str, parameters: tuple[str, ...], form: str) -> str:
    """Say what to write for a name that is no parameter, in this form, or what there is."""
    plain = name.removeprefix('?').lower()
    if plain in parameters:
        return f' (write {form % plain})'
    return f' (it has {", ".join(parameters) or "none"})'
