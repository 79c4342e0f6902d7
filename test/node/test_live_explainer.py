"""The explainer under the node, driven without ROS: real planner, real texts, no middleware."""

import json
import threading
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
import sliding_tiles
from conftest import WAREHOUSE
from patience import PATIENCE, eventually

from mirror_explainer.node import live_explainer as module
from mirror_explainer.node.diagnostics import Level
from mirror_explainer.node.inputs import Configuration, Text
from mirror_explainer.node.live_explainer import LiveExplainer
from mirror_explainer.node.surroundings import Others

DOMAIN, PROBLEM, PLAN = (
    (WAREHOUSE / name).read_text() for name in ('domain.pddl', 'problem.pddl', 'plan.txt')
)
USER_MODEL = str(WAREHOUSE / 'user_model.yaml')
THREE_SENTENCES = 'I will grab a blue cube and a red circle.\nI will exit from the bottom door.'


class Operator:
    """Stands between a live explainer and a test: publishes, asks, sets, and keeps the answers."""

    def __init__(self, **settings: object) -> None:
        self.published: list[tuple[str, str]] = []
        self.configuration = self._with(Configuration(), answer_timeout=PATIENCE, **settings)
        self.explainer = LiveExplainer(self.configuration, self._publish)

    def _publish(self, text: str, report: str) -> None:
        self.published.append((text, report))

    @staticmethod
    def _with(configuration: Configuration, **settings: object) -> Configuration:
        changes: dict[str, Any] = {}
        for name, value in settings.items():
            part = next(p for p in vars(configuration) if hasattr(getattr(configuration, p), name))
            changes[part] = replace(
                changes.get(part, getattr(configuration, part)), **{name: value}
            )
        return replace(configuration, **changes)

    def set(self, **settings: object) -> None:
        """Set parameters by their names."""
        self.configuration = self._with(self.configuration, **settings)
        self.explainer.configure(self.configuration)

    def publish(self, **texts: str) -> None:
        """Publish texts, each on the topic of its name."""
        for name, text in texts.items():
            self.explainer.hear(name, Text(text, f'/{name}'))

    def answer(self) -> str:
        """Ask, and return the answer."""
        reply = self.explainer.ask()
        assert reply.success, reply.message
        return reply.message

    def refusal(self) -> str:
        """Ask, and return why there is no answer."""
        reply = self.explainer.ask()
        assert not reply.success, reply.message
        return reply.message


@pytest.fixture
def operator() -> Iterator[Callable[..., Operator]]:
    """Return a function that starts an explainer with these parameters."""
    operators: list[Operator] = []

    def start(**settings: object) -> Operator:
        operators.append(Operator(**settings))
        return operators[-1]

    yield start
    for operator in operators:
        operator.explainer.close()


@pytest.fixture(scope='module')
def shared() -> Iterator[Operator]:
    """One explainer for all tests that leave it as it was."""
    operator = Operator(user_model_file=USER_MODEL)
    yield operator
    operator.explainer.close()


@pytest.fixture
def served(shared: Operator) -> Iterator[Operator]:
    """The shared explainer with the warehouse's task; afterwards it is as before."""
    before = shared.configuration
    shared.publish(domain=DOMAIN, problem=PROBLEM, plan=PLAN)
    yield shared
    shared.configuration = before
    shared.explainer.configure(before)
    shared.explainer.forget()


def test_what_is_missing_is_said_until_all_has_been_heard(operator) -> None:
    robot = operator()
    nothing, for_the_operator = robot.refusal(), robot.explainer.diagnose(Others()).message
    robot.publish(plan=PROBLEM)
    mixed_up = robot.refusal()
    robot.publish(domain=DOMAIN, plan=PLAN)
    rest, of_the_rest = robot.refusal(), robot.explainer.diagnose(Others()).message
    robot.publish(problem=PROBLEM)

    assert nothing == 'I have no plan yet.'
    assert for_the_operator == (
        'waiting for domain (topic, or parameter domain_file), problem (topic), plan (topic)'
    )
    assert mixed_up.startswith(
        '/plan, line 1: this is a PDDL definition, but a plan is expected here'
    )
    assert rest == 'I do not know yet. Please ask me again in a moment.'
    assert of_the_rest == 'waiting for problem (topic)'
    # Without a user model the parts of the goal are told.
    assert robot.answer() == (
        'I will grab the blue cube from the blue room.\n'
        'I will grab the red circle from the red room.\n'
        'I will exit through the bottom door.'
    )
    warnings = robot.explainer.diagnose(Others()).values['warnings']
    assert warnings.startswith('no user model is named (parameter user_model_file)')
    robot.set(user_model_file=USER_MODEL)
    assert robot.answer() == THREE_SENTENCES


def test_the_domain_may_come_from_a_file_and_a_message_replaces_it(operator) -> None:
    robot = operator(domain_file=str(WAREHOUSE / 'domain.pddl'), user_model_file=USER_MODEL)
    robot.publish(problem=PROBLEM, plan=PLAN)
    from_file = robot.answer()
    robot.publish(domain='(define (domain other))')

    assert from_file == THREE_SENTENCES
    assert 'the domain given is "other"' in robot.refusal()


def test_each_answer_is_published_with_its_report(served) -> None:
    answer = served.answer()
    text, report = served.published[-1]

    assert text == answer
    assert json.loads(report)['spoken'] == answer
    assert len(json.loads(report)['sentences']) == 3
    assert 'hypotheses' not in json.loads(report)


def test_settings_act_at_once(served, tmp_path: Path) -> None:
    served.set(n=1)
    one = served.answer()
    served.set(n=2, strategy='decreasing')
    last_two = served.answer()
    served.set(user_model_file=str(tmp_path / 'nowhere.yaml'))
    without_model = served.refusal()
    served.set(user_model_file=USER_MODEL, n=3, strategy='informative')

    assert one == 'I will exit from the bottom door.'
    assert last_two == 'I will navigate to the right corridor.\nI will exit from the bottom door.'
    assert 'nowhere.yaml: the file cannot be read' in without_model
    assert served.answer() == THREE_SENTENCES


def test_limits_that_are_lowered_hold_for_what_was_read_before_too(served) -> None:
    served.answer()
    served.set(max_objects=5)

    assert 'max_objects allows (now 5)' in served.refusal()


def test_with_remember_asking_again_tells_more_until_it_is_forgotten(served) -> None:
    served.set(remember=True, n=2)
    first, second, third = served.answer(), served.answer(), served.answer()
    forgotten = served.explainer.forget()

    assert first == 'I will grab a blue cube and a red circle.'
    assert second == 'I will exit from the bottom door.'
    assert third == 'The rest is only details.'
    assert forgotten == 3
    assert served.answer() == first


BAD_INPUTS = {
    'PDDL that does not parse': ('problem', PROBLEM[:-40], '/problem'),
    'a plan for another problem': ('plan', '(fly a b)', '/plan, line 1: the domain has no action'),
    'an unknown object': ('plan', '(move left mars)', 'no object "mars"'),
    'a first action that fails': ('plan', '(grab red_cube red_room)', '(robot-at red_room)'),
    'a plan that stops early': ('plan', '(move left center)', 'does not reach the goal'),
    'a problem on the plan topic': ('plan', PROBLEM, 'a plan is expected here'),
    'a plan on the problem topic': ('problem', PLAN, 'must begin with (define (problem'),
    'a domain on the problem topic': ('problem', DOMAIN, 'a problem is expected here'),
    'an empty problem': ('problem', '', 'the text is empty'),
    'an empty domain': ('domain', ' \n', 'the text is empty'),
    'noise': ('plan', 'x y\n' * 100_000, '/plan, line 1: this is no action'),
    'noise in place of PDDL': ('problem', '\x7f(§' * 100_000, '/problem'),
    'too much noise': (
        'plan',
        'x y\n' * 5_000_000,
        '/plan: its bytes (20000000) are more than max_',
    ),
}


@pytest.mark.parametrize('what', BAD_INPUTS)
def test_bad_input_is_told_by_calls_and_diagnostics_until_good_input_comes(
    served, what: str
) -> None:
    topic, text, expected = BAD_INPUTS[what]
    served.publish(**{topic: text})
    reason = served.refusal()
    diagnosis = served.explainer.diagnose(Others())
    served.publish(domain=DOMAIN, problem=PROBLEM, plan=PLAN)

    assert expected in reason
    assert '\n' not in reason
    assert diagnosis.message == reason
    assert diagnosis.level is Level.ERROR
    assert served.answer() == THREE_SENTENCES
    healed = served.explainer.diagnose(Others())
    assert (healed.level, healed.message) == (Level.OK, 'ready')


def test_a_robot_without_a_plan_says_so_in_the_user_models_words_and_diagnostics_in_theirs(
    served, model_file
) -> None:
    phrases = 'phrases: {no_plan: I wait for orders., wrong_input: I cannot tell you.}'
    words = f'{Path(USER_MODEL).read_text()}\n{phrases}\n'
    served.publish(plan='')
    by_default = served.refusal()
    served.set(user_model_file=str(model_file(words)))
    in_own_words = served.refusal()
    diagnosis = served.explainer.diagnose(Others())
    served.publish(plan='(fly')

    assert by_default == 'I have nothing to do right now.'
    assert in_own_words == 'I wait for orders.'
    assert served.refusal() == 'I cannot tell you.'
    assert served.explainer.diagnose(Others()).message.startswith('/plan, line 1: ')
    assert diagnosis.level is Level.WARN
    assert diagnosis.message == '/plan: the robot has no current plan'


def test_a_call_before_the_texts_are_read_is_asked_to_come_again(served) -> None:
    served.set(answer_timeout=0.0)
    served.publish(plan=PLAN + '; again')

    assert served.refusal() == 'I do not know yet. Please ask me again in a moment.'


def test_a_user_model_with_faults_fails_calls_until_the_file_is_mended(
    served, tmp_path: Path
) -> None:
    user_model = tmp_path / 'user_model.yaml'
    user_model.write_text('goals:\n  - goal: (holding nothing)\n  - goal: (outside red_cube)\n')
    served.set(user_model_file=str(user_model))
    reason = served.refusal()
    diagnosed = served.explainer.diagnose(Others()).message
    user_model.write_text(Path(USER_MODEL).read_text())

    assert reason == (
        f'{user_model}, line 2: goals[0].goal: the problem has no object '
        '"nothing"; and 1 more fault: see the log or /diagnostics'
    )
    assert f'{user_model}: 2 faults: line 2: ' in diagnosed
    assert 'line 3: ' in diagnosed
    assert served.answer() == THREE_SENTENCES


def test_an_internal_error_is_a_refusal_and_ends_nothing(monkeypatch, served) -> None:
    served.answer()

    def fail(*arguments: object) -> None:
        raise RuntimeError('something is \x1b[31m broken')

    with monkeypatch.context() as patched:
        patched.setattr(module.Answers, 'give', fail)
        refusal = served.refusal()

    assert refusal.startswith('internal error, please report it: RuntimeError(')
    assert '\x1b' not in refusal
    assert served.answer() == THREE_SENTENCES


@pytest.fixture
def puzzled(operator, tmp_path: Path) -> Operator:
    """An explainer of the 15-puzzle, patient enough to plan for the whole test."""
    user_model = tmp_path / 'tiles.yaml'
    user_model.write_text(sliding_tiles.USER_MODEL)
    robot = operator(user_model_file=str(user_model), planning_timeout=600.0, deadline=600.0)
    robot.publish(domain=sliding_tiles.DOMAIN)
    return robot


def publish_tiles(robot: Operator, moves: int) -> list[str]:
    """Publish a puzzle; return the sentences of its plan."""
    problem, plan = sliding_tiles.scrambled(moves, seed=moves)
    robot.publish(problem=problem, plan=plan)
    return sliding_tiles.sentences(plan)


def test_a_call_that_waits_is_answered_about_the_newest_plan(puzzled) -> None:
    publish_tiles(puzzled, moves=200)
    heard: list[str] = []
    waiting = threading.Thread(target=lambda: heard.append(puzzled.answer()))
    waiting.start()
    eventually(
        lambda: 'planning 0 of 2' in puzzled.explainer.diagnose(Others()).message, 'the planning'
    )
    sentences = publish_tiles(puzzled, moves=3)
    waiting.join(PATIENCE)

    assert set(heard[0].split('\n')) <= set(sentences)


def test_where_planning_takes_longer_than_calls_wait_they_are_answered_from_what_is_known(
    puzzled,
) -> None:
    puzzled.set(answer_timeout=0.0)
    sentences = publish_tiles(puzzled, moves=200)
    reply = eventually(lambda: (found := puzzled.explainer.ask()).success and found, 'an answer')
    report = json.loads(puzzled.published[-1][1])
    diagnosis = puzzled.explainer.diagnose(Others())

    assert set(reply.message.split('\n')) <= set(sentences)
    assert not report['complete']
    assert report['planned'] < 1.0
    assert (diagnosis.values['state'], diagnosis.message) == ('planning', 'planning 0 of 2')
    assert float(diagnosis.values['planned']) == pytest.approx(report['planned'])
    assert 'hypotheses' not in diagnosis.values


def test_what_planning_finds_is_published_by_the_next_call_and_not_by_itself(served) -> None:
    served.set(answer_timeout=0.0)
    served.publish(plan=PLAN + '; another text')
    eventually(lambda: served.explainer.ask().success, 'the first answer')
    eventually(
        lambda: served.explainer.diagnose(Others()).message == 'ready',
        'the end of the planning',
    )
    before = len(served.published)
    answer = served.answer()

    assert before >= 1
    assert len(served.published) == before + 1
    assert answer == THREE_SENTENCES
    assert json.loads(served.published[-1][1])['complete']


def test_more_calls_than_may_wait_are_answered_at_once(puzzled) -> None:
    sentences = publish_tiles(puzzled, moves=200)
    puzzled.explainer._waiting = threading.Semaphore(1)
    waiting = threading.Thread(target=puzzled.explainer.ask)
    waiting.start()
    eventually(lambda: not puzzled.explainer._waiting._value, 'the call that waits')
    reply = eventually(lambda: (found := puzzled.explainer.ask()).success and found, 'an answer')
    still_waiting = waiting.is_alive()
    puzzled.explainer.close()
    waiting.join(PATIENCE)

    assert still_waiting
    assert set(reply.message.split('\n')) <= set(sentences)
