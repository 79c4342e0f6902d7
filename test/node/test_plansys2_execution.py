"""The texts of a plan that PlanSys2 carries out, and of how far it is."""

from types import SimpleNamespace

import pytest

from mirror_explainer.errors import InputError
from mirror_explainer.node.plansys2_execution import (
    DONE,
    FAILED,
    RUNNING,
    Execution,
    PlannedAction,
    goal_holds,
)
from mirror_explainer.node.plansys2_messages import FIELDS, checked

THERE = PlannedAction(0.0, '(roll c1 gate beans)', 6.0)
BACK = PlannedAction(6.001, '(roll c1 beans gate)', 6.0)
AGAIN = PlannedAction(12.002, '(roll c1 gate beans)', 6.0)


@pytest.fixture
def execution() -> Execution:
    return Execution.of([THERE, BACK, AGAIN])


def test_a_plan_is_told_with_its_times(execution):
    assert execution.plan.splitlines() == [
        '0.000: (roll c1 gate beans) [6.000]',
        '6.001: (roll c1 beans gate) [6.000]',
        '12.002: (roll c1 gate beans) [6.000]',
    ]


def test_nothing_has_begun_at_first(execution):
    assert execution.progress == ''


def test_what_has_begun_is_told_in_the_order_of_the_plan(execution):
    now = execution.after('(roll c1 beans gate):6001', RUNNING)
    now = now.after('(roll c1 gate beans):0', DONE)
    assert now.progress == 'done: (roll c1 gate beans)\nrunning: (roll c1 beans gate)'


def test_the_same_action_twice_is_told_apart_by_its_start(execution):
    # PlanSys2 cuts 12.002 s, which is 12.00199985… as a float32, to 12001 ms.
    now = execution.after('(roll c1 gate beans):12001', RUNNING)
    assert [place for place, s in enumerate(now.standing) if s == RUNNING] == [2]


@pytest.mark.parametrize(
    'name', [':0', '', '(roll c2 gate beans):0', '(roll c1 gate beans)', '(roll c1 gate beans):x']
)
def test_what_is_no_action_of_the_plan_changes_nothing(execution, name):
    assert execution.after(name, DONE) == execution


def test_a_failed_action_fails_the_plan(execution):
    now = execution.after('(roll c1 beans gate):6001', FAILED)
    assert now.failed
    assert now.progress == 'failed: (roll c1 beans gate)'


def problem(facts: str, goal: str) -> str:
    return f'( define ( problem p )\n( :init\n\t{facts} )\n( :goal\n\t{goal}\n)\n)\n'


@pytest.mark.parametrize(
    ('facts', 'goal', 'holds'),
    [
        ('( has c1 rake )\n\t( has c1 hoe )', '( and ( has c1 rake ) ( has c1 Hoe ) )', True),
        ('( has c1 rake )', '( and ( has c1 rake ) ( has c1 hoe ) )', False),
        ('( has c1 rake )', '(has c1 rake)', True),
        ('( has c1 rake )', '( or ( has c1 rake ) ( has c1 hoe ) )', False),
        ('( has c1 rake )', '( and ( has c1 rake ) ( not ( has c1 hoe ) ) )', False),
        ('( has c1 rake )', '( and )', False),
    ],
)
def test_whether_a_goal_of_facts_is_reached_is_read_off_the_problem(facts, goal, holds):
    assert goal_holds(problem(facts, goal)) is holds


def modules(**left_out: tuple[str, ...]) -> tuple[SimpleNamespace, SimpleNamespace]:
    """Return modules like PlanSys2's, with some fields left out."""

    def with_fields(name: str) -> SimpleNamespace:
        fields = {f: 'string' for f in FIELDS[name] if f not in left_out.get(name, ())}
        return SimpleNamespace(get_fields_and_field_types=lambda: fields)

    messages = ('ActionExecutionInfo', 'Plan', 'PlanItem')
    return (
        SimpleNamespace(**{name: with_fields(name) for name in messages}),
        SimpleNamespace(
            **{n: SimpleNamespace(Response=with_fields(n)) for n in ('GetDomain', 'GetProblem')}
        ),
    )


def test_messages_of_another_version_are_refused_by_name():
    with pytest.raises(
        InputError, match='which have ActionExecutionInfo.action_full_name, GetDom'
    ):
        checked(*modules(ActionExecutionInfo=('action_full_name',), GetDomain=('success',)))


def test_a_message_that_is_missing_is_told_with_all_its_fields():
    msg, srv = modules()
    del msg.PlanItem
    with pytest.raises(InputError, match='PlanItem.time, PlanItem.action, PlanItem.duration'):
        checked(msg, srv)


def test_the_messages_of_jazzy_are_taken():
    msg, srv = modules()
    assert checked(msg, srv).Plan is msg.Plan
