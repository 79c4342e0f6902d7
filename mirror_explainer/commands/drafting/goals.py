"""Candidate goals: the robot's own and those seen, and what is like them."""

from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from mirror_explainer.commands.drafting.patterns import Pattern, World, kind_of

# More candidates than these are left out, as comments.
MOST_CANDIDATES = 600
# Of so many goals seen, the most frequent ones, patterns are made.
MOST_LIFTED = 20
# Of a goal with more parts than these, a part less is told by the listener's own doubt.
_MOST_LESSENED = 8
# How much is expected of goals of nearly the same form, beside those of the same.
_NEARLY = 0.3


@dataclass(frozen=True)
class Candidate:
    """A pattern, how often goals of this form are expected, and how many it stands for.

    `why` says where it comes from, `left_out` why it is only proposed, '' if it is taken.
    `name` is what a person calls it, '' if none did.
    """

    pattern: Pattern
    weight: float
    count: int
    why: str
    left_out: str = ''
    name: str = ''


def candidates(world: World, own: Sequence[str], seen: Mapping[str, int]) -> list[Candidate]:
    """Return the candidates: the goals seen, what is like the robot's own and them, and parts.

    `own` are the parts of the robot's goal, which counts as seen once more where others
    were seen; `seen` are goals with how often. A goal that is new is expected as often as one
    was: once for each different goal, of its form (Witten and Bell's estimate). The own
    goal with a part less, if it is new, counts as seen once where its form was seen. Raises
    InputError for a goal that is none of the task's.
    """
    often = {tuple(own): 1}
    for goal, count in seen.items():
        parts = world.parts(goal)
        same = next((known for known in often if set(known) == set(parts)), parts)
        often[same] = often.get(same, 0) + count
    frequent = sorted(often, key=lambda parts: (parts != tuple(own), -often[parts]))
    lifted = frequent[: 1 + MOST_LIFTED]
    like = {parts: world.like(parts) for parts in lifted}
    less = {parts: list(_without_one(world, parts, often if seen else ())) for parts in lifted}
    found: dict[Pattern, tuple[float, str]] = {}
    if seen:
        for parts, count in often.items():
            found[Pattern(parts)] = (float(count), _times(count, parts == tuple(own)))
        forms = [pattern for patterns in like.values() for pattern in patterns]
        for fewer in less[tuple(own)]:
            rest = _same(found, Pattern(fewer))
            if rest not in found:
                is_of_form = any(world.stands_for(form, rest) for form in forms)
                found[rest] = (1.0 if is_of_form else _NEARLY, 'its own with a part less')
    these = 'these' if lifted == frequent else f'the {MOST_LIFTED} most frequent of these'
    for parts in lifted:
        why = f'like {these}' if seen else 'like its own'
        _add(world, found, like[parts], why, weight=1.0)
    for parts in lifted:
        for fewer in less[parts]:
            _add(world, found, world.like(fewer), 'with a part less', _NEARLY / len(parts))
    for parts in lifted:
        _add(world, found, world.with_one_twice(parts), 'with one object for two', _NEARLY)
    known = often if seen else ()
    pairs = [pair for fewer in less[tuple(own)] for pair in _without_one(world, fewer, known)]
    for fewer in {frozenset(parts): parts for parts in pairs}.values():
        _add(world, found, world.like(fewer), 'with two parts less', _NEARLY**2 / len(pairs))
    for why, patterns in _of_one_kind(world, lifted, known).items():
        _add(world, found, patterns, why, _NEARLY)
    return list(_bounded(world, found))


def _times(count: int, is_own: bool) -> str:
    """Say how often a goal was seen; the robot's own counts once for now."""
    times = 'once' if count == 1 else f'{count} times'
    if is_own:
        return "the robot's own goal" + (f', {times} with this one' if count > 1 else '')
    return f'seen {times}'


def _same(found: Iterable[Pattern], goal: Pattern) -> Pattern:
    """Return the one of these goals that has the same parts in whatever order, or the goal."""
    return next((known for known in found if set(known.parts) == set(goal.parts)), goal)


def _add(
    world: World,
    found: dict[Pattern, tuple[float, str]],
    patterns: Sequence[Pattern],
    why: str,
    weight: float,
) -> None:
    """Add patterns, which share the weight.

    Of two that are alike, where one stands for all goals of the other, the wider one gets the
    weights of both.
    """
    for pattern in patterns:
        share = weight / len(patterns)
        wider = next((known for known in found if world.stands_for(known, pattern)), None)
        if wider:
            found[wider] = (found[wider][0] + share, found[wider][1])
            continue
        narrower = [known for known in found if known.types and world.stands_for(pattern, known)]
        absorbed = [found.pop(known) for known in narrower]
        reason = absorbed[0][1] if absorbed else why
        share += sum(before for before, _ in absorbed)
        found[pattern] = (share, reason)


def _bounded(world: World, found: Mapping[Pattern, tuple[float, str]]) -> Iterator[Candidate]:
    """Yield the candidates, those taken as long as they are not too many together."""
    total = 0
    for pattern, (weight, why) in found.items():
        count = world.count(pattern)
        is_too_much = total > 0 and total + count > MOST_CANDIDATES
        total += 0 if is_too_much else count
        left_out = 'too many beside the others; choose' if is_too_much else ''
        yield Candidate(pattern, weight, count, why, left_out)


def _of_one_kind(
    world: World, goals: Sequence[tuple[str, ...]], often: Collection[tuple[str, ...]]
) -> dict[str, list[Pattern]]:
    """Return patterns of one kind of part, beside what all the goals seen have, by what they are.

    First of the kinds in some goals, the robot's own first; then of what no goal has, some
    action makes true and none needs: that is made for its own sake.
    """
    each_part = {part for parts in often for part in parts}
    times = Counter(map(kind_of, each_part))
    in_all = set.intersection(*map(set, often)) if len(often) > 1 else set()
    always = {part for part in in_all if times[kind_of(part)] == 1}
    kept = tuple(part for part in goals[0] if world.holds(part) or part in always)
    kinds = {kind_of(part): part for parts in reversed(goals) for part in parts[::-1]}
    left = [part for part in kinds.values() if part not in kept]
    alone = [pattern for part in left for pattern in world.like((part, *kept)) if pattern.types]
    seen = {kind.strip('()') for kind in kinds}
    new = [world.end(predicate) for predicate in world.ends if predicate not in seen]
    return {
        'one thing alone': alone,
        'two of a kind': [both for pattern in alone for both in world.twice(pattern)],
        'all of a kind': [all_ for pattern in alone for all_ in world.all_of(pattern)],
        'never seen, but no other action needs it': [
            replace(pattern, parts=(*pattern.parts, *kept))
            for pattern in new
            if pattern.types or not world.holds(pattern.goal)
        ],
    }


def _without_one(
    world: World, parts: Sequence[str], often: Collection[tuple[str, ...]]
) -> Iterator[tuple[str, ...]]:
    """Yield a goal's parts without one of them, for each one, if anything is left to do.

    A part stays that holds already, such as where the robot parks; and of one that all the
    goals seen have one of its kind. Nothing is left out of a goal with too many parts.
    """
    if len(parts) > _MOST_LESSENED:
        return
    kinds = {kind_of(part) for part in set.intersection(*map(set, often))} if often else set()
    for left_out in range(len(parts)):
        rest = tuple(part for i, part in enumerate(parts) if i != left_out)
        stays = world.holds(parts[left_out]) or not kinds <= set(map(kind_of, rest))
        if not stays and not all(map(world.holds, rest)):
            yield rest
