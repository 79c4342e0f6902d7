"""A task's domain and problem as the texts that planners take."""

from mirror_explainer.pddl.text.actions import Parts
from mirror_explainer.pddl.text.declarations import Declarations
from mirror_explainer.pddl.text.definition import Definition
from mirror_explainer.pddl.text.plain_types import with_actions
from mirror_explainer.pddl.text.tree import Branch, Tree, Word, made, word

_NUMBER = 'number'


def texts_for_planners(parts: Parts, declared: Declarations) -> tuple[str, str]:
    """Return a task's domain and problem, which say what they require."""
    domain, problem = with_actions(_as_required(parts.domain), parts.actions), parts.problem
    if _NUMBER in declared.types:  # Fast Downward wants that name for itself
        domain, problem = _renamed(domain, declared), _renamed(problem, declared)
    return domain.text(), problem.without(':requirements').text()


def _as_required(domain: Definition) -> Definition:
    """Return the domain with the requirements that what is left of it may have."""
    place = domain.section(':requirements') or Branch((), domain.line)
    return domain.having(
        ':requirements', made('(:requirements :adl :derived-predicates :action-costs)', place)
    )


def _renamed(definition: Definition, declared: Declarations) -> Definition:
    """Return a definition that calls the type "number" by another name."""
    name = 'a-number'
    while name in declared.types:
        name += '-'

    def renamed(tree: Branch, everywhere: bool = False) -> Branch:
        parts: list[Tree] = []
        for before, part in zip([None, *tree], tree, strict=False):
            is_type = part == _NUMBER and (everywhere or before == '-')
            other = part if isinstance(part, Word) else renamed(part)
            parts.append(word(name, part) if is_type else other)
        return tree.like(parts)

    for keyword, sections in definition.sections.items():
        if keyword == ':functions':  # these are numbers indeed
            parts = (tuple(p if isinstance(p, Word) else renamed(p) for p in s) for s in sections)
            changed = [s.like(p) for s, p in zip(sections, parts, strict=True)]
        else:
            changed = [renamed(section, keyword == ':types') for section in sections]
        definition = definition.having(keyword, *changed)
    return definition
