"""What commands say on a terminal, and in a pipe."""

import importlib
import os
import pty
import re
import subprocess
import sys

import pytest

from mirror_explainer.commands.command_line import command_parser

pytest.importorskip('rich', reason='the extra [experiments] is not installed')

TELL = """
from mirror_explainer.commands.terminal import tell, tell_error, tell_table, tell_warning
from mirror_explainer.errors import InputError
tell_table('Found', ('observer', 'n'), [(('people [red]', '3'), True), (('same', '10'), False)])
tell('I will go. ' * 9, 'bold')
tell_warning('compare', 'slow')
tell_error('user_study', InputError('study.yaml', 'no [bold] title', 3))
"""
COLOUR = b'\x1b['


def test_a_part_of_an_options_name_is_not_taken_for_it(capsys):
    with pytest.raises(SystemExit):
        command_parser('robot', 'Goes.').parse_args(['--vers'])
    assert 'unrecognized arguments: --vers' in capsys.readouterr().err


def test_a_pipe_gets_no_colour_and_all_the_words():
    done = subprocess.run([sys.executable, '-c', TELL], capture_output=True)

    assert COLOUR not in done.stdout + done.stderr
    assert b'people [red]   3' in done.stdout
    assert b'I will go. ' * 9 in done.stdout
    assert done.stderr == (
        b'compare: warning: slow\nuser_study: study.yaml, line 3: no [bold] title\n'
    )


def test_a_terminal_gets_colour():
    ours, theirs = pty.openpty()
    environment = {**os.environ, 'TERM': 'xterm-256color', 'COLUMNS': '100'}
    environment.pop('NO_COLOR', None)
    subprocess.run(
        [sys.executable, '-c', TELL], stdout=theirs, stderr=theirs, env=environment, check=True
    )
    os.close(theirs)
    told = os.read(ours, 10_000)
    os.close(ours)

    assert told.count(COLOUR) >= 8  # a beginning and an end each
    assert b'I will go. ' * 9 in told  # in one line: the terminal breaks it
    assert b'no [bold] title' in told


COMMANDS = {
    'verbalize': 'commands.verbalize',
    'compare': 'commands.compare',
    'draft_user_model': 'commands.draft_user_model',
    'user_study': 'experiments.study.user_study',
    'who_understands': 'experiments.understanding.who_understands',
    'pucrs_benchmark': 'experiments.benchmark.pucrs',
    'planning_speed': 'experiments.planning.speed',
    'plans_per_belief': 'experiments.planning.plans_per_belief',
    'scale': 'experiments.planning.scale',
    'operator_page': 'web.operator.operator_page',
    'warehouse_robot': 'demo.warehouse_robot',
    'task_list_robot': 'demo.task_list_robot',
    'explainer_node': 'node.explainer_node',
    'plansys2_bridge': 'node.plansys2_bridge',
}
OF_ROS = {name for name, module in COMMANDS.items() if module.startswith(('web', 'demo', 'node'))}


@pytest.mark.parametrize('name', COMMANDS)
def test_a_command_tells_its_version_and_its_help_has_examples_that_it_takes(name, capsys):
    if name in OF_ROS:
        pytest.importorskip('rclpy', reason='needs ROS 2')
    main = importlib.import_module(f'mirror_explainer.{COMMANDS[name]}').main
    # A robot's node gets the program's name before its arguments.
    first = [name] if name in OF_ROS and name != 'operator_page' else []

    def said(*arguments):
        with pytest.raises(SystemExit) as ended:
            main([*first, *arguments])
        assert ended.value.code == 0
        return capsys.readouterr().out

    assert said('--version').startswith(f'{name} ')
    usage = said('--help')
    examples = re.findall(r'(?:python3 -m [\w.]+|ros2 run mirror_explainer \w+)(.*)', usage)
    assert examples
    for example in examples:
        own = example.split(' --ros-args')[0].split()
        help_ = said(own[0], '--help') if own and not own[0].startswith('-') else usage
        assert [word for word in own if word.startswith('-') and word not in help_] == []
