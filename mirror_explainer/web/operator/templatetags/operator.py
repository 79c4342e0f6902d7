"""Probabilities in the operator's templates: as words, and as the width of a bar."""

from django import template

from mirror_explainer.web.operator.shown import percent


def width(probability: float) -> str:
    """Return a probability as a number from 0 to 100, with a point in any language."""
    return f'{100 * probability:.1f}'


register = template.Library()
register.filter('percent', percent)
register.filter('width', width)
