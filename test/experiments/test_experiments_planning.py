"""The benchmarks of planning: what they measure on the warehouse, and how they tell bad input."""

import json
from pathlib import Path

import pytest

from mirror_explainer.experiments.benchmark.dataset import Listed, listed_locations, manifest
from mirror_explainer.experiments.planning import plans_per_belief, scale, speed
from mirror_explainer.experiments.planning.robots import robots
from mirror_explainer.planning import Planner, Status

ENTRY = {'domain': 'rooms', 'instance': 'rooms_p01', 'obs100_len': 7, 'lmcut_tier': 'easy'}


def listed(folder: Path, *entries: object) -> Path:
    """A data set of one instance, and a manifest of these entries."""
    instance = folder / 'rooms' / 'rooms_p01'
    instance.mkdir(parents=True)
    (instance / 'template.pddl').write_text('(define (problem p) (:goal (and <HYPOTHESIS>)))')
    (folder / 'manifest.json').write_text(json.dumps({'instances': entries}))
    return folder


def test_the_fast_way_is_set_beside_one_call_a_belief(capsys) -> None:
    assert speed.main(['--only', 'warehouse', '--sample', '1']) == 0

    [row] = [
        line for line in capsys.readouterr().out.split('\n') if line.startswith('| warehouse')
    ]
    assert row.split(' | ')[1] == '64'  # 4 goals × 2⁴ states
    assert row.endswith(' 2 |')  # a cost for each state of the world: before and after a step


def test_what_is_lost_with_fewer_plans_is_told_for_every_number_of_them(capsys) -> None:
    assert plans_per_belief.main(['--only', 'choices', '--renamings', '1']) == 0

    rows = [line for line in capsys.readouterr().out.split('\n') if line.startswith('| warehouse')]
    lost, renamed = rows[:-1], rows[-1]
    assert [row.split(' | ')[1] for row in lost] == ['1', '3', '10', '30', '100', '300']
    assert lost[-1].endswith(' 0.0% |')
    assert renamed.count(' of 4 ') == 6  # one renaming, N = 1 … 4


@pytest.mark.parametrize('command', [speed, plans_per_belief])
def test_a_data_set_that_cannot_be_used_is_told_in_words(command, tmp_path, capsys) -> None:
    assert command.main(['--pucrs', str(tmp_path / 'nowhere')]) == 2
    assert 'there is no such folder' in capsys.readouterr().err

    (listed(tmp_path) / 'manifest.json').unlink()
    assert command.main(['--pucrs', str(tmp_path)]) == 2
    assert 'manifest.json' in capsys.readouterr().err


def test_a_manifest_says_which_instances_are_hard(tmp_path) -> None:
    dataset = listed(tmp_path, ENTRY, {**ENTRY, 'instance': 'rooms_p02', 'lmcut_tier': 'hard'})

    assert manifest(dataset)[1] == Listed('rooms', 'rooms_p02', hard=True, observed=7)
    assert [location.name for location in listed_locations(dataset, hard=False)] == ['rooms_p01']


def test_a_manifest_that_lists_what_is_not_there_is_an_error(tmp_path) -> None:
    with pytest.raises(ValueError, match='what is not there: rooms/rooms_p02'):
        listed_locations(listed(tmp_path, {**ENTRY, 'instance': 'rooms_p02'}), hard=False)


def test_robots_of_every_family_are_planned_for_and_set_beside_plain_searches(capsys) -> None:
    assert scale.main(['--only', 'hospital, 1 packs', '--sample', '1']) == 0

    [row] = [line for line in capsys.readouterr().out.split('\n') if line.startswith('| hospital')]
    assert row.split(' | ')[1] == '40'  # 10 goals × 2² states, none unknown


def test_every_robot_of_the_families_has_goals_that_can_be_reached() -> None:
    with Planner(planning_timeout=60.0) as planner:
        for robot in robots()[::3]:
            [result] = planner.plan(robot.space, robot.beliefs[:1]).results
            assert result.status is Status.SOLVED, robot.name
