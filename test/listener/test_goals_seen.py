"""The goals that a robot had, and what a listener who knows of them takes it to be up to."""

from dataclasses import replace
from pathlib import Path

import pytest
from conftest import WAREHOUSE

from mirror_explainer.errors import InputError
from mirror_explainer.listener.goals_seen import (
    MOST_GOALS,
    GoalsSeen,
    goals_seen_text,
    read_goals_seen,
    with_goals_seen,
)
from mirror_explainer.listener.user_model import CandidateGoal, UserModel, read_user_model
from mirror_explainer.pddl import read_task

DOMAIN = '(define (domain d) (:predicates (g0) (g1) (g2)))'
PROBLEM = '(define (problem p) (:domain d) (:init) (:goal (g0)))'
TASK = read_task(DOMAIN, PROBLEM)


def model(**probabilities: float) -> UserModel:
    """Return a user model with goals by the names of their atoms."""
    return UserModel(tuple(CandidateGoal(g, f'({g})', p) for g, p in probabilities.items()))


def seen(user_model: UserModel, counts: dict[str, int]) -> dict[str, float]:
    """Return P(G) after these sights."""
    return {
        goal.name: goal.probability for goal in with_goals_seen(user_model, TASK, counts).goals
    }


def test_what_the_model_says_weighs_as_much_as_one_sight_of_each_candidate():
    found = seen(model(g0=0.25, g1=0.75), {'(g0)': 6})

    # (2 · 0.25 + 6) / (2 + 6) and (2 · 0.75) / (2 + 6)
    assert found == {'g0': pytest.approx(6.5 / 8), 'g1': pytest.approx(1.5 / 8)}


def test_without_any_sight_the_model_stays_as_it_is():
    assert seen(model(g0=0.25, g1=0.75), {}) == pytest.approx({'g0': 0.25, 'g1': 0.75})


def test_goals_are_known_again_however_they_are_written_and_others_are_left_out():
    both = UserModel((*model(g0=0.5).goals, CandidateGoal('both', '(and (g0) (g1))', 0.5)))

    found = seen(both, {'(and (g1) (g0))': 2, '(AND (g0) (g1))': 1, '(g2)': 9, '(g9)': 9, '(': 1})

    # (2 · 0.5 + 3) / (2 + 3)
    assert found == pytest.approx({'g0': 1 / 5, 'both': 4 / 5})


def test_a_goal_that_the_model_rules_out_stays_ruled_out():
    assert seen(model(g0=0.0, g1=1.0), {'(g0)': 5, '(g1)': 1}) == {'g0': 0.0, 'g1': 1.0}


def test_of_candidates_that_are_the_same_goal_one_gets_the_sights():
    same = UserModel(tuple(replace(goal, goal='(g0)') for goal in model(g0=0.5, g1=0.5).goals))

    found = seen(same, {'(g0)': 2})

    assert sum(found.values()) == pytest.approx(1.0)


@pytest.mark.parametrize('text', ['', '\n', '# nothing yet\n', 'goals_seen: {}\n'])
def test_a_file_may_have_no_goals_yet(tmp_path: Path, text: str):
    file = tmp_path / 'seen.yaml'
    file.write_text(text)
    assert read_goals_seen(str(file)).counts == {}


@pytest.mark.parametrize(
    'text',
    [
        'goals_seen: [1, 2]',
        'goals_seen: {(g0): many}',
        'goals_seen: {(g0): true}',
        'goals_seen: {(g0): -1}',
        f'goals_seen: {{(g0): {10**400}}}',
        'goals_seen: {(g0): 1}\nother: 2',
        'goals_seen: {(g0): 1',
        'goals_seen: !!int x',
        'a: &a [*a]',
        '[' * 2000,
        'just words',
    ],
)
def test_a_broken_file_is_told_whatever_is_wrong(tmp_path: Path, text: str):
    file = tmp_path / 'seen.yaml'
    file.write_text(text)
    with pytest.raises(InputError, match=r'seen\.yaml'):
        read_goals_seen(str(file))


def test_all_goals_without_a_count_are_named(tmp_path: Path):
    file = tmp_path / 'seen.yaml'
    file.write_text('goals_seen: {(g0): many, (g1): 2, (g2): -1}')
    with pytest.raises(InputError, match=r'no whole number of times for \(g0\); \(g2\)$'):
        read_goals_seen(str(file))


def test_what_is_written_can_be_read_and_the_rarest_are_dropped(tmp_path: Path):
    file = tmp_path / 'seen.yaml'
    counts = {f'(g {number})': number for number in range(MOST_GOALS + 5)}
    file.write_text(goals_seen_text(GoalsSeen(counts)))

    found = read_goals_seen(str(file)).counts

    assert list(found.items()) == [*reversed(counts.items())][:MOST_GOALS]


def test_a_user_model_says_whether_its_listener_knows_of_goals_seen(model_file):
    text = (WAREHOUSE / 'user_model.yaml').read_text()
    assert not read_user_model(model_file(text)).goals_seen
    assert read_user_model(model_file(text + '\ngoals_seen: true\n')).goals_seen
