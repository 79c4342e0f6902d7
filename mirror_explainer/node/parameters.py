"""The node's parameters: all that a running explainer may be told, with ranges and meanings."""

from collections.abc import Callable, Collection, Iterable, Iterator
from dataclasses import fields
from typing import Any

from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor

from mirror_explainer.errors import did_you_mean
from mirror_explainer.input_limits import InputLimits
from mirror_explainer.node.inputs import Configuration, NodeSettings
from mirror_explainer.settings import Meaning, PlanningSettings, Question, settings_of

# The parts of a Configuration.
_PARTS = {
    'node': NodeSettings,
    'question': Question,
    'planning': PlanningSettings,
    'limits': InputLimits,
}


def _descriptor(default: object, meaning: Meaning) -> ParameterDescriptor:
    descriptor = ParameterDescriptor(description=meaning.description, read_only=meaning.fixed)
    if meaning.choices:
        named = ', '.join(choice or 'empty' for choice in meaning.choices)
        descriptor.additional_constraints = f'one of: {named}'
    if isinstance(default, float):
        between = FloatingPointRange(from_value=meaning.least, to_value=meaning.most)
        descriptor.floating_point_range = [between]
    elif isinstance(default, int) and not isinstance(default, bool):
        between = IntegerRange(from_value=int(meaning.least), to_value=int(meaning.most))
        descriptor.integer_range = [between]
    return descriptor


_SETTINGS = [found for part in _PARTS.values() for found in settings_of(part)]
CHOICES = {item.name: meaning.choices for item, meaning in _SETTINGS if meaning.choices}
PARAMETERS = tuple(
    (item.name, item.default, _descriptor(item.default, meaning)) for item, meaning in _SETTINGS
)


def configuration(value_of: Callable[[str], Any]) -> Configuration:
    """Return what the parameters say, each by its name."""
    return Configuration(
        **{
            name: part(**{item.name: value_of(item.name) for item in fields(part)})
            for name, part in _PARTS.items()
        }
    )


def unknown_parameters(given: Iterable[str], declared: Collection[str]) -> Iterator[str]:
    """Yield a sentence for each parameter that was given to the node, which would ignore it."""
    for name in sorted(set(given).difference(declared)):
        meant = did_you_mean(name, declared)
        yield f'the parameter "{name}" is not one of this node\'s, and is ignored{meant}'
