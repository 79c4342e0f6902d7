"""Which candidates the robot can reach from where it is: a few of each are planned for first."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from mirror_explainer.commands.drafting.goals import Candidate
from mirror_explainer.commands.drafting.patterns import Pattern, World
from mirror_explainer.planning import Belief, BeliefSpace, Planner, Status

# So many goals of each candidate are tried before all of it.
_FIRST = 3


def within_reach(
    world: World, candidates: Sequence[Candidate], planner: Planner, deadline: float
) -> list[Candidate]:
    """Return the candidates, those left out of which no goal can be reached, as is proved.

    Planning takes `deadline` seconds at most. Raises PlanningError and InputError as
    `Planner.plan` does.
    """
    goals = {
        c.pattern: list({frozenset(goal): goal for goal in world.goals(c.pattern)}.values())
        for c in candidates
        if not c.left_out
    }
    first = {pattern: found[:: max(1, len(found) // _FIRST)] for pattern, found in goals.items()}
    hard = _out_of_reach(world, first, planner, deadline / 2)
    all_of_it = {pattern: goals[pattern] for pattern in hard}
    out = _out_of_reach(world, all_of_it, planner, deadline / 2)
    return [
        replace(c, left_out='none can be reached as things are') if c.pattern in out else c
        for c in candidates
    ]


def _out_of_reach(
    world: World,
    goals: Mapping[Pattern, Sequence[tuple[str, ...]]],
    planner: Planner,
    deadline: float,
) -> set[Pattern]:
    """Return the patterns none of whose goals, as given, can be reached."""
    texts = tuple(f'(and {" ".join(goal)})' for some in goals.values() for goal in some)
    if not texts:
        return set()
    space = BeliefSpace(world.task.domain, world.task.problem, texts)
    asked = [Belief(index) for index in range(len(texts))]
    results = iter(planner.plan(space, asked, deadline=deadline).results)
    statuses = {pattern: {next(results).status for _ in some} for pattern, some in goals.items()}
    return {pattern for pattern, found in statuses.items() if found == {Status.UNSOLVABLE}}
