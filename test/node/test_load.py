"""A real node with many callers and a robot that never rests; `benchmarks/load.py` has figures."""

import contextlib
import os
import threading
from pathlib import Path

import pytest

pytest.importorskip('rclpy', reason='needs ROS 2')

import rclpy
from crowd import Answer, Calls, crowd
from parcels import DOMAIN, FEW_GOALS, RightAnswers, right_answers
from robot_stream import NOT_READY, RobotStream, Times, Verdict, judge
from ros_peer import Peer, explainer

NAMESPACE = f'/load_{os.getpid()}'
CLIENTS = 50


@pytest.fixture
def peer():
    rclpy.init()
    with contextlib.closing(Peer(NAMESPACE)) as peer:
        yield peer
    rclpy.try_shutdown()


def test_fifty_callers_are_answered_although_the_robot_never_stops_changing(
    peer: Peer, tmp_path: Path
):
    user_model = tmp_path / 'user_model.yaml'
    user_model.write_text(FEW_GOALS)
    right = right_answers(user_model)
    robot, answered = RobotStream(peer), threading.Event()

    def change_all_the_time() -> None:
        while not answered.wait(0.02):  # 50 Hz
            robot.send()

    changing = threading.Thread(target=change_all_the_time)
    with (
        explainer(peer, tmp_path, user_model_file=user_model, answer_timeout=60.0),
        crowd(NAMESPACE, CLIENTS, processes=2) as callers,
    ):
        peer.publish('domain', DOMAIN)
        robot.send()
        assert peer.answer() == right.to(0)
        changing.start()
        try:
            calls = callers.call('verbalize_plan', CLIENTS, calls=2)
        finally:
            answered.set()
            changing.join()
        last = peer.answer()
    assert judge(calls, robot.times, right) == Verdict(right=2 * CLIENTS)
    assert right.are(last, robot.newest)


# Updates 0, 1, 2 are published at 0, 10, 20 s, and surely heard a second later.
TIMES = Times([0.0, 10.0, 20.0], [1.0, 11.0, 21.0])
RIGHT = RightAnswers('I will grab parcel 000000.')


@pytest.mark.parametrize(
    ('number', 'began', 'ended', 'verdict'),
    [
        (1, 15.0, 16.0, 'right'),
        (1, 10.5, 10.6, 'right'),  # already heard, perhaps
        (0, 10.5, 10.6, 'right'),  # not yet heard, perhaps
        (1, 15.0, 30.0, 'right'),  # the newest when the call began
        (2, 15.0, 30.0, 'right'),  # the newest when the call ended
        (0, 15.0, 16.0, 'stale'),
        (1, 21.0, 22.0, 'stale'),
        (2, 15.0, 16.0, 'wrong'),  # from the future
    ],
)
def test_an_answer_is_judged_by_the_updates_that_it_may_be_made_from(
    number, began, ended, verdict
):
    calls = Calls([Answer(began, ended, True, RIGHT.to(number))])
    found = judge(calls, TIMES, RIGHT)
    assert {name: getattr(found, name) for name in ('right', 'stale', 'wrong')} == {
        name: int(name == verdict) for name in ('right', 'stale', 'wrong')
    }


def test_other_words_are_wrong_and_refusals_are_told_from_faults():
    answers = [
        Answer(15.0, 16.0, True, 'I will grab parcel 000001 and run.'),
        Answer(15.0, 16.0, False, 'the plan does not reach the goal'),
        Answer(15.0, 16.0, False, NOT_READY),
        Answer(10.5, 10.9, False, 'the plan does not reach the goal'),  # its half may be known
    ]
    found = judge(Calls(answers, lost=3), TIMES, RIGHT)
    assert (found.wrong, found.not_ready, found.lost, found.faults) == (2, 1, 3, 5)
    assert found.under_way == 1
