"""The states on optimal paths: of each optimal plan at least one order, and few others.

A state is a number with a bit for each fact. Two things keep the states few: of steps that do
not get in each other's way one order is enough, and a state from which too much is lacking is
on no optimal path.
"""

import functools
import math
import operator
import sys
from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from random import Random

from mirror_explainer.planning.downward.ground_task import Fact, Operator, State

# A state as one number: a bit for each fact that holds.
Mask = int

# By the cost spent: the states reached at no less, with their (operator, next state) pairs.
Layers = dict[int, dict[Mask, list[tuple[int, Mask]]]]

# Costs are integers, and sums of shares of them are off by less than this.
_ROUNDING = 0.5


@dataclass(frozen=True)
class Paths:
    """The layers of states from `start` on, and `ends`, which reach the goal at the cost.

    `complete` says that nothing was left out for want of width.
    """

    layers: Layers
    start: Mask
    ends: list[Mask]
    complete: bool


@dataclass(frozen=True)
class Effort:
    """How many steps to look at, at most; and from how many states reached at the same cost.

    Where there are more of these, a sample is drawn.
    """

    steps: int
    width: int = sys.maxsize


def optimal_paths(
    operators: Sequence[Operator], state: State, goal: Sequence[Fact], cost: int, effort: Effort
) -> Paths | None:
    """Explore what is within the optimal cost, which is positive for each operator.

    Each state is there at the least it takes. None if that is more than the effort allows.
    """
    bits = _Bits(operators, state, goal)
    start, wanted = bits.mask(enumerate(state)), bits.mask(goal)
    steps = [bits.step(each) for each in operators]
    enough, lacking = _Enough(steps, wanted), _Lacking(steps, wanted)
    least = {start: 0}
    waiting: dict[int, set[Mask]] = {0: {start}}
    layers: Layers = defaultdict(dict)
    left, random, complete = effort.steps, Random(0), True
    while waiting:
        spent = min(waiting)
        reached = sorted(here for here in waiting.pop(spent) if least[here] == spent)
        if len(reached) > effort.width:
            reached, complete = random.sample(reached, effort.width), False
        for here in reached:
            following = layers[spent][here] = []
            numbers = enough.numbers(here)
            left -= len(numbers)
            if left < 0:
                return None
            for number in numbers:
                then = spent + steps[number].cost
                there = here & steps[number].keeps | steps[number].sets
                known = least.get(there)
                if known is None and then + lacking.cost(there) > cost + _ROUNDING:
                    continue
                if known is None or then < known:
                    least[there] = then
                    waiting.setdefault(then, set()).add(there)
                if then <= least[there]:
                    following.append((number, there))
    ends = [here for here in layers[cost] if here & wanted == wanted]
    return Paths(layers, start, ends, complete)


@dataclass(frozen=True)
class _Step:
    """An operator on states as numbers: it needs some bits, keeps some, and sets some.

    It `excludes` the other values of the variables that it needs.
    """

    needs: Mask
    excludes: Mask
    keeps: Mask
    sets: Mask
    cost: int

    @property
    def brings(self) -> Mask:
        """What it makes true that need not be true before."""
        return self.sets & ~self.needs

    def disturbs(self, other: '_Step') -> bool:
        """Say whether it makes false what the other needs or sets."""
        return bool((other.needs | other.sets) & ~(self.keeps | self.sets))


class _Bits:
    """Gives each fact a bit, and so each state a number."""

    def __init__(self, operators: Sequence[Operator], state: State, goal: Sequence[Fact]) -> None:
        facts = dict.fromkeys(goal)
        for each in operators:
            facts.update(dict.fromkeys((*each.condition, *each.effect)))
        facts.update((fact, None) for fact in enumerate(state))
        self._bit = {fact: 1 << number for number, fact in enumerate(facts)}
        self._of_variable: dict[int, Mask] = defaultdict(int)
        for (variable, _), bit in self._bit.items():
            self._of_variable[variable] |= bit

    def mask(self, facts: Iterable[Fact]) -> Mask:
        """Return the bits of the facts."""
        return sum(self._bit[fact] for fact in set(facts))

    def step(self, each: Operator) -> _Step:
        """Return an operator with its facts as bits."""
        needs, sets = self.mask(each.condition), self.mask(each.effect)
        read, changed = self._all_values(each.condition), self._all_values(each.effect)
        return _Step(needs, read & ~needs, ~changed, sets, each.cost)

    def _all_values(self, facts: Iterable[Fact]) -> Mask:
        return sum(self._of_variable[variable] for variable in {v for v, _ in facts})


class _Enough:
    """Which steps to go on with in a state: some order of each optimal plan begins with one.

    These are strong stubborn sets (Wehrle and Helmert, "Efficient stubborn sets", ICAPS 2014):
    whatever brings about a goal that is open, what one of these lacks, and what gets in the way
    of one of these.
    """

    def __init__(self, steps: Sequence[_Step], goal: Mask) -> None:
        self._steps = steps
        self._goal = goal
        self._bringing: dict[Mask, int] = defaultdict(int)
        for number, step in enumerate(steps):
            for bit in _single(step.brings):
                self._bringing[bit] |= 1 << number
        self._in_the_way: dict[int, int] = {}

    def numbers(self, here: Mask) -> list[int]:
        """Return the numbers of steps that can be made, none where the goal is reached."""
        open_goals = self._goal & ~here
        chosen = to_look_at = self._bringing[open_goals & -open_goals] if open_goals else 0
        usable = []
        while to_look_at:
            number = to_look_at.bit_length() - 1
            missing = self._steps[number].needs & ~here
            if missing:
                more = self._bringing[missing & -missing]
            else:
                usable.append(number)
                more = self._disturbing(number)
            to_look_at = to_look_at ^ 1 << number | more & ~chosen
            chosen |= more
        return sorted(usable)

    def _disturbing(self, number: int) -> int:
        """Return the steps that interfere with one, a bit for each."""
        if number not in self._in_the_way:
            step = self._steps[number]
            self._in_the_way[number] = sum(
                1 << index for index, other in enumerate(self._steps) if _interfere(step, other)
            )
        return self._in_the_way[number]


def _interfere(one: _Step, other: _Step) -> bool:
    """Say whether it matters which of two steps comes first, where both can be made."""
    if one is other or one.needs & other.excludes:
        return False
    return one.disturbs(other) or other.disturbs(one)


class _Lacking:
    """What a state lacks at least until the goal: facts without which no plan goes on.

    A fact that is wanted is brought about some time; what all steps that bring it about need is
    wanted too. The cost of a step is shared evenly among the facts that it may bring, so that
    none counts twice.
    """

    def __init__(self, steps: Sequence[_Step], goal: Mask) -> None:
        self._goal = goal
        bringing: dict[Mask, list[_Step]] = defaultdict(list)
        for step in steps:
            for bit in _single(step.brings):
                bringing[bit].append(step)
        self._needed = {
            bit: functools.reduce(operator.and_, (step.needs for step in bringers))
            for bit, bringers in bringing.items()
        }
        wanted = self._closed(goal, 0)
        self._share = {
            bit: min(step.cost / (step.brings & wanted).bit_count() for step in bringing[bit])
            for bit in _single(wanted)
            if bit in bringing
        }

    def _closed(self, wanted: Mask, here: Mask) -> Mask:
        """Return what is wanted and not yet so, and what else is needed for that."""
        found = to_look_at = wanted & ~here
        while to_look_at:
            bit = to_look_at & -to_look_at
            more = self._needed.get(bit, 0) & ~here & ~found
            to_look_at = to_look_at ^ bit | more
            found |= more
        return found

    def cost(self, here: Mask) -> float:
        """Return what it takes at least from a state to the goal."""
        return sum(
            self._share.get(bit, math.inf) for bit in _single(self._closed(self._goal, here))
        )


def _single(bits: Mask) -> Iterator[Mask]:
    """Yield each bit by itself."""
    while bits:
        yield bits & -bits
        bits &= bits - 1
