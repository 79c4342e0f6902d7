"""What a listener might not know: facts whose other truth changes what a rational robot does.

Which these are the planner says: some candidate goals are planned for as things are, and with
one fact the other way round, or with several that change together. A fact without which nothing
can be done is none of them, nor one that changes no plan.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import accumulate

from mirror_explainer.commands.drafting.patterns import World
from mirror_explainer.commands.drafting.possible import Possible
from mirror_explainer.pddl import words_of
from mirror_explainer.planning import Belief, BeliefPlans, BeliefSpace, Planner, Status

MOST_FACTS = 6
MOST_GROUPS = 3  # and no more than facts, but one
# How many facts are tried, for how many goals.
_TRIED_FACTS = 40
_TRIED_GOALS = 6


@dataclass(frozen=True)
class Doubt:
    """Facts that hold or not together, and `others` that change with them.

    Where such facts hold it is enough to doubt one; where they do not, the doubt is about all.
    """

    facts: tuple[str, ...]
    others: tuple[str, ...] = ()


@dataclass(frozen=True)
class Doubts:
    """Facts to doubt, and groups of facts of which one holds, the true one first.

    `more` doubts were found than these; not `complete` if there was not time to try all.
    """

    facts: tuple[Doubt, ...]
    groups: tuple[tuple[str, ...], ...]
    more: int
    complete: bool


def doubts(
    world: World,
    goals: Sequence[tuple[str, ...]],
    robot_plan: Sequence[str],
    planner: Planner,
    deadline: float,
) -> Doubts:
    """Return what to doubt; `goals` are candidates by their parts, the robot's own first.

    Raises PlanningError and InputError as `Planner.plan` does.
    """
    possible = Possible(world, goals)
    goals = goals[:_TRIED_GOALS]
    texts = tuple(f'(and {" ".join(goal)})' for goal in goals)
    task = world.task
    space = BeliefSpace(task.domain, task.problem, texts)
    first = planner.plan(space, [Belief(g) for g in range(len(goals))], deadline=deadline / 2)
    plans = [robot_plan, *(r.plans[0].actions for r in first.results if r.status is Status.SOLVED)]
    tried = list(_tried(possible, plans))[:_TRIED_FACTS]
    groups = sorted(possible.places(robot_plan), key=lambda group: not possible.is_named(group))
    groups = groups[: 2 * MOST_GROUPS]
    changes = [frozenset(doubt.facts) for doubt in tried]
    changes += [change for group in groups for change in _moves(group)]
    named = tuple(sorted(frozenset().union(*changes))) if changes else ()
    held = frozenset(named) & task.initial_facts
    space = BeliefSpace(task.domain, task.problem, texts, named)
    beliefs = [Belief(g, held ^ change) for change in changes for g in range(len(goals))]
    asked = [*(Belief(g, held) for g in range(len(goals))), *beliefs]
    report = planner.plan(space, asked, deadline=deadline) if changes else first
    found = dict(zip(asked, report.results, strict=True)) if changes else {}
    usual = [found.get(Belief(g, held)) for g in range(len(goals))]

    def effect(change: frozenset[str]) -> list[str]:
        """Say of each goal whether a change leads to another plan."""
        results = (found[Belief(g, held ^ change)] for g in range(len(goals)))
        return [_effect(possible, *pair, change) for pair in zip(usual, results, strict=True)]

    told = [d for d in tried if {'cost', 'other'} & set(effect(frozenset(d.facts)))]
    lines = accumulate(len(doubt.facts) for doubt in told)
    written = [d for d, number in zip(told, lines, strict=True) if number <= MOST_FACTS]
    # First the places that are nearer or farther, then those that are only elsewhere: of things
    # that the goal does not name nobody would ask.
    moved = {group: [effect(change) for change in _moves(group)] for group in groups}
    farther = [group for group in groups if all(_lead_to({'cost'}, e) for e in moved[group])]
    elsewhere = [
        group
        for group in groups
        if possible.is_named(group) and all(_lead_to({'cost', 'other'}, e) for e in moved[group])
    ]
    kept = list(dict.fromkeys([*farther, *elsewhere]))
    return Doubts(
        tuple(written),
        tuple(kept[: min(MOST_GROUPS, max(1, len(told)))]),
        len(told) - len(written),
        all(result.status is not Status.UNKNOWN for result in report.results),
    )


def _tried(possible: Possible, plans: Sequence[Sequence[str]]) -> Iterator[Doubt]:
    """Yield what may be doubted: first what the robot's plan, the first one, brings about.

    Then what is about no object or one, then the rest; of each what a plan needs first.
    """
    made = list(dict.fromkeys(possible.made(plans[0])))
    needed = [fact for plan in plans for fact in possible.needed(plan)]
    few = dict.fromkeys([*made, *needed, *possible.absent()])
    seen: set[str] = set()
    for fact in sorted(few, key=lambda f: (f not in made, len(words_of(f)), f not in needed)):
        if fact not in seen:
            doubt = _doubt(possible, fact)
            seen |= {*doubt.facts, *doubt.others}
            yield doubt


def _doubt(possible: Possible, fact: str) -> Doubt:
    """Return the doubt whether a fact holds, with what changes with it."""
    holds = possible.world.task.initial_facts
    others = sorted(f for f in possible.together(fact) if (f in holds) == (fact in holds))
    return Doubt((fact,), tuple(others)) if fact in holds else Doubt((fact, *others))


def _effect(
    possible: Possible, usual: BeliefPlans | None, now: BeliefPlans, change: frozenset[str]
) -> str:
    """Say what a change does to a goal's plan: 'none' left, another 'cost', an 'other' plan."""
    if usual is None or usual.status is not Status.SOLVED:
        return ''
    if now.status is not Status.SOLVED:
        return 'none' if now.status is Status.UNSOLVABLE else ''
    if now.plans[0].cost != usual.plans[0].cost:
        return 'cost'
    return 'other' if change & set(possible.needed(usual.plans[0].actions)) else ''


def _moves(group: Sequence[str]) -> list[frozenset[str]]:
    """Return the changes that make another fact of a group true than the first."""
    return [frozenset([group[0], other]) for other in group[1:]]


def _lead_to(kinds: set[str], effects: Sequence[str]) -> bool:
    """Say whether a change has an effect of these kinds on some plan, and leaves each goal one."""
    return not kinds.isdisjoint(effects) and 'none' not in effects
