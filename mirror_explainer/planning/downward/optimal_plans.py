"""All optimal plans up to order, once the optimal cost is known.

Two plans with the same actions in another order are one observation to the
listener, so a plan counts here by how often it has each action. The states of one order
of each plan are few (`optimal_paths.py`), however many the orders are; and operators that
have nothing to do with one another are looked at apart.
"""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from random import Random

from mirror_explainer.planning.downward.ground_task import Fact, Operator, State
from mirror_explainer.planning.downward.independent_parts import independent_parts
from mirror_explainer.planning.downward.optimal_paths import (
    Effort,
    Layers,
    Mask,
    optimal_paths,
)

Actions = tuple[str, ...]

# A plan is one number, the sum of its actions' numbers. These are drawn with so many bits that
# plans with other actions have other sums: that two of a million had the same is less likely
# than once in 2^88 tasks.
_BITS = 128

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
    effort: Effort,
) -> OptimalPlans | None:
    """Return up to `most` optimal plans that use these operators only; costs are positive.

    `known` is one of them. If there are more, a sample is drawn, which the order
    of the operators decides. None if that is more than the effort allows.
    """
    parts: list[tuple[list[Actions], bool]] = []
    for part in independent_parts(operators):
        names = {operator.name for operator in part}
        own_goal = [fact for fact in goal if any(_concerns(o, fact[0]) for o in part)]
        counted = {operator.name: operator.cost for operator in part}
        cost = sum(counted[name] for name in known if name in names)
        plans = _plans_of_part(part, state, own_goal, cost, most, effort)
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


def _plans_of_part(
    operators: Sequence[Operator],
    state: State,
    goal: Sequence[Fact],
    cost: int,
    most: int,
    effort: Effort,
) -> tuple[list[Actions], bool] | None:
    """Return plans of exactly this cost, and whether these are all; None if that is too much."""
    paths = optimal_paths(operators, state, goal, cost, effort)
    if paths is None:
        return None
    ones = _ones(operators)
    suffixes, complete = _suffixes(operators, ones, paths.layers, paths.ends, _SPARE * most)
    found = sorted(suffixes.get(paths.start, ()))
    chosen = found if len(found) <= most else Random(0).sample(found, most)
    plans = [
        _ordered(operators, ones, paths.layers, suffixes, paths.start, plan) for plan in chosen
    ]
    return plans, paths.complete and complete and len(found) <= most


def _suffixes(
    operators: Sequence[Operator],
    ones: Sequence[int],
    layers: Layers,
    ends: Iterable[Mask],
    most: int,
) -> tuple[dict[Mask, set[int]], bool]:
    """Return what may follow each state on an optimal path, and whether that is everything.

    Where more than `most` plans follow a state, a sample of them stays.
    """
    suffixes: dict[Mask, set[int]] = {here: {0} for here in ends}
    complete = True
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
    random, numbers = Random(0), dict[str, int]()
    return [numbers.setdefault(o.name, random.getrandbits(_BITS)) for o in operators]


def _ordered(
    operators: Sequence[Operator],
    ones: Sequence[int],
    layers: Layers,
    suffixes: dict[Mask, set[int]],
    start: Mask,
    plan: int,
) -> Actions:
    """Return a plan's actions in an order that can be carried out."""
    names = []
    spent, here = 0, start
    while plan:
        index, here, plan = next(_first_steps(layers[spent][here], ones, suffixes, plan))
        names.append(operators[index].name)
        spent += operators[index].cost
    return tuple(names)


def _first_steps(
    steps: Sequence[tuple[int, Mask]],
    ones: Sequence[int],
    suffixes: dict[Mask, set[int]],
    plan: int,
) -> Iterator[tuple[int, Mask, int]]:
    """Yield the steps with which a plan can begin, and what then remains of it."""
    for index, there in steps:
        rest = plan - ones[index]
        if rest >= 0 and rest in suffixes.get(there, ()):
            yield index, there, rest
