"""The 15-puzzle: well scrambled, no optimal planner solves it soon; a few moves away, any does."""

import random

SIZE = 4
CELLS = [(x, y) for y in range(SIZE) for x in range(SIZE)]

DOMAIN = """(define (domain tiles)
  (:requirements :strips :typing)
  (:types tile cell)
  (:predicates (at ?t - tile ?c - cell) (blank ?c - cell) (next ?a ?b - cell))
  (:action slide
    :parameters (?t - tile ?from ?to - cell)
    :precondition (and (at ?t ?from) (blank ?to) (next ?from ?to))
    :effect (and (not (at ?t ?from)) (at ?t ?to) (not (blank ?to)) (blank ?from))))
"""


def _cell(cell: tuple[int, int]) -> str:
    return f'c{cell[0]}{cell[1]}'


def _neighbours(cell: tuple[int, int]) -> list[tuple[int, int]]:
    x, y = cell
    near = [(x + 1, y), (x - 1, y), (x, y + 1), (x, y - 1)]
    return [place for place in near if place in CELLS]


def _ats(tiles: dict[tuple[int, int], str]) -> str:
    return ' '.join(f'(at {tile} {_cell(cell)})' for cell, tile in tiles.items())


ORDERED = {cell: f't{i}' for i, cell in enumerate(CELLS[1:], start=1)}
ONE_MOVE_FURTHER = {CELLS[0]: 't1'} | {c: t for c, t in ORDERED.items() if t != 't1'}
USER_MODEL = f"""goals:
  - {{name: in order, goal: "(and {_ats(ORDERED)})"}}
  - {{name: one move further, goal: "(and {_ats(ONE_MOVE_FURTHER)})"}}
sentences: {{slide: "I will slide {{t}} from {{from}} to {{to}}."}}
"""


def sentences(plan: str) -> list[str]:
    """Return what is said of each move of a plan."""
    moves = (line.strip('()').split() for line in plan.split('\n'))
    return [f'I will slide {tile} from {start} to {end}.' for _, tile, start, end in moves]


def scrambled(moves: int, seed: int = 0) -> tuple[str, str]:
    """Return a problem that is so many random moves away from order, and the plan back."""
    chance = random.Random(seed)
    tiles = dict(ORDERED)
    blank, plan = CELLS[0], []
    for _ in range(moves):
        cell = chance.choice(_neighbours(blank))
        plan.append(f'(slide {tiles[cell]} {_cell(blank)} {_cell(cell)})')
        tiles[blank] = tiles.pop(cell)
        blank = cell
    adjacent = ' '.join(f'(next {_cell(a)} {_cell(b)})' for a in CELLS for b in _neighbours(a))
    names = ' '.join(f't{i}' for i in range(1, len(CELLS)))
    problem = f"""(define (problem scrambled) (:domain tiles)
  (:objects {names} - tile {' '.join(map(_cell, CELLS))} - cell)
  (:init {_ats(tiles)} (blank {_cell(blank)}) {adjacent})
  (:goal (and {_ats(ORDERED)})))
"""
    return problem, '\n'.join(reversed(plan))
