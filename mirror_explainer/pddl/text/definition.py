"""The sections of a PDDL definition: in any order, empty ones, several of a kind.

Whoever joins model files, as PlanSys2 does, has sections twice and declares a thing in
several places: what is equal is one, what is unequal is a fault of the text.
"""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

from mirror_explainer.errors import InputError, did_you_mean
from mirror_explainer.input_limits import InputLimits
from mirror_explainer.pddl.text.tree import (
    Branch,
    Tree,
    Word,
    as_text,
    layout,
    parse,
    require_name,
    require_usual_numbers,
    word,
)
from mirror_explainer.text_files import plain_text

# In the order in which PDDL's grammar, and Fast Downward, want them.
_JOINED = {
    'domain': (':requirements', ':types', ':constants', ':predicates', ':functions'),
    'problem': (':requirements', ':objects', ':init'),
}
_SINGLE = {'domain': (), 'problem': (':domain', ':goal', ':metric', ':length')}
_EACH = {
    'domain': (
        ':constraints',
        ':derived',
        ':action',
        ':durative-action',
        ':process',
        ':event',
        ':task',
        ':method',
    ),
    'problem': (':constraints', ':htn'),
}
_ORDER = {
    'domain': (*_JOINED['domain'], *_EACH['domain']),
    'problem': (
        ':domain',
        ':requirements',
        ':objects',
        ':htn',
        ':init',
        ':goal',
        ':constraints',
        ':metric',
        ':length',
    ),
}
_OLD_FORM = {
    ':axiom': 'axioms; write (:derived (predicate ?x - type) condition)',
    ':safety': 'safety constraints; leave it out',
    ':scope': 'a language before PDDL; leave it out',
}
_DEFINE = re.compile(r'\(\s*define\s*\(\s*(domain|problem)(?![^\s()])', re.IGNORECASE)
_HEAD = re.compile(r'(?:\s|;[^\n]*(?:\n|$))*' + _DEFINE.pattern, re.IGNORECASE)


@dataclass(frozen=True)
class Definition:
    """A domain or problem, `kind`, by its sections; those that are joined stand there once.

    `source` is the file or topic that it came from. Of `sections`, each branch
    begins with its keyword.
    """

    kind: str
    name: str
    source: str
    sections: Mapping[str, tuple[Branch, ...]] = field(repr=False)
    line: int = 1

    def all(self, *keywords: str) -> tuple[Branch, ...]:
        """Return the sections of these kinds, by kinds."""
        return tuple(part for keyword in keywords for part in self.sections.get(keyword, ()))

    def section(self, keyword: str) -> Branch | None:
        """Return the one section of a kind, None if there is none."""
        return next(iter(self.sections.get(keyword, ())), None)

    def contents(self, keyword: str) -> list[Tree]:
        """Return what stands in the one section of a kind, nothing if there is none."""
        section = self.section(keyword)
        return [] if section is None else section[1:]

    def having(self, keyword: str, *branches: Branch) -> 'Definition':
        """Return the definition with these sections of a kind instead."""
        return replace(self, sections={**self.sections, keyword: branches})

    def without(self, *keywords: str) -> 'Definition':
        """Return the definition without the sections of these kinds."""
        kept = {k: branches for k, branches in self.sections.items() if k not in keywords}
        return replace(self, sections=kept)

    def with_contents(self, keyword: str, contents: Sequence[Tree]) -> 'Definition':
        """Return the definition with other contents of the one section of a kind."""
        section = self.section(keyword)
        place = Branch((), self.line) if section is None else section
        return self.having(keyword, place.like([word(keyword, place), *contents]))

    def tree(self) -> Branch:
        """Return the definition with its sections in the usual order."""
        place = Branch((), self.line)
        head = place.like([word(self.kind, place), word(self.name, place)])
        return place.like(
            [word('define', place), head, *self.all(*_ORDER[self.kind])],
        )

    def text(self) -> str:
        """Return the definition's text."""
        return layout(self.tree())


def read_definition(
    text: str,
    kind: str,
    source: str,
    limits: InputLimits | None = None,
    stop: Callable[[], None] | None = None,
) -> Definition:
    """Read the sections of a PDDL domain or problem.

    `stop` is called now and then, and may raise. Raises InputError for a text that is
    no such definition, has sections that PDDL does not, or unequal ones for the same.
    """
    text = require_head(text, kind, source, limits)
    trees = parse(text, source, stop)
    definition = trees[0]
    assert isinstance(definition, Branch)  # it has a head
    if len(trees) > 1:
        after = trees[1]
        raise InputError(
            source,
            f'"{as_text(after)[:60]}" stands after the end of the {kind}: is there a closing '
            'parenthesis too many before it?',
            after.line,
        )
    require_usual_numbers(definition, source)
    head, *parts = definition[1:]
    assert isinstance(head, Branch)
    if len(head) != 2 or not isinstance(head[1], Word):
        raise InputError(source, f'(define ({kind} …) takes one name', head.line)
    require_name(head[1], source)
    sections: dict[str, list[Branch]] = {}
    for part in parts:
        sections.setdefault(_keyword(part, kind, source), []).append(part)  # type: ignore[arg-type]
    whole = {
        keyword: _joined(keyword, branches, kind, source) for keyword, branches in sections.items()
    }
    return Definition(kind, head[1], source, whole, definition.line)


def require_head(text: str, kind: str, source: str, limits: InputLimits | None = None) -> str:
    """Return a text in its plain form. Raises InputError unless it begins as it should."""
    if limits:
        limits.require_bytes(text, source)
    text = plain_text(text)
    if not text.strip():
        raise InputError(
            source,
            f'the text is empty; a PDDL {kind} is expected',
            cure='Give the whole text; only a plan may be empty.',
        )
    found = _HEAD.match(text)
    if found is None:
        cure = f'Give the text of the {kind} here, not the name of a file or another text.'
        if later := _DEFINE.search(text):
            line = text.count('\n', 0, later.start()) + 1
            cure = f'Leave out what stands before the (define …) on line {line}.'
        reason = f'this is no PDDL {kind}: it must begin with (define ({kind} …)'
        raise InputError(source, reason, 1, cure=cure)
    if found[1].lower() != kind:
        raise InputError(
            source,
            f'this is a PDDL {found[1].lower()}, but a {kind} is expected here: '
            'are the two mixed up?',
            text.count('\n', 0, found.end()) + 1,
            cure='Check which is which: the files, or the names and remappings of the topics.',
        )
    return text


def _keyword(part: Tree, kind: str, source: str) -> str:
    """Return the keyword of a section. Raises InputError for what is none."""
    keyword = part.head if isinstance(part, Branch) else str(part)
    if isinstance(part, Branch) and keyword in _ORDER[kind]:
        return keyword
    if keyword in _OLD_FORM:
        reason = f'({keyword} …) is an old form of {_OLD_FORM[keyword]}'
        raise InputError(source, reason, part.line)
    other = 'problem' if kind == 'domain' else 'domain'
    if keyword in _ORDER[other]:
        reason = f'"({keyword}" belongs into the {other}, but stands in the {kind}'
        raise InputError(source, f'{reason}: is a parenthesis missing?', part.line)
    hint = did_you_mean(keyword, _ORDER[kind])
    shown = as_text(part)[:40] if isinstance(part, Branch) else keyword
    raise InputError(source, f'"{shown}" is no section of a {kind}{hint}', part.line)


def _joined(keyword: str, branches: list[Branch], kind: str, source: str) -> tuple[Branch, ...]:
    """Return what remains of the sections of a kind: what is equal is there once."""
    if keyword in _JOINED[kind]:
        close = _closed if keyword in (':types', ':constants', ':objects') else list
        contents = [part for branch in branches for part in close(branch[1:])]
        whole = branches[0].like([branches[0][0], *contents])
        return (whole if len(branches) > 1 else branches[0],)
    distinct = [part for i, part in enumerate(branches) if part not in branches[:i]]
    if keyword in _SINGLE[kind] and len(distinct) > 1:
        raise unequal(f'({keyword} …)', distinct[0], distinct[1], source)
    return tuple(distinct)


def _closed(typed: list[Tree]) -> list[Tree]:
    """Return a typed list that another can follow."""
    if not typed or (len(typed) > 1 and typed[-2] == '-'):
        return typed
    return [*typed, word('-', typed[-1]), word('object', typed[-1])]


def unequal(what: str, one: Tree, other: Tree, source: str) -> InputError:
    """Return the error that a thing is declared in two ways."""
    lines = f'on line {one.line} and on line {other.line}'
    if one.line == other.line:
        lines = f'both on this line, at characters {one.column} and {other.column}'
    return InputError(
        source,
        f'{what} is there twice, and not the same: {lines}',
        other.line,
        cure='Keep one of them.',
    )
