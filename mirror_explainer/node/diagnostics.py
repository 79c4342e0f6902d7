"""What an operator sees of the node: a level, a sentence, and values by name.

Without ROS; the node publishes it on /diagnostics. docs/operations.md has a table of
the values.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import IntEnum
from typing import NamedTuple

from mirror_explainer.errors import some_of
from mirror_explainer.listener.explanation import Explanation
from mirror_explainer.listener.preparation import Preparation
from mirror_explainer.node.history import History
from mirror_explainer.node.inputs import Inputs
from mirror_explainer.node.moment import Moment
from mirror_explainer.node.readiness import Phase, Readiness
from mirror_explainer.node.surroundings import Surroundings
from mirror_explainer.pddl.progress import StepStatus
from mirror_explainer.planning import Status

# What is latched has arrived by the time that the node has waited for so long.
_ARRIVAL_SECONDS = 3.0
# Characters that a value has at most: they are read in a table.
_LONGEST = 500


class Level(IntEnum):
    """How bad it is, numbered as in diagnostic_msgs/DiagnosticStatus."""

    OK = 0
    WARN = 1
    ERROR = 2


class Fault(NamedTuple):
    """What is wrong, or waited for, in one sentence, and what to do about it, '' for nothing."""

    message: str
    cure: str = ''


@dataclass(frozen=True)
class Diagnosis:
    """A level, one sentence that says why, and values by key."""

    level: Level
    message: str
    values: dict[str, str]


def diagnose(
    readiness: Readiness,
    history: History,
    inputs: Inputs,
    surroundings: Surroundings,
    answer: Explanation | None = None,
) -> Diagnosis:
    """Say how things stand now, for a person who has to mend them.

    `inputs` are those heard last, `answer` is the one given last. While an update
    is worked on, things are as bad as the last update left them.
    """
    now = Moment()
    working = readiness.phase is Phase.PLANNING
    outcome = history.outcome if working else readiness
    level, (message, cure) = _verdict(outcome, surroundings, now)
    if working and level is Level.ERROR:
        message = f'{readiness.message}; the last update failed: {message}'
    elif working:
        message, cure = readiness.message, ''
    others = surroundings.others
    for fault in filter(None, (crowded(others.publishers), _unreliable(others.unreliable))):
        level = max(level, Level.WARN)
        message, cure = f'{message}; {fault.message}', f'{fault.cure} {cure}'.strip()
    since = history.since if readiness.phase is history.outcome.phase else readiness.since
    values = {
        'state': readiness.phase.value,
        'state since': str(since),
        'seconds in this state': f'{now.seconds_since(since):.0f}',
        'what to do': cure or 'nothing',
        **_last_error(history, now),
        'inputs': readiness.inputs.digest,
        **_ages(inputs, surroundings, now),
        'other servers of verbalize_plan': str(others.rivals),
        **{f'publishers of {n}': str(len(by)) for n, by in others.publishers.items()},
        **_work(readiness, history, answer),
        'MiB of node': f'{surroundings.node_memory / 2**20:.0f}',
        'MiB of planners': f'{surroundings.planner_memory / 2**20:.0f}',
        'version': surroundings.version,
    }
    return Diagnosis(level, _short(message), {key: _short(text) for key, text in values.items()})


def _verdict(readiness: Readiness, surroundings: Surroundings, now: Moment) -> tuple[Level, Fault]:
    """Return how bad it is how an update ended, and why."""
    if readiness.phase is Phase.ERROR:
        return Level.ERROR, Fault(readiness.message, readiness.cure)
    if readiness.preparation is None:
        return Level.WARN, _what_is_waited_for(readiness, surroundings, now)
    fault = _what_is_lacking(readiness, surroundings)
    if fault is None:
        return Level.OK, Fault(readiness.message)
    return Level.WARN, Fault(f'{readiness.message}, but {fault.message}', fault.cure)


def _what_is_lacking(readiness: Readiness, surroundings: Surroundings) -> Fault | None:
    """Return what makes answers worth less than they might be, None if nothing does."""
    if surroundings.others.rivals:
        return rivalry(surroundings.others.rivals)
    if silent := _silent(readiness.inputs, surroundings):
        return Fault(
            f'nobody publishes {" and ".join(silent)} any more',
            'See whether what published it still runs: the answers are about what it told last.',
        )
    if not readiness.inputs.user_model_file:
        return Fault(
            'without a user model: answers tell the parts of the goal',
            "Name one as user_model_file; draft_user_model drafts it from the robot's texts.",
        )
    preparation = readiness.preparation
    if preparation is None or preparation.model.complete:
        return None
    covered = preparation.model.covered
    why = [f'{covered:.0%} of P(B) within max_beliefs'] if covered < 1.0 - 1e-9 else []
    return Fault(
        f'not for all beliefs: {"; ".join([*why, *preparation.warnings])}',
        _cure_for_unplanned(preparation),
    )


def _cure_for_unplanned(preparation: Preparation) -> str:
    """Return what makes planning give more: not time, where no plan is no proof."""
    unknown = {r.reason for r in preparation.results.values() if r.status is Status.UNKNOWN}
    if preparation.unsure and unknown == {preparation.unsure}:
        return (
            'Take out of the user model what the robot cannot do from here, or leave it: time '
            'does not help.'
        )
    raised = 'Raise deadline, planning_timeout or max_beliefs'
    return f'{raised}, or let the user model have fewer beliefs.'


def _what_is_waited_for(readiness: Readiness, surroundings: Surroundings, now: Moment) -> Fault:
    """Return what there is no explanation without."""
    others, inputs = surroundings.others, readiness.inputs
    if others.elsewhere and not (inputs.problem or inputs.plan):
        there = some_of([f'{place}plan' for place in others.elsewhere])
        cure = f'There is {there}: is this node to be in that namespace (-r __ns:=…)? '
        return Fault(readiness.message, cure + readiness.cure)
    unheard = [
        name
        for name, heard in (('problem', inputs.problem), ('plan', inputs.plan))
        if heard is None
        and {*others.publishers.get(name, ())}.difference(others.unreliable.get(name, ()))
    ]
    if not unheard or now.seconds_since(readiness.since) < _ARRIVAL_SECONDS:
        return Fault(readiness.message, readiness.cure)
    return Fault(
        f'{readiness.message}; somebody publishes {" and ".join(unheard)}, but nothing was heard',
        'Nothing, if the robot has told none yet. Else let it be published again, or latched '
        '(transient local). If that does not help, the middleware loses it: start this node '
        'again.',
    )


def _silent(inputs: Inputs, surroundings: Surroundings) -> list[str]:
    """Return the topics on which the robot told what it does, and nobody publishes now."""
    told = {'problem': inputs.problem, 'plan': inputs.plan, 'progress': inputs.progress}
    return [n for n, text in told.items() if text and surroundings.others.publishers.get(n) == ()]


def crowded(publishers: Mapping[str, Sequence[str]]) -> Fault | None:
    """Return what is wrong where two nodes tell the same, None if none do.

    `publishers` are the names of the nodes that publish each input.
    """
    topics, nodes = _where_so_many_publish(2, publishers)
    if not topics:
        return None
    return Fault(
        f'more than one node publishes {topics} (named {nodes}), and what they tell is mixed',
        'Of two robots give each a namespace or ROS_DOMAIN_ID of its own; of one robot let one '
        'node publish a topic. One that was killed is forgotten after 20 s.',
    )


def _unreliable(publishers: Mapping[str, Sequence[str]]) -> Fault | None:
    """Return what is wrong where nodes publish an input as best effort, None if none do."""
    topics, nodes = _where_so_many_publish(1, publishers)
    if not topics:
        return None
    return Fault(
        f'{nodes} publishes {topics} as best effort, which is not heard here',
        'Publish it reliably (QoS reliability: reliable).',
    )


def _where_so_many_publish(least: int, publishers: Mapping[str, Sequence[str]]) -> tuple[str, str]:
    """Return the topics that so many nodes publish whose names are known, and these, in words."""
    known = {name: [*filter(None, nodes)] for name, nodes in publishers.items()}
    topics = [name for name, nodes in known.items() if len(nodes) >= least]
    nodes = sorted({node for name in topics for node in known[name]})
    return ' and '.join(topics), some_of(nodes)


def rivalry(rivals: int) -> Fault:
    """Return what is wrong with other servers of verbalize_plan in the namespace."""
    return Fault(
        f'{rivals} more {"node serves" if rivals == 1 else "nodes serve"} verbalize_plan here: '
        'a call may be answered by any of them',
        'End the other explainer, or give each a namespace or ROS_DOMAIN_ID of its own. One '
        'that was killed is forgotten after 20 s.',
    )


def _last_error(history: History, now: Moment) -> dict[str, str]:
    error = history.last_error
    if error is None:
        return {'last error': 'none'}
    return {
        'last error': error.message,
        'last error still so': 'yes' if history.outcome.phase is Phase.ERROR else 'no',
        'last error time': str(error.since),
        'seconds since last error': f'{now.seconds_since(error.since):.0f}',
        'last error cure': error.cure,
    }


def _ages(inputs: Inputs, surroundings: Surroundings, now: Moment) -> dict[str, str]:
    """Return where each input came from, and how long ago."""
    values = {}
    for name, text, file in (
        ('domain', inputs.domain, inputs.domain_file),
        ('problem', inputs.problem, ''),
        ('plan', inputs.plan, ''),
        ('progress', inputs.progress, ''),
        ('user model', None, inputs.user_model_file),
    ):
        source = text.source if text else file
        age = now.seconds_since(text.heard) if text else surroundings.file_ages.get(file)
        values[f'{name} from'] = source or 'none'
        if age is not None:
            values[f'seconds since {name}'] = f'{age:.0f}'
    return values


def _work(readiness: Readiness, history: History, answer: Explanation | None) -> dict[str, str]:
    """Return what was done, how long it took, and what is covered by the plans found."""
    values = {
        'updates': str(history.updates),
        'calls answered': str(history.calls_answered),
        'calls failed': str(history.calls_failed),
    }
    if history.last_call is not None:
        values['seconds of last call'] = f'{history.last_call:.3f}'
    if answer is not None:
        values['seconds selecting'] = f'{answer.seconds_selecting:.3f}'
    preparation = readiness.preparation
    if preparation is not None and preparation.situation is not None:
        situation, statuses = preparation.situation, preparation.statuses
        told = [s for s in reversed(StepStatus) if s in statuses or s is not StepStatus.SKIPPED]
        counts = [f'{statuses.count(status)} {status}' for status in told]
        values |= {
            'episode': f'{situation.number}, {situation.reason}',
            'progress': ', '.join(counts),
        }
    if preparation is not None:
        values |= {
            'seconds reading': f'{preparation.seconds.read:.3f}',
            'planned': f'{preparation.planned:.6f}',
            'covered mass': f'{preparation.prior.covered_mass:.6f}',
            'warnings': '; '.join(preparation.warnings) or 'none',
        }
    if preparation is not None and readiness.phase is Phase.READY:
        model = preparation.model
        values |= {
            'seconds planning': f'{preparation.seconds.planning:.3f}',
            'planner calls': str(preparation.planner_calls),
            'hypotheses': str(len(model.hypotheses)),
            'unsolvable mass': f'{model.unsolvable:.6f}',
            'unknown mass': f'{1.0 - model.planned:.6f}',
        }
    return values


def _short(text: str) -> str:
    """Return the text on one line, cut where it is too long for a table."""
    line = ' '.join(text.split())
    return line if len(line) <= _LONGEST else f'{line[:_LONGEST]} …'
