"""The scripts say what they lack before they do anything."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

SCRIPTS = Path(__file__).parents[1] / 'scripts'
# An interpreter that takes itself for an old one.
OLD = f"""#!/bin/sh
exec {sys.executable} -c "import sys
sys.version, sys.version_info = '3.10.13 (main)', (3, 10, 13)
$2"
"""


@pytest.mark.parametrize(
    ('python', 'told'),
    [
        ('./python3.1O', './python3.1O cannot be run as Python: name one of 3.11 or newer'),
        ('./old', 'This needs Python 3.11 or newer, which ./old is not'),
    ],
)
def test_an_interpreter_that_will_not_do_costs_no_environment(
    python: str, told: str, tmp_path: Path
) -> None:
    shutil.copytree(SCRIPTS, tmp_path / 'scripts')
    (tmp_path / 'setup.py').touch()
    (tmp_path / '.venv').mkdir()
    (tmp_path / 'old').write_text(OLD)
    (tmp_path / 'old').chmod(0o755)

    demo = subprocess.run(
        [tmp_path / 'scripts' / 'demo'],
        env={**os.environ, 'PYTHON': python},
        capture_output=True,
        text=True,
    )

    assert demo.returncode == 1
    assert told in demo.stderr
    assert (tmp_path / '.venv').is_dir()


def test_without_ros_the_one_who_asks_is_told_so() -> None:
    words = [sys.executable, '-I', '-S', SCRIPTS / 'ask.py', '--once']
    asked = subprocess.run(words, capture_output=True, text=True)
    assert asked.returncode == 1
    assert asked.stderr.startswith('there is no rclpy here: source ROS 2')
    assert len(asked.stderr.splitlines()) == 1
