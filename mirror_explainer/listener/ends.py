"""What the robot's way brings about: its ends, and those that it would have for other goals.

Of a robot whose way one cannot foresee, only its ends tell what it is up to (method,
section 1). They depend on the candidates and the run of π_R alone, and are found before any
planning.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from mirror_explainer.listener.goals import Part


@dataclass(frozen=True)
class Aim:
    """What an unforeseen way is for: a candidate goal, or one that lacks one part of it.

    `goal` is the candidate's index; `lacking` the part that this one lacks, None for the
    candidate itself. `parts` are those that are not true all the way (A), in order; `ends`
    the plan positions that achieve one, by part.
    """

    goal: int
    lacking: Part | None
    parts: tuple[Part, ...]
    ends: Mapping[Part, int]

    @property
    def positions(self) -> list[int]:
        """The plan positions that achieve a part, ascending."""
        return sorted(set(self.ends.values()))


def aims(
    goals: Sequence[Sequence[Part]],
    truth: Mapping[Part, Sequence[bool]],
    positions: Sequence[int],
) -> tuple[tuple[Aim, ...], ...]:
    """Return for each goal its own aim, and then those that lack one of its parts.

    `goals` are the candidates' parts. `truth` says whether each part holds in each of the
    T + 1 states that π_R passes through; `positions` are the T plan positions that lead
    from one to the next.
    """
    whole = [tuple(part for part in parts if not all(truth[part])) for parts in goals]
    shared = frozenset.intersection(*map(frozenset, whole)) if len(whole) > 1 else frozenset()
    candidates = {frozenset(parts) for parts in whole}
    achieved = {part: _achieving(held, positions) for part, held in truth.items()}

    def aim(goal: int, lacking: Part | None, parts: tuple[Part, ...]) -> Aim:
        ends = {part: end for part in parts if (end := achieved[part]) is not None}
        return Aim(goal, lacking, parts, ends)

    def aims_of(goal: int, parts: tuple[Part, ...]) -> Iterator[Aim]:
        yield aim(goal, None, parts)
        for lacking in parts:
            rest = tuple(part for part in parts if part != lacking)
            if lacking not in shared and rest and frozenset(rest) not in candidates:
                yield aim(goal, lacking, rest)

    return tuple(tuple(aims_of(goal, parts)) for goal, parts in enumerate(whole))


def _achieving(held: Sequence[bool], positions: Sequence[int]) -> int | None:
    """Return the position that makes a part true for the last time, None if none does."""
    rises = [
        position
        for position, before, after in zip(positions, held, held[1:], strict=False)
        if after and not before
    ]
    return rises[-1] if rises else None
