"""PDDL as nested lists of words, and the edits by which one task stands for many beliefs.

A goal becomes an action that leads to one common end fact, and each uncertain
fact gets two actions that make it true and false.
"""

from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import lcm
from typing import Any

# No PDDL name contains "@", so these clash with nothing.
REACHED = '@reached'
GOAL_ACTION = '@goal'
FACT_ACTION = '@fact'

_TOTAL_COST = 'total-cost'

# Costs scaled to integers may not come near the limit of a 32-bit sum.
_LARGEST_COST = 1_000_000


class UnfitError(Exception):
    """The texts are not what Fast Downward's translator takes."""


@dataclass(frozen=True)
class Lists:
    """A belief space's texts as nested lists of lower-case words.

    `scale` is what the costs in them were multiplied by, to be integers.
    `domain` lacks :requirements, and has the problem's objects as constants.
    """

    domain: list[Any]
    goals: tuple[Any, ...]
    facts: tuple[tuple[str, ...], ...]
    initial_facts: tuple[tuple[str, ...], ...]
    initial_numbers: tuple[Any, ...]
    metric: list[Any] | None
    scale: int

    @property
    def certain_facts(self) -> list[tuple[str, ...]]:
        """The initial facts that are not uncertain."""
        return [fact for fact in self.initial_facts if fact not in self.facts]

    @property
    def objects(self) -> tuple[str, ...]:
        """All objects in the order in which they are declared."""
        words = next(part[1:] for part in self.domain[1:] if part[0] == ':constants')
        return tuple(
            word
            for before, word in zip(['', *words], words, strict=False)
            if '-' not in (before, word)
        )


def read_lists(
    domain: list[Any], problem: list[Any], goals: Sequence[Any], facts: Sequence[list[str]]
) -> Lists:
    """Take a belief space apart. Raises UnfitError if the texts are not as PDDL wants them."""
    sections = _sections(problem)
    constants = _closed(sections.pop(':constants', []))
    constants += _closed(sections.pop(':objects', []))
    init = sections.get(':init', [])
    metric = sections.get(':metric')
    if metric:
        values = _cost_values(domain, init)
    else:  # the translator wants a value for each cost all the same
        domain, values = _without_costs(domain), []
    scale = _scale([*_increases(domain), *(value[2] for value in values)])
    return Lists(
        domain=_scaled(_with_constants(domain, constants), scale),
        goals=tuple(goals),
        facts=tuple(map(tuple, facts)),
        initial_facts=tuple(
            dict.fromkeys(tuple(fact) for fact in init if fact and fact[0] not in ('=', 'not'))
        ),
        initial_numbers=tuple(_scaled(values, scale)),
        metric=[':metric', *metric] if metric else None,
        scale=scale,
    )


def edited_domain(lists: Lists, goals: Collection[int], free_facts: bool) -> list[Any]:
    """Return the domain with an action for each goal, and, if asked, two for each fact."""
    actions: list[Any] = [
        _action(f'{GOAL_ACTION}{index}', lists.goals[index], [REACHED]) for index in goals
    ]
    if free_facts:
        for index, fact in enumerate(lists.facts):
            actions.append(_action(f'{FACT_ACTION}{index}-on', [], list(fact)))
            actions.append(_action(f'{FACT_ACTION}{index}-off', [], ['not', list(fact)]))
    head = [
        [*section, [REACHED]] if section[0] == ':predicates' else section
        for section in lists.domain[1:]
    ]
    return ['define', *head, *actions]


def edited_problem(lists: Lists, initial_facts: Collection[tuple[str, ...]]) -> list[Any]:
    """Return the problem of reaching the end fact from the given initial facts."""
    name = next(section[1] for section in lists.domain[1:] if section[0] == 'domain')
    init = [':init', *map(list, initial_facts), *lists.initial_numbers]
    end = [] if lists.metric is None else [lists.metric]
    return ['define', ['problem', name], [':domain', name], init, [':goal', [REACHED]], *end]


def _action(name: str, precondition: Any, effect: Any) -> list[Any]:
    return [':action', name, ':parameters', [], ':precondition', precondition, ':effect', effect]


def _sections(definition: list[Any]) -> dict[str, list[Any]]:
    """Return the contents of a definition's sections by their keywords."""
    found: dict[str, list[Any]] = {}
    for section in definition[1:]:
        if not isinstance(section, list) or not section or not isinstance(section[0], str):
            raise UnfitError('a section without a keyword')
        if section[0] in found:
            raise UnfitError(f'two sections {section[0]}')
        found[section[0]] = section[1:]
    return found


def _closed(typed_list: list[Any]) -> list[Any]:
    """Return a typed list that another can follow."""
    untyped_end = typed_list and (len(typed_list) < 2 or typed_list[-2] != '-')
    return [*typed_list, '-', 'object'] if untyped_end else list(typed_list)


def _with_constants(domain: list[Any], constants: list[Any]) -> list[Any]:
    """Return the domain with more constants, and its sections in the translator's order."""
    parts = [part for part in domain[1:] if isinstance(part, list) and part]
    actions = [part for part in parts if part[0] in (':action', ':derived')]
    others = {part[0]: part[1:] for part in parts if part[0] not in (':action', ':derived')}
    if len(others) + len(actions) != len(domain) - 1:
        raise UnfitError('a section twice, or without a keyword')
    others.pop(':requirements', None)
    others[':constants'] = _closed(others.get(':constants', [])) + constants
    others.setdefault(':predicates', [])
    order = ['domain', ':types', ':constants', ':predicates', ':functions']
    if not others.keys() <= set(order):
        raise UnfitError(f'a section {", ".join(others.keys() - set(order))}')
    head = [[keyword, *others[keyword]] for keyword in order if keyword in others]
    return ['define', *head, *actions]


def _increases(tree: Any) -> Iterator[Any]:
    """Yield what actions cost: a number, or the function whose value it is."""
    if isinstance(tree, list):
        if _is_cost(tree):
            yield tree[2]
        for part in tree:
            yield from _increases(part)


def _without_costs(tree: Any) -> Any:
    """Return the tree with an empty effect for every one that raises the total cost."""
    if not isinstance(tree, list):
        return tree
    return ['and'] if _is_cost(tree) else [_without_costs(part) for part in tree]


def _is_cost(tree: list[Any]) -> bool:
    return len(tree) == 3 and tree[0] == 'increase' and _function(tree[1]) == _TOTAL_COST


def _cost_values(domain: list[Any], init: list[Any]) -> list[Any]:
    """Return the initial (= (function …) number) of the functions that actions cost.

    The translator has no other numbers. A function that conditions or effects
    need is refused there; any other may be left out.
    """
    functions = {_TOTAL_COST, *map(_function, _increases(domain))}
    numbers = [fact for fact in init if fact[:1] == ['='] and len(fact) == 3]
    return [number for number in numbers if _function(number[1]) in functions]


def _function(term: Any) -> str | None:
    """Return the function's name in "(distance a b)" or "total-cost", None if there is none."""
    name = term[0] if isinstance(term, list) and term else term
    return name if isinstance(name, str) else None


def _scale(costs: Iterable[Any]) -> int:
    """Return the least factor that makes all costs integers."""
    numbers = [Fraction(cost) for cost in costs if _is_number(cost)]
    scale = lcm(*(number.denominator for number in numbers))
    if scale > 1 and max(numbers) * scale > _LARGEST_COST:
        raise UnfitError('costs with too many digits')
    return scale


def _is_number(word: Any) -> bool:
    return isinstance(word, str) and word.replace('.', '', 1).isdigit()


def _scaled(tree: Any, factor: int) -> Any:
    """Return the tree with its costs multiplied."""
    if not isinstance(tree, list):
        return tree
    if len(tree) == 3 and tree[0] in ('increase', '=') and _is_number(tree[2]):
        return [tree[0], tree[1], str(Fraction(tree[2]) * factor)]
    return [_scaled(part, factor) for part in tree]
