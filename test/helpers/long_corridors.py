"""A courier in a building of very many rooms: much to read, and a long plan."""

from itertools import pairwise
from pathlib import Path

FLOORS, PARCELS = 5, 10

DOMAIN = """
(define (domain couriers) (:requirements :strips :typing) (:types room parcel)
  (:predicates (courier-at ?r - room) (beside ?a ?b - room) (depot ?r - room)
    (left-at ?p - parcel ?r - room) (carried ?p - parcel) (delivered ?p - parcel))
  (:action walk :parameters (?from ?to - room)
    :precondition (and (courier-at ?from) (beside ?from ?to))
    :effect (and (not (courier-at ?from)) (courier-at ?to)))
  (:action collect :parameters (?p - parcel ?r - room)
    :precondition (and (courier-at ?r) (left-at ?p ?r))
    :effect (and (not (left-at ?p ?r)) (carried ?p)))
  (:action deliver :parameters (?p - parcel ?r - room)
    :precondition (and (courier-at ?r) (depot ?r) (carried ?p))
    :effect (and (not (carried ?p)) (delivered ?p))))
"""


def write_task(folder: Path, rooms: int = 500) -> list[str]:
    """Write domain, problem, plan and user model there; return the options of verbalize.

    Of ten parcels two are to be brought to the depot; the listener thinks any neighbours
    among them equally likely. The two farthest it is: some 90 steps.
    """
    length = rooms // FLOORS
    grid = [[f'room-{floor}-{number}' for number in range(length)] for floor in range(FLOORS)]
    beside = [pair for corridor in grid for pair in pairwise(corridor)]
    beside += [pair for column in zip(*grid, strict=True) for pair in pairwise(column)]
    places = [(number % FLOORS, 5 + 4 * number) for number in range(PARCELS)]
    goals = [_goal(number, (number + 1) % PARCELS) for number in range(PARCELS)]
    first, second = PARCELS - 2, PARCELS - 1
    depot = grid[0][0]
    problem = f"""
(define (problem far) (:domain couriers)
  (:objects {' '.join(sum(grid, []))} - room {' '.join(map(_parcel, range(PARCELS)))} - parcel)
  (:init (courier-at {depot}) (depot {depot})
    {' '.join(f'(beside {a} {b}) (beside {b} {a})' for a, b in beside)}
    {' '.join(f'(left-at {_parcel(p)} {grid[f][n]})' for p, (f, n) in enumerate(places))})
  (:goal {goals[first]}))
"""
    there, on, back = (
        _walk(grid, *stretch)
        for stretch in pairwise([(0, 0), places[first], places[second], (0, 0)])
    )
    plan = [
        *there, f'(collect {_parcel(first)} {grid[places[first][0]][places[first][1]]})',
        *on, f'(collect {_parcel(second)} {grid[places[second][0]][places[second][1]]})',
        *back, f'(deliver {_parcel(first)} {depot})', f'(deliver {_parcel(second)} {depot})',
    ]  # fmt: skip
    options = []
    for option, name, text in (
        ('--domain', 'domain.pddl', DOMAIN),
        ('--problem', 'problem.pddl', problem),
        ('--plan', 'plan.txt', '\n'.join(plan)),
        (
            '--user-model',
            'user_model.yaml',
            '\n'.join(['goals:', *(f'- goal: {g}' for g in goals)]),
        ),
    ):
        (folder / name).write_text(text)
        options += [option, str(folder / name)]
    return options


def _parcel(number: int) -> str:
    return f'parcel-{number}'


def _goal(*parcels: int) -> str:
    return f'(and {" ".join(f"(delivered {_parcel(parcel)})" for parcel in parcels)})'


def _walk(grid: list[list[str]], start: tuple[int, int], end: tuple[int, int]) -> list[str]:
    """Along the corridor first, then from floor to floor."""
    (floor, number), (last_floor, last) = start, end
    along = range(number, last, 1 if last > number else -1)
    across = range(floor, last_floor, 1 if last_floor > floor else -1)
    rooms = [grid[floor][n] for n in along] + [grid[f][last] for f in across]
    return [f'(walk {a} {b})' for a, b in pairwise([*rooms, grid[last_floor][last]])]
