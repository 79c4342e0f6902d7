"""One task told from beginning to end by the explainer of the node; nothing is planned twice."""

import json
import time
from collections.abc import Callable
from typing import Any

import pytest
import sliding_tiles
from conftest import WAREHOUSE
from patience import eventually
from test_live_explainer import (
    DOMAIN,
    PLAN,
    PROBLEM,
    USER_MODEL,
    Operator,
    operator,
    puzzled,
)

from mirror_explainer.node.diagnostics import Level
from mirror_explainer.node.inputs import Text
from mirror_explainer.node.moment import Moment
from mirror_explainer.node.surroundings import Others
from mirror_explainer.pddl import read_task
from mirror_explainer.pddl.plan_text import read_plan
from mirror_explainer.pddl.problem_text import with_state
from mirror_explainer.pddl.simulation import carry_out
from mirror_explainer.planning import Planner

__all__ = ['operator', 'puzzled']  # the fixtures
LINES = [line for line in PLAN.split('\n') if line.startswith('(')]
STATES = carry_out(read_task(DOMAIN, PROBLEM), read_plan(PLAN)).states
PROBLEMS = [with_state(PROBLEM, state) for state in STATES]
# What is said after so many steps, at most two sentences.
CUBE, CIRCLE = 'a blue cube', 'a red circle'
TOLD = {
    0: 'I will grab a blue cube and a red circle.',
    4: 'I have grabbed a blue cube.\nI will grab a red circle.',
    6: 'I have grabbed a blue cube.\nI will grab a red circle.',
    7: 'I have grabbed a blue cube and a red circle.',
    10: 'I have grabbed a blue cube and a red circle.\nI am done.',
}
# How a robot tells where it is: the plan that remains, the whole plan again, or only its state.
WAYS: dict[str, Callable[[int], dict[str, str]]] = {
    'the rest of the plan': lambda done: {'plan': '\n'.join(LINES[done:])},
    'the whole plan': lambda done: {'plan': PLAN + f'; after {done} steps\n'},
    'the state alone': lambda done: {},
}


@pytest.fixture
def robot(operator) -> Operator:
    served: Operator = operator(user_model_file=USER_MODEL, n=2)
    served.publish(domain=DOMAIN, problem=PROBLEM, plan=PLAN)
    return served


def report(robot: Operator) -> dict[str, Any]:
    """Ask, and return the answer's JSON."""
    robot.answer()
    answer: dict[str, Any] = json.loads(robot.published[-1][1])
    return answer


@pytest.mark.parametrize('way', WAYS)
def test_from_the_first_step_to_the_last_nothing_is_planned_again(
    robot: Operator, way: str
) -> None:
    first = report(robot)
    for done in range(1, 11):
        robot.publish(problem=PROBLEMS[done], **WAYS[way](done))

        answer = report(robot)

        expected = ['done'] * done + ['ahead'] * (10 - done)
        assert [row['status'] for row in answer['plan']] == expected
        assert answer['episode'] == first['episode']
        assert answer['understanding'] == first['understanding']
        assert answer['seconds']['planning'] == first['seconds']['planning']
        assert answer['spoken'] == TOLD.get(done, answer['spoken'])
        assert answer['complete']
    assert first['spoken'] == TOLD[0]


def test_what_was_said_conditions_the_whole_episode(robot: Operator) -> None:
    robot.set(remember=True, n=1)
    told = [robot.answer()]
    for done in range(1, 11):
        robot.publish(problem=PROBLEMS[done])
        told.append(robot.answer())

    assert told[:3] == [
        'I will exit from the bottom door.',
        'I will grab a red circle.',
        'I will grab a blue cube.',
    ]
    assert not {'I have grabbed a blue cube.', 'I have grabbed a red circle.'} & set(told)
    assert told[3].startswith(('The rest is only details', 'You have heard all'))
    assert told[10] == 'I am done.'


def test_a_state_that_the_plan_does_not_lead_through_begins_a_new_episode(
    robot: Operator,
) -> None:
    first = report(robot)
    robot.publish(problem=PROBLEMS[4])
    report(robot)
    # Somebody has put the robot back to where it was, with what it has.
    robot.publish(
        problem=PROBLEMS[4].replace('(robot-at blue_room)', '(robot-at left)'),
        plan='\n'.join(['(move left center)', '(move center doors)', *LINES[5:]]),
    )

    second, again = report(robot), report(robot)

    assert (first['episode']['number'], first['episode']['reason']) == (1, 'first')
    assert (second['episode']['number'], second['episode']['reason']) == (2, 'replanned')
    assert second['spoken'].startswith('I have changed my plan.\nI will grab a red circle.')
    assert not again['spoken'].startswith('I have changed my plan.')


def test_another_goal_is_a_new_task(robot: Operator) -> None:
    report(robot)
    begin, end = PROBLEM.index('(:goal'), PROBLEM.rindex(')')
    robot.publish(
        problem=f'{PROBLEM[:begin]}(:goal (robot-at center)){PROBLEM[end:]}', plan=LINES[0]
    )

    second = report(robot)

    assert (second['episode']['number'], second['episode']['reason']) == (2, 'new task')
    assert second['spoken'] == 'I have a new task.\nI will navigate to the central corridor.'


def test_a_goal_that_shares_what_is_still_to_be_achieved_is_told_as_another_plan(
    robot: Operator,
) -> None:
    report(robot)
    robot.publish(
        problem=PROBLEM.replace('(holding blue_cube)', '(holding red_circle)'),
        plan='\n'.join([*LINES[:2], *LINES[5:]]),
    )

    second = report(robot)

    assert (second['episode']['number'], second['episode']['reason']) == (2, 'new task')
    assert second['spoken'].startswith('I have changed my plan.\nI will grab a red circle.')


def test_a_robot_may_tell_its_progress_itself(robot: Operator) -> None:
    report(robot)
    done = '\n'.join(f'done: {line}' for line in LINES[:3])
    robot.publish(progress=f'{done}\nrunning: {LINES[3]}\n')
    going, spoken = report(robot), robot.answer()
    robot.publish(progress=f'{done}\nfailed: {LINES[3]}')
    stuck = robot.answer()
    robot.publish(
        progress=f'{done}\nrunning: {LINES[4]}\nfailed: {LINES[3]} because it is glued\n'
        f'failed: {LINES[6]} because it is lost'
    )
    both = robot.answer()
    robot.publish(progress='')
    back = robot.refusal()
    robot.publish(progress=f'{done}\ndone: (fly away)')
    unknown = robot.refusal()

    statuses = [row['status'] for row in going['plan']]
    assert statuses == [*['done'] * 3, 'running', *['ahead'] * 6]
    assert spoken == 'I am grabbing a blue cube.\nI will grab a red circle.'
    assert stuck == (
        'I am stuck: I cannot grab a blue cube.\n'
        'I meant to grab a red circle.\nI meant to exit from the bottom door.'
    )
    assert both == (
        'I am stuck: I cannot grab a blue cube.\nIt is glued.\n'
        "I cannot grab a red circle.\nIt is lost.\nI am reaching the warehouses' doors.\n"
        'I meant to exit from the bottom door.'
    )
    assert '(move left center) was done, and is not any more' in back
    assert '/progress, line 4: (fly away) is no step of the plan' in unknown


def test_where_all_that_is_said_is_done_the_step_going_on_is_told_as_well(
    robot: Operator,
) -> None:
    done = '\n'.join(f'done: {line}' for line in LINES[:7])
    robot.publish(progress=f'{done}\nrunning: {LINES[7]}')
    on_the_way = report(robot)
    robot.publish(progress=done)
    between = report(robot)

    assert between['spoken'] == TOLD[7]
    assert on_the_way['spoken'] == f"{TOLD[7]}\nI am reaching the warehouses' doors."
    assert on_the_way['sentences'] == between['sentences']


def test_progress_in_the_plan_before_is_not_taken_for_that_in_the_next(robot: Operator) -> None:
    a_minute_ago = Moment(time.monotonic() - 60)
    progress = '\n'.join(f'done: {line}' for line in LINES)
    robot.explainer.hear('progress', Text(progress, '/progress', a_minute_ago))
    # It was heard before the plan, so it may be about another.
    assert robot.answer() == TOLD[0]

    robot.publish(progress=progress + '\n')

    assert robot.answer() == TOLD[10]


def test_a_node_that_comes_late_hears_of_a_robot_in_the_middle_of_its_plan(operator) -> None:
    late: Operator = operator(user_model_file=USER_MODEL, n=2)
    late.publish(domain=DOMAIN, problem=PROBLEMS[5], plan=PLAN)

    answer = report(late)

    assert answer['spoken'] == 'I have grabbed a blue cube.\nI will grab a red circle.'
    assert [row['status'] for row in answer['plan']] == ['done'] * 5 + ['ahead'] * 5


def test_an_edited_user_model_is_taken_up_in_the_middle_of_an_episode(
    robot: Operator, tmp_path
) -> None:
    report(robot)
    robot.publish(problem=PROBLEMS[4])
    file = tmp_path / 'user.yaml'
    text = (WAREHOUSE / 'user_model.yaml').read_text()
    file.write_text(text.replace('I will grab', 'I will fetch'))
    robot.set(user_model_file=str(file))

    answer = report(robot)

    assert answer['spoken'] == 'I have fetched a blue cube.\nI will fetch a red circle.'
    assert answer['episode']['number'] == 1


def test_progress_does_not_stop_a_search_under_way(monkeypatch, puzzled: Operator) -> None:
    begun, ended, plan = [], [], Planner.plan

    def watched(planner: Planner, *given: Any, **options: Any) -> Any:
        begun.append(given)
        try:
            return plan(planner, *given, **options)
        finally:
            ended.append(given)

    def told(done: int) -> bool:
        if not puzzled.explainer.ask().success:
            return False
        rows = json.loads(puzzled.published[-1][1])['plan']
        return [row['status'] for row in rows].count('done') == done

    monkeypatch.setattr(Planner, 'plan', watched)
    puzzled.set(answer_timeout=0.0)
    problem, steps = sliding_tiles.scrambled(moves=200, seed=200)
    puzzled.publish(problem=problem, plan=steps)
    eventually(lambda: begun, 'the planning')
    for done in range(1, 4):
        puzzled.publish(progress='\n'.join(f'done: {s}' for s in steps.split('\n')[:done]))
        eventually(lambda done=done: told(done), f'an answer after {done} steps')

    assert (len(begun), len(ended)) == (1, 0)


def test_where_planning_fails_as_a_whole_the_task_is_told_without_it_to_its_end(operator) -> None:
    robot: Operator = operator(user_model_file=USER_MODEL, n=2, planner='no-such-engine')
    robot.publish(domain=DOMAIN, problem=PROBLEM, plan=PLAN)
    told = []
    for done in (0, 4, 10):
        robot.publish(problem=PROBLEMS[done])
        answer = report(robot)
        told.append(answer['spoken'])
        assert not answer['complete']
        assert answer['planned'] == 0.0
    diagnosis = robot.explainer.diagnose(Others())

    assert told == [TOLD[0], TOLD[4], TOLD[10]]
    assert (diagnosis.level, diagnosis.values['state']) == (Level.ERROR, 'error')
    assert diagnosis.message.startswith('there is no planning engine "no-such-engine" here')
    assert diagnosis.values['warnings'] == f'answered without planning: {diagnosis.message}'
