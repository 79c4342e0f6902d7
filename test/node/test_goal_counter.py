"""Goals are counted in a file, whatever becomes of the file."""

import multiprocessing
import os
from collections.abc import Callable
from pathlib import Path

import pytest
from conftest import WAREHOUSE
from test_live_explainer import DOMAIN, PLAN, PROBLEM, Operator, operator

from mirror_explainer.input_limits import InputLimits
from mirror_explainer.listener.goals_seen import MOST_GOALS, read_goals_seen
from mirror_explainer.node.goal_counter import GoalCounter
from mirror_explainer.node.surroundings import Others
from mirror_explainer.pddl import read_task
from mirror_explainer.pddl.plan_text import read_plan
from mirror_explainer.pddl.problem_text import with_state
from mirror_explainer.pddl.simulation import carry_out
from mirror_explainer.pddl.situation import FIRST, REPLANNED, RESTARTED, RESUMED, Situation

__all__ = ['operator']  # the fixture
LIMITS = InputLimits()
LINES = [line for line in PLAN.split('\n') if line.startswith('(')]
GOAL = '(and (holding red_circle) (holding blue_cube) (outside bottom_door))'
OTHER = PROBLEM.replace('(holding blue_cube)', '(holding red_circle)')
OTHER_GOAL = '(and (holding red_circle) (holding red_circle) (outside bottom_door))'


def episode(number: int, reason: str = FIRST) -> Situation:
    """Return what counting looks at of the episode with this number."""
    return Situation(None, None, '', '', None, number, reason)


def counts(counter: GoalCounter, *goals: str, begin: int = 1) -> list[dict[str, int]]:
    """Count goals, one an episode; return what was counted before each."""
    return [
        dict(counter.count(episode(number), goal, LIMITS))
        for number, goal in enumerate(goals, start=begin)
    ]


def test_each_task_counts_once_and_is_not_among_those_before_it(tmp_path: Path):
    file = tmp_path / 'seen.yaml'
    counter = GoalCounter(str(file))

    found = counts(counter, '(a)', '(b)', '(a)')
    again = counter.count(episode(3), '(a)', LIMITS)

    assert found == [{}, {'(a)': 1}, {'(a)': 1, '(b)': 1}]
    assert again == found[-1]
    assert read_goals_seen(str(file)).counts == {'(a)': 2, '(b)': 1}


def test_a_goal_that_was_not_reached_yet_does_not_count_again(tmp_path: Path):
    counter = GoalCounter(str(tmp_path / 'seen.yaml'))
    counts(counter, '(a)')
    for number, reason in enumerate((REPLANNED, RESTARTED, RESUMED), start=2):
        counter.count(episode(number, reason), '(a)', LIMITS)
    assert read_goals_seen(str(tmp_path / 'seen.yaml')).counts == {'(a)': 1}


def test_a_node_that_is_started_anew_on_its_task_does_not_count_it_again(tmp_path: Path):
    file = tmp_path / 'seen.yaml'
    counts(GoalCounter(str(file)), '(b)', '(a)')

    anew = counts(GoalCounter(str(file)), '(a)', '(b)', '(a)')

    # What it was at is not among those before it; what comes after it is new.
    assert anew == [{'(a)': 0, '(b)': 1}, {'(a)': 1, '(b)': 1}, {'(a)': 1, '(b)': 2}]
    assert read_goals_seen(str(file)).counts == {'(a)': 2, '(b)': 2}


def test_the_same_goal_on_another_day_counts(tmp_path: Path):
    file = tmp_path / 'seen.yaml'
    counts(GoalCounter(str(file)), '(a)')
    written = file.read_text()
    assert 'taken_up:' in written
    long_ago = written[: written.index("'")] + "'2026-05-04T09:30:00+00:00'\n"
    file.write_text(long_ago)

    counts(GoalCounter(str(file)), '(a)')

    assert read_goals_seen(str(file)).counts == {'(a)': 2}


def test_without_a_file_nothing_is_counted():
    assert counts(GoalCounter(''), '(a)', '(a)') == [{}, {}]


def test_what_people_write_into_the_file_is_kept_and_its_permissions_too(tmp_path: Path):
    file = tmp_path / 'seen.yaml'
    file.write_text('goals_seen:\n  (b): 7\n')
    file.chmod(0o640)
    link = tmp_path / 'link.yaml'
    link.symlink_to(file)

    before = counts(GoalCounter(str(link)), '(a)')

    assert before == [{'(b)': 7}]
    assert read_goals_seen(str(file)).counts == {'(b)': 7, '(a)': 1}
    assert file.stat().st_mode & 0o777 == 0o640
    assert link.is_symlink()


def test_of_goals_as_rare_the_oldest_are_dropped_so_that_new_ones_come_in(tmp_path: Path):
    file = tmp_path / 'seen.yaml'
    lines = ''.join(f'  (g {number}): 1\n' for number in range(MOST_GOALS))
    file.write_text(f'goals_seen:\n{lines}')

    counts(GoalCounter(str(file)), '(new)')

    found = read_goals_seen(str(file)).counts
    assert len(found) == MOST_GOALS
    assert found['(new)'] == 1
    assert f'(g {MOST_GOALS - 1})' not in found


def break_it(file: Path) -> None:
    file.write_text('goals_seen: {(a): 1')


def make_it_a_folder(file: Path) -> None:
    file.mkdir()


def make_it_a_pipe(file: Path) -> None:
    os.mkfifo(file)


@pytest.mark.parametrize('spoil', [break_it, make_it_a_folder, make_it_a_pipe])
def test_a_file_that_cannot_be_used_is_told_and_left_alone_and_nothing_is_lost(
    tmp_path: Path, spoil: Callable[[Path], None]
):
    file = tmp_path / 'seen.yaml'
    spoil(file)
    before = file.stat()
    counter = GoalCounter(str(file))

    found = counts(counter, '(a)', '(a)')
    warning = counter.warning
    untouched = file.stat()
    file.rename(tmp_path / 'away')
    counts(counter, '(b)', begin=3)

    assert found == [{}, {'(a)': 1}]
    assert f'the goals seen are only kept in memory until this is mended: {file}' in warning
    assert (untouched.st_ino, untouched.st_mtime_ns) == (before.st_ino, before.st_mtime_ns)
    assert read_goals_seen(str(file)).counts == {'(a)': 2, '(b)': 1}
    assert counter.warning == ''
    assert os.listdir(tmp_path).count('seen.yaml') == 1
    assert len(os.listdir(tmp_path)) == 2


@pytest.mark.parametrize(
    ('path', 'reason'),
    [
        ('/sys/seen.yaml', 'Permission denied'),  # may not be written, whoever one is
        ('/nowhere/seen.yaml', 'No such file or directory'),
        ('/dev/full', 'it is a pipe or a device'),
        ('\0', 'null'),
    ],
)
def test_a_place_where_nothing_can_be_written_is_told(path: str, reason: str):
    counter = GoalCounter(path)
    assert counts(counter, '(a)', '(b)') == [{}, {'(a)': 1}]
    assert reason in counter.warning


def count_often(path: str, goal: str) -> None:
    counts(GoalCounter(path), *[goal] * 50)


def test_two_robots_may_share_a_file_and_nothing_is_lost(tmp_path: Path):
    file = str(tmp_path / 'seen.yaml')
    robots = [multiprocessing.Process(target=count_often, args=(file, g)) for g in ('(a)', '(b)')]
    for robot in robots:
        robot.start()
    for robot in robots:
        robot.join()

    assert read_goals_seen(file).counts == {'(a)': 50, '(b)': 50}


def test_a_running_explainer_counts_and_a_listener_who_knows_takes_it_into_account(
    operator, model_file, tmp_path: Path
):
    file = tmp_path / 'seen.yaml'
    file.write_text(f'goals_seen:\n  {GOAL}: 25\n')
    words = (WAREHOUSE / 'user_model.yaml').read_text()
    robot: Operator = operator(
        goals_seen_file=str(file), user_model_file=str(model_file(words + '\ngoals_seen: true\n'))
    )
    robot.publish(domain=DOMAIN, problem=PROBLEM, plan=PLAN)
    robot.answer()
    preparation = robot.explainer._updates.readiness.preparation
    states = carry_out(read_task(DOMAIN, PROBLEM), read_plan(PLAN)).states
    robot.publish(problem=with_state(PROBLEM, states[4]))  # progress
    robot.answer()
    robot.publish(problem=PROBLEM, plan=PLAN + '; again\n')  # put back: a new plan, the same goal
    robot.answer()
    robot.publish(problem=OTHER, plan='\n'.join([*LINES[:2], *LINES[5:]]))
    robot.answer()

    probabilities = {goal.goal: goal.probability for goal in preparation.prior.goals}
    assert len(probabilities) == 30
    # One of 30 equal candidates, seen 25 times: (30 · 1/30 + 25) / (30 + 25).
    assert probabilities[GOAL] == pytest.approx(26 / 55)
    assert read_goals_seen(str(file)).counts == {GOAL: 26, OTHER_GOAL: 1}


def test_goals_are_counted_before_there_is_a_user_model(operator, tmp_path: Path):
    file = tmp_path / 'seen.yaml'
    robot: Operator = operator(goals_seen_file=str(file))
    robot.publish(domain=DOMAIN, problem=PROBLEM, plan=PLAN)
    robot.answer()
    robot.publish(problem=OTHER, plan='\n'.join([*LINES[:2], *LINES[5:]]))
    robot.answer()
    assert read_goals_seen(str(file)).counts == {GOAL: 1, OTHER_GOAL: 1}

    robot.set(user_model_file=str(WAREHOUSE / 'user_model.yaml'))
    robot.answer()
    assert read_goals_seen(str(file)).counts == {GOAL: 1, OTHER_GOAL: 1}


def test_a_file_that_cannot_be_used_takes_no_answer_away(operator, tmp_path: Path):
    file = tmp_path / 'seen.yaml'
    break_it(file)
    robot: Operator = operator(
        goals_seen_file=str(file), user_model_file=str(WAREHOUSE / 'user_model.yaml')
    )
    robot.publish(domain=DOMAIN, problem=PROBLEM, plan=PLAN)

    assert robot.answer().endswith('I will exit from the bottom door.')
    warnings = robot.explainer.diagnose(Others()).values['warnings']
    assert f'until this is mended: {file}, line 1: no YAML that can be read' in warnings
