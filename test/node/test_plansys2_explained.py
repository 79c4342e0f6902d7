"""PlanSys2, bridge and explainer together: a person asks at every moment of a plan."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from patience import eventually
from plansys2_peer import StandIn, bridge, plansys2
from plansys2_task import Task, fetch, greenhouse, roll
from ros_peer import Peer, explainer

USER_MODEL = """goals:
  - {goal: (carries c1 rake)}
  - {goal: (carries c1 hoe)}
  - {goal: (and (carries c1 rake) (carries c1 hoe))}
sentences:
  roll: "I will roll to the {b}."
  fetch: "I will fetch the {t}."
"""


@contextmanager
def asked(peer: Peer, folder: Path, task: Task, **parameters: object) -> Iterator[StandIn]:
    """Run PlanSys2, bridge and explainer, until there is a first answer."""
    model = folder / 'user.yaml'
    model.write_text(USER_MODEL)
    with (
        plansys2(peer, folder, task.json()) as robot,
        bridge(peer, folder),
        explainer(peer, folder, user_model_file=str(model), **parameters),
    ):
        robot.do('execute')
        peer.answer()
        yield robot


def answers(peer: Peer, times: int = 3) -> list[str]:
    """Ask some times on end; all calls must be answered."""
    replies = [peer.call() for _ in range(times)]
    assert all(reply.success for reply in replies), [reply.message for reply in replies]
    return [reply.message for reply in replies]


def test_every_call_is_answered_while_actions_run(peer, tmp_path):
    heard = peer.hear('progress')
    with asked(peer, tmp_path, greenhouse(status_period=0.3)) as robot:
        for step in range(4):
            robot.do(f'start {step}')
            answers(peer)  # before the states of the actions have come
            running = f'running: {STEPS[step]}'
            eventually(lambda line=running: heard and line in heard[-1], 'that it runs')
            answers(peer)
            robot.do(f'end {step}')
            answers(peer)
        robot.do('finish')
        plans = peer.hear('plan')
        eventually(lambda: plans and plans[-1] == '', 'the end of the plan')
        done = eventually(
            lambda: 'done' in (said := peer.answer()) and said, 'that the robot is done'
        )
    assert done.splitlines()[-1] == 'I am done.'


STEPS = [step.action for step in greenhouse().plan]


def test_what_is_done_going_on_and_ahead_is_told_as_that(peer, tmp_path):
    with asked(peer, tmp_path, greenhouse(status_period=0.3), n=2) as robot:
        robot.do('start 0', 'end 0', 'start 1', 'end 1', 'start 2')
        said = eventually(
            lambda: 'have' in (said := peer.answer()) and said, 'a sentence in the past tense'
        )
    assert said == 'I have fetched the rake.\nI will fetch the hoe.'


def test_calls_are_answered_while_actions_overlap(peer, tmp_path):
    task = greenhouse(status_period=0.3)
    task.objects['cart'].append('c2')
    task.facts.append('(at_bed c2 gate)')
    task.plan = [
        roll(0.0, 'c1', 'gate', 'Beans'),
        roll(1.0, 'c2', 'gate', 'herbs'),
        fetch(6.001, 'c1', 'rake', 'Beans'),
        fetch(7.001, 'c2', 'hoe', 'herbs'),
    ]
    task.goal = '( and ( carries c1 rake ) ( carries c2 hoe ) )'
    with asked(peer, tmp_path, task) as robot:
        for happening in ('start 0', 'start 1', 'end 0', 'start 2', 'end 1', 'start 3'):
            robot.do(happening)
            answers(peer)
        robot.do('end 2', 'end 3', 'finish')


def test_a_robot_that_is_stuck_says_so(peer, tmp_path):
    with asked(peer, tmp_path, greenhouse(status_period=0.3)) as robot:
        robot.do('start 0', 'end 0', 'start 1', 'fail 1')
        said = eventually(lambda: 'stuck' in (said := peer.answer()) and said, 'that it is stuck')
    assert 'I cannot fetch the rake.' in said


def test_another_plan_in_the_middle_is_explained(peer, tmp_path):
    import json
    from dataclasses import asdict

    with asked(peer, tmp_path, greenhouse(status_period=0.3)) as robot:
        robot.do('start 0', 'end 0')
        steps = [
            roll(0.0, 'c1', 'Beans', 'herbs'),
            fetch(6.001, 'c1', 'hoe', 'herbs'),
            roll(8.002, 'c1', 'herbs', 'Beans'),
            fetch(14.003, 'c1', 'rake', 'Beans'),
        ]
        robot.do(f'plan {json.dumps([asdict(step) for step in steps])}', 'execute')
        plans = peer.hear('plan')
        eventually(
            lambda: plans and plans[-1].startswith('0.000: (roll c1 Beans herbs)'), 'the new plan'
        )
        assert 'I will fetch the hoe' in peer.answer()


@pytest.mark.parametrize('late', ['bridge', 'explainer'])
def test_who_comes_late_answers_from_the_middle_of_the_plan(peer, tmp_path, late):
    model = tmp_path / 'user.yaml'
    model.write_text(USER_MODEL)
    with plansys2(peer, tmp_path, greenhouse(status_period=0.3).json()) as robot:
        robot.do('execute', 'start 0', 'end 0', 'start 1')
        if late == 'bridge':
            with (
                explainer(peer, tmp_path, user_model_file=str(model)),
                bridge(peer, tmp_path),
            ):
                said = peer.answer()
        else:
            with bridge(peer, tmp_path):
                plans = peer.hear('plan')
                eventually(lambda: plans and plans[-1], 'the plan')
                with explainer(peer, tmp_path, user_model_file=str(model)):
                    said = peer.answer()
    assert 'fetch' in said
