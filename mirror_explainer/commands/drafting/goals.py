"""Candidate goals: the robot's own and those seen, and what is like them."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from mirror_explainer.commands.drafting.patterns import Pattern, World

# More candidates than these are left out, as comments.
MOST_CANDIDATES = 600
# How much is expected of goals of nearly the same form, beside those of the same.
_NEARLY = 0.3
_PART = 'with a part less'


@dataclass(frozen=True)
class Candidate:
    """A pattern, how often goals of this form are expected, and how many it stands for.

    `why` says where it comes from, `left_out` why it is only proposed, '' if it is taken.
    """

    pattern: Pattern
    weight: float
    count: int
    why: str
    left_out: str = ''


def candidates(world: World, own: Sequence[str], seen: Mapping[str, int]) -> list[Candidate]:
    """Return the candidates: the goals seen, what is like the robot's own and them, and parts.

    `own` are the parts of the robot's goal, which counts as seen once more where others
    were seen; `seen` are goals with how often. A goal that is new is expected as often as one
    was: once for each different goal, of its form (Witten and Bell's estimate), and once
    for each form (Laplace's). Raises InputError for a goal that is none of the task's.
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
    why = 'like them' if seen else 'like its own'
    for parts in often:
        _add(world, found, world.like(parts), why, weight=1.0, first=1.0)
    for parts in often:
        for fewer in _without_one(parts):
            _add(world, found, world.like(fewer), _PART, _NEARLY / len(parts))
    for parts in often:
        _add(world, found, world.with_one_twice(parts), 'with one object for two', _NEARLY)
    return list(_bounded(world, found, needless=_PART if seen else ''))


def _add(
    world: World,
    found: dict[Pattern, tuple[float, str]],
    patterns: Sequence[Pattern],
    why: str,
    weight: float,
    first: float = 0.0,
) -> None:
    """Add patterns, which share the weight.

    Of two that are alike, where one stands for all goals of the other, the wider one gets the
    weights of both; `first` is for those that are the first of their form.
    """
    for pattern in patterns:
        share = weight / len(patterns)
        wider = next((known for known in found if _stands_for(world, known, pattern)), None)
        if wider:
            found[wider] = (found[wider][0] + share, found[wider][1])
            continue
        narrower = [known for known in found if known.types and _stands_for(world, pattern, known)]
        absorbed = [found.pop(known) for known in narrower]
        reason = absorbed[0][1] if absorbed else why
        share += sum(before for before, _ in absorbed) if absorbed else first / len(patterns)
        found[pattern] = (share, reason)


def _stands_for(world: World, wider: Pattern, narrower: Pattern) -> bool:
    """Say whether a pattern stands for all the goals of another."""
    if sorted(map(_head, wider.parts)) != sorted(map(_head, narrower.parts)):
        return False
    goals, others = (
        {frozenset(goal) for goal in world.goals(pattern)} for pattern in (wider, narrower)
    )
    return goals >= others


def _bounded(
    world: World, found: Mapping[Pattern, tuple[float, str]], needless: str
) -> Iterator[Candidate]:
    """Yield the candidates, those taken as long as they are not too many together.

    Those that come from `needless` are left out: where it is known what the robot does, a
    listener allows for goals with a part less without being told, and for each as much.
    """
    total = 0
    for pattern, (weight, why) in found.items():
        count = world.count(pattern)
        left_out = ''
        if why == needless:
            left_out = 'a listener allows for that anyway; take in what it does'
        elif total and total + count > MOST_CANDIDATES:
            left_out = 'too many beside the others; choose'
        else:
            total += count
        yield Candidate(pattern, weight, count, why, left_out)


def _head(part: str) -> str:
    return part.split()[0]


def _without_one(parts: Sequence[str]) -> Iterator[tuple[str, ...]]:
    """Yield a goal's parts without one of them, for each one, if any is left."""
    if len(parts) > 1:
        for left_out in range(len(parts)):
            yield tuple(part for i, part in enumerate(parts) if i != left_out)
