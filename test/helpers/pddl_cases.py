"""Small planning problems for the tests of planning."""

import itertools
from dataclasses import replace
from pathlib import Path
from random import Random

from mirror_explainer.planning import BeliefSpace

_WAREHOUSE = Path(__file__).parents[2] / 'config' / 'warehouse'
WAREHOUSE_DOMAIN = (_WAREHOUSE / 'domain.pddl').read_text()
WAREHOUSE_PROBLEM = (_WAREHOUSE / 'problem.pddl').read_text()

TOOLS_DOMAIN = """
(define (domain tools)
  (:requirements :strips :action-costs)
  (:predicates (raw) (cut) (polished) (saw-sharp) (lost))
  (:functions (total-cost) - number)
  (:action cut-fast
    :parameters ()
    :precondition (and (raw) (saw-sharp))
    :effect (and (cut) (not (raw)) (increase (total-cost) 2)))
  (:action cut-slowly
    :parameters ()
    :precondition (raw)
    :effect (and (cut) (not (raw)) (increase (total-cost) 7)))
  (:action polish
    :parameters ()
    :precondition (cut)
    :effect (and (polished) (increase (total-cost) 1))))
"""

TOOLS_PROBLEM = """
(define (problem chair)
  (:domain tools)
  (:init (raw) (= (total-cost) 0))
  (:goal (polished))
  (:metric minimize (total-cost)))
"""
TOOLS = BeliefSpace(TOOLS_DOMAIN, TOOLS_PROBLEM, ('(polished)', '(lost)'), ('(saw-sharp)',))
TOOLS_SHARP = frozenset(['(saw-sharp)'])

_GRIPPER_DOMAIN = """
(define (domain gripper)
  (:requirements :strips :typing)
  (:types room ball hand)
  (:predicates (robot-at ?r - room) (at ?b - ball ?r - room) (free ?h - hand)
               (carry ?b - ball ?h - hand))
  (:action move
    :parameters (?a ?b - room)
    :precondition (robot-at ?a)
    :effect (and (robot-at ?b) (not (robot-at ?a))))
  (:action pick
    :parameters (?b - ball ?r - room ?h - hand)
    :precondition (and (at ?b ?r) (robot-at ?r) (free ?h))
    :effect (and (carry ?b ?h) (not (at ?b ?r)) (not (free ?h))))
  (:action drop
    :parameters (?b - ball ?r - room ?h - hand)
    :precondition (and (carry ?b ?h) (robot-at ?r))
    :effect (and (at ?b ?r) (free ?h) (not (carry ?b ?h)))))
"""


def gripper(balls: int) -> tuple[str, str, str]:
    """Return domain, problem and goal of carrying balls to another room.

    From about twelve balls on, finding a plan stays easy, proving one optimal
    takes minutes: every ball looks like every other.
    """
    names = [f'ball{i}' for i in range(balls)]
    problem = f"""
    (define (problem many-balls)
      (:domain gripper)
      (:objects here there - room left right - hand {' '.join(names)} - ball)
      (:init (robot-at here) (free left) (free right)
             {' '.join(f'(at {name} here)' for name in names)})
      (:goal (and)))
    """
    goal = f'(and {" ".join(f"(at {name} there)" for name in names)})'
    return _GRIPPER_DOMAIN, problem, goal


def random_space(random: Random) -> BeliefSpace:
    """Return a small domain with all that planning for many beliefs at once could get wrong.

    There is a thing that is at one place at a time (which an uncertain fact can
    contradict), static facts, negative conditions, costs, goals that are
    unreachable, hold already or contradict themselves, and now and then
    conditional effects, disjunctions and quantifiers.
    """
    extra = random.choice(['', '', '', '', '', '', 'when', 'or', 'forall', 'exists'])
    costs = random.random() < 0.6
    actions = [
        f'(:action go :parameters (?x ?y) :precondition (and (at ?x) (link ?x ?y))'
        f' :effect (and (at ?y) (not (at ?x)){_cost(random, costs)}))'
    ]
    for index in range(random.randint(3, 6)):
        parameters = ['?x', '?y'][: random.randint(0, 2)]
        condition = _literals(random, [*parameters, 'a'], random.randint(0, 2), 0.25)
        if extra == 'forall' and index == 0:
            condition.append('(forall (?z) (or (free ?z) (at ?z)))')
        if extra == 'exists' and index == 0:
            condition.append('(exists (?z) (and (at ?z) (link ?z ?z)))')
        effect = _literals(random, [*parameters, 'b'], random.randint(1, 3), 0.4, fixed=())
        if extra == 'when' and index == 0:
            effect.append('(when (at a) (free b))')
        actions.append(
            f'(:action act{index} :parameters ({" ".join(parameters)})'
            f' :precondition (and {" ".join(condition)})'
            f' :effect (and {" ".join(effect)}{_cost(random, costs)}))'
        )
    domain = f"""
    (define (domain random)
      (:requirements :adl :action-costs)
      (:constants a b)
      (:predicates (at ?x) (link ?x ?y) (free ?x) (tied ?x ?y) (lit))
      (:functions (total-cost))
      {' '.join(actions)})
    """
    facts = random.sample(_ATOMS, random.randint(8, 18))
    problem = f"""
    (define (problem random)
      (:domain random)
      (:objects c d)
      (:init {' '.join(facts)} (= (total-cost) 0))
      (:goal (and))
      {'(:metric minimize (total-cost))' if costs else ''})
    """
    goals = [
        f'(and {" ".join(_literals(random, list("abcd"), random.randint(1, 3), 0.2))})'
        for _ in range(2)
    ]
    if extra == 'or':
        goals[0] = f'(or {goals[0]} (and (at b) (not (lit))))'
    return BeliefSpace(domain, problem, tuple(goals), tuple(random.sample(_ATOMS, 3)))


def with_changed_state(space: BeliefSpace, random: Random) -> BeliefSpace:
    """Return the space with one or two of the facts that may change turned over."""
    problem = space.problem
    changing = [atom for atom in _ATOMS if 'link' not in atom]
    for atom in random.sample(changing, random.randint(1, 2)):
        if atom in problem:
            problem = problem.replace(atom, '')
        else:
            problem = problem.replace('(:init ', f'(:init {atom} ')
    return replace(space, problem=problem)


_ARITY = {'at': 1, 'free': 1, 'tied': 2, 'lit': 0, 'link': 2}
_ATOMS = [
    f'({" ".join([name, *terms])})'
    for name, arity in _ARITY.items()
    for terms in itertools.product('abcd', repeat=arity)
]


def _cost(random: Random, costs: bool) -> str:
    return f' (increase (total-cost) {random.randint(0, 4)})' if costs else ''


def _literals(
    random: Random,
    terms: list[str],
    count: int,
    negated: float,
    fixed: tuple[str, ...] = ('link',),
) -> list[str]:
    """Return distinct literals over the terms; the `fixed` predicates may be among them."""
    names = ['at', 'free', 'tied', 'lit', *fixed]
    found: dict[str, str] = {}
    for _ in range(count):
        name = random.choice(names)
        atom = f'({" ".join([name, *(random.choice(terms) for _ in range(_ARITY[name]))])})'
        found[atom] = f'(not {atom})' if random.random() < negated else atom
    return list(found.values())
