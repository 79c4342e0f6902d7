"""Texts in the study's templates: of the participant's language, and a researcher's Markdown."""

from collections.abc import Mapping
from typing import Any

from django import template
from django.utils.safestring import SafeString, mark_safe
from markdown_it import MarkdownIt

# No HTML of its own, and no addresses but of the web and mail (its rule): it can do no harm.
_MARKDOWN = MarkdownIt('commonmark', {'html': False}).disable('image')


def t(context: Mapping[str, Any], key: str, **values: object) -> str:
    """Return a text of the participant's language; templates escape it."""
    text: str = context['words'].text(key, **values)
    return text


def paragraphs(context: Mapping[str, Any], key: str, **values: object) -> SafeString:
    """Return a text of the catalogue that is Markdown, as HTML."""
    return markdown(context['words'].text(key, **values))


def markdown(text: str) -> SafeString:
    """Return Markdown as HTML."""
    return mark_safe(_MARKDOWN.render(text))  # the renderer escapes


register = template.Library()
register.simple_tag(takes_context=True)(t)
register.simple_tag(takes_context=True)(paragraphs)
register.filter('markdown', markdown)
