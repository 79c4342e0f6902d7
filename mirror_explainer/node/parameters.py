"""The node's parameters: names, defaults, ranges, and which can be set on the running node."""

from collections.abc import Collection, Iterable, Iterator

from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor

from mirror_explainer.errors import did_you_mean
from mirror_explainer.input_limits import InputLimits
from mirror_explainer.settings import Meaning, PlanningSettings, Question, setting, settings_of

# Those of no dataclass: what the node hears and does, beside planning and answering.
_OWN = {
    'domain_file': setting('', 'PDDL domain; a message on "domain" replaces it', fixed=True),
    'user_model_file': setting('', 'YAML: what the listener may believe'),
    'remember': setting(False, 'whether each answer conditions the next'),
    'answer_timeout': setting(5.0, 's, that a call waits for an update', least=0.0, most=1e6),
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


def _declared() -> Iterator[tuple[str, object, Meaning]]:
    for name, item in _OWN.items():
        yield name, item.default, item.metadata['meaning']
    for kind in (Question, PlanningSettings, InputLimits):
        for item, meaning in settings_of(kind):
            yield item.name, item.default, meaning


CHOICES = {name: meaning.choices for name, _, meaning in _declared() if meaning.choices}
PARAMETERS = tuple(
    (name, default, _descriptor(default, meaning)) for name, default, meaning in _declared()
)


def unknown_parameters(given: Iterable[str], declared: Collection[str]) -> Iterator[str]:
    """Yield a sentence for each parameter that was given to the node, which would ignore it."""
    for name in sorted(set(given).difference(declared)):
        meant = did_you_mean(name, declared)
        yield f'the parameter "{name}" is not one of this node\'s, and is ignored{meant}'
