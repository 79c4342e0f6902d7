"""The benchmarks of planning: what they measure on the warehouse, and how they tell bad input."""

import json
import sys
from pathlib import Path

import pytest
from kstar import needs_kstar

from mirror_explainer.experiments.benchmark.dataset import Listed, listed_locations, manifest
from mirror_explainer.experiments.planning import plans_per_belief, scale, speed
from mirror_explainer.experiments.planning.plain_searches import PEERS, seconds_of
from mirror_explainer.experiments.planning.robots import robots
from mirror_explainer.experiments.planning.scale_tables import Row, Searches, searches_table
from mirror_explainer.planning import Planner, Status

ENTRY = {'domain': 'rooms', 'instance': 'rooms_p01', 'obs100_len': 7, 'lmcut_tier': 'easy'}


def listed(folder: Path, *entries: object) -> Path:
    """A data set of one instance, and a manifest of these entries."""
    instance = folder / 'rooms' / 'rooms_p01'
    instance.mkdir(parents=True)
    (instance / 'template.pddl').write_text('(define (problem p) (:goal (and <HYPOTHESIS>)))')
    (folder / 'manifest.json').write_text(json.dumps({'instances': entries}))
    return folder


def rows_of(told: str, *names: str) -> list[list[str]]:
    """The cells of the rows of all tables told whose names begin with one of these."""
    begins = tuple(f'| {name}' for name in names)
    lines = [line for line in told.split('\n') if line.startswith(begins)]
    return [[cell.strip() for cell in line.strip('|').split('|')] for line in lines]


def test_the_fast_way_is_set_beside_one_call_a_belief(capsys) -> None:
    assert speed.main(['--only', 'warehouse', '--sample', '1']) == 0

    row, of_domain = rows_of(capsys.readouterr().out, 'warehouse')
    assert row[1] == '64'  # 4 goals × 2⁴ states
    assert row[-1] == '2'  # a cost for each state of the world: before and after a step
    assert of_domain[1] == '1'
    assert of_domain[3] == row[3]  # the median of one


@needs_kstar
def test_what_is_lost_with_fewer_plans_is_told_for_every_number_of_them(capsys) -> None:
    assert plans_per_belief.main(['--only', 'choices', '--renamings', '1']) == 0

    told = rows_of(capsys.readouterr().out, 'warehouse', 'all')
    lost, lost_in_all, renamed, renamed_in_all = told
    assert lost[1:] == lost_in_all[1:]
    assert len(lost[1:]) == 6  # numbers of plans
    assert lost[-1] == '0.0% (0.00)'
    assert renamed[1:] == renamed_in_all[1:]
    assert all(' of 4' in cell for cell in renamed[1:])  # one renaming, N = 1 … 4


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


def test_robots_of_every_family_are_planned_for_and_set_beside_plain_searches(
    tmp_path, capsys
) -> None:
    figure = tmp_path / 'scale'
    only = ['--only', 'hospital, 1 packs', '--sample', '1', '--figure', str(figure)]
    assert scale.main(only) == 0

    planned, searched = rows_of(capsys.readouterr().out, 'hospital')
    assert planned[1] == '40'  # 10 goals × 2² states, none unknown
    assert searched[1] == '4'
    assert float(searched[3]) > 0  # the best single searches end
    assert figure.with_suffix('.svg').exists()


def test_a_peer_that_is_not_installed_is_left_out_and_named(monkeypatch) -> None:
    for package in ('up_symk', 'kstar_planner'):
        monkeypatch.setitem(sys.modules, package, None)
    installed = {peer.name: 2.0 for peer in PEERS if peer.found()}
    row = Row('a robot', 1, 0, *[1.0] * 5, 1, 0.5, 1.0, True, Searches(4, 1.5, 0.5, installed))

    heading, _, told, _, *lines = searches_table([row]).split('\n')
    assert heading.endswith('| LAMA |')
    assert told == '| a robot | 4 | 1.50 | 0.50 | 3.0 | 2.00 |'
    assert 'not installed: SymK (up-symk), K* (kstar-planner).' in lines[-1]


def test_a_plain_search_that_does_not_end_in_time_is_ended() -> None:
    assert seconds_of(['sh', '-c', 'while :; do :; done'], b'', 0.05) is None
    assert seconds_of(['sh', '-c', 'exit 12'], b'', 0.05) is None  # nothing found
    assert seconds_of(['sh', '-c', 'cat >/dev/null'], b'a task', 5.0) is not None


def test_every_robot_of_the_families_has_goals_that_can_be_reached() -> None:
    with Planner(planning_timeout=60.0) as planner:
        for robot in robots()[::3]:
            [result] = planner.plan(robot.space, robot.beliefs[:1]).results
            assert result.status is Status.SOLVED, robot.name
