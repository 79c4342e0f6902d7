"""Four kinds of robots with many equally good plans, drawn as goal recognition problems.

A robot that delivers parcels on a grid, one in a hospital with two lifts, one that inspects
a plant, and one that assembles. Everything follows from a seed.
"""

from collections.abc import Callable, Iterable, Mapping
from itertools import combinations
from random import Random

from mirror_explainer.experiments.benchmark.dataset import RecognitionProblem

_GRID = """
(define (domain parcels) (:requirements :strips :typing) (:types cell parcel)
  (:predicates (robot-at ?c - cell) (next-to ?a ?b - cell) (waits ?p - parcel ?c - cell)
    (carried ?p - parcel) (free-hand) (delivered ?p - parcel ?c - cell))
  (:action move :parameters (?from ?to - cell)
    :precondition (and (robot-at ?from) (next-to ?from ?to))
    :effect (and (not (robot-at ?from)) (robot-at ?to)))
  (:action pick-up :parameters (?p - parcel ?c - cell)
    :precondition (and (robot-at ?c) (waits ?p ?c) (free-hand))
    :effect (and (not (waits ?p ?c)) (not (free-hand)) (carried ?p)))
  (:action deliver :parameters (?p - parcel ?c - cell)
    :precondition (and (robot-at ?c) (carried ?p))
    :effect (and (not (carried ?p)) (free-hand) (delivered ?p ?c))))
"""
_HOSPITAL = """
(define (domain hospital) (:requirements :strips :typing) (:types room medicine lift)
  (:predicates (robot-at ?r - room) (corridor ?a ?b - room) (joins ?l - lift ?a ?b - room)
    (stored ?m - medicine ?r - room) (aboard ?m - medicine) (brought ?m - medicine ?r - room))
  (:action drive :parameters (?from ?to - room)
    :precondition (and (robot-at ?from) (corridor ?from ?to))
    :effect (and (not (robot-at ?from)) (robot-at ?to)))
  (:action take-lift :parameters (?l - lift ?from ?to - room)
    :precondition (and (robot-at ?from) (joins ?l ?from ?to))
    :effect (and (not (robot-at ?from)) (robot-at ?to)))
  (:action load :parameters (?m - medicine ?r - room)
    :precondition (and (robot-at ?r) (stored ?m ?r))
    :effect (and (not (stored ?m ?r)) (aboard ?m)))
  (:action bring :parameters (?m - medicine ?r - room)
    :precondition (and (robot-at ?r) (aboard ?m))
    :effect (and (not (aboard ?m)) (brought ?m ?r))))
"""
_INSPECTION = """
(define (domain inspection) (:requirements :strips :typing) (:types place machine target)
  (:predicates (robot-at ?p - place) (path ?a ?b - place) (seen-from ?m - machine ?p - place)
    (target-at ?t - target ?p - place) (calibrated) (inspected ?m - machine))
  (:action drive :parameters (?from ?to - place)
    :precondition (and (robot-at ?from) (path ?from ?to))
    :effect (and (not (robot-at ?from)) (robot-at ?to)))
  (:action calibrate :parameters (?t - target ?p - place)
    :precondition (and (robot-at ?p) (target-at ?t ?p))
    :effect (calibrated))
  (:action inspect :parameters (?m - machine ?p - place)
    :precondition (and (robot-at ?p) (seen-from ?m ?p) (calibrated))
    :effect (inspected ?m)))
"""
_ASSEMBLY = """
(define (domain assembly) (:requirements :strips :typing) (:types part tray tool frame)
  (:predicates (in ?p - part ?t - tray) (held ?p - part) (empty) (fits ?t - tool ?p - part)
    (on-rack ?t - tool) (in-use ?t - tool) (no-tool) (placed ?p - part ?f - frame)
    (fastened ?p - part ?f - frame))
  (:action pick :parameters (?p - part ?t - tray)
    :precondition (and (in ?p ?t) (empty))
    :effect (and (not (in ?p ?t)) (not (empty)) (held ?p)))
  (:action place :parameters (?p - part ?f - frame)
    :precondition (held ?p)
    :effect (and (not (held ?p)) (empty) (placed ?p ?f)))
  (:action take-tool :parameters (?t - tool)
    :precondition (and (on-rack ?t) (no-tool))
    :effect (and (not (on-rack ?t)) (not (no-tool)) (in-use ?t)))
  (:action put-back :parameters (?t - tool)
    :precondition (in-use ?t)
    :effect (and (not (in-use ?t)) (no-tool) (on-rack ?t)))
  (:action fasten :parameters (?p - part ?f - frame ?t - tool)
    :precondition (and (placed ?p ?f) (in-use ?t) (fits ?t ?p))
    :effect (fastened ?p ?f)))
"""


def _problem(
    domain: str, objects: Mapping[str, Iterable[str]], facts: Iterable[str], goals: Iterable[str]
) -> RecognitionProblem:
    """Return the problem; each goal is made of atoms, and the first is the true one."""
    listed = ' '.join(f'{" ".join(names)} - {kind}' for kind, names in objects.items())
    pool = tuple(f'(and {goal})' for goal in goals)
    name = domain.split('(domain ')[1].split(')')[0]
    template = (
        f'(define (problem drawn) (:domain {name})\n  (:objects {listed})\n'
        f'  (:init {" ".join(facts)})\n  (:goal (and <HYPOTHESIS>)))'
    )
    return RecognitionProblem(domain, template, pool, pool[0], None)


def _both_ways(predicate: str, pairs: Iterable[tuple[str, ...]]) -> list[str]:
    return [f'({predicate} {a} {b})' for pair in pairs for a, b in (pair, pair[::-1])]


def grid(random: Random) -> RecognitionProblem:
    """Draw a robot that delivers two of four parcels on a grid of 4 × 3 cells, one at a time."""
    cells = [f'cell-{column}{row}' for column in 'abcd' for row in '123']
    next_to = [
        (a, b)
        for a, b in combinations(cells, 2)
        if sum(abs(ord(x) - ord(y)) for x, y in zip(a, b, strict=True)) == 1
    ]
    parcels = ['red-parcel', 'blue-parcel', 'green-parcel', 'white-parcel']
    start, *places = random.sample(cells, len(parcels) + 4)
    waits = [f'(waits {parcel} {cell})' for parcel, cell in zip(parcels, places, strict=False)]
    desks = places[len(parcels) :]
    one = [f'(delivered {parcel} {desk})' for parcel in parcels for desk in desks]
    goals = [f'{a} {b}' for a, b in combinations(one, 2) if a.split()[1] != b.split()[1]]
    facts = [f'(robot-at {start})', '(free-hand)', *waits, *_both_ways('next-to', next_to)]
    return _problem(_GRID, {'cell': cells, 'parcel': parcels}, facts, goals)


def hospital(random: Random) -> RecognitionProblem:
    """Draw a robot that brings two of four medicines to wards on three floors, by two lifts."""
    floors = {level: [f'ward-{level}{letter}' for letter in 'abc'] for level in '123'}
    halls = [f'hall-{level}' for level in floors]
    corridors = [(f'hall-{level}', ward) for level, wards in floors.items() for ward in wards]
    lifts = ['front-lift', 'back-lift']
    joins = [f'(joins {lift} {a} {b})' for lift in lifts for a in halls for b in halls if a != b]
    medicines = ['insulin', 'antibiotics', 'painkillers', 'vitamins']
    wards = [ward for of_level in floors.values() for ward in of_level]
    stores = random.sample(wards, 2)
    stored = [f'(stored {medicine} {random.choice(stores)})' for medicine in medicines]
    others = random.sample([ward for ward in wards if ward not in stores], 3)
    one = [f'(brought {medicine} {ward})' for medicine in medicines for ward in others]
    goals = [f'{a} {b}' for a, b in combinations(one, 2) if a.split()[1] != b.split()[1]]
    facts = [
        f'(robot-at {random.choice(halls)})', *stored, *joins, *_both_ways('corridor', corridors),
    ]  # fmt: skip
    objects = {'room': [*wards, *halls], 'medicine': medicines, 'lift': lifts}
    return _problem(_HOSPITAL, objects, facts, goals)


def inspection(random: Random) -> RecognitionProblem:
    """Draw a robot that inspects two of five machines of a plant, with a calibrated camera."""
    places = [f'{side}-{end}' for side in ('north', 'middle', 'south') for end in ('west', 'east')]
    paths = [
        (a, b)
        for a, b in combinations(places, 2)
        if a.split('-')[1] == b.split('-')[1] or a.split('-')[0] == b.split('-')[0]
    ]
    machines = ['pump', 'valve', 'motor', 'tank', 'fan']
    seen = [
        f'(seen-from {machine} {place})'
        for machine in machines
        for place in random.sample(places, 2)
    ]
    targets = ['plate', 'disc', 'cross']
    at = [
        f'(target-at {target} {place})'
        for target, place in zip(targets, random.sample(places, 3), strict=True)
    ]
    goals = [f'(inspected {a}) (inspected {b})' for a, b in combinations(machines, 2)]
    facts = [f'(robot-at {random.choice(places)})', *seen, *at, *_both_ways('path', paths)]
    objects = {'place': places, 'machine': machines, 'target': targets}
    return _problem(_INSPECTION, objects, facts, goals)


def assembly(random: Random) -> RecognitionProblem:
    """Draw a robot that fastens two of five parts to one of two frames, with either tool."""
    parts = ['bracket', 'cover', 'hinge', 'handle', 'plate']
    trays = ['left-tray', 'right-tray']
    tools = ['screwdriver', 'wrench', 'key']
    frames = ['door', 'drawer']
    lies = [f'(in {part} {random.choice(trays)})' for part in parts]
    fits = [f'(fits {tool} {part})' for part in parts for tool in random.sample(tools, 2)]
    racks = [f'(on-rack {tool})' for tool in tools]
    goals = [
        ' '.join(f'(fastened {part} {frame})' for part in chosen)
        for chosen in combinations(parts, 2)
        for frame in frames
    ]
    facts = ['(empty)', '(no-tool)', *lies, *fits, *racks]
    objects = {'part': parts, 'tray': trays, 'tool': tools, 'frame': frames}
    return _problem(_ASSEMBLY, objects, facts, goals)


ROBOTS: Mapping[str, Callable[[Random], RecognitionProblem]] = {
    'grid': grid,
    'hospital': hospital,
    'inspection': inspection,
    'assembly': assembly,
}
