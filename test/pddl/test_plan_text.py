"""Reading plan texts, and checking them against the task."""

import pytest

from mirror_explainer.errors import InputError
from mirror_explainer.explainer import robot_plan
from mirror_explainer.pddl import Task, read_task
from mirror_explainer.pddl.plan_check import check_plan
from mirror_explainer.pddl.plan_text import read_plan, without_dummy

MOVE, GRAB = '(move left center)', '(grab red_circle red_room)'

FORMS = {
    'plain': f'{MOVE}\n{GRAB}\n',
    'capitals': '(MOVE Left CENTER)\n(Grab RED_CIRCLE red_room)',
    'white space': '\n\n  (  move \t left   center )  \n\t\n(grab red_circle red_room)\n\n',
    'no line end': f'{MOVE}\n{GRAB}',
    'CRLF': f'{MOVE}\r\n{GRAB}\r\n; cost = 2 (unit cost)\r\n',
    'BOM': f'\ufeff{MOVE}\n{GRAB}\n',
    'Fast Downward': f'{MOVE}\n{GRAB}\n; cost = 2 (unit cost)\n',
    'comments': f'; a plan\n{MOVE} ; (grab blue_cube blue_room)\n;;\n {GRAB};\n',
    'times and durations': f'0.000: {MOVE} [1.0]\n1.000: {GRAB} [1.0]\n',
    'whole times': f'0: {MOVE}\n1: {GRAB}\n',
    'short durations': f'0.0: {MOVE} [0.001]\n0.001: {GRAB} [0.001]\n',
    'intervals': f'0: {MOVE} [0, 5]\n5: {GRAB} [5, 6]\n',
    'durations and costs': f'0.00: {MOVE} [D:1.00; C:0.10]\n1.00: {GRAB} [D:1.00; C:0.10]\n',
    'exponents': f'1e-05: {MOVE} [5]\n1.5E+01: {GRAB} [5] ; late\n',
    'out of order': f'2.5: {GRAB} [1.0]\n0.5: {MOVE} [1.0]\n',
    'out of order as numbers': f'10: {GRAB}\n9: {MOVE}\n',
    'unified-planning': (
        'SequentialPlan:\n    move(left, center)\n    grab(red_circle, red_room)\n'
    ),
    'unified-planning, timed': (
        'TimeTriggeredPlan:\n    0.0: move(left, center) [1.0]\n'
        '    1.0: grab(red_circle, red_room) [1.0]\n'
    ),
    'header': f'plan:\n{MOVE}\n{GRAB}\n',
    'header on the same line': f'Plan: {MOVE}\n{GRAB}\n',
    'FF': 'step    0: MOVE LEFT CENTER\n        1: GRAB RED_CIRCLE RED_ROOM\n',
    'FF in parentheses': f'step 0: {MOVE}\n1: {GRAB}',
}


@pytest.mark.parametrize('text', FORMS.values(), ids=FORMS)
def test_every_form_of_a_plan_reads_as_the_same_actions(text: str) -> None:
    steps = read_plan(text)

    assert [step.action for step in steps] == [MOVE, GRAB]


def test_actions_without_arguments_are_read_in_every_form() -> None:
    for text in ('(wait)', '0: (wait) [1]', 'wait()', 'SequentialPlan:\n    wait', '0: WAIT'):
        assert [step.action for step in read_plan(text)] == ['(wait)']


@pytest.mark.parametrize('text', ['', '  \n\t\n', '; cost = 0 (unit cost)\n', '\ufeff', 'plan:\n'])
def test_a_text_without_actions_is_the_empty_plan(text: str) -> None:
    assert read_plan(text) == ()


def test_steps_know_their_lines_though_times_put_them_in_another_order() -> None:
    steps = read_plan(f'; late\n2: {GRAB}\n\n1: {MOVE}\n')

    assert [(step.action, step.line) for step in steps] == [(MOVE, 4), (GRAB, 2)]


def test_steps_of_equal_times_keep_the_order_of_the_text() -> None:
    assert [step.line for step in read_plan('1: (a)\n0: (b)\n1: (c)\n0: (d)')] == [2, 4, 1, 3]


NOISE = {
    'a sentence': 'I will go to the center.',
    'a bare action': 'move left center',
    'no closing parenthesis': '(move left center',
    'no opening parenthesis': 'move left center)',
    'nested': '(move (left) center)',
    'nothing in the parentheses': '()',
    'only a time': '0.0:',
    'no number': 'now: (move left center)',
    'text after the action': '(move left center) please',
    'a negative time': '-1: (move left center)',
    'XML': '<plan><move/></plan>',
    'an unclosed duration': '0: (move left center) [1.0',
}


@pytest.mark.parametrize('line', NOISE.values(), ids=NOISE)
def test_what_is_no_action_is_refused_with_its_line_and_text(line: str) -> None:
    with pytest.raises(InputError) as refused:
        read_plan(f'; a comment\n\n{line}\n', '/robot/plan')

    assert str(refused.value) == f'/robot/plan, line 3: this is no action of a plan: "{line}"'


def test_a_line_without_start_time_among_timed_ones_is_refused() -> None:
    with pytest.raises(InputError, match='line 2: this line has no start time, but others have'):
        read_plan(f'0: {MOVE}\n{GRAB}\n')


def test_a_problem_or_domain_in_place_of_the_plan_is_told_so(warehouse) -> None:
    for text in ((warehouse / name).read_text() for name in ('domain.pddl', 'problem.pddl')):
        for given_text in (text, '\ufeff' + text, text.upper(), text.replace('\n', '\r\n')):
            with pytest.raises(InputError, match='a PDDL definition, but a plan is expected here'):
                read_plan(given_text)


@pytest.mark.parametrize(
    'noise',
    [
        'x' * 1_000_000,
        'x ' * 500_000 + '(',
        '(' * 1_000_000,
        '(' + 'x ' * 500_000,
        'a(' + 'x,' * 500_000,
        'a' + ' ' * 1_000_000 + ']',
        ' ' * 1_000_000 + ']',
        '(a' + ' ' * 1_000_000 + ']',
        'a(' + ' ' * 1_000_000 + ']',
        'a(b' + ' ' * 1_000_000 + ']',
        '0:' + ' ' * 1_000_000 + ']',
        'step' + ' ' * 1_000_000 + ']',
        '1' * 1_000_000 + ']',
        '(a)' + '[' * 1_000_000,
        '(a)\n' * 1000 + '\0' * 1_000_000,
    ],
    ids=lambda noise: f'{noise[:4]}…{noise[-4:]}',
)
def test_a_megabyte_of_noise_is_refused_in_few_words(noise: str) -> None:
    with pytest.raises(InputError) as refused:
        read_plan(noise)  # with a pattern of quadratic time for hours: the test's time would be up

    assert len(str(refused.value)) < 400


def test_a_good_plan_costs_its_number_of_actions(warehouse, task: Task) -> None:
    text = (warehouse / 'plan.txt').read_text()

    assert check_plan(task, read_plan(text)).cost == 10.0


def test_the_cost_is_the_metric_of_the_problem() -> None:
    domain = """
    (define (domain d)
      (:requirements :strips :action-costs)
      (:predicates (p) (q))
      (:functions (total-cost) - number)
      (:action a :parameters () :precondition (p) :effect (and (q) (increase (total-cost) 3))))
    """
    problem = """
    (define (problem x) (:domain d) (:init (p) (= (total-cost) 0)) (:goal (q))
      (:metric minimize (total-cost)))
    """

    assert check_plan(read_task(domain, problem), read_plan('(a)\n(a)')).cost == 6.0  # 3 + 3


FAILURES = {
    'unknown action': (
        '(mov left center)',
        'plan, line 1: the domain has no action "mov" (did you mean "move"?)',
    ),
    'unknown action that is like no other': (
        '(xyz)',
        'plan, line 1: the domain has no action "xyz"',
    ),
    'unknown object': (
        '(Move left Centre)',
        'plan, line 1: (Move left Centre): the problem has no object "Centre" '
        '(did you mean "center"?)',
    ),
    'too few arguments': (
        '(move left)',
        'plan, line 1: (move left): "move" takes 2 arguments, (?a - place ?b - place), not 1',
    ),
    'wrong type': (
        '(move left bottom_door)',
        'plan, line 1: (move left bottom_door): bottom_door is of type door, '
        'but "move" takes a place there: (?a - place ?b - place)',
    ),
    'first step fails': (
        '\n(move center doors)',
        'plan, line 2: (move center doors) cannot be carried out as step 1 of 1: '
        '(robot-at center) does not hold',
    ),
    'a later step fails, and only the first that does is named': (
        '(move left center)\n(move center red_room)\n(grab blue_cube doors)',
        'plan, line 2: (move center red_room) cannot be carried out as step 2 of 3: '
        '(connected center red_room) does not hold',
    ),
    'two conditions lack': (
        '(move left center)\n(grab blue_cube blue_room)\n(grab blue_cube blue_room)',
        'plan, line 2: (grab blue_cube blue_room) cannot be carried out as step 2 of 3: '
        '(robot-at blue_room) does not hold',
    ),
    'the goal is not reached': (
        '(move left center)',
        'plan: the plan does not reach the goal: (holding red_circle) does not hold, '
        '(holding blue_cube) does not hold, (outside bottom_door) does not hold',
    ),
}


@pytest.mark.parametrize(('text', 'said'), FAILURES.values(), ids=FAILURES)
def test_a_plan_that_fails_is_refused_with_action_and_condition(
    task: Task, text: str, said: str
) -> None:
    with pytest.raises(InputError) as refused:
        robot_plan(task, text)

    assert str(refused.value) == said


@pytest.mark.parametrize(
    ('text', 'cure'),
    [
        ('(move left center)\n(mov center doors)', 'Correct that line'),
        ('(move left center)\n(move center)', 'Correct that line'),
        ('(move left center)\n(mov center doors)\n(grb red_cube doors)', 'Give domain, problem'),
        ('(mov left center)', 'Give domain, problem'),
    ],
)
def test_a_plan_of_which_half_fits_is_not_taken_for_one_of_another_task(
    task: Task, text: str, cure: str
) -> None:
    with pytest.raises(InputError) as refused:
        robot_plan(task, text)

    assert refused.value.cure.startswith(cure)


def test_the_step_that_fails_is_counted_in_the_order_of_time(task: Task) -> None:
    with pytest.raises(InputError) as refused:
        robot_plan(task, '1: (move center left)\n3: (move right left)\n0: (move left center)')

    assert str(refused.value) == (
        'plan, line 2: (move right left) cannot be carried out as step 3 of 3: '
        '(robot-at right) does not hold, (connected right left) does not hold'
    )


def test_conditions_that_must_not_hold_and_disjunctions_are_told_too() -> None:
    domain = """
    (define (domain d)
      (:requirements :adl)
      (:predicates (p) (q) (done))
      (:action a :parameters () :precondition (not (p)) :effect (done))
      (:action b :parameters () :precondition (or (q) (done)) :effect (done)))
    """
    task = read_task(domain, '(define (problem x) (:domain d) (:init (p)) (:goal (done)))')

    with pytest.raises(InputError, match=r'step 1 of 1: \(p\) holds$'):
        robot_plan(task, '(a)')
    with pytest.raises(InputError, match=r'step 1 of 1: \(or \(q\) \(done\)\) does not hold$'):
        robot_plan(task, '(b)')


def test_a_trailing_reach_goal_is_dropped_unless_the_domain_has_it(warehouse, task: Task) -> None:
    text = (warehouse / 'plan.txt').read_text()

    plan = robot_plan(task, text + '(reach-goal)\n').plan

    assert plan == robot_plan(task, text).plan
    assert len(plan.actions) == 10
    with pytest.raises(InputError, match='line 1: the domain has no action "reach-goal"'):
        robot_plan(task, '(reach-goal)\n(move left center)')
    domain = """
    (define (domain d) (:predicates (p))
      (:action reach-goal :parameters () :effect (p)))
    """
    own = read_task(domain, '(define (problem x) (:domain d) (:init) (:goal (p)))')
    assert without_dummy(own, read_plan('(reach-goal)')) == read_plan('(reach-goal)')


def test_a_reach_goal_at_the_latest_time_is_trailing_wherever_it_stands(
    warehouse, task: Task
) -> None:
    actions = read_plan((warehouse / 'plan.txt').read_text())
    lines = [f'{i}: {step.action} [1]' for i, step in enumerate(actions)]

    plan = robot_plan(task, '\n'.join(['10: (REACH-GOAL ) [1]', *reversed(lines)])).plan

    assert plan.actions == tuple(step.action for step in actions)
