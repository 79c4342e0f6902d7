"""Candidate goals: the robot's own and those seen, and what is like them."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from mirror_explainer.commands.drafting.patterns import Pattern, World

# More candidates than these are left out, as comments.
MOST_CANDIDATES = 600
# How much is expected of goals that were never seen, for one that was.
_LIKE_SEEN, _PART = 0.1, 0.03


@dataclass(frozen=True)
class Candidate:
    """A pattern, how often goals of this form are expected, and how many it stands for.

    `why` says where it comes from; what is not `taken` is one too many.
    """

    pattern: Pattern
    weight: float
    count: int
    why: str
    taken: bool = True


def candidates(world: World, own: Sequence[str], seen: Mapping[str, int]) -> list[Candidate]:
    """Return the candidates: the goals seen, what is like the robot's own and them, and parts.

    `own` are the parts of the robot's goal, which counts as seen once more where others
    were seen; `seen` are goals with how often. Raises InputError for one that is none of the
    task's.
    """
    often = {tuple(own): 1}
    for goal, count in seen.items():
        parts = world.parts(goal)
        same = next((known for known in often if set(known) == set(parts)), parts)
        often[same] = often.get(same, 0) + count
    found: dict[Pattern, tuple[float, str]] = {}
    if seen:
        for parts, count in often.items():
            found[Pattern(parts)] = (float(count), "the robot's own goal, or one seen")
    share = _LIKE_SEEN if seen else 1.0
    for parts, count in often.items():
        for pattern in world.like(parts):
            _add(world, found, pattern, share * count, 'like them' if seen else 'like its own')
    for parts in often:
        for fewer in _without_one(parts):
            for pattern in world.like(fewer):
                _add(world, found, pattern, _PART, 'with a part less', more=False)
    return list(_bounded(world, found))


def _add(
    world: World,
    found: dict[Pattern, tuple[float, str]],
    pattern: Pattern,
    weight: float,
    why: str,
    more: bool = True,
) -> None:
    """Add a pattern, or with `more` its weight to one that stands for the same goals."""
    goals = {frozenset(goal) for goal in world.goals(pattern)}
    for known, (before, reason) in found.items():
        alike = sorted(map(_head, known.parts)) == sorted(map(_head, pattern.parts))
        if alike and goals <= {frozenset(goal) for goal in world.goals(known)}:
            found[known] = (before + weight * more, reason)
            return
    found[pattern] = (weight, why)


def _bounded(world: World, found: Mapping[Pattern, tuple[float, str]]) -> Iterator[Candidate]:
    """Yield the candidates, those taken as long as they are not too many together."""
    total = 0
    for pattern, (weight, why) in found.items():
        count = world.count(pattern)
        taken = not total or total + count <= MOST_CANDIDATES
        total += count * taken
        yield Candidate(pattern, weight, count, why, taken)


def _head(part: str) -> str:
    return part.split()[0]


def _without_one(parts: Sequence[str]) -> Iterator[tuple[str, ...]]:
    """Yield a goal's parts without one of them, for each one, if any is left."""
    if len(parts) > 1:
        for left_out in range(len(parts)):
            yield tuple(part for i, part in enumerate(parts) if i != left_out)
