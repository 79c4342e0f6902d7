"""Drafts beside user models that were written by hand, before the drafter was tried on them.

`test/benchmarks/drafted_models.py` does the same for each two goals that may have been seen.
"""

from pathlib import Path

import pytest
from drafted import Robot

from mirror_explainer.planning import Planner

ROBOTS = Path(__file__).parent / 'drafted_robots'
# The names of two goals that each robot was seen to have, beside the one that it has now.
SEEN = {
    'kitchen': ('pancake by the window', 'salad outside'),
    'laboratory': ('sample c for lipids', 'sample a to the archive'),
    'mower': ('front and back lawn', 'front lawn with its edges'),
    'windfarm': ('turbine 1 in colour', 'turbine 4 in infrared'),
}


@pytest.fixture(scope='module')
def planner():
    """One planner for all robots."""
    with Planner(planning_timeout=10.0) as planner:
        yield planner


@pytest.mark.parametrize('name', SEEN)
def test_a_draft_has_what_is_written_by_hand_and_says_the_same_ends_or_as_telling_ones(
    name, planner, tmp_path
):
    robot = Robot(ROBOTS / name, planner)

    drafted = robot.drafted([g for g in robot.others if g.name in SEEN[name]], tmp_path)

    assert not drafted.missing
    assert drafted.found >= 0.8 * drafted.by_hand
    assert drafted.proposed <= 2 * drafted.by_hand
    for told, by_hand, tied in zip(drafted.answers, robot.answers, drafted.tied, strict=True):
        assert robot.ends(told) == robot.ends(by_hand) or tied


def test_where_a_thing_stands_that_only_the_plan_takes_is_proposed_as_well(planner, tmp_path):
    robot = Robot(ROBOTS / 'bar', planner)

    drafted = robot.drafted(robot.others[:1], tmp_path)

    assert drafted.found == drafted.by_hand
    assert drafted.proposed <= 2 * drafted.by_hand
