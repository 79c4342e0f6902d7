"""The types (either a b) as types that PDDL's readers know.

For variables, a common supertype: a type made up for a and b has their objects
and no others if it stands between the two and the one type that is above both.
For what predicates take, the type object.
"""

import re
from collections.abc import Collection, Iterator, Mapping
from dataclasses import replace

from mirror_explainer.pddl.text.sections import (
    blanked,
    line_at,
    section,
    sections,
    without_comments,
)
from mirror_explainer.pddl.text.texts import Texts

EITHER = re.compile(r'\(\s*either\b([^()]*)\)', re.IGNORECASE)

# What is listed there is no variable that ranges over the objects of its type.
_WITHOUT_VARIABLES = (':predicates', ':types', ':constants', ':objects')


def with_common_supertypes(texts: Texts) -> Texts:
    """Return the texts with a supertype for every (either …) that a variable has.

    Those stay for which a type would need two types right above it.
    """
    domain, problem = texts.domain, texts.problem
    parents = _parents(domain)
    used = [_alternatives(found[1], parents) for t in (domain, problem) for found in _eithers(t)]
    names = {types: name for types in used if (name := _name(types, used, parents))}
    made_up = {types: name for types, name in names.items() if len(types) > 1}
    words = set(re.findall(r'[^\s()]+', f'{domain} {problem}'.lower()))
    if not names or words & {*made_up.values()}:
        return texts
    domain, problem = (_named(text, names, parents) for text in (domain, problem))
    return replace(texts, domain=_with_types(domain, parents, made_up), problem=problem)


def with_plain_predicates(domain: str) -> str:
    """Return the domain with the type object for every (either …) in :predicates.

    Predicates then take more than declared; what actions can do stays the same,
    since the types of their own parameters decide on that.
    """
    alternatives = [*_in_predicates(domain)]
    for found in reversed(alternatives):
        domain = blanked(domain, found.start(), found.end(), 'object')
    types = section(domain, ':types') if alternatives else None
    # A type that is declared as a supertype only is, for unified-planning, no object.
    roots = ' '.join(sorted(_roots(_declared(domain)))) if types else ''
    if types and roots:
        domain = f'{domain[: types.end - 1]} {roots} - object{domain[types.end - 1 :]}'
    return domain


def types_in_predicates(domain: str) -> Iterator[tuple[str, int]]:
    """Yield each type that an (either …) in :predicates names, in lower case, with its line."""
    for found in _in_predicates(domain):
        for name in found[1].lower().split():
            yield name, line_at(domain, found.start())


def _in_predicates(domain: str) -> Iterator[re.Match[str]]:
    predicates = section(domain, ':predicates')
    if predicates:
        yield from EITHER.finditer(without_comments(domain), predicates.start, predicates.end)


def _eithers(text: str) -> Iterator[re.Match[str]]:
    """Yield every (either …) among the variables of conditions, effects and parameters."""
    plain = without_comments(text)
    for part in sections(text):
        if part.keyword not in _WITHOUT_VARIABLES:
            yield from EITHER.finditer(plain, part.start, part.end)


def _parents(domain: str) -> dict[str, str]:
    """Return each type's supertype; types that are declared as supertypes only have object."""
    parents = _declared(domain)
    return parents | dict.fromkeys(_roots(parents), 'object')


def _declared(domain: str) -> dict[str, str]:
    """Return the supertype of each type that is declared for itself."""
    types = section(domain, ':types')
    if not types:
        return {}
    text = without_comments(domain)[types.start : types.end].lower()
    if text.count('(') > 1:
        return {}  # an (either …) among the types themselves is not read
    words = text.strip('()').split()[1:]
    parents: dict[str, str] = {}
    names: list[str] = []
    rest = iter(words)
    for word in rest:
        if word == '-':
            parents |= dict.fromkeys(names, next(rest, 'object'))
            names = []
        else:
            names.append(word)
    return parents | dict.fromkeys(names, 'object')


def _roots(parents: Mapping[str, str]) -> set[str]:
    """Return the types that are declared as supertypes only."""
    return {parent for parent in parents.values() if parent not in parents} - {'object'}


def _alternatives(words: str, parents: Mapping[str, str]) -> frozenset[str]:
    """Return the types named, without those that are subtypes of others among them."""
    named = frozenset(words.lower().split())
    return frozenset(name for name in named if not _above(name, parents) & named)


def _above(name: str, parents: Mapping[str, str]) -> set[str]:
    above: set[str] = set()
    while (name := parents.get(name, '')) and name not in above:
        above.add(name)
    return above


def _name(
    types: frozenset[str], used: Collection[frozenset[str]], parents: Mapping[str, str]
) -> str:
    """Return the name of the one type that has the objects of all of these, "" if none can be."""
    if len(types) == 1:
        return next(iter(types))
    overlapping = any(other & types for other in used if len(other) > 1 and other != types)
    siblings = len({parents.get(name, name) for name in types}) == 1
    return '-or-'.join(sorted(types)) if siblings and not overlapping else ''


def _named(text: str, names: Mapping[frozenset[str], str], parents: Mapping[str, str]) -> str:
    """Return the text with the names of types for what they stand for."""
    for found in reversed([*_eithers(text)]):
        name = names.get(_alternatives(found[1], parents))
        if name:
            text = blanked(text, found.start(), found.end(), name)
    return text


def _with_types(
    domain: str, parents: Mapping[str, str], made_up: Mapping[frozenset[str], str]
) -> str:
    """Return the domain with the types made up, between their alternatives and what is above."""
    types = section(domain, ':types')
    if not made_up or not types:
        return domain
    lifted = {kind: name for alternatives, name in made_up.items() for kind in alternatives}
    tops = {name: parents[next(iter(kinds))] for kinds, name in made_up.items()}
    listed = ' '.join(
        f'{name} - {above}' for name, above in ({**parents, **lifted, **tops}).items()
    )
    lines = '\n' * domain.count('\n', types.start, types.end)
    return f'{domain[: types.start]}(:types {listed}{lines}){domain[types.end :]}'
