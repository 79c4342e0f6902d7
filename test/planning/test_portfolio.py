"""Each search of the portfolio finds the optimal costs, on whatever is left of a task."""

import os
from pathlib import Path
from random import Random

import pytest
from derived_cases import random_derived_space
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from pddl_cases import TOOLS, random_space
from plain_downward import plain_costs

from mirror_explainer.experiments.planning.cases import every_belief
from mirror_explainer.planning import Belief, BeliefSpace, Planner, Status
from mirror_explainer.planning.downward.ground_task import Operator
from mirror_explainer.planning.downward.grounding import translator
from mirror_explainer.planning.downward.grounding.pddl_lists import Lists
from mirror_explainer.planning.downward.grounding.translations import Translations
from mirror_explainer.planning.downward.portfolio import (
    FIRST_TRY,
    PLAIN,
    Try,
    next_try,
    plain,
)
from mirror_explainer.planning.downward.program import Search, downward, find_downward
from mirror_explainer.planning.downward.subject import Subjects
from mirror_explainer.planning.downward.superset_walk import SupersetWalk

SPACES = -(-int(os.environ.get('MIRROR_EXPLAINER_BELIEFS', '320')) // 40)
FOREVER = 1000.0  # s
BLIND = 'astar(blind())'


def every_subject(lists: Lists, space: BeliefSpace) -> list[Subjects]:
    """Return the space's beliefs as tasks, one by one and, where that can be, grounded at once."""
    beliefs = every_belief(space)
    grounding = translator.ground(lists)
    singles = Translations(lists, space, beliefs)
    if isinstance(grounding, str):
        return [singles]
    together = [belief for belief in beliefs if belief.goal not in grounding.hard_goals]
    initial = translator.initial_atoms(lists)
    # Each belief by itself, so that none is known by another.
    walks = [SupersetWalk(grounding, initial, [b], lists.scale, '') for b in together]
    return [*walks, singles]


def searched(subjects: Subjects, subject: object, text: bytes, member: str) -> float | None:
    """Return the cost that one search finds, None if it says that there is no plan."""
    search = Search(downward(find_downward('') or ''), text, member, FOREVER)
    outcome = search.outcome()
    assert outcome.status is not Status.UNKNOWN, (member, outcome)
    if outcome.status is Status.UNSOLVABLE:
        return None
    finding = subjects.checked(subject, outcome.plans)
    result = finding and subjects.settle(subject, finding)
    assert result, (member, outcome.plans)
    return result.plans[0].cost


def check_every_member(space: BeliefSpace) -> int:
    """Compare each search for each belief with Fast Downward called plainly; return how many."""
    lists = translator.parse(space)
    beliefs = every_belief(space)
    expected = dict(zip(beliefs, plain_costs(space, beliefs, BLIND), strict=True))
    compared = 0
    for subjects in every_subject(lists, space):
        while subjects.ready:
            subject = subjects.ready.popleft()
            cost = expected[subject.members[0]]
            finding = subjects.known(subject)
            if finding is not None:
                assert (not finding.plans) == (cost is None)
                continue
            task = subjects.search_input(subject)
            for member in task.members:
                assert searched(subjects, subject, task.text, member) == cost, member
                compared += 1
    return compared


BY_SEED = settings(
    max_examples=SPACES,
    derandomize=True,
    deadline=None,
    suppress_health_check=list(HealthCheck),
    database=None,
)


@BY_SEED
@given(seed=st.integers(0, 2**32))
def test_every_search_finds_what_fast_downward_says(seed: int) -> None:
    check_every_member(random_space(Random(seed)))


def test_every_search_for_conditional_effects_finds_what_fast_downward_says() -> None:
    spaces = (random_space(Random(seed)) for seed in range(1000))
    conditional = [space for space in spaces if '(when' in space.domain][: max(2, SPACES // 4)]

    assert sum(map(check_every_member, conditional)) > 0


@settings(BY_SEED, max_examples=max(2, SPACES // 4))
@given(seed=st.integers(0, 2**32))
def test_every_search_for_derived_predicates_finds_what_fast_downward_says(seed: int) -> None:
    check_every_member(random_derived_space(Random(seed)))


def tries(lesson: Try | None, left: float) -> list[tuple[str, float]]:
    """Return what is tried one after another on a task that no search is done with.

    What is left, and how long each takes, is counted in first tries.
    """
    tried: dict[str, float] = {}
    found = []
    while one := next_try(PLAIN, lesson, tried, left * FIRST_TRY):
        found.append((one.configuration, pytest.approx(one.seconds / FIRST_TRY)))
        tried[one.configuration] = one.seconds
        left -= one.seconds / FIRST_TRY
    return found


def test_short_tries_of_every_search_come_before_longer_ones() -> None:
    first, second, third = PLAIN

    assert tries(None, 33.0) == [
        *((member, 1.0) for member in PLAIN),
        *((member, 4.0) for member in PLAIN),
        (first, 16.0),
        (second, 2.0),
    ]


def test_lm_cut_is_first_where_operators_are_few_and_favoured_where_several_things_act() -> None:
    def moves(count: int, robots: int) -> list[Operator]:
        return [
            Operator('(move)', ((n % robots, n),), ((n % robots, -n),), 1) for n in range(count)
        ]

    few, unsure = plain(moves(100, 1))
    assert 'lmcut' in few[0]
    assert sorted(few) == sorted(PLAIN)
    assert unsure is None
    assert plain(moves(200, 1)) == (PLAIN, None)
    members, likely = plain(moves(200, 2))
    assert members == PLAIN
    assert likely
    assert 'lmcut' in next_try(members, likely, {}, FOREVER).configuration


def test_what_suited_one_task_is_tried_first_and_for_longer_at_the_next() -> None:
    first, second, third = PLAIN

    assert tries(Try(third, 0.1 * FIRST_TRY), 60.0)[:6] == [
        (third, 8.0),
        (first, 1.0),
        (second, 1.0),
        (third, 32.0),
        (first, 4.0),
        (second, 4.0),
    ]
    assert tries(Try(second, 7.0 * FIRST_TRY), 100.0)[0] == (second, 14.0)


def test_the_time_in_which_a_search_does_not_work_does_not_count(tmp_path: Path) -> None:
    slow = tmp_path / 'downward'
    slow.write_text(f'#!/bin/sh\nsleep 0.5\nexec {find_downward("")} "$@"\n')
    slow.chmod(0o755)
    with Planner(planning_timeout=0.2, downward_binary=str(slow)) as planner:
        [result] = planner.plan(TOOLS, [Belief(0)]).results

    assert result.plans[0].cost == 7 + 1
