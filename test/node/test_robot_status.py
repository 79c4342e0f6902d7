"""What a robot is doing by one message after the other, with their times, and no thread."""

import re
from functools import cache

import pytest
from test_episodes import LINES, PROBLEMS
from test_live_explainer import DOMAIN, PLAN, PROBLEM

from mirror_explainer.errors import InputError, NoPlanError
from mirror_explainer.node.inputs import Inputs, Text
from mirror_explainer.node.moment import Moment
from mirror_explainer.node.robot_status import RobotStatus
from mirror_explainer.pddl import Task, read_task
from mirror_explainer.pddl.situation import Situation


@cache
def read(problem: str) -> Task:
    return read_task(DOMAIN, problem)


def with_goal(goal: str, problem: str = PROBLEM) -> str:
    return f'{problem[: problem.index("(:goal")]}(:goal (and {goal})))'


def told(done: int, lines: list[str] = LINES) -> str:
    """Return the progress of a robot that is at the step after so many."""
    return '\n'.join([*(f'done: {line}' for line in lines[:done]), f'running: {lines[done]}'])


class Robot:
    """Publishes texts one after the other, a millisecond apart; `passes` makes it later."""

    def __init__(self, *common: str) -> None:
        self._common = common  # the parts of all goals that the listener thinks of
        self._status = RobotStatus()
        self._inputs = Inputs()
        self._now = 0.0

    def passes(self, seconds: float) -> None:
        self._now += seconds

    def publish(self, **texts: str) -> Situation:
        """Publish texts in this order, which are read together; return what comes of it."""
        for name, text in texts.items():
            self.passes(0.001)
            self._inputs = self._inputs.hearing(name, Text(text, f'/{name}', Moment(self._now)))
        assert self._inputs.problem
        task = read(self._inputs.problem.text)
        return self._status.update(DOMAIN, self._inputs, task, common=self._common)


def shown(situation: Situation) -> tuple[int, str, str]:
    """Return the episode's number, why it began, and "ra" for a step running, one ahead."""
    progress = ''.join(step.value[0] for step in situation.progress.steps)
    return situation.number, situation.reason, progress[:6]


@pytest.fixture
def robot() -> Robot:
    """A robot in the midst of its plan, as it told a while ago."""
    robot = Robot()
    robot.publish(problem=PROBLEM, progress=told(0), plan=PLAN)
    robot.passes(5.0)
    assert shown(robot.publish(progress=told(5))) == (1, 'first', 'dddddr')
    robot.passes(1.5)
    return robot


BEGIN = {'problem': PROBLEM, 'progress': told(0), 'plan': PLAN}


@pytest.mark.parametrize(
    'order',
    [['problem', 'progress', 'plan'], ['plan', 'progress', 'problem'], ['plan', 'progress']],
)
def test_a_plan_that_comes_again_with_its_first_progress_is_started_again(
    robot: Robot, order: list[str]
) -> None:
    begun = {name: BEGIN[name] for name in order}

    assert shown(robot.publish(**begun)) == (2, 'restarted', 'raaaaa')
    robot.passes(5.0)
    assert shown(robot.publish(progress=told(5))) == (2, 'restarted', 'dddddr')
    robot.passes(5.0)
    assert shown(robot.publish(**begun)) == (3, 'restarted', 'raaaaa')


def test_so_it_is_where_the_plan_comes_behind_its_progress_or_there_was_none_meanwhile(
    robot: Robot,
) -> None:
    with pytest.raises(InputError, match=rf'{re.escape(LINES[0])} was done, and is not any more'):
        robot.publish(progress=told(0))
    assert shown(robot.publish(plan=PLAN)) == (2, 'restarted', 'raaaaa')
    robot.publish(progress=told(5))
    with pytest.raises(NoPlanError):
        robot.publish(plan='')
    assert shown(robot.publish(**BEGIN)) == (3, 'restarted', 'raaaaa')


def test_a_round_of_the_same_texts_is_one_more(robot: Robot) -> None:
    robot.publish(progress='\n'.join(f'done: {line}' for line in LINES))

    assert shown(robot.publish(**BEGIN)) == (2, 'again', 'raaaaa')


def test_a_robot_that_repeats_its_plan_all_the_time_is_told_that_it_names_too_little(
    robot: Robot,
) -> None:
    robot.publish(plan=PLAN)

    assert shown(robot.publish(progress=told(6))) == (1, 'first', 'dddddd')
    robot.publish(plan=PLAN)
    with pytest.raises(InputError, match='was done, and is not any more'):
        robot.publish(progress=f'running: {LINES[7]}')


@pytest.mark.parametrize(('first', 'second'), [('problem', 'plan'), ('plan', 'problem')])
def test_where_what_was_done_is_undone_by_the_state_the_same_plan_is_started_again(
    robot: Robot, first: str, second: str
) -> None:
    robot.publish(**{first: BEGIN[first]})
    assert shown(robot.publish(**{second: BEGIN[second]})) == (2, 'restarted', 'aaaaaa')
    # It is told of the plan that began, not of the one before.
    assert shown(robot.publish(progress=told(1))) == (2, 'restarted', 'draaaa')
    robot.passes(1.5)
    assert shown(robot.publish(problem=PROBLEM, plan=PLAN)) == (3, 'restarted', 'aaaaaa')
    robot.publish(progress=told(0))
    robot.publish(progress='\n'.join(f'done: {line}' for line in LINES))
    robot.passes(1.5)
    assert shown(robot.publish(problem=PROBLEM, plan=PLAN)) == (4, 'again', 'aaaaaa')


@pytest.mark.parametrize(
    'again',
    [
        {'plan': PLAN},  # nobody says that the state is the first
        {'problem': PROBLEM},
        {'problem': PROBLEMS[4], 'plan': PLAN},  # as the robot was on its way
        {'problem': PROBLEMS[5], 'plan': PLAN},
    ],
)
def test_else_what_comes_again_is_a_repetition(robot: Robot, again: dict[str, str]) -> None:
    assert shown(robot.publish(**again)) == (1, 'first', 'dddddr')


@pytest.mark.parametrize('period', [0.1, 0.4, 5.0])
def test_of_a_robot_that_repeats_problem_and_plan_progress_is_believed(period: float) -> None:
    robot = Robot()
    robot.publish(problem=PROBLEM, plan=PLAN, progress=told(0))
    for done in (1, 3, 5):
        for _ in range(round(6.0 / period)):
            robot.passes(period)
            robot.publish(problem=PROBLEM, plan=PLAN)

        assert shown(robot.publish(progress=told(done)))[0] == 1


def test_a_robot_that_has_not_started_again_after_all_is_believed_to_repeat_its_plan(
    robot: Robot,
) -> None:
    assert shown(robot.publish(problem=PROBLEM, plan=PLAN))[:2] == (2, 'restarted')
    robot.publish(progress=told(6))
    robot.passes(1.5)

    assert shown(robot.publish(problem=PROBLEM, plan=PLAN)) == (2, 'restarted', 'dddddd')


def test_a_robot_that_begins_with_its_plan_once_more_tries_again_what_failed(robot: Robot) -> None:
    failed = told(5).replace('running', 'failed')
    assert robot.publish(progress=failed).progress.failed == (5,)
    robot.passes(1.5)
    situation = robot.publish(problem=PROBLEMS[5], plan=PLAN)

    assert (situation.progress.failed, *shown(situation)) == ((), 1, 'first', 'ddddda')


@pytest.mark.parametrize('is_told_once_more', [False, True])
def test_the_end_of_a_plan_is_not_told_of_the_next_one_though_it_came_just_before(
    robot: Robot, is_told_once_more: bool
) -> None:
    over = {'progress': '\n'.join(f'done: {line}' for line in LINES)}
    robot.publish(**over)
    robot.passes(0.4)
    late = over if is_told_once_more else {}

    begun = robot.publish(problem=with_goal('(robot-at center)'), plan=LINES[0], **late)
    assert shown(begun) == (2, 'new task', 'a')
    assert shown(robot.publish(**over)) == (2, 'new task', 'a')
    assert shown(robot.publish(progress=f'running: {LINES[0]}')) == (2, 'new task', 'r')
    with pytest.raises(InputError, match='is no step of the plan'):
        robot.publish(progress=f'running: {LINES[3]}')


def test_progress_that_is_too_long_is_refused_like_any_other_message(robot: Robot) -> None:
    with pytest.raises(InputError, match='/progress: its bytes .* max_message_bytes allows'):
        robot.publish(progress=told(6) + ';' * 1_000_000)

    assert shown(robot.publish(progress=told(6))) == (1, 'first', 'dddddd')


HOME = '(robot-at left)'
CUBE, CIRCLE = '(holding blue_cube)', '(holding red_circle)'
TO_CUBE = LINES[:4]
TO_CIRCLE = [*LINES[:2], *LINES[5:7]]
BACK = ['(move doors center)', '(move center left)']
FOR_CUBE = [*TO_CUBE, LINES[4], *BACK]
FOR_CIRCLE = [*TO_CIRCLE, LINES[7], *BACK]


def test_that_robots_come_home_makes_no_two_tasks_alike() -> None:
    robot = Robot()
    robot.publish(problem=with_goal(CUBE + HOME), plan='\n'.join(FOR_CUBE))
    robot.publish(progress=told(2, FOR_CUBE))
    there = PROBLEMS[2]
    detour = robot.publish(
        problem=with_goal(CIRCLE + HOME, there), plan='\n'.join(FOR_CIRCLE[2:]), progress=''
    )
    robot.publish(progress='\n'.join(f'done: {line}' for line in FOR_CIRCLE[2:]))
    robot.passes(5.0)
    back = robot.publish(problem=with_goal(CUBE + HOME), plan='\n'.join(FOR_CUBE), progress='')

    assert (detour.reason, detour.like_before, detour.is_detour) == ('new task', False, True)
    assert (back.reason, back.like_before) == ('resumed', False)


@pytest.mark.parametrize('common', [(), ('robot-at(left)',)])
def test_a_robot_that_comes_home_in_the_midst_of_its_task_goes_back_to_it(
    common: tuple[str, ...],
) -> None:
    robot = Robot(*common)
    robot.publish(problem=with_goal(CUBE + HOME), plan='\n'.join(FOR_CUBE))
    robot.publish(progress=told(2, FOR_CUBE))
    home = robot.publish(
        problem=with_goal(HOME, PROBLEMS[2]), plan='\n'.join(BACK), progress=told(0, BACK)
    )
    robot.publish(progress='\n'.join(f'done: {line}' for line in BACK))
    robot.passes(5.0)
    back = robot.publish(problem=with_goal(CUBE + HOME), plan='\n'.join(FOR_CUBE), progress='')

    assert (home.reason, home.like_before, home.is_detour) == ('new task', True, True)
    assert (back.reason, back.like_before, back.is_detour) == ('resumed', False, False)


@pytest.mark.parametrize('common', [(), ('robot-at(left)',)])
def test_what_all_goals_have_in_common_makes_no_two_of_them_alike(common: tuple[str, ...]) -> None:
    robot = Robot(*common)
    robot.publish(problem=with_goal(CUBE + HOME, PROBLEMS[2]), plan='\n'.join(FOR_CUBE[2:]))
    other = with_goal(CIRCLE + HOME, PROBLEMS[2])

    assert robot.publish(problem=other, plan='\n'.join(FOR_CIRCLE[2:])).like_before == (not common)


def test_a_goal_that_loses_what_is_achieved_is_another_plan_up_to_the_way_home() -> None:
    robot = Robot('robot-at(left)')
    both = with_goal(CUBE + CIRCLE + HOME)
    robot.publish(problem=both, plan='\n'.join([*LINES[:8], *BACK]))
    rests = [(CIRCLE + HOME, 5, [*LINES[5:8], *BACK]), (HOME, 8, BACK)]
    for goal, done, left in rests:
        problem = with_goal(goal, PROBLEMS[done])

        situation = robot.publish(problem=problem, plan='\n'.join(left))
        assert (situation.reason, situation.like_before) == ('new task', True)
        assert not situation.is_detour
