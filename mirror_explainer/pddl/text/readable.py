"""What unified-planning's reader does not take, refused by name and line."""

from mirror_explainer.errors import InputError
from mirror_explainer.pddl.text.either_types import EITHER, with_plain_predicates
from mirror_explainer.pddl.text.sections import line_at, sections, without_comments
from mirror_explainer.pddl.text.texts import Texts

# What may stand in a domain, but not for unified-planning's reader or its compiler.
_REFUSED = {
    ':axiom': 'axioms in an old form (:axiom; write :derived)',
    ':process': 'processes (:process)',
    ':event': 'events (:event)',
    ':task': 'tasks to be broken down (:task)',
    ':method': 'methods (:method)',
}


def require_readable(texts: Texts) -> None:
    """Raise InputError for what unified-planning does not read, with its name and line."""
    for part in sections(texts.domain):
        if part.keyword in _REFUSED:
            raise InputError(
                texts.domain_source,
                f'it has {_REFUSED[part.keyword]}, which unified-planning cannot read',
                line_at(texts.domain, part.start),
            )
    for text, source in (
        (with_plain_predicates(texts.domain), texts.domain_source),
        (texts.problem, texts.problem_source),
    ):
        found = EITHER.search(without_comments(text))
        if found:
            raise InputError(
                source,
                f'no one type stands for "{found[0]}" here; declare a common supertype instead',
                line_at(text, found.start()),
            )
