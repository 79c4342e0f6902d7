"""What commands say on a terminal, and in a pipe."""

import os
import pty
import subprocess
import sys

import pytest

pytest.importorskip('rich', reason='the extra [experiments] is not installed')

TELL = """
from mirror_explainer.commands.terminal import tell_error, tell_table
from mirror_explainer.errors import InputError
tell_table('Found', ('observer', 'n'), [(('people [red]', '3'), True), (('same', '10'), False)])
tell_error('user_study', InputError('study.yaml', 'no [bold] title', 3))
"""
COLOUR = b'\x1b['


def test_a_pipe_gets_no_colour_and_all_the_words():
    done = subprocess.run([sys.executable, '-c', TELL], capture_output=True)

    assert COLOUR not in done.stdout + done.stderr
    assert b'people [red]   3' in done.stdout
    assert done.stderr == b'user_study: study.yaml, line 3: no [bold] title\n'


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

    assert COLOUR in told
    assert b'no [bold] title' in told


@pytest.mark.parametrize('module', ['experiments.study.user_study', 'web.operator.operator_page'])
def test_commands_tell_their_version(module):
    if 'operator' in module:
        pytest.importorskip('rclpy', reason='needs ROS 2')
    command = [sys.executable, '-m', f'mirror_explainer.{module}', '--version']
    done = subprocess.run(command, capture_output=True, text=True, check=True)

    assert done.stdout.startswith(f'{module.split(".")[-1]} ')
