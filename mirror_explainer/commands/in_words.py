"""What an answer does to its listener, in a few plain sentences."""

from functools import partial
from textwrap import shorten

from mirror_explainer.listener.explanation import Explanation

# A candidate that is less probable than this need not be told of.
_WORTH_TELLING = 0.05
_MOST_NAMES = 3
_LONGEST_NAME = 100  # characters
_MOST_UNSAID = 5


def in_words(explanation: Explanation) -> str:
    """Say what the listener now takes the goal to be, how sure they are, and what is left open."""
    return ' '.join([_taken_for(explanation), *_left_open(explanation), *_amiss(explanation)])


def _taken_for(explanation: Explanation) -> str:
    named = partial(_named, explanation)
    true = named(explanation.true_goal)
    before, after = explanation.understanding_before, explanation.understanding
    likeliest = max(explanation.goals[:-1], key=lambda goal: goal['posterior'])
    others = (goal for goal in explanation.goals[:-1] if goal['name'] != explanation.true_goal)
    alike = [named(goal['name']) for goal in others if goal['posterior'] > 0.99 * after]
    if alike and likeliest['posterior'] <= 1.01 * after:
        also = alike[0] if len(alike) == 1 else f'{len(alike)} others'
        return (
            f'The listener cannot tell yet: {true} and {also} are as likely to them, '
            f'{after:.0%} each ({before:.0%} before).'
        )
    if likeliest['posterior'] <= after + 1e-9:
        return (
            f"The listener now takes the robot's goal to be {true} and is {after:.0%} sure "
            f'({before:.0%} before).'
        )
    return (
        f"The listener would now take the robot's goal to be {named(likeliest['name'])} "
        f'({likeliest["posterior"]:.0%}). The true one, {true}, is {after:.0%} likely to them '
        f'({before:.0%} before).'
    )


def _named(explanation: Explanation, goal: str) -> str:
    """Return what a goal is called, shortened, in quotation marks."""
    called = explanation.in_words.get(goal, goal)
    return f'"{shorten(called, _LONGEST_NAME, placeholder=" …")}"'


def _left_open(explanation: Explanation) -> list[str]:
    """Say which parts were not mentioned, and which larger goals fit what was said as well."""
    told = []
    if explanation.unmentioned:
        told.append(f'Left unsaid: {" ".join(_unsaid(explanation))}')
    larger = [
        goal
        for goal, is_larger in zip(explanation.goals, explanation.model.larger, strict=False)
        if is_larger and goal['posterior'] >= _WORTH_TELLING
    ]
    larger.sort(key=lambda goal: -goal['posterior'])
    if larger:
        most = larger[:_MOST_NAMES]
        named = ', '.join(f'{_named(explanation, g["name"])} ({g["posterior"]:.0%})' for g in most)
        told.append(f'To the listener it may do more: {named}.')
    partial = explanation.goals[-1]['posterior']
    if partial >= _WORTH_TELLING:
        told.append(f'Perhaps it does only a part of that, or of another goal ({partial:.0%}).')
    return told


def _unsaid(explanation: Explanation) -> list[str]:
    """Return the sentences of the steps, in their tense, for what was not mentioned, if few."""
    unsaid = [explanation.plan[place]['sentence'] for place in explanation.unsaid_ends]
    if len(unsaid) <= _MOST_UNSAID:
        return unsaid
    return [*unsaid[: _MOST_UNSAID - 1], f'And {len(unsaid) - _MOST_UNSAID + 1} more.']


def _amiss(explanation: Explanation) -> list[str]:
    told = []
    if not explanation.optimal and explanation.strategy == 'informative':
        told.append('There was no time to prove that nothing tells more.')
    if not explanation.complete:
        told.append(
            f'Planning was done for {explanation.planned:.0%} of what they may believe; for the '
            'rest they are taken not to foresee how the robot goes about it.'
            if explanation.planned < 1.0 - 1e-9
            else 'Not all plans that were asked for were found in time.'
        )
    return told
