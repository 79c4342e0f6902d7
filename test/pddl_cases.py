"""Small planning problems for the tests of planning."""

from pathlib import Path

_WAREHOUSE = Path(__file__).parent.parent / 'config' / 'warehouse'
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
