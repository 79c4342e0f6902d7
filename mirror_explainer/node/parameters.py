"""The node's parameters: names, defaults, ranges, and which can be set on the running node."""

from collections.abc import Collection, Iterable, Iterator

from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor

from mirror_explainer import settings
from mirror_explainer.errors import did_you_mean
from mirror_explainer.input_limits import InputLimits
from mirror_explainer.selection.strategies import STRATEGIES


def _text(description: str, read_only: bool = False) -> ParameterDescriptor:
    return ParameterDescriptor(description=description, read_only=read_only)


def _count(
    description: str, least: int, most: int, read_only: bool = False
) -> ParameterDescriptor:
    between = [IntegerRange(from_value=least, to_value=most)]
    return ParameterDescriptor(description=description, integer_range=between, read_only=read_only)


def _number(
    description: str, least: float, most: float, read_only: bool = False
) -> ParameterDescriptor:
    between = [FloatingPointRange(from_value=float(least), to_value=float(most))]
    return ParameterDescriptor(
        description=description, floating_point_range=between, read_only=read_only
    )


PARAMETERS = (
    ('domain_file', '', _text('PDDL domain; a message on "domain" replaces it', True)),
    ('user_model_file', '', _text('YAML: what the listener may believe')),
    ('n', settings.SENTENCES, _count('sentences of an answer, if the plan has them', 1, 1000)),
    (
        'threshold',
        0.0,
        _number('say only as many as bring the cross-entropy below this (nats)', 0, 1e3),
    ),
    ('strategy', 'informative', _text(f'one of {", ".join(STRATEGIES)}')),
    ('remember', False, _text('whether each answer conditions the next')),
    ('planner', settings.PLANNER, _text("a unified-planning engine's name", True)),
    (
        'plans_per_belief',
        settings.PLANS_PER_BELIEF,
        _count('optimal plans of a belief, at most', 1, 10_000),
    ),
    (
        'max_beliefs',
        settings.MAX_BELIEFS,
        _count('most probable beliefs to plan for', 1, 1_000_000),
    ),
    (
        'planning_timeout',
        settings.PLANNING_TIMEOUT,
        _number('s, for each belief', 1e-3, 1e6, True),
    ),
    ('deadline', settings.DEADLINE, _number('s, for the planning of a whole update', 1e-3, 1e6)),
    (
        'selection_budget',
        settings.SELECTION_BUDGET,
        _number('s, to prove the best choice', 1e-3, 1.0),
    ),
    ('answer_timeout', 5.0, _number('s, that a call waits for an update', 0, 1e6)),
    ('workers', settings.WORKERS, _count('planning processes at a time', 1, 256, True)),
    (
        'planner_memory_limit',
        settings.MEMORY_LIMIT,
        _count('MiB, for each search', 80, 1 << 24, True),
    ),
    (
        'max_message_bytes',
        InputLimits.max_message_bytes,
        _count('bytes of a message, or of a file', 1000, 1 << 30),
    ),
    (
        'max_objects',
        InputLimits.max_objects,
        _count('objects of a problem, with constants', 1, 1 << 20),
    ),
    (
        'max_words',
        InputLimits.max_words,
        _count('words of a domain or problem, initial facts left out', 10, 1 << 30),
    ),
    ('max_plan_length', InputLimits.max_plan_length, _count('actions of a plan', 1, 1 << 20)),
    (
        'max_instances',
        InputLimits.max_instances,
        _count('conditions and effects to look at to check a plan', 1, 1 << 30),
    ),
    ('max_goals', InputLimits.max_goals, _count('goals of a user model', 1, 1 << 20)),
    (
        'max_uncertain_facts',
        InputLimits.max_uncertain_facts,
        _count('uncertain facts of a user model, those of one_of included', 0, 10_000),
    ),
    ('downward_binary', '', _text("Fast Downward's search, if self-built", True)),
)


def unknown_parameters(given: Iterable[str], declared: Collection[str]) -> Iterator[str]:
    """Yield a sentence for each parameter that was given to the node, which would ignore it."""
    for name in sorted(set(given).difference(declared)):
        meant = did_you_mean(name, declared)
        yield f'the parameter "{name}" is not one of this node\'s, and is ignored{meant}'
