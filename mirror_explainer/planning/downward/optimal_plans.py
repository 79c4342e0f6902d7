"""All optimal plans up to order, once it is known which operators occur in any.

Two plans with the same actions in another order are one observation to the
listener, so a plan counts here by how often it has each action. The states on
optimal paths are few where the operators are few, however many the orders are;
and operators that have nothing to do with one another are looked at apart.
"""

import heapq
import math
from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from random import Random

from mirror_explainer.planning.downward.ground_task import Fact, Operator, State
from mirror_explainer.planning.downward.independent_parts import independent_parts

Actions = tuple[str, ...]

# A task with more states within the optimal cost than this is not enumerated.
_MOST_STATES = 50_000

# A plan as one number: so many bits for the count of each action. An optimal plan is in no
# state twice, so that no count reaches the number of states.
_BITS = _MOST_STATES.bit_length()

# While plans are put together, so many times more are kept than will be returned.
_SPARE = 20


@dataclass(frozen=True)
class OptimalPlans:
    """Optimal plans, each in an order that can be carried out.

    `all` says that there are no others but reorderings of these.
    """

    plans: tuple[Actions, ...]
    all: bool


def optimal_plans(
    operators: Sequence[Operator],
    state: State,
    goal: Sequence[Fact],
    known: Sequence[str],
    most: int,
) -> OptimalPlans | None:
    """Return up to `most` optimal plans that use these operators only; costs are positive.

    `known` is one of them. If there are more, a sample is drawn, which the order
    of the operators decides. None if there are too many states to look at.
    """
    parts: list[tuple[list[Actions], bool]] = []
    for part in independent_parts(operators):
        names = {operator.name for operator in part}
        own_goal = [fact for fact in goal if any(_concerns(o, fact[0]) for o in part)]
        counted = {operator.name: operator.cost for operator in part}
        cost = sum(counted[name] for name in known if name in names)
        plans = _plans_of_part(part, state, own_goal, cost, most)
        if plans is None:
            return None
        parts.append(plans)
    total = math.prod(len(plans) for plans, _ in parts)
    chosen = range(total) if total <= most else Random(0).sample(range(total), most)
    return OptimalPlans(
        tuple(_combination([plans for plans, _ in parts], index) for index in chosen),
        total <= most and all(complete for _, complete in parts),
    )


def _combination(parts: Sequence[Sequence[Actions]], index: int) -> Actions:
    """Return the index-th way to take one plan of each part, one after another."""
    actions: list[str] = []
    for plans in parts:
        index, place = divmod(index, len(plans))
        actions += plans[place]
    return tuple(actions)


def _concerns(operator: Operator, variable: int) -> bool:
    return any(variable == other for other, _ in operator.effect)


# A state as one number: a bit for each fact that holds.
_Mask = int

# By the cost spent: the states reached at no less, with their (operator, next state) pairs.
_Layers = dict[int, dict[_Mask, list[tuple[int, _Mask]]]]


@dataclass(frozen=True)
class _Step:
    """An operator on states as numbers: it needs some bits, keeps some, and sets some."""

    needs: _Mask
    keeps: _Mask
    sets: _Mask
    cost: int


class _Bits:
    """Gives each fact a bit, and so each state a number."""

    def __init__(self, operators: Sequence[Operator], state: State, goal: Sequence[Fact]) -> None:
        facts = dict.fromkeys(goal)
        for operator in operators:
            facts.update(dict.fromkeys((*operator.condition, *operator.effect)))
        facts.update((fact, None) for fact in enumerate(state))
        self._bit = {fact: 1 << number for number, fact in enumerate(facts)}
        self._of_variable: dict[int, _Mask] = defaultdict(int)
        for (variable, _), bit in self._bit.items():
            self._of_variable[variable] |= bit

    def mask(self, facts: Iterable[Fact]) -> _Mask:
        """Return the bits of the facts."""
        return sum(self._bit[fact] for fact in set(facts))

    def step(self, operator: Operator) -> _Step:
        """Return an operator with its facts as bits."""
        changed = sum(self._of_variable[v] for v in {v for v, _ in operator.effect})
        return _Step(
            self.mask(operator.condition), ~changed, self.mask(operator.effect), operator.cost
        )


def _plans_of_part(
    operators: Sequence[Operator], state: State, goal: Sequence[Fact], cost: int, most: int
) -> tuple[list[Actions], bool] | None:
    """Return plans of exactly this cost, and whether these are all; None if that is too much."""
    bits = _Bits(operators, state, goal)
    start = bits.mask(enumerate(state))
    layers = _layers([bits.step(operator) for operator in operators], start, cost)
    if layers is None:
        return None
    suffixes, complete = _suffixes(operators, layers, bits.mask(goal), cost, _SPARE * most)
    found = sorted(suffixes.get(start, ()))
    chosen = found if len(found) <= most else Random(0).sample(found, most)
    plans = [_ordered(operators, layers, suffixes, start, plan) for plan in chosen]
    return plans, complete and len(found) <= most


def _layers(steps: Sequence[_Step], start: _Mask, cost: int) -> _Layers | None:
    """Explore what can be reached within the cost, each state at the least it takes."""
    numbered = [(index, s.needs, s.keeps, s.sets, s.cost) for index, s in enumerate(steps)]
    least = {start: 0}
    waiting = [(0, start)]
    layers: _Layers = defaultdict(dict)
    while waiting:
        spent, here = heapq.heappop(waiting)
        if here in layers[spent] or least[here] < spent:
            continue
        following = layers[spent][here] = []
        for index, needs, keeps, sets, own_cost in numbered:
            then = spent + own_cost
            if here & needs != needs or then > cost:
                continue
            there = here & keeps | sets
            known = least.get(there, cost + 1)
            if then <= known:
                following.append((index, there))
            if then < known:
                least[there] = then
                heapq.heappush(waiting, (then, there))
        if len(least) > _MOST_STATES:
            return None
    return layers


def _suffixes(
    operators: Sequence[Operator], layers: _Layers, goal: _Mask, cost: int, most: int
) -> tuple[dict[_Mask, set[int]], bool]:
    """Return what may follow each state on an optimal path, and whether that is everything.

    Where more than `most` plans follow a state, a sample of them stays.
    """
    suffixes: dict[_Mask, set[int]] = {
        here: {0} for here in layers.get(cost, ()) if here & goal == goal
    }
    complete = True
    ones = _ones(operators)
    for spent in sorted(layers, reverse=True):
        for here, steps in layers[spent].items():
            following = suffixes.get(here, set())
            for index, there in steps:
                # A state that another path reaches at less cost is on no optimal path here.
                if there in layers.get(spent + operators[index].cost, ()):
                    one = ones[index]
                    following |= {one + suffix for suffix in suffixes.get(there, ())}
            if len(following) > most:
                following = set(Random(0).sample(sorted(following), most))
                complete = False
            if following:
                suffixes[here] = following
    return suffixes, complete


def _ones(operators: Sequence[Operator]) -> list[int]:
    """Return what each operator adds to a plan's number: the same under the same name.

    An action whose condition has alternatives is several operators.
    """
    numbers: dict[str, int] = {}
    return [1 << _BITS * numbers.setdefault(o.name, len(numbers)) for o in operators]


def _ordered(
    operators: Sequence[Operator],
    layers: _Layers,
    suffixes: dict[_Mask, set[int]],
    start: _Mask,
    plan: int,
) -> Actions:
    """Return a plan's actions in an order that can be carried out."""
    names = []
    ones = _ones(operators)
    spent, here = 0, start
    while plan:
        index, here, plan = next(_first_steps(layers[spent][here], ones, suffixes, plan))
        names.append(operators[index].name)
        spent += operators[index].cost
    return tuple(names)


def _first_steps(
    steps: Sequence[tuple[int, _Mask]],
    ones: Sequence[int],
    suffixes: dict[_Mask, set[int]],
    plan: int,
) -> Iterator[tuple[int, _Mask, int]]:
    """Yield the steps with which a plan can begin, and what then remains of it."""
    for index, there in steps:
        rest = plan - ones[index]
        if rest >= 0 and rest in suffixes.get(there, ()):
            yield index, there, rest
