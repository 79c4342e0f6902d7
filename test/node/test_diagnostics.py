"""What an operator sees of the explainer: levels, sentences and values, without ROS."""

import logging
import os
import re
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest
from conftest import WAREHOUSE
from prepared import prepared as planned

from mirror_explainer.commands.command_line import package_version
from mirror_explainer.explainer import explain
from mirror_explainer.listener.explanation import Explanation
from mirror_explainer.listener.preparation import Preparation
from mirror_explainer.listener.user_model import read_user_model
from mirror_explainer.node.diagnostics import Diagnosis, Level, diagnose
from mirror_explainer.node.history import History, news
from mirror_explainer.node.inputs import Inputs, Text
from mirror_explainer.node.moment import Moment
from mirror_explainer.node.readiness import Phase, Readiness
from mirror_explainer.node.surroundings import Others, Surroundings, look_around
from mirror_explainer.pddl import Task, read_task
from mirror_explainer.pddl.plan_text import read_plan
from mirror_explainer.pddl.situation import Statement, situation_of
from mirror_explainer.planning import BeliefPlans, Planner, Status

WAITING = Readiness(
    Phase.WAITING,
    'waiting for plan (topic)',
    cure='Start the robot.',
    inputs=Inputs(problem=Text('(define (problem p))', '/problem')),
)
WORKING = Readiness(Phase.PLANNING, 'planning 3 of 30')
WRONG = Readiness(Phase.ERROR, '/plan, line 1: no action "fly"', cure='Publish another plan.')
PUBLISHED = dict.fromkeys(('domain', 'problem', 'plan', 'progress'), ('/robot',))


@pytest.fixture(scope='module')
def planner() -> Iterator[Planner]:
    with Planner() as planner:
        yield planner


def prepared(task: Task, warehouse: Path, planner: Planner, max_beliefs: int) -> Preparation:
    plan = (warehouse / 'plan.txt').read_text()
    user_model = read_user_model(warehouse / 'user_model.yaml', task)
    return planned(task, plan, user_model, planner, max_beliefs=max_beliefs)


@pytest.fixture(scope='module')
def ready(planner: Planner) -> Readiness:
    task = read_task(*((WAREHOUSE / f'{name}.pddl').read_text() for name in ('domain', 'problem')))
    preparation = prepared(task, WAREHOUSE, planner, 1024)
    texts = [(WAREHOUSE / name).read_text() for name in ('domain.pddl', 'problem.pddl')]
    steps = read_plan((WAREHOUSE / 'plan.txt').read_text())
    situation = situation_of(Statement(*texts, task, steps))
    preparation = replace(preparation, situation=situation)
    inputs = Inputs(
        problem=Text('', '/problem'), plan=Text('', '/plan'), user_model_file='user.yaml'
    )
    return Readiness(Phase.READY, 'ready', preparation, inputs)


def seen(
    *outcomes: Readiness,
    now: Readiness | None = None,
    inputs: Inputs | None = None,
    surroundings: Surroundings | None = None,
    answer: Explanation | None = None,
) -> Diagnosis:
    """Return the diagnosis after updates that ended so, with `now` under way."""
    history = History()
    for outcome in outcomes:
        history = history.after_update(outcome)
    return diagnose(
        now or outcomes[-1],
        history,
        inputs or Inputs(),
        surroundings or Surroundings(others=Others(PUBLISHED)),
        answer,
    )


def test_a_ready_explainer_is_ok_and_nothing_is_to_be_done(ready: Readiness) -> None:
    diagnosis = seen(WAITING, ready)

    assert (diagnosis.level, diagnosis.message) == (Level.OK, 'ready')
    assert diagnosis.values['what to do'] == 'nothing'
    assert diagnosis.values['last error'] == 'none'
    assert diagnosis.values['covered mass'] == '1.000000'
    assert diagnosis.values['updates'] == '2'


def test_an_error_is_told_with_its_cure_and_when_it_was() -> None:
    diagnosis = seen(WRONG)

    assert (diagnosis.level, diagnosis.message) == (Level.ERROR, WRONG.message)
    assert diagnosis.values['what to do'] == WRONG.cure
    assert diagnosis.values['last error'] == WRONG.message
    assert diagnosis.values['last error cure'] == WRONG.cure
    assert diagnosis.values['last error time'] == WRONG.since.wall.isoformat(timespec='seconds')
    assert diagnosis.values['last error still so'] == 'yes'


def test_an_error_that_is_over_is_remembered_as_over(ready: Readiness) -> None:
    diagnosis = seen(WRONG, ready)

    assert diagnosis.level is Level.OK
    assert diagnosis.values['last error'] == WRONG.message
    assert diagnosis.values['last error still so'] == 'no'


def test_waiting_is_a_warning_that_says_what_to_do() -> None:
    diagnosis = seen(WAITING, surroundings=Surroundings(others=Others({'plan': ()})))

    assert (diagnosis.level, diagnosis.message) == (Level.WARN, WAITING.message)
    assert diagnosis.values['what to do'] == WAITING.cure


def test_what_is_published_best_effort_or_elsewhere_is_told_with_its_cure() -> None:
    long_ago = Moment(steady=time.monotonic() - 1000.0)
    waiting = replace(WAITING, inputs=Inputs(), since=long_ago)
    robot = {'problem': ('/robot',), 'plan': ('/robot',)}
    unreliable = seen(waiting, surroundings=Surroundings(others=Others(robot, robot)))
    elsewhere = seen(waiting, surroundings=Surroundings(others=Others(elsewhere=['/vinny/', '/'])))

    assert unreliable.message == (
        'waiting for plan (topic); /robot publishes problem and plan as best effort, which is '
        'not heard here'
    )
    assert unreliable.values['what to do'].startswith('Publish it reliably')
    assert elsewhere.values['what to do'] == (
        'There is /vinny/plan; /plan: is this node to be in that namespace (-r __ns:=…)? '
        'Start the robot.'
    )


def test_what_is_published_and_does_not_arrive_has_another_cure() -> None:
    both = Surroundings(others=Others(PUBLISHED))
    just_started = seen(replace(WAITING, since=Moment()), surroundings=both)
    long_ago = Moment(steady=time.monotonic() - 1000.0)
    diagnosis = seen(replace(WAITING, since=long_ago), surroundings=both)

    assert just_started.message == WAITING.message
    assert diagnosis.level is Level.WARN
    assert diagnosis.message == (
        'waiting for plan (topic); somebody publishes plan, but nothing was heard'
    )
    assert 'latched (transient local)' in diagnosis.values['what to do']


@pytest.mark.parametrize(
    ('outcome', 'level', 'message', 'cure'),
    [
        (WAITING, Level.WARN, 'planning 3 of 30', 'nothing'),
        (
            WRONG,
            Level.ERROR,
            f'planning 3 of 30; the last update failed: {WRONG.message}',
            WRONG.cure,
        ),
    ],
    ids=['waiting', 'error'],
)
def test_while_an_update_is_worked_on_things_are_as_bad_as_before(
    outcome: Readiness, level: Level, message: str, cure: str
) -> None:
    diagnosis = seen(outcome, now=WORKING)

    assert (diagnosis.level, diagnosis.message) == (level, message)
    assert diagnosis.values['what to do'] == cure
    assert diagnosis.values['state'] == 'planning'


def test_replanning_is_ok_where_the_last_plan_could_be_explained(ready: Readiness) -> None:
    assert seen(ready, now=WORKING).level is Level.OK


def test_updates_that_end_alike_do_not_change_since_when_it_is_so(ready: Readiness) -> None:
    first = replace(ready, since=Moment(steady=time.monotonic() - 1000.0))
    another = replace(WRONG, message='another', since=Moment(steady=time.monotonic() - 10.0))

    still_ready = seen(WRONG, first, ready)
    not_ready = seen(first, another)

    assert int(still_ready.values['seconds in this state']) >= 1000
    assert still_ready.values['state since'] == str(first.since)
    assert 10 <= int(not_ready.values['seconds in this state']) < 1000


def test_a_robot_that_fell_silent_is_a_warning(ready: Readiness) -> None:
    diagnosis = seen(ready, surroundings=Surroundings(others=Others(PUBLISHED | {'plan': ()})))

    assert diagnosis.level is Level.WARN
    assert diagnosis.message == 'ready, but nobody publishes plan any more'
    assert 'told last' in diagnosis.values['what to do']
    assert diagnosis.values['publishers of plan'] == '0'


def test_that_two_nodes_tell_the_same_is_a_warning_whatever_else_is_wrong(
    ready: Readiness,
) -> None:
    two = Surroundings(others=Others(PUBLISHED | {'plan': ('/b/robot', '/a/robot')}))

    diagnosis, failed = seen(ready, surroundings=two), seen(WRONG, surroundings=two)

    told = (
        'more than one node publishes plan (named /a/robot; /b/robot), and what they tell is mixed'
    )
    assert (diagnosis.level, diagnosis.message) == (Level.WARN, f'ready; {told}')
    assert diagnosis.values['publishers of plan'] == '2'
    assert 'ROS_DOMAIN_ID' in diagnosis.values['what to do']
    assert (failed.level, failed.message) == (Level.ERROR, f'{WRONG.message}; {told}')
    assert failed.values['what to do'].endswith(WRONG.cure)


def test_a_node_whose_name_is_not_known_yet_is_counted_but_not_told(ready: Readiness) -> None:
    two = Surroundings(others=Others(PUBLISHED | {'plan': ('/a/robot', '')}, {'plan': ('',)}))

    diagnosis = seen(ready, surroundings=two)

    assert (diagnosis.level, diagnosis.message) == (Level.OK, 'ready')
    assert diagnosis.values['publishers of plan'] == '2'


def test_without_a_user_model_is_a_warning(ready: Readiness) -> None:
    diagnosis = seen(replace(ready, inputs=replace(ready.inputs, user_model_file='')))

    assert diagnosis.level is Level.WARN
    assert diagnosis.message.startswith('ready, but without a user model')
    assert 'draft_user_model' in diagnosis.values['what to do']


def test_an_explanation_without_all_beliefs_is_a_warning(
    task: Task, warehouse: Path, planner: Planner
) -> None:
    some = prepared(task, warehouse, planner, max_beliefs=10)

    diagnosis = seen(Readiness(Phase.READY, 'ready', some, Inputs(user_model_file='user.yaml')))

    assert diagnosis.level is Level.WARN
    assert 'not for all beliefs' in diagnosis.message
    assert 'max_beliefs' in diagnosis.values['what to do']
    # 30 equally probable goals, of which the 10 first, or 9 and the robot's, are taken.
    assert float(diagnosis.values['covered mass']) == pytest.approx(10 / 30, abs=1e-6)


def test_of_what_has_no_plan_with_something_left_out_it_is_not_said_that_time_helps(
    ready: Readiness,
) -> None:
    assert ready.preparation is not None
    *planned, last = ready.preparation.results.items()
    unsure = 'planned for with something left out'
    for reason, helps in ((unsure, False), ('no plan within 0.1 s', True)):
        unplanned = BeliefPlans(Status.UNKNOWN, reason=reason)
        some = ready.preparation.knowing(dict([*planned, (last[0], unplanned)]))

        diagnosis = seen(replace(ready, preparation=replace(some, unsure=unsure)))

        assert diagnosis.level is Level.WARN
        assert ('Raise deadline' in diagnosis.values['what to do']) == helps


def test_each_input_is_shown_with_its_source_and_age(ready: Readiness, tmp_path: Path) -> None:
    user_model = tmp_path / 'user.yaml'
    user_model.write_text('goals: []\n')
    os.utime(user_model, (time.time() - 500, time.time() - 500))
    long_ago = Moment(steady=time.monotonic() - 100.0)
    inputs = Inputs(
        domain_file='/nowhere/domain.pddl',
        problem=Text('', '/robot/problem'),
        plan=Text('', '/robot/plan', long_ago),
        user_model_file=str(user_model),
    )

    values = seen(
        ready,
        inputs=inputs,
        surroundings=look_around(['/nowhere/domain.pddl', str(user_model)], Others(PUBLISHED)),
    ).values

    assert values['plan from'] == '/robot/plan'
    assert 100 <= int(values['seconds since plan']) < 500
    assert int(values['seconds since user model']) >= 500
    assert values['user model from'] == str(user_model)
    assert values['domain from'] == '/nowhere/domain.pddl'
    assert 'seconds since domain' not in values


def test_a_message_heard_at_another_time_is_the_same_message() -> None:
    assert Text('(a)', '/plan', Moment(steady=1.0)) == Text('(a)', '/plan', Moment(steady=2.0))


def test_values_are_short_and_on_one_line() -> None:
    wrong = replace(WRONG, message='line 1: wrong;\n' * 1000)

    diagnosis = seen(wrong)

    for text in (diagnosis.message, *diagnosis.values.values()):
        assert len(text) < 600
        assert '\n' not in text


def test_calls_are_counted(ready: Readiness) -> None:
    history = History().after_call(True, 0.25).after_call(False, 1.5).after_call(True, 0.5)

    values = diagnose(ready, history, Inputs(), Surroundings()).values

    assert (values['calls answered'], values['calls failed']) == ('2', '1')
    assert values['seconds of last call'] == '0.500'


def test_the_memory_of_the_processes_that_plan_is_counted() -> None:
    hold = "x = bytearray(64 << 20); print('held', flush=True); input()"
    command = [sys.executable, '-c', hold]
    before = look_around([], Others()).planner_memory
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as child:
        assert child.stdout is not None
        child.stdout.readline()
        during = look_around([], Others())
        child.kill()

    assert during.planner_memory - before > 64 << 20
    assert during.node_memory > 0
    assert during.version == package_version()


def test_the_handbook_lists_every_value_and_no_other(ready: Readiness, warehouse: Path) -> None:
    assert ready.preparation is not None
    answer = explain(ready.preparation)
    history = History().after_update(WRONG).after_update(ready).after_call(True, 0.1)
    text = Text('', '/topic')
    path = str(warehouse / 'user_model.yaml')
    values = diagnose(
        ready,
        history,
        Inputs(domain=text, problem=text, plan=text, progress=text, user_model_file=path),
        look_around([path], Others(PUBLISHED)),
        answer,
    ).values

    handbook = (warehouse.parents[1] / 'docs' / 'operations.md').read_text()
    table = handbook.split('| key |')[1].split('\n\n')[0]
    listed = [
        key
        for cell in re.findall(r'^\| (`[^|]*) \|', table, re.MULTILINE)
        for key in re.findall(r'`([^`]*)`', cell)
    ]

    assert sorted(listed) == sorted(values)


def levels(before: Readiness, now: Readiness) -> list[int]:
    return [level for level, _ in news(before, now)]


def test_that_the_next_plan_can_be_explained_too_is_no_news(ready: Readiness) -> None:
    assert max(levels(WAITING, ready)) == logging.INFO
    assert max(levels(ready, ready)) == logging.DEBUG
    assert max(levels(WRONG, ready)) == logging.INFO


def test_an_error_is_logged_with_its_cure() -> None:
    assert list(news(WAITING, WRONG)) == [(logging.ERROR, f'{WRONG.message}. {WRONG.cure}')]


def test_a_warning_that_stays_is_logged_once(ready: Readiness) -> None:
    assert ready.preparation is not None
    warned, twice = (
        replace(ready, preparation=replace(ready.preparation, warnings=warnings))
        for warnings in (('one',), ('one', 'two'))
    )

    assert (logging.WARNING, 'one') in news(ready, warned)
    assert logging.WARNING not in levels(warned, warned)
    assert [line for level, line in news(warned, twice) if level == logging.WARNING] == ['two']
