"""What an operator sees of the node: a level, a sentence, and values by name.

Without ROS; the node publishes it on /diagnostics.
"""

import time
from dataclasses import dataclass
from enum import IntEnum

from mirror_explainer.updates import Phase, State


class Level(IntEnum):
    """How bad it is, numbered as in diagnostic_msgs/DiagnosticStatus."""

    OK = 0
    WARN = 1
    ERROR = 2


@dataclass(frozen=True)
class Diagnosis:
    """A level, one sentence that says why, and values by key (see docs/operations.md)."""

    level: Level
    message: str
    values: dict[str, str]


def diagnose(state: State, last_error: str = '') -> Diagnosis:
    """Say how things stand."""
    levels = {Phase.WAITING: Level.WARN, Phase.ERROR: Level.ERROR}
    level, message = levels.get(state.phase, Level.OK), state.message
    values = {
        'state': state.phase.value,
        'seconds in this state': f'{time.monotonic() - state.since:.0f}',
        'inputs': state.inputs.digest,
        'last error': last_error or 'none',
    }
    if state.preparation is not None:
        model, seconds = state.preparation.model, state.preparation.seconds
        warnings = '; '.join(model.warnings)
        values |= {
            'seconds reading': f'{seconds.read:.3f}',
            'seconds planning': f'{seconds.planning:.3f}',
            'planner calls': str(state.preparation.planner_calls),
            'hypotheses': str(len(model.hypotheses)),
            'covered mass': f'{model.covered_mass:.6f}',
            'unsolvable mass': f'{model.unsolvable_mass:.6f}',
            'unknown mass': f'{model.unknown_mass:.6f}',
            'stand-in plans': str(model.stand_in_plans),
            'warnings': warnings or 'none',
        }
        if not model.complete:
            level, message = Level.WARN, f'{message}, but not for all beliefs: {warnings}'
    return Diagnosis(level, message, values)
