"""What a task has that planning for the listener cannot use: it is left out, and said so.

Refused is what is wrong, not what is merely more than an explanation needs.
"""

from dataclasses import dataclass, field

from mirror_explainer.pddl.text.actions import effects
from mirror_explainer.pddl.text.declarations import Declarations
from mirror_explainer.pddl.text.definition import Definition
from mirror_explainer.pddl.text.numerals import number
from mirror_explainer.pddl.text.tree import Branch, Tree, Word, branches, has_word, word

_FOLLOWS = 'a belief for which no plan is found then counts as unforeseen, not as impossible'

PREFERENCES = 'soft goals, (preference …), are left out'
CONSTRAINTS = 'constraints on the way to the goal are left out'
TIMED_FACTS = (
    'what comes true by itself at a time, (at TIME …), counts as true from the beginning, unless '
    'it is wanted false somewhere'
)
BY_ITSELF = (
    'what happens by itself, (:process …) and (:event …), is left out; what it makes true counts '
    'as true from the beginning, and conditions on its numbers are left out'
)
TASKS = 'tasks and methods to break them down by are left out: only actions and the goal count'
CONTINUOUS = (
    'effects that go on all the while (#t), and conditions on what they change, are left out'
)
OPEN_DURATIONS = 'durations that are left open count with the least that they can be'
CHANGING_DURATIONS = 'durations that change as the plan runs count with what they are at first'
DERIVED_LATER = (
    'derived conditions that must hold after the start of an action that changes them are left out'
)
NUMBERS = (
    'numbers that change count when the plan of the robot is checked; in planning for the '
    "listener's beliefs conditions on them count as true"
)
NUMBERS_IN_EFFECTS = (
    'effects, and derived predicates, that depend on numbers that change are left out of planning '
    "for the listener's beliefs"
)
UNSTEADY = 'numbers that multiply or divide what changes are left out'
METRIC = 'the metric is no sum of what actions cost, so every action counts the same'
METRIC_UNKNOWN = (
    'every action counts the same, since the metric names what the domain has no function for'
)

_TRAJECTORY = frozenset(
    [
        'always',
        'sometime',
        'within',
        'at-most-once',
        'sometime-after',
        'sometime-before',
        'always-within',
        'hold-during',
        'hold-after',
    ]
)
# What of these loosens or tightens what can be done, and not only what is best.
_HARMLESS = frozenset([PREFERENCES, METRIC, METRIC_UNKNOWN, OPEN_DURATIONS, CHANGING_DURATIONS])
# And what only loosens it, so that there are all plans that there were.
_LOOSENING = _HARMLESS | {NUMBERS}


@dataclass
class LeftOut:
    """Collects what was left out: for each kind the first place.

    `changes` are those that nobody makes, such as (open ?d) or (increase (level) …), by kinds.
    """

    places: dict[str, tuple[str, int, str]] = field(default_factory=dict)
    changes: dict[str, list[Branch]] = field(default_factory=dict)

    def note(self, kind: str, source: str, place: Tree | None, what: str = '') -> None:
        """Remember that something of a kind was left out there, and what, where that is told."""
        if kind not in self.places:
            self.places[kind] = (source, 1 if place is None else place.line, what)

    def note_change(self, kind: str, change: Tree) -> None:
        """Remember a change that comes by itself."""
        if isinstance(change, Branch):
            self.changes.setdefault(kind, []).append(change)

    @property
    def relaxed(self) -> bool:
        """Say whether plans may exist in the task that do not in what was kept, or the reverse."""
        return bool(self.places.keys() - _HARMLESS)

    @property
    def loses_plans(self) -> bool:
        """Say whether plans may exist in the task that do not in what was kept."""
        return bool(self.places.keys() - _LOOSENING)

    def warnings(self) -> tuple[str, ...]:
        """Return a line for each kind."""
        return tuple(
            f'{source}, line {line}: {kind}{what and f": {what}"}'
            f'{"" if kind in _LOOSENING else f"; {_FOLLOWS}"}'
            for kind, (source, line, what) in self.places.items()
        )


def without_extras(
    domain: Definition, problem: Definition, declared: Declarations, left_out: LeftOut
) -> tuple[Definition, Definition]:
    """Return the definitions without what no check and no planning here can use.

    Numbers stay; see `pddl.numbers`.
    """
    for keyword, kind in (
        (':constraints', CONSTRAINTS),
        (':process', BY_ITSELF),
        (':event', BY_ITSELF),
        (':task', TASKS),
        (':method', TASKS),
        (':htn', TASKS),
    ):
        for definition in (domain, problem):
            for section in definition.all(keyword):
                if len(section) > 1:
                    left_out.note(kind, definition.source, section)
                if kind == BY_ITSELF:
                    for effect in effects(_effect_of(section), definition.source, False):
                        left_out.note_change(kind, effect.change)
    gone = (':constraints', ':process', ':event', ':task', ':method', ':htn')
    domain, problem = domain.without(*gone), problem.without(*gone, ':length')
    for keyword in (':action', ':durative-action', ':derived'):
        kept = [_kept(section, domain.source, left_out) for section in domain.all(keyword)]
        domain = domain.having(keyword, *kept)
    goals = [_kept(section, problem.source, left_out) for section in problem.all(':goal')]
    problem = problem.having(':goal', *goals)
    parts = problem.contents(':init')
    timed = [part for part in parts if isinstance(part, Branch) and _is_timed(part, declared)]
    if timed:
        left_out.note(TIMED_FACTS, problem.source, timed[0])
        for part in timed:
            left_out.note_change(TIMED_FACTS, _change(part[2]))
        apart = set(map(id, timed))
        problem = problem.with_contents(':init', [p for p in parts if id(p) not in apart])
    return domain, problem


def _effect_of(section: Branch) -> Tree | None:
    """Return the effect of a process or an event."""
    parts = zip(section, section[1:], strict=False)
    return next((part for keyword, part in parts if keyword == ':effect'), None)


def _change(fact: Tree) -> Tree:
    """Return what is true at a time as a change to it."""
    if isinstance(fact, Branch) and fact.head == '=':
        return fact.like([word('assign', fact), *fact[1:]])
    return fact


def _kept(section: Branch, source: str, left_out: LeftOut) -> Branch:
    """Return a section without preferences, conditions on the way, and continuous change."""
    heads = {branch.head for branch in branches(section)}
    if not heads & (_TRAJECTORY | {'preference'}) and not has_word('#t', section):
        return section
    kept = _without(section, source, left_out)
    assert isinstance(kept, Branch)
    return kept


def _without(tree: Tree, source: str, left_out: LeftOut) -> Tree:
    if isinstance(tree, Word):
        return tree
    found = PREFERENCES if tree.head == 'preference' else ''
    if tree.head in _TRAJECTORY and any(isinstance(part, Branch) for part in tree):
        found = CONSTRAINTS
    if tree.head in ('increase', 'decrease') and has_word('#t', tree):
        found = CONTINUOUS
    if found:
        left_out.note(found, source, tree)
        if found == CONTINUOUS:
            left_out.note_change(found, tree)
        return tree.like([_and(tree)])
    return tree.like(_without(part, source, left_out) for part in tree)


def _and(place: Tree) -> Word:
    return word('and', place)


def _is_timed(part: Branch, declared: Declarations) -> bool:
    """Say whether a part of :init is a fact at a time, as in (at 5 (open door))."""
    return (
        part.head == 'at'
        and len(part) == 3
        and isinstance(part[1], Word)
        and part[1] not in declared.objects
        and number(part[1]) is not None
        and isinstance(part[2], Branch)
    )
