"""When updates are worked on, and who gets what comes of them: with works that are played."""

import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest
from patience import PATIENCE, eventually

from mirror_explainer.errors import Cancelled
from mirror_explainer.node import updates as module
from mirror_explainer.node.inputs import Inputs, Text
from mirror_explainer.node.readiness import Phase, Readiness
from mirror_explainer.node.stop_request import StopRequest
from mirror_explainer.node.updates import Updates
from mirror_explainer.text_files import TextFiles

READY = Readiness(Phase.READY, 'ready', preparation='an answer')
BAD = Readiness(Phase.ERROR, 'bad plan', blamed='/plan')
NO_MODEL = Readiness(Phase.ERROR, 'no such file', blamed='user_model.yaml')
BROKEN = Readiness(Phase.ERROR, 'the planner is broken', may_pass=True)


class PlayedMaker:
    """Makes what comes of inputs with a function of the inputs, and notes the inputs that came."""

    def __init__(self, make: Callable[[Inputs, StopRequest], Readiness]) -> None:
        self.files = TextFiles()
        self.made: list[Inputs] = []
        self.closed = False
        self._make = make

    def warm_up(self) -> None:
        pass

    def forget_files(self) -> None:
        self.files = TextFiles()

    def make(
        self, inputs: Inputs, stop: StopRequest, tell: Callable[[Readiness], None]
    ) -> Readiness:
        self.tell = tell
        self.made.append(inputs)
        return replace(self._make(inputs, stop), inputs=inputs)

    def close(self) -> None:
        self.closed = True


class Robot:
    """Submits one plan after the other, and hears what comes of them."""

    def __init__(self, make: Callable[[Inputs, StopRequest], Readiness]) -> None:
        self.maker = PlayedMaker(make)
        self.told: list[Readiness] = []
        self.updates = Updates(self.maker, self.told.append)
        self._ended = threading.Event()
        self._stream: threading.Thread | None = None

    def submit(self, plan: str, problem: str = 'a problem') -> None:
        inputs = Inputs(plan=Text(plan, '/plan'), problem=Text(problem, '/problem'))
        self.updates.submit(inputs, patience=5.0)

    def stream(self, period: float, plans: str = 'a plan') -> None:
        """Submit new problems from now on, so many seconds after each other.

        A {} in the plan makes it a new one each time.
        """

        def submit_all() -> None:
            number = 0
            while not self._ended.wait(period):
                number += 1
                self.submit(plans.format(number), f'problem {number}')

        self.submit(plans, 'the first problem')
        self._stream = threading.Thread(target=submit_all)
        self._stream.start()

    def wait_for_work(self) -> None:
        """Wait until the first work has begun."""
        eventually(lambda: self.maker.made, 'the first work')

    def phases_told(self, count: int) -> list[Phase]:
        """Return what was told, once it is so much: calls are answered a moment before."""
        eventually(lambda: len(self.told) >= count, f'{count} updates told')
        return [told.phase for told in self.told]

    def close(self) -> None:
        self._ended.set()
        if self._stream:
            self._stream.join()
        self.updates.close()


@pytest.fixture
def played() -> Iterator[Callable[..., Robot]]:
    """Return a function that makes a robot whose updates are played by a function."""
    robots: list[Robot] = []

    def make(work: Callable[[Inputs, StopRequest], Readiness]) -> Robot:
        robots.append(Robot(work))
        return robots[-1]

    yield make
    for robot in robots:
        robot.close()


def until_stopped(inputs: Inputs, stop: StopRequest) -> Readiness:
    """Work that ends only when it is to stop."""
    while True:
        stop.check()
        time.sleep(0.001)


@pytest.mark.parametrize(
    ('outcome', 'plans'),
    [
        (READY, 'plan {}'),
        (BAD, 'the same plan'),
        (NO_MODEL, 'plan {}'),
        (Readiness(Phase.WAITING, 'no plan'), ''),
    ],
)
@pytest.mark.parametrize('period', [0.01, 0.05])
def test_what_comes_of_a_stream_that_never_rests_is_told_whatever_it_is(
    played, outcome, plans, period
):
    # Every work is overtaken by newer inputs while it goes on.
    robot = played(lambda inputs, stop: time.sleep(0.1) or outcome)
    robot.stream(period, plans)

    heard = robot.updates.wait(PATIENCE)

    assert heard.message == outcome.message
    assert [told.message for told in robot.told][:1] in ([], [outcome.message])


def test_a_new_plan_that_does_not_fit_its_problem_is_not_told_while_they_never_rest(
    monkeypatch, played
):
    monkeypatch.setattr(module, 'DOUBTFUL_SECONDS', PATIENCE)
    # Each problem and plan may be halves of two updates.
    robot = played(lambda inputs, stop: time.sleep(0.4) or BAD)
    robot.stream(0.01, 'plan {}')

    while len(robot.maker.made) < 5:
        heard = robot.updates.wait(0.1)
        assert heard.phase is Phase.PLANNING

    assert robot.told == []


def test_a_plan_that_comes_long_before_its_problem_is_not_told_to_be_wrong(monkeypatch, played):
    monkeypatch.setattr(module, 'DOUBTFUL_SECONDS', PATIENCE)
    robot = played(lambda inputs, stop: BAD if inputs.problem.text == 'old' else READY)
    robot.submit('plan', 'old')
    robot.wait_for_work()
    robot.submit('plan', 'new')

    assert robot.updates.wait(PATIENCE).phase is Phase.READY
    assert robot.phases_told(1) == [Phase.READY]


def test_work_on_older_inputs_is_stopped_by_the_first_newer_one(played):
    robot = played(
        lambda inputs, stop: until_stopped(inputs, stop) if inputs.plan.text == 'old' else READY
    )
    robot.submit('old')
    robot.wait_for_work()
    robot.submit('new')

    heard = robot.updates.wait(PATIENCE)

    assert heard.phase is Phase.READY
    assert heard.inputs.plan.text == 'new'
    assert robot.phases_told(1) == [Phase.READY]
    assert robot.told[0].inputs.plan.text == 'new'


def planning(preparation: str, inputs: Inputs) -> Readiness:
    """Return what is told while planning goes on."""
    return Readiness(Phase.PLANNING, 'planning 1 of 2', preparation, inputs)


def test_a_call_that_waited_in_vain_gets_what_is_known_by_then(played):
    def work(inputs: Inputs, stop: StopRequest) -> Readiness:
        robot.maker.tell(planning('a first answer', inputs))
        return until_stopped(inputs, stop)

    robot = played(work)
    robot.submit('plan')
    robot.wait_for_work()
    heard = eventually(
        lambda: (found := robot.updates.wait(0.01)).preparation and found, 'an answer'
    )

    assert heard.preparation == 'a first answer'
    assert heard.inputs.plan.text == 'plan'
    assert robot.told == []


def test_what_is_known_about_older_inputs_is_not_for_calls_that_come_after_newer_ones(played):
    def work(inputs: Inputs, stop: StopRequest) -> Readiness:
        if inputs.plan.text == 'old':
            robot.maker.tell(planning('the old answer', inputs))
            goes_on.wait(PATIENCE)
        return until_stopped(inputs, stop)

    goes_on = threading.Event()
    robot = played(work)
    robot.submit('old')
    eventually(lambda: robot.updates.wait(0.01).preparation, 'the old answer')
    robot.submit('new')
    heard = robot.updates.wait(0.01)
    goes_on.set()

    assert heard.preparation is None
    assert heard.message == 'reading the newest inputs'


def test_after_work_that_was_stopped_texts_are_read_and_planned_for_half_as_long_as_calls_wait(
    monkeypatch, played
):
    asked: list[float] = []
    monkeypatch.setattr(StopRequest, 'after', lambda stop, seconds: asked.append(seconds))
    goes_on = threading.Semaphore(0)

    def work(inputs: Inputs, stop: StopRequest) -> Readiness:
        for _ in 'read', 'planned':
            goes_on.acquire(timeout=PATIENCE)
            if inputs.plan.text == 'first':
                raise Cancelled
            robot.maker.tell(planning(inputs.plan.text, inputs))
        return READY

    robot = played(work)
    robot.submit('first')
    robot.wait_for_work()
    robot.submit('second')  # while the first is read: at once
    goes_on.release()
    eventually(lambda: len(robot.maker.made) == 2, 'the second work')
    robot.submit('third')  # while the second is read: not before it is
    assert asked == [0.0, 0.0]
    goes_on.release()
    eventually(lambda: len(asked) == 3, 'that the second is to stop')
    robot.submit('fourth')  # while the second is planned for
    assert asked[2:] == [2.5, 2.5]  # calls wait for 5 s
    goes_on.release()
    eventually(lambda: len(robot.maker.made) == 3, 'the next work')
    robot.submit('fifth')  # the second was done, so at once again
    assert asked[-1] == 0.0
    goes_on.release(10)


def test_another_attempt_takes_no_answer_away_while_it_goes_on(monkeypatch, played):
    monkeypatch.setattr('mirror_explainer.node.retries.FIRST_SECONDS', 0.01)
    goes_on = threading.Event()

    def work(inputs: Inputs, stop: StopRequest) -> Readiness:
        robot.maker.tell(planning('a first answer', inputs))
        if len(robot.maker.made) > 1:
            goes_on.wait(PATIENCE)
        return Readiness(Phase.READY, 'ready', SimpleNamespace(failed_beliefs=1), may_pass=True)

    robot = played(work)
    robot.submit('plan')
    eventually(lambda: len(robot.maker.made) == 2, 'another attempt')
    heard = robot.updates.wait(PATIENCE)
    goes_on.set()

    assert heard.phase is Phase.READY
    assert heard.preparation.failed_beliefs == 1


def test_a_file_is_read_once_it_has_been_left_alone(monkeypatch, played, tmp_path: Path):
    monkeypatch.setattr(module, 'FILE_SETTLING_SECONDS', 1.0)
    monkeypatch.setattr(module, 'LONGEST_FILE_SETTLING_SECONDS', PATIENCE)
    file = tmp_path / 'user_model.yaml'
    file.write_text('0')
    texts = []
    robot = played(lambda inputs, stop: texts.append(robot.maker.files.read(str(file))) or READY)
    robot.submit('plan')
    robot.updates.wait(PATIENCE)

    for number in range(1, 31):
        file.write_text(str(number))
        robot.updates.look_at_files()
        time.sleep(0.05)  # in all longer than the file has to be left alone
    robot.updates.wait(PATIENCE)

    assert texts == ['0', '30']


def test_a_file_that_is_never_left_alone_is_read_after_a_while(monkeypatch, played, tmp_path):
    monkeypatch.setattr(module, 'LONGEST_FILE_SETTLING_SECONDS', 0.7)
    file = tmp_path / 'user_model.yaml'
    file.write_text('')
    robot = played(lambda inputs, stop: robot.maker.files.read(str(file)) and READY or READY)
    robot.submit('plan')
    robot.updates.wait(PATIENCE)
    end = time.monotonic() + PATIENCE
    while len(robot.maker.made) < 3 and time.monotonic() < end:
        with file.open('a') as stream:
            stream.write('x')
        robot.updates.look_at_files()
        time.sleep(0.01)

    assert len(robot.maker.made) >= 3


def test_a_call_does_not_wait_for_a_file_system_that_hangs(monkeypatch, played):
    robot = played(lambda inputs, stop: READY)
    robot.submit('plan')
    assert robot.updates.wait(PATIENCE).phase is Phase.READY
    hangs, goes_on = threading.Event(), threading.Event()
    monkeypatch.setattr(robot.maker.files, 'changed', lambda: hangs.set() or goes_on.wait() and 0)
    first = threading.Thread(target=robot.updates.wait, args=[PATIENCE])
    first.start()
    assert hangs.wait(PATIENCE)

    heard = robot.updates.wait(0.01)

    assert first.is_alive()
    assert heard.phase is Phase.READY
    goes_on.set()
    first.join()


def test_a_listener_that_fails_changes_nothing(played):
    robot = played(lambda inputs, stop: READY)
    failed = []

    def fail(outcome: Readiness) -> None:
        failed.append(outcome)
        raise RuntimeError('the listener is broken')

    robot.updates._on_done = fail
    robot.submit('one')
    first = robot.updates.wait(PATIENCE)
    robot.submit('two')
    second = robot.updates.wait(PATIENCE)

    assert (first.phase, second.phase) == (Phase.READY, Phase.READY)
    assert second.inputs.plan.text == 'two'
    assert failed


def test_an_error_that_may_pass_is_tried_again_by_a_call_and_told_once(monkeypatch, played):
    monkeypatch.setattr('mirror_explainer.node.retries.CALL_SECONDS', 0.0)
    # Only calls bring another attempt; they do not before it is as long ago as the last one took.
    monkeypatch.setattr('mirror_explainer.node.retries.FIRST_SECONDS', 10 * PATIENCE)
    outcomes = [BROKEN, BROKEN, READY]
    robot = played(lambda inputs, stop: outcomes[min(len(robot.maker.made), 3) - 1])
    robot.submit('plan')

    heard = [robot.updates.wait(PATIENCE).phase]
    end = time.monotonic() + PATIENCE
    while heard[-1] is Phase.ERROR and time.monotonic() < end:
        heard.append(robot.updates.wait(PATIENCE).phase)
        time.sleep(0.001)

    assert heard[0] is Phase.ERROR
    assert heard[-1] is Phase.READY
    assert len(robot.maker.made) == 3
    assert robot.phases_told(2) == [Phase.ERROR, Phase.READY]


@pytest.mark.parametrize(('then', 'kept'), [(25, 1), (1, 1), (0, 0)])
def test_another_attempt_replaces_an_answer_only_if_it_knows_more(monkeypatch, played, then, kept):
    monkeypatch.setattr('mirror_explainer.node.retries.FIRST_SECONDS', 0.01)
    failures = [1, then]

    def work(inputs: Inputs, stop: StopRequest) -> Readiness:
        failed = failures[min(len(robot.maker.made), 2) - 1]
        answer = SimpleNamespace(failed_beliefs=failed)
        return Readiness(Phase.READY, 'ready', answer, may_pass=failed > 0)

    robot = played(work)
    robot.submit('plan')
    robot.updates.wait(PATIENCE)
    eventually(lambda: len(robot.maker.made) > 2 - (then == 0), 'another attempt')
    eventually(
        lambda: robot.updates.readiness.preparation.failed_beliefs == kept, 'the better one'
    )

    assert robot.updates.wait(PATIENCE).preparation.failed_beliefs == kept
    assert len(robot.phases_told(1)) == 1 + (kept == 0)


def test_closing_frees_who_waits_and_closes_the_maker(played):
    robot = played(until_stopped)
    robot.submit('plan')
    heard = []
    waiting = threading.Thread(target=lambda: heard.append(robot.updates.wait(PATIENCE)))
    waiting.start()

    robot.updates.close()
    waiting.join(PATIENCE)

    assert heard[0].phase is Phase.PLANNING
    assert robot.maker.closed
