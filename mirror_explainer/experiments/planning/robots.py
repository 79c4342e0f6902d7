"""Robots of growing size to plan for: maps, hands, a hospital, parts to mount, shelves, a drone.

Each family makes a belief space and the beliefs that a listener may hold.
"""

import itertools
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from random import Random

from mirror_explainer.planning import Belief, BeliefSpace

Grid = list[list[str]]


@dataclass(frozen=True)
class Robot:
    """A family's member: its beliefs, those with all uncertain facts first for each goal.

    Of the uncertain facts in `group` exactly one holds.
    """

    name: str
    space: BeliefSpace
    beliefs: tuple[Belief, ...]
    group: tuple[str, ...] = ()


def robots(seed: int = 0) -> list[Robot]:
    """Return all families in their sizes, the same for the same seed."""
    return [
        *(_fetching(f'map of {n} places', n, 2, 10, 2, seed=seed) for n in (50, 200, 500)),
        *(
            _fetching(f'one hand, {fetch} of 10', 50, fetch, 6, 0, one_hand=True, seed=seed)
            for fetch in (2, 3, 4)
        ),
        *(_hospital(packs, 10, seed) for packs in (1, 2, 3)),
        *(_parts(parts, 10, seed) for parts in (8, 10, 12)),
        *(_shelves(shelves, 19, seed) for shelves in (12, 24, 36)),
        *(_drone(side, 10, seed) for side in (4, 5, 7)),
    ]


def _robot(
    name: str,
    domain: str,
    objects: Iterable[str],
    facts: Iterable[str],
    goals: Sequence[str],
    uncertain: Sequence[str] = (),
    group: Sequence[str] = (),
) -> Robot:
    """Return a robot whose listener is uncertain of some facts, and which of a group holds."""
    problem = (
        f'(define (problem some) (:domain robot) (:objects {" ".join(objects)})'
        f' (:init {" ".join(facts)}) (:goal (and)))'
    )
    space = BeliefSpace(domain, problem, tuple(goals), (*uncertain, *group))
    beliefs = (
        Belief(goal, frozenset((*true, *one)))
        for goal in range(len(goals))
        for size in range(len(uncertain), -1, -1)
        for true in itertools.combinations(uncertain, size)
        for one in itertools.product(*([group] if group else []))
    )
    return Robot(name, space, tuple(beliefs), tuple(group))


def _domain(predicates: str, *actions: tuple[str, str, str, str], types: str = '') -> str:
    bodies = ' '.join(
        f'(:action {name} :parameters ({parameters}) :precondition (and {condition})'
        f' :effect (and {effect}))'
        for name, parameters, condition, effect in actions
    )
    return (
        f'(define (domain robot) (:requirements :strips :typing) {types}'
        f' (:predicates {predicates}) {bodies})'
    )


_GO = ('go', '?a ?b - place', '(at ?a) (way ?a ?b)', '(not (at ?a)) (at ?b)')


def _grid(places: int) -> tuple[list[str], list[tuple[str, str]]]:
    """Return places and the ways between neighbours in a grid of four rows."""
    names = [[f'p{x}-{y}' for y in range(4)] for x in range(-(-places // 4))]
    ways = [
        *((a, b) for column in names for a, b in itertools.pairwise(column)),
        *(pair for two in itertools.pairwise(names) for pair in zip(*two, strict=True)),
    ]
    return [name for column in names for name in column], ways


def _both(kind: str, ways: Iterable[tuple[str, str]]) -> list[str]:
    return [f'({kind} {x} {y})' for a, b in ways for x, y in ((a, b), (b, a))]


def _different(random: Random, items: Sequence[str], size: int, count: int) -> list[list[str]]:
    found: dict[tuple[str, ...], None] = {}
    while len(found) < count:
        found[tuple(sorted(random.sample(items, size)))] = None
    return [list(chosen) for chosen in found]


def _fetching(
    name: str,
    places: int,
    fetch: int,
    goals: int,
    gates: int,
    *,
    one_hand: bool = False,
    group: Sequence[str] = (),
    seed: int,
) -> Robot:
    """A robot that brings things home; gates may be open; with one hand it carries one."""
    random = Random(f'{name} {seed}')
    names, ways = _grid(places)
    things = [f't{number}' for number in range(10)]
    gated = random.sample(ways, gates)
    hand, empty, full = ('(free)', '(not (free))', '(free)') if one_hand else ('', '', '')
    domain = _domain(
        '(at ?p - place) (way ?a ?b - place) (gate ?g ?a ?b) (open ?g) (free) (home ?p - place)'
        ' (lies ?t - thing ?p - place) (held ?t - thing) (brought ?t - thing)',
        _GO,
        ('pass', '?g - barrier ?a ?b - place', '(at ?a) (gate ?g ?a ?b) (open ?g)', _GO[3]),
        ('take', '?t - thing ?p - place', f'(at ?p) (lies ?t ?p) {hand}',
         f'(held ?t) (not (lies ?t ?p)) {empty}'),
        ('give', '?t - thing ?p - place', '(at ?p) (home ?p) (held ?t)',
         f'(brought ?t) (not (held ?t)) {full}'),
        types='(:types place thing barrier)',
    )  # fmt: skip
    barriers = [f'g{number}' for number in range(gates)]
    facts = [
        *_both('way', (way for way in ways if way not in gated)),
        *(f'(gate {g} {x} {y})' for g, (a, b) in zip(barriers, gated, strict=True)
          for x, y in ((a, b), (b, a))),
        *(f'(open {g})' for g in barriers),
        *(f'(lies {thing} {random.choice(names[1:])})' for thing in things),
        '(free)', f'(at {names[0]})', f'(home {random.choice(names)})',
    ]  # fmt: skip
    wanted = _different(random, things, fetch, goals)
    return _robot(
        name,
        domain,
        [*names, '- place', *things, '- thing', *barriers, *(['- barrier'] if barriers else [])],
        facts,
        [f'(and {" ".join(f"(brought {thing})" for thing in each)})' for each in wanted],
        [f'(open {g})' for g in barriers],
        group,
    )


def _hospital(packs: int, goals: int, seed: int) -> Robot:
    """Three floors of six rooms, two lifts that may be out of order, two trays for packs."""
    random = Random(f'hospital {packs} {seed}')
    rooms = [[f'r{floor}-{number}' for number in range(6)] for floor in range(3)]
    every, lifts, names = [r for floor in rooms for r in floor], ['east', 'west'], 'abcd'
    items = [f'pack-{letter}' for letter in names]
    domain = _domain(
        '(at ?p - place) (way ?a ?b - place) (shaft ?l - lift ?p - place) (works ?l - lift)'
        ' (lies ?k - pack ?p - place) (on ?k - pack ?t - tray) (empty ?t - tray)',
        _GO,
        ('ride', '?l - lift ?a ?b - place', '(at ?a) (shaft ?l ?a) (shaft ?l ?b) (works ?l)',
         '(not (at ?a)) (at ?b)'),
        ('load', '?k - pack ?t - tray ?p - place', '(at ?p) (lies ?k ?p) (empty ?t)',
         '(on ?k ?t) (not (lies ?k ?p)) (not (empty ?t))'),
        ('unload', '?k - pack ?t - tray ?p - place', '(at ?p) (on ?k ?t)',
         '(lies ?k ?p) (empty ?t) (not (on ?k ?t))'),
        types='(:types place lift pack tray)',
    )  # fmt: skip
    facts = [
        *_both('way', (pair for floor in rooms for pair in itertools.pairwise(floor))),
        *(f'(shaft east {floor[-1]}) (shaft west {floor[0]})' for floor in rooms),
        *(f'(lies {item} {random.choice(rooms[0])})' for item in items),
        *(f'(works {lift})' for lift in lifts),
        '(empty upper)', '(empty lower)', f'(at {rooms[0][2]})',
    ]  # fmt: skip
    wanted = [
        [f'(lies {item} {random.choice(rooms[1] + rooms[2])})' for item in chosen]
        for chosen in (random.sample(items, packs) for _ in range(goals))
    ]
    return _robot(
        f'hospital, {packs} packs',
        domain,
        [*every, '- place', *lifts, '- lift', *items, '- pack', 'upper lower - tray'],
        facts,
        [f'(and {" ".join(goal)})' for goal in wanted],
        [f'(works {lift})' for lift in lifts],
    )


def _parts(count: int, goals: int, seed: int) -> Robot:
    """An arm that mounts parts on parts, four in a goal."""
    random = Random(f'parts {count} {seed}')
    parts = [f'part{number}' for number in range(count)]
    domain = _domain(
        '(on ?a ?b) (stands ?a) (clear ?a) (idle) (held ?a)',
        ('lift', '?a', '(clear ?a) (stands ?a) (idle)',
         '(held ?a) (not (stands ?a)) (not (clear ?a)) (not (idle))'),
        ('drop', '?a', '(held ?a)', '(stands ?a) (clear ?a) (idle) (not (held ?a))'),
        ('mount', '?a ?b', '(held ?a) (clear ?b)',
         '(on ?a ?b) (clear ?a) (idle) (not (held ?a)) (not (clear ?b))'),
        ('part', '?a ?b', '(on ?a ?b) (clear ?a) (idle)',
         '(held ?a) (clear ?b) (not (on ?a ?b)) (not (clear ?a)) (not (idle))'),
    )  # fmt: skip
    towers = [parts[i : i + 3] for i in range(0, count, 3)]
    facts = ['(idle)']
    for tower in towers:
        facts += [f'(stands {tower[0]})', f'(clear {tower[-1]})']
        facts += [f'(on {above} {below})' for below, above in itertools.pairwise(tower)]
    wanted = [random.sample(parts, 4) for _ in range(goals)]
    return _robot(
        f'{count} parts to mount',
        domain,
        parts,
        facts,
        [
            f'(and {" ".join(f"(on {a} {b})" for b, a in itertools.pairwise(tower))}'
            f' (stands {tower[0]}))'
            for tower in wanted
        ],
    )


def _shelves(shelves: int, goals: int, seed: int) -> Robot:
    """A warehouse: on which shelf one of the things lies is not known."""
    places = 4 * shelves // 3
    group = [f'(lies t0 {place})' for place in _grid(places)[0][1 : shelves + 1]]
    return _fetching(f'{shelves} shelves', places, 2, goals, 0, group=group, seed=seed)


def _drone(side: int, goals: int, seed: int) -> Robot:
    """A drone that takes three photos and comes back; where it can charge is not sure."""
    random = Random(f'drone {side} {seed}')
    names: Grid = [[f'w{x}-{y}' for y in range(side)] for x in range(side)]
    ways = [
        *(pair for column in names for pair in itertools.pairwise(column)),
        *(pair for row in zip(*names, strict=True) for pair in itertools.pairwise(row)),
    ]
    every = [name for column in names for name in column]
    levels = [f'l{number}' for number in range(2 * side + 1)]
    docks = random.sample(every[1:], 2)
    domain = _domain(
        '(at ?p - place) (way ?a ?b - place) (charge ?l - level) (next ?l ?m - level)'
        ' (full ?l - level) (dock ?p - place) (seen ?p - place)',
        ('fly', '?a ?b - place ?l ?m - level', '(at ?a) (way ?a ?b) (charge ?l) (next ?m ?l)',
         '(at ?b) (charge ?m) (not (at ?a)) (not (charge ?l))'),
        ('look', '?a - place ?l ?m - level', '(at ?a) (charge ?l) (next ?m ?l)',
         '(seen ?a) (charge ?m) (not (charge ?l))'),
        ('fill', '?a - place ?l ?m - level', '(at ?a) (dock ?a) (charge ?l) (full ?m)',
         '(charge ?m) (not (charge ?l))'),
        types='(:types place level)',
    )  # fmt: skip
    facts = [
        *_both('way', ways),
        *(f'(next {a} {b})' for a, b in itertools.pairwise(levels)),
        f'(full {levels[-1]})', f'(charge {levels[-1]})', f'(at {every[0]})', f'(dock {every[0]})',
        *(f'(dock {place})' for place in docks),
    ]  # fmt: skip
    wanted = _different(random, every, 3, goals)
    return _robot(
        f'drone over {side * side} places',
        domain,
        [*every, '- place', *levels, '- level'],
        facts,
        [f'(and (at {every[0]}) {" ".join(f"(seen {p})" for p in each)})' for each in wanted],
        [f'(dock {place})' for place in docks],
    )
