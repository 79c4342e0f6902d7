"""When updates are worked on, and who gets what comes of them: with works that are played."""

import itertools
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import pytest
from patience import PATIENCE, eventually

from mirror_explainer.errors import Cancelled
from mirror_explainer.node import updates as module
from mirror_explainer.node.inputs import Inputs, Text
from mirror_explainer.node.moment import Moment
from mirror_explainer.node.readiness import Phase, Readiness
from mirror_explainer.node.stop_request import StopRequest
from mirror_explainer.node.updates import Updates
from mirror_explainer.text_files import TextFiles


@dataclass(frozen=True)
class Answer:
    """Stands in for a preparation: of the task with a plan, told of at some progress."""

    plan: str = ''
    progress: str = ''
    text: str = 'unplanned'
    failed_beliefs: int = 0

    def is_of_task_of(self, other: 'Answer') -> bool:
        return self.plan == other.plan

    def at(self, newer: 'Answer') -> 'Answer':
        return replace(self, progress=newer.progress)


BAD = Readiness(Phase.ERROR, 'bad plan', blamed='/plan')
NO_MODEL = Readiness(Phase.ERROR, 'no such file', blamed='user_model.yaml')
BROKEN = Readiness(Phase.ERROR, 'the planner is broken', may_pass=True)


def planning(inputs: Inputs, text: str = 'unplanned') -> Readiness:
    """Return what is known of the inputs while planning goes on."""
    progress = inputs.progress.text if inputs.progress else ''
    answer = Answer(inputs.plan.text, progress, text)
    return Readiness(Phase.PLANNING, 'planning 1 of 2', answer)


def read_at_once(inputs: Inputs, stop: StopRequest) -> Readiness:
    """Read what is always good."""
    return planning(inputs)


def planned(unplanned: Answer, stop: StopRequest) -> Readiness:
    """Plan for what is always solved at once."""
    return Readiness(Phase.READY, 'ready', replace(unplanned, text='planned'))


class PlayedReader:
    """Reads inputs with a function, and notes the inputs that came."""

    def __init__(self, read: Callable[[Inputs, StopRequest], Readiness]) -> None:
        self.files = TextFiles()
        self.asked: list[Inputs] = []
        self._read = read

    def forget_files(self) -> None:
        self.files = TextFiles()

    def read(self, inputs: Inputs, stop: StopRequest) -> Readiness:
        self.asked.append(inputs)
        return replace(self._read(inputs, stop), inputs=inputs)


class PlayedRefiner:
    """Plans with a function, and notes the plans of the tasks that came."""

    def __init__(self, refine: Callable[[Answer, StopRequest], Readiness]) -> None:
        self.asked: list[str] = []
        self.closed = False
        self._refine = refine

    def warm_up(self) -> None:
        pass

    def refine(
        self, unplanned: Answer, stop: StopRequest, tell: Callable[[Readiness], None]
    ) -> Readiness:
        self.tell = tell
        self.asked.append(unplanned.plan)
        return self._refine(unplanned, stop)

    def close(self) -> None:
        self.closed = True


class Robot:
    """Submits one plan after the other, and hears what comes of them."""

    def __init__(
        self,
        read: Callable[[Inputs, StopRequest], Readiness] = read_at_once,
        refine: Callable[[Answer, StopRequest], Readiness] = planned,
    ) -> None:
        self.reader = PlayedReader(read)
        self.refiner = PlayedRefiner(refine)
        self.told: list[Readiness] = []
        self.updates = Updates(self.reader, self.refiner, self.told.append)
        self._ended = threading.Event()
        self._stream: threading.Thread | None = None

    def submit(
        self,
        plan: str,
        problem: str = 'a problem',
        progress: str = '',
        heard_before: tuple[float, float] = (0.0, 0.0),
    ) -> None:
        plan_heard, problem_heard = (Moment(time.monotonic() - s) for s in heard_before)
        inputs = Inputs(
            plan=Text(plan, '/plan', plan_heard),
            problem=Text(problem, '/problem', problem_heard),
            progress=Text(progress, '/progress'),
        )
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

    def make(**works: Callable[..., Readiness]) -> Robot:
        robots.append(Robot(**works))
        return robots[-1]

    yield make
    for robot in robots:
        robot.close()


def until_stopped(given: object, stop: StopRequest) -> Readiness:
    """Work that ends only when it is to stop."""
    while True:
        stop.check()
        time.sleep(0.001)


@pytest.mark.parametrize(
    ('outcome', 'plans'),
    [
        (BAD, 'the same plan'),
        (NO_MODEL, 'plan {}'),
        (Readiness(Phase.WAITING, 'no plan'), ''),
    ],
)
@pytest.mark.parametrize('period', [0.01, 0.05])
def test_what_comes_of_a_stream_that_never_rests_is_told_whatever_it_is(
    played, outcome, plans, period
):
    # Every reading is overtaken by newer inputs while it goes on.
    robot = played(read=lambda inputs, stop: time.sleep(0.1) or outcome)
    robot.stream(period, plans)

    heard = robot.updates.wait(PATIENCE)

    assert heard.message == outcome.message
    assert robot.phases_told(1)[0] is outcome.phase


@pytest.mark.parametrize('period', [0.01, 0.05])
def test_tasks_that_never_rest_are_planned_for_all_the_same(played, period):
    def refine(unplanned: Answer, stop: StopRequest) -> Readiness:
        time.sleep(0.3)
        stop.check()
        return planned(unplanned, stop)

    robot = played(refine=refine)
    robot.stream(period, 'plan {}')

    heard = robot.updates.wait(PATIENCE)

    assert heard.preparation.text == 'planned'


def test_a_new_plan_that_does_not_fit_its_problem_is_not_told_while_they_never_rest(
    monkeypatch, played
):
    monkeypatch.setattr(module, 'DOUBTFUL_SECONDS', PATIENCE)
    # Each problem and plan may be halves of two updates.
    robot = played(read=lambda inputs, stop: time.sleep(0.4) or BAD)
    robot.stream(0.01, 'plan {}')

    while len(robot.reader.asked) < 5:
        heard = robot.updates.wait(0.1)
        assert heard.phase is Phase.PLANNING

    assert robot.told == []


def test_what_is_heard_again_counts_as_heard_now(monkeypatch, played):
    monkeypatch.setattr(module, 'SETTLING_SECONDS', 0.5)
    robot = played()
    robot.submit('plan', heard_before=(60.0, 0.0))
    robot.submit('plan')
    robot.updates.wait(PATIENCE)

    (read,) = robot.reader.asked
    assert read.plan.heard.seconds_since(read.problem.heard) > -30.0


def test_a_plan_that_comes_again_after_the_progress_is_read_once_more_and_then_once_for_both(
    played,
):
    robot = played()

    def submit(*heard_after: float) -> int:
        """Submit problem and plan heard so long after the progress; return the readings so far."""
        now = time.monotonic()
        texts = {
            name: Text(name, f'/{name}', Moment(now + seconds))
            for name, seconds in zip(['problem', 'plan'], heard_after, strict=True)
        }
        progress = Text('progress', '/progress', Moment(now))
        robot.updates.submit(Inputs(**texts, progress=progress), patience=5.0)
        robot.updates.wait(PATIENCE)
        return len(robot.reader.asked)

    assert submit(-1.0, -1.0) == submit(-0.5, -0.5) == 1
    assert submit(0.0, 0.5) == submit(0.5, -0.1) == submit(0.6, 0.6) == 2
    # By then the progress is about a plan before, until it comes again.
    assert submit(1.5, 1.5) == submit(2.0, 2.0) == 3
    assert submit(0.1, 0.1) == 4


def test_a_plan_that_comes_long_before_its_problem_is_not_told_to_be_wrong(monkeypatch, played):
    monkeypatch.setattr(module, 'DOUBTFUL_SECONDS', PATIENCE)
    robot = played(
        read=lambda inputs, stop: BAD if inputs.problem.text == 'old' else planning(inputs)
    )
    robot.submit('plan', 'old')
    eventually(lambda: robot.reader.asked, 'the first reading')
    robot.submit('plan', 'new')

    assert robot.updates.wait(PATIENCE).phase is Phase.READY
    assert robot.phases_told(1) == [Phase.READY]


def test_a_plan_is_doubted_for_as_long_as_its_problem_is_new(monkeypatch, played):
    monkeypatch.setattr(module, 'DOUBTFUL_SECONDS', PATIENCE)
    monkeypatch.setattr(module, 'LONGEST_DOUBTFUL_SECONDS', 2 * PATIENCE)
    robot = played(
        read=lambda inputs, stop: planning(inputs) if inputs.plan.text == 'new' else BAD
    )
    robot.submit('old', heard_before=(PATIENCE + 1.0, 0.0))
    eventually(lambda: robot.reader.asked, 'the reading of the old plan')
    robot.submit('new')

    assert robot.updates.wait(PATIENCE).phase is Phase.READY
    assert robot.phases_told(1) == [Phase.READY]


def test_a_plan_that_has_not_fitted_for_long_is_told_to_be_wrong(monkeypatch, played):
    monkeypatch.setattr(module, 'DOUBTFUL_SECONDS', PATIENCE)
    robot = played(read=lambda inputs, stop: BAD)
    robot.submit('plan', heard_before=(PATIENCE + 1.0, PATIENCE + 1.0))

    assert robot.updates.wait(PATIENCE / 2).phase is Phase.ERROR


def test_a_plan_that_fits_none_of_ever_newer_states_is_told_to_be_wrong(monkeypatch, played):
    monkeypatch.setattr(module, 'DOUBTFUL_SECONDS', PATIENCE)
    monkeypatch.setattr(module, 'LONGEST_DOUBTFUL_SECONDS', 0.5)
    robot = played(read=lambda inputs, stop: BAD)
    states = itertools.count()

    def told() -> list[Readiness]:
        robot.submit('plan', f'state {next(states)}')
        return robot.told

    assert eventually(told, 'that the plan is wrong')[0].phase is Phase.ERROR


@pytest.mark.parametrize('stage', ['read', 'refine'])
def test_work_on_an_older_task_is_stopped_by_the_first_newer_one(played, stage):
    goes_on = {'read': read_at_once, 'refine': planned}[stage]

    def work(given: Inputs | Answer, stop: StopRequest) -> Readiness:
        text = given.plan.text if isinstance(given, Inputs) else given.plan
        return (until_stopped if text == 'old' else goes_on)(given, stop)

    robot = played(**{stage: work})
    robot.submit('old')
    begun = {'read': robot.reader.asked, 'refine': robot.refiner.asked}[stage]
    eventually(lambda: begun, 'the first work')
    robot.submit('new')

    heard = robot.updates.wait(PATIENCE)

    assert heard.phase is Phase.READY
    assert heard.inputs.plan.text == 'new'
    assert robot.phases_told(1) == [Phase.READY]
    assert robot.told[0].inputs.plan.text == 'new'


def test_progress_does_not_stop_the_planning_and_its_result_is_for_the_newest_progress(played):
    goes_on = threading.Event()

    def refine(unplanned: Answer, stop: StopRequest) -> Readiness:
        while not goes_on.wait(0.001):
            stop.check()
        return planned(unplanned, stop)

    robot = played(refine=refine)
    robot.submit('plan')
    eventually(lambda: robot.refiner.asked, 'the planning')
    heard = []
    for step in '123':
        robot.submit('plan', progress=step)
        heard.append(
            eventually(
                lambda step=step: (
                    (found := robot.updates.wait(0.01)).preparation
                    and found.preparation.progress == step
                    and found
                ),
                f'the progress {step}',
            )
        )
    goes_on.set()
    after = robot.updates.wait(PATIENCE)

    assert [found.phase for found in heard] == [Phase.PLANNING] * 3
    assert after.preparation == Answer('plan', '3', 'planned')
    assert after.inputs.progress.text == '3'
    assert robot.refiner.asked == ['plan']


def test_progress_after_the_planning_is_answered_without_any_more(played):
    robot = played()
    heard = []
    for step in '0123':
        robot.submit('plan', progress=step)
        heard.append(robot.updates.wait(PATIENCE))

    assert [(found.phase, found.preparation.progress) for found in heard] == [
        (Phase.READY, step) for step in '0123'
    ]
    assert robot.refiner.asked == ['plan']


def test_what_is_wrong_for_a_while_takes_nothing_away_that_was_planned(played):
    robot = played(
        read=lambda inputs, stop: NO_MODEL if inputs.progress.text == 'x' else planning(inputs)
    )
    heard = []
    for step in '1x2':
        robot.submit('plan', progress=step)
        heard.append(robot.updates.wait(PATIENCE).message)

    assert heard == ['ready', NO_MODEL.message, 'ready']
    assert robot.refiner.asked == ['plan']


def test_a_call_that_waited_in_vain_gets_what_is_known_by_then(played):
    def refine(unplanned: Answer, stop: StopRequest) -> Readiness:
        robot.refiner.tell(told('a first answer'))
        return until_stopped(unplanned, stop)

    robot = played(refine=refine)
    robot.submit('plan')
    heard = eventually(
        lambda: (
            (found := robot.updates.wait(0.01)).preparation
            and found.preparation.text != 'unplanned'
            and found
        ),
        'an answer',
    )

    assert heard.preparation.text == 'a first answer'
    assert heard.inputs.plan.text == 'plan'
    assert robot.told == []


def told(text: str) -> Readiness:
    """Return what planning tells meanwhile."""
    return Readiness(Phase.PLANNING, 'planning 1 of 2', Answer(text=text))


def test_what_is_known_about_an_older_task_is_not_for_calls_that_come_after_a_newer_one(played):
    goes_on = threading.Event()
    robot = played(
        read=lambda inputs, stop: (
            (inputs.plan.text == 'old' or goes_on.wait(PATIENCE)) and planning(inputs)
        ),
        refine=until_stopped,
    )
    robot.submit('old')
    eventually(lambda: robot.updates.wait(0.01).preparation, 'the old answer')
    robot.submit('new')
    heard = robot.updates.wait(0.01)
    goes_on.set()

    assert heard.preparation is None
    assert heard.message == 'reading the newest inputs'


def test_a_reading_is_not_stopped_if_the_one_before_it_was(played):
    goes_on = threading.Semaphore(0)
    stopped: dict[str, bool] = {}

    def read(inputs: Inputs, stop: StopRequest) -> Readiness:
        goes_on.acquire(timeout=PATIENCE)
        stopped[inputs.plan.text] = stop.is_set()
        stop.check()
        return planning(inputs)

    robot = played(read=read)
    robot.submit('1')
    for number in range(1, 5):
        eventually(lambda n=number: len(robot.reader.asked) == n, f'reading {number}')
        robot.submit(str(number + 1))  # while number is read
        goes_on.release()
    goes_on.release()
    robot.updates.wait(PATIENCE)

    assert stopped == {'1': True, '2': False, '3': True, '4': False, '5': False}


def test_after_planning_that_was_stopped_the_next_goes_on_for_half_as_long_as_calls_wait(
    monkeypatch, played
):
    asked: list[float] = []

    def refine(unplanned: Answer, stop: StopRequest) -> Readiness:
        monkeypatch.setattr(stop, 'after', asked.append)
        goes_on.acquire(timeout=PATIENCE)
        if unplanned.plan == 'first':
            raise Cancelled
        return planned(unplanned, stop)

    goes_on = threading.Semaphore(0)
    robot = played(refine=refine)

    def submit(plan: str) -> None:
        robot.submit(plan)
        eventually(
            lambda: (
                (found := robot.updates.readiness).preparation and found.inputs.plan.text == plan
            ),
            'the reading',
        )

    submit('first')
    eventually(lambda: len(robot.refiner.asked) == 1, 'the first planning')
    submit('second')  # while the first is planned for: at once
    assert asked == [0.0]
    goes_on.release()
    eventually(lambda: len(robot.refiner.asked) == 2, 'the second planning')
    submit('third')
    submit('fourth')
    assert asked[1:] == [2.5, 2.5]  # calls wait for 5 s
    goes_on.release()
    eventually(lambda: len(robot.refiner.asked) == 3, 'the next planning')
    submit('fifth')  # the second was done, so at once again
    assert asked[-1] == 0.0
    assert robot.refiner.asked == ['first', 'second', 'fourth']
    goes_on.release(10)


def failing(unplanned: Answer, beliefs: int) -> Readiness:
    """Return what comes of planning that failed for some beliefs."""
    answer = replace(unplanned, text='planned', failed_beliefs=beliefs)
    return Readiness(Phase.READY, 'ready', answer, may_pass=beliefs > 0)


def test_another_attempt_takes_no_answer_away_while_it_goes_on(monkeypatch, played):
    monkeypatch.setattr('mirror_explainer.node.retries.FIRST_SECONDS', 0.01)
    goes_on = threading.Event()

    def refine(unplanned: Answer, stop: StopRequest) -> Readiness:
        robot.refiner.tell(told('a first answer'))
        if len(robot.refiner.asked) > 1:
            goes_on.wait(PATIENCE)
        return failing(unplanned, 1)

    robot = played(refine=refine)
    robot.submit('plan')
    eventually(lambda: len(robot.refiner.asked) == 2, 'another attempt')
    first = robot.updates.wait(PATIENCE)
    robot.submit('plan', progress='1')
    second = robot.updates.wait(PATIENCE)
    goes_on.set()

    assert [found.phase for found in (first, second)] == [Phase.READY] * 2
    assert second.preparation == Answer('plan', '1', 'planned', failed_beliefs=1)


@pytest.mark.parametrize('between', ['', 'x'])
def test_what_failed_is_tried_again_after_progress_and_after_what_was_wrong(
    monkeypatch, played, between
):
    monkeypatch.setattr('mirror_explainer.node.retries.FIRST_SECONDS', 2.0)
    robot = played(
        read=lambda inputs, stop: NO_MODEL if inputs.progress.text == 'x' else planning(inputs),
        refine=lambda unplanned, stop: failing(unplanned, 2 - len(robot.refiner.asked)),
    )
    robot.submit('plan')
    first = robot.updates.wait(PATIENCE)
    for step in (between, '1'):
        robot.submit('plan', progress=step)
        robot.updates.wait(PATIENCE)
    eventually(lambda: robot.updates.readiness.preparation.failed_beliefs == 0, 'a better one')

    assert first.preparation.failed_beliefs == 1
    assert robot.refiner.asked == ['plan'] * 2


def test_a_file_is_read_once_it_has_been_left_alone(monkeypatch, played, tmp_path: Path):
    monkeypatch.setattr(module, 'FILE_SETTLING_SECONDS', 1.0)
    monkeypatch.setattr(module, 'LONGEST_FILE_SETTLING_SECONDS', PATIENCE)
    file = tmp_path / 'user_model.yaml'
    file.write_text('0')
    texts = []
    robot = played(
        read=lambda inputs, stop: (
            texts.append(robot.reader.files.read(str(file))) or planning(inputs)
        )
    )
    robot.submit('plan')
    robot.updates.wait(PATIENCE)

    stalls = True
    while stalls:  # a machine that does leaves the file alone
        stalls = False
        texts.clear()
        for number in range(1, 31):
            began = time.monotonic()
            file.write_text(str(number))
            robot.updates.look_at_files()
            time.sleep(0.05)  # in all longer than the file has to be left alone
            stalls |= time.monotonic() - began > 0.5
        robot.updates.wait(PATIENCE)

    assert texts == ['30']


def test_a_file_that_is_never_left_alone_is_read_after_a_while(monkeypatch, played, tmp_path):
    monkeypatch.setattr(module, 'LONGEST_FILE_SETTLING_SECONDS', 0.7)
    file = tmp_path / 'user_model.yaml'
    file.write_text('')
    robot = played(
        read=lambda inputs, stop: (robot.reader.files.read(str(file)), planning(inputs))[1]
    )
    robot.submit('plan')
    robot.updates.wait(PATIENCE)
    end = time.monotonic() + PATIENCE
    while len(robot.reader.asked) < 3 and time.monotonic() < end:
        with file.open('a') as stream:
            stream.write('x')
        robot.updates.look_at_files()
        time.sleep(0.01)

    assert len(robot.reader.asked) >= 3


def test_a_call_does_not_wait_for_a_file_system_that_hangs(monkeypatch, played):
    robot = played()
    robot.submit('plan')
    assert robot.updates.wait(PATIENCE).phase is Phase.READY
    hangs, goes_on = threading.Event(), threading.Event()
    monkeypatch.setattr(robot.reader.files, 'changed', lambda: hangs.set() or goes_on.wait() and 0)
    first = threading.Thread(target=robot.updates.wait, args=[PATIENCE])
    first.start()
    assert hangs.wait(PATIENCE)

    heard = robot.updates.wait(0.01)

    assert first.is_alive()
    assert heard.phase is Phase.READY
    goes_on.set()
    first.join()


def test_a_listener_that_fails_changes_nothing(played):
    robot = played()
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
    robot = played(
        refine=lambda unplanned, stop: (
            BROKEN if len(robot.refiner.asked) < 3 else planned(unplanned, stop)
        )
    )
    robot.submit('plan')

    heard = [robot.updates.wait(PATIENCE).phase]
    end = time.monotonic() + PATIENCE
    while heard[-1] is Phase.ERROR and time.monotonic() < end:
        heard.append(robot.updates.wait(PATIENCE).phase)
        time.sleep(0.001)

    assert heard[0] is Phase.ERROR
    assert heard[-1] is Phase.READY
    assert len(robot.refiner.asked) == 3
    assert robot.phases_told(2) == [Phase.ERROR, Phase.READY]


@pytest.mark.parametrize(('then', 'kept'), [(25, 1), (1, 1), (0, 0)])
def test_another_attempt_replaces_an_answer_only_if_it_knows_more(monkeypatch, played, then, kept):
    monkeypatch.setattr('mirror_explainer.node.retries.FIRST_SECONDS', 0.01)
    failures = [1, then]
    robot = played(
        refine=lambda unplanned, stop: failing(
            unplanned, failures[min(len(robot.refiner.asked), 2) - 1]
        )
    )
    robot.submit('plan')
    robot.updates.wait(PATIENCE)
    eventually(lambda: len(robot.refiner.asked) > 2 - (then == 0), 'another attempt')
    eventually(
        lambda: robot.updates.readiness.preparation.failed_beliefs == kept, 'the better one'
    )

    assert robot.updates.wait(PATIENCE).preparation.failed_beliefs == kept
    told = 1 + (kept == 0)
    eventually(lambda: len(robot.phases_told(1)) == told, 'what it came to, and no more')


def test_closing_frees_who_waits_and_closes_the_maker(played):
    robot = played(refine=until_stopped)
    robot.submit('plan')
    heard = []
    waiting = threading.Thread(target=lambda: heard.append(robot.updates.wait(PATIENCE)))
    waiting.start()

    robot.updates.close()
    waiting.join(PATIENCE)

    assert heard[0].phase is Phase.PLANNING
    assert robot.refiner.closed
