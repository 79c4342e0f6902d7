"""Filters of the operator's templates: probabilities, and what goals are called."""

from django import template

from mirror_explainer.web.operator.heard import Answer
from mirror_explainer.web.operator.shown import percent


def width(probability: float) -> str:
    """Return a probability as a number from 0 to 100, with a point in any language."""
    return f'{100 * probability:.1f}'


def called(goal: str, answer: Answer) -> str:
    """Return what a goal, or a part of one, is called in an answer."""
    return answer.called(goal)


register = template.Library()
register.filter('percent', percent)
register.filter('width', width)
register.filter('called', called)
