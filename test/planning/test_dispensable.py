"""What can be dispensed with changes no cost: on random tasks, all their states walked through."""

import heapq
import itertools
from random import Random

import pytest

from mirror_explainer.planning.downward.dispensable import indispensable
from mirror_explainer.planning.downward.ground_task import Fact, Operator, State

SIZES = (3, 3, 2, 2)


def random_operator(random: Random) -> Operator:
    condition = {
        v: random.randrange(SIZES[v]) for v in random.sample(range(4), random.choice((1, 2)))
    }
    effect = {
        v: random.randrange(SIZES[v]) for v in random.sample(range(4), random.choice((1, 2, 3)))
    }
    return Operator(
        '(act)', (*condition.items(),), (*effect.items(),), random.choice((0, 1, 1, 2))
    )


def costs(operators: list[Operator], start: State) -> dict[State, int]:
    """Return what it costs to come to each state that can be reached."""
    found: dict[State, int] = {}
    queue = [(0, start)]
    while queue:
        cost, state = heapq.heappop(queue)
        if state not in found:
            found[state] = cost
            for operator in operators:
                if all(state[v] == value for v, value in operator.condition):
                    values = list(state)
                    for v, value in operator.effect:
                        values[v] = value
                    heapq.heappush(queue, (cost + operator.cost, tuple(values)))
    return found


def cheapest(found: dict[State, int], goal: tuple[Fact, ...]) -> int | None:
    reaching = [cost for state, cost in found.items() if all(state[v] == x for v, x in goal)]
    return min(reaching, default=None)


@pytest.mark.parametrize('gain', [0, 1])
def test_what_can_be_dispensed_with_changes_no_cost(gain: int) -> None:
    gone = 0
    for seed in range(400):
        random = Random(seed)
        operators = [random_operator(random) for _ in range(10)]
        goal = ((0, random.randrange(3)), (2, 1))[: random.choice((1, 2))]
        reached = costs(operators, (0, 0, 0, 0))
        facts = [(v, value) for v, size in enumerate(SIZES) for value in range(size)]
        mutexes = [
            frozenset(pair)
            for pair in itertools.combinations(facts, 2)
            if not any(all(state[v] == value for v, value in pair) for state in reached)
        ]

        left = indispensable(operators, goal, mutexes, gain)

        gone += len(operators) - len(left)
        assert cheapest(costs(left, (0, 0, 0, 0)), goal) == cheapest(reached, goal), seed
    assert gone


def test_a_lift_stops_only_where_somebody_waits_or_wants_to_go() -> None:
    def move(start: int, end: int, cost: int = 1) -> Operator:
        return Operator(f'(move f{start} f{end})', ((0, start),), ((0, end),), cost)

    floors = range(4)
    moves = [move(a, b) for a, b in itertools.permutations(floors, 2) if (a, b) != (1, 3)]
    enter = Operator('(enter)', ((0, 1), (1, 0)), ((1, 1),), 1)
    leave = Operator('(leave)', ((0, 3), (1, 1)), ((1, 2),), 1)

    kept = indispensable([*moves, enter, leave], [(1, 2)], gain=1)

    # By floor 0 or 2 only from floor 1, from where no move leads to floor 3.
    stops = {'(move f1 f0)', '(move f1 f2)'}
    ends = {operator.name for operator in moves if operator.effect[0][1] in (1, 3)}
    assert {operator.name for operator in kept} == ends | stops | {'(enter)', '(leave)'}


def test_an_arm_puts_a_part_on_another_only_where_the_goal_wants_it() -> None:
    # Variables 0 and 1: where parts a and b are (0: held, 1: on the table, 2: on the other);
    # 2 and 3: whether they are clear; 4: whether the hand is empty.
    operators = []
    for part, other in ((0, 1), (1, 0)):
        held, on_table, on_other = ((part, value) for value in range(3))
        clear, other_clear, hand = (2 + part, 1), (2 + other, 1), (4, 1)
        taken = (held, (2 + part, 0), (4, 0))
        operators += [
            Operator(f'(lift {part})', (on_table, clear, hand), taken, 1),
            Operator(f'(drop {part})', (held,), (on_table, clear, hand), 1),
            Operator(f'(part {part})', (on_other, clear, hand), (*taken, other_clear), 1),
            Operator(
                f'(mount {part})',
                (held, other_clear),
                (on_other, clear, hand, (2 + other, 0)),
                1,
            ),
        ]
    mutexes = [frozenset({(0, 2), (3, 1)}), frozenset({(1, 2), (2, 1)})]

    def gone(gain: int, known: list[frozenset[Fact]]) -> set[str]:
        kept = indispensable(operators, [(0, 2)], known, gain)
        return {operator.name for operator in operators} - {operator.name for operator in kept}

    assert gone(0, mutexes) == {'(mount 1)'}
    assert gone(1, mutexes) == set()  # it costs no more
    assert gone(0, []) == set()  # for all that is known, something may be on what is clear
