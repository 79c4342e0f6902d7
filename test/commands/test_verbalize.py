"""The command as users meet it: a process with files, an exit status and two streams."""

import json
import os
import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import pytest
from patience import PATIENCE

import mirror_explainer
from mirror_explainer.commands.verbalize import main

PACKAGES_OF_ROS = ('rclpy', 'std_msgs', 'std_srvs', 'rcl_interfaces', 'diagnostic_msgs')
EXIT = 'I will exit from the bottom door.'
CUBE = 'I will grab a blue cube.'
CIRCLE = 'I will grab a red circle.'


@pytest.fixture(scope='module')
def without_ros(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """Return an environment in which importing ROS fails, wherever it may be installed."""
    folder = tmp_path_factory.mktemp('no_ros')
    for package in PACKAGES_OF_ROS:
        (folder / f'{package}.py').write_text('raise SystemExit("ROS was imported")\n')
    root = Path(mirror_explainer.__file__).parents[1]
    paths = [str(folder), str(root), os.environ.get('PYTHONPATH', '')]
    return {**os.environ, 'PYTHONPATH': os.pathsep.join(paths)}


@dataclass
class Done:
    """What came of a run of the command."""

    returncode: object
    stdout: str
    stderr: str


def arguments_of(words: Sequence[object], files: Mapping[str, object]) -> list[str]:
    """Return a command line with the example's files but for those given; None is left out."""
    named = {
        'domain': 'domain.pddl',
        'problem': 'problem.pddl',
        'plan': 'plan.txt',
        'user-model': 'user_model.yaml',
        **{name.replace('_', '-'): file for name, file in files.items()},
    }
    options = [(f'--{name}', str(file)) for name, file in named.items() if file is not None]
    return [*(word for pair in options for word in pair), *map(str, words)]


@pytest.fixture
def command(without_ros: dict[str, str], warehouse: Path):
    """Return a function that runs the command as a process, in the example's folder."""

    def run(*words: object, **files: object) -> Done:
        done = subprocess.run(
            [
                sys.executable,
                '-m',
                'mirror_explainer.verbalize',
                *arguments_of(words, files),
            ],
            cwd=warehouse,
            env=without_ros,
            capture_output=True,
            text=True,
            encoding='utf-8',
            timeout=2 * PATIENCE,
        )
        return Done(done.returncode, done.stdout, done.stderr)

    return run


@pytest.fixture
def verbalize(
    warehouse: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
):
    """Return a function that runs the command within this process, which takes less long."""
    monkeypatch.chdir(warehouse)

    def run(*words: object, **files: object) -> Done:
        try:
            status = main(arguments_of(words, files))
        except SystemExit as ended:  # argparse's way
            status = ended.code
        return Done(status, *capsys.readouterr())

    return run


def test_of_many_ends_that_are_left_and_long_names_only_the_first_are_told(command, tmp_path):
    rooms = [f'hall{number}' for number in range(1, 20)]
    swept = ' '.join(f'(swept {room})' for room in rooms)
    texts = {
        'domain': '(define (domain sweeping) (:predicates (swept ?r))'
        ' (:action sweep :parameters (?r) :precondition () :effect (swept ?r)))',
        'problem': f'(define (problem day) (:domain sweeping) (:objects {" ".join(rooms)}) (:init)'
        f' (:goal (and {swept})))',
        'plan': '\n'.join(f'(sweep {room})' for room in rooms),
        'user_model': f'goals: [{{goal: "(and {swept})"}}, {{goal: (swept hall1)}}]',
    }
    for name, text in texts.items():
        (tmp_path / name).write_text(text)

    done = command('--n', '1', **{name: tmp_path / name for name in texts})

    summary = done.stdout.split('\n\n')[1]
    assert 'to be "sweep hall1, hall2, hall3, ' in summary
    assert ' …" and is ' in summary
    unsaid = 'I will sweep hall2. I will sweep hall3. I will sweep hall4. And 14 more.'
    assert unsaid in summary


def test_plain_output_is_the_sentences_a_summary_the_order_and_the_curve(command) -> None:
    done = command('-n', '2', '--order', '--curve', '--listener', 'planner')

    assert (done.returncode, done.stderr) == (0, '')
    sentences, summary, order, curve = done.stdout.rstrip('\n').split('\n\n')
    assert sentences.splitlines() == ['I will grab a blue cube and a red circle.']
    for said in (
        'cannot tell yet: "a red circle and a blue cube, the bottom door" and "',
        '35% each (3% before)',
        f'Left unsaid: {EXIT}',
    ):
        assert said in summary
    assert '\n' not in summary
    assert 'nats' not in summary
    steps = order.splitlines()[1:]
    assert [int(step.split('.')[0]) for step in steps] == [*range(1, 9)]
    assert steps[0].split('  ')[-1] == EXIT
    assert '+1.00 nats' in steps[0] and '100%' in steps[2]
    head, *rows = curve.splitlines()
    assert head.split() == ['N', 'informative', 'increasing', 'decreasing']
    assert rows[1].split()[:4] == ['2', '2.36', 'nats', '35%']
    assert len(rows) == 8  # of ten steps three are one sentence

    head, *rows = command('--curve').stdout.rstrip('\n').split('\n\n')[-1].splitlines()
    assert len(rows) == 8 + 2 and rows[8].startswith('(Informative says at most N sentences')


def test_it_is_told_that_goals_seen_play_no_part_here(verbalize, tmp_path: Path, warehouse: Path):
    model = tmp_path / 'user.yaml'
    model.write_text((warehouse / 'user_model.yaml').read_text() + '\ngoals_seen: true\n')

    done = verbalize(user_model=model)

    assert 'goals_seen: true changes nothing here' in done.stderr
    assert done.stdout == verbalize().stdout


def test_json_has_everything_the_order_and_the_curve_too(command) -> None:
    planners = ('--selection-budget', '1', '--listener', 'planner')
    done = command('--json', '--order', '--curve', *planners, user_model='visitor.yaml')

    assert (done.returncode, done.stderr) == (0, '')
    told = json.loads(done.stdout, parse_constant=lambda name: pytest.fail(f'{name} is no JSON'))
    assert told['n'] == 3
    assert told['strategy'] == 'informative'
    assert told['optimal'] is told['complete'] is True
    assert len(told['hypotheses']) == 16
    assert told['seconds']['read'] > 0
    assert told['seconds']['planning'] > 0
    assert told['planner_calls'] > 0
    assert len(told['order']) == 8
    gains = [step['information_gain'] for step in told['order']]
    everything = told['curve'][-1]['informative']
    assert sum(gains) == pytest.approx(everything['information_gain'])
    assert everything['information_gain'] <= told['cross_entropy_before']
    assert told['order'][-1]['understanding'] == pytest.approx(1.0)
    assert [row['n'] for row in told['curve']] == [*range(1, 9)]
    for row in told['curve']:
        best = row['informative']
        assert best['gap'] == 0.0
        for strategy in ('informative', 'increasing', 'decreasing'):
            measures = row[strategy]
            assert best['information_gain'] >= measures['information_gain'] - 1e-9
            assert measures['cross_entropy'] == pytest.approx(
                told['cross_entropy_before'] - measures['information_gain'], abs=1e-9
            )
    assert told['curve'][2]['informative']['positions'] == told['positions']


def test_without_a_plan_it_plans_and_a_threshold_says_only_what_is_needed(
    verbalize, tmp_path: Path
) -> None:
    answer = tmp_path / 'answer.txt'

    done = verbalize(
        '--threshold', '1e-6', '--output', answer, '--listener', 'planner', plan=None,
        problem='low_battery_problem.pddl', user_model='visitor.yaml',
    )  # fmt: skip

    assert (done.returncode, done.stdout, done.stderr) == (0, '', '')
    sentences, summary = answer.read_text(encoding='utf-8').rstrip('\n').split('\n\n')
    assert 'I will recharge my battery.' in sentences.splitlines()
    assert len(sentences.splitlines()) < 8
    assert '100% sure (20% before)' in summary


def test_the_plan_that_was_found_can_be_kept_and_given_back(verbalize, tmp_path: Path) -> None:
    plan = tmp_path / 'plan.txt'

    first = verbalize('--save-plan', plan, plan=None)
    again = verbalize(plan=plan)

    assert len(plan.read_text().splitlines()) == 10
    assert first.stdout == again.stdout


def test_a_reader_who_has_enough_is_no_error(without_ros, warehouse: Path) -> None:
    words = ' '.join(arguments_of(['--json'], {}))
    done = subprocess.run(
        ['bash', '-c', f'"{sys.executable}" -m mirror_explainer.verbalize {words} | head -c 1'],
        cwd=warehouse,
        env=without_ros,
        capture_output=True,
        text=True,
        timeout=2 * PATIENCE,
    )

    assert (done.stdout, done.stderr) == ('{', '')


def test_what_was_said_and_the_strategy_shape_the_answer(verbalize, tmp_path: Path) -> None:
    said = tmp_path / 'said.txt'
    said.write_text(f'\ufeff{EXIT}\r\n\r\n  I will enter the red warehouse. \n', encoding='utf-8')

    done = verbalize(
        '--json', '-n', '2', '--strategy', 'decreasing', '--said', said, user_model='visitor.yaml'
    )

    assert (done.returncode, done.stderr) == (0, '')
    told = json.loads(done.stdout)
    assert told['strategy'] == 'decreasing'
    assert told['positions'] == [7, 8]  # 9, the exit, was said
    assert told['understanding_before'] > 0.2


TEN_FAULTS = """\
goals:
  - {goal: (holdin red_circle)}
  - {goal: (holding red_circl)}
  - {goal: (holding bottom_door)}
  - {gaol: (charged)}
uncertain_facts: [{fact: (charged), probability: 2.0}]
rationality: -1.0
colour: red
sentences:
  fly: I fly.
  move: "{nowhere}"
"""


def test_a_file_that_is_missing_is_named(command) -> None:
    done = command(domain='no_domain.pddl')

    assert (done.returncode, done.stdout) == (2, '')
    assert done.stderr == (
        'verbalize: no_domain.pddl: the file cannot be read: No such file or directory. Check the '
        'path: unless it is absolute, it begins where the program was started.\n'
    )


def test_an_output_that_cannot_be_written_is_named(verbalize) -> None:
    done = verbalize('--output', '/nowhere/said.txt', '-n', '1')

    assert done == Done(
        2,
        '',
        'verbalize: /nowhere/said.txt: the file cannot be written: No such file or directory\n',
    )


def test_all_faults_of_a_user_model_are_told(verbalize, tmp_path: Path) -> None:
    path = tmp_path / 'user.yaml'
    path.write_text(TEN_FAULTS)

    done = verbalize(user_model=path)

    assert (done.returncode, done.stdout) == (2, '')
    assert done.stderr.startswith(f'verbalize: {path}: 10 faults: line 2: goals[0].goal: ')
    assert len(done.stderr.splitlines()) == 1


def test_an_engine_that_is_not_there_is_told_and_what_is_known_without_it(verbalize) -> None:
    done = verbalize('--planner', 'no-such-engine')

    assert done.returncode == 0
    assert done.stdout.startswith('I will grab a blue cube and a red circle.\n')
    assert 'Planning was done for 0%' in done.stdout
    assert 'answered without planning' in done.stderr
    assert 'no-such-engine' in done.stderr
    assert len(done.stderr.splitlines()) == 1

    without_a_plan = verbalize('--planner', 'no-such-engine', plan=None)

    assert (without_a_plan.returncode, without_a_plan.stdout) == (2, '')
    assert 'no-such-engine' in without_a_plan.stderr


def test_a_deadline_that_is_over_at_once_leaves_an_answer(verbalize) -> None:
    done = verbalize('--deadline', '0.01')

    assert done.returncode == 0
    assert done.stdout.startswith('I will grab a blue cube and a red circle.\n')


def test_a_goal_that_the_robot_cannot_reach_is_told(verbalize, tmp_path: Path) -> None:
    problem = tmp_path / 'stuck.pddl'
    text = (Path(__file__).parents[2] / 'config/warehouse/problem.pddl').read_text()
    problem.write_text(text.replace('(charged))', ')').replace('(station-at center)', ''))

    done = verbalize(problem=problem, plan=None)

    assert (done.returncode, done.stdout) == (2, '')
    assert done.stderr == (
        "verbalize: the robot's own goal cannot be reached from its initial state, nor can "
        f'(outside bottom_door) alone. Correct the :init or the :goal of {problem}.\n'
    )


def test_bad_pddl_is_told_with_file_and_line(verbalize, tmp_path: Path, warehouse: Path) -> None:
    problem = tmp_path / 'problem.pddl'
    problem.write_text((warehouse / 'problem.pddl').read_text().replace('(robot-at', '(robt-at'))

    assert verbalize(problem=problem) == Done(
        2,
        '',
        f'verbalize: {problem}, line 13: (robt-at left): the domain has no predicate "robt-at" '
        '(did you mean "robot-at"?)\n',
    )


def test_files_mixed_up_are_told(verbalize) -> None:
    assert verbalize(domain='problem.pddl', problem='domain.pddl') == Done(
        2,
        '',
        'verbalize: problem.pddl, line 6: this is a PDDL problem, but a domain is expected here: '
        'are the two mixed up? Check which is which: the files, or the names and remappings of '
        'the topics.\n',
    )


def test_a_plan_for_another_problem_is_told_with_its_first_failing_step(verbalize) -> None:
    assert verbalize(problem='low_battery_problem.pddl') == Done(
        2,
        '',
        'verbalize: plan.txt, line 10: (exit bottom_door right) cannot be carried '
        'out as step 10 of 10: (charged) does not hold. See whether a step before it is missing '
        'or out of order, or the :init of the problem is not the state in which the plan starts. '
        '(A robot must publish problem and plan one right after the other, whenever either '
        'changes.)\n',
    )


def test_an_empty_plan_is_told(verbalize, tmp_path: Path) -> None:
    plan = tmp_path / 'plan.txt'
    plan.write_text('; cost = 0\n')

    assert verbalize(plan=plan) == Done(
        2,
        '',
        f'verbalize: {plan}: the plan is empty, and the goal does not hold yet. '
        'Leave --plan out, and a plan is made.\n',
    )


def test_a_file_that_is_no_text_is_told(verbalize, tmp_path: Path) -> None:
    binary = tmp_path / 'plan.txt'
    binary.write_bytes(b'\xff\xfe(\x00')

    done = verbalize(plan=binary)

    assert done.returncode == 2
    assert done.stderr.startswith(f'verbalize: {binary}, line 1: this is no UTF-8 text: ')


def test_a_folder_in_place_of_a_file_is_told(verbalize, tmp_path: Path) -> None:
    assert verbalize(plan=tmp_path) == Done(
        2, '', f'verbalize: {tmp_path}: the file cannot be read: Is a directory\n'
    )


@pytest.mark.parametrize(
    ('option', 'value', 'said'),
    [
        ('-n', 'x', 'argument -n/--n: "x" is no whole number from 1 to 1000'),
        ('-n', '0', 'argument -n/--n: "0" is no whole number from 1 to 1000'),
        ('--max-beliefs', '0', 'argument --max-beliefs: "0" is no whole number from 1 to 1000000'),
        ('--threshold', 'nan', 'argument --threshold: "nan" is no number from 0 to 1000'),
        ('--threshold', 'much', 'argument --threshold: "much" is no number from 0 to 1000'),
        ('--strategy', 'random', "argument --strategy: invalid choice: 'random'"),
    ],
)
def test_a_bad_option_is_told_in_words(verbalize, option: str, value: str, said: str) -> None:
    done = verbalize(option, value)

    assert (done.returncode, done.stdout) == (2, '')
    assert said in done.stderr
