"""Every command in README and docs is one that there is; those that need no robot are run."""

import importlib
import os
import re
import shlex
import subprocess
import sys
from collections.abc import Iterator
from functools import cache
from itertools import pairwise
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / 'README.md', ROOT / 'CONTRIBUTING.md', *sorted((ROOT / 'docs').glob('*.md'))]
# Pages whose commands are run in order, in one folder.
RUN = ('README.md', 'tutorial.md', 'verbalize.md')


def commands(page: Path) -> Iterator[list[str]]:
    """Yield the words of each command in a page's blocks, continued lines joined."""
    text = re.sub(r'\\\n\s*', ' ', page.read_text())
    for line in text.split('\n'):
        found = re.match(r'\s{4,}((?:ros2|python3? -m|scripts/)\b.*|scripts/.*)', line)
        if found:
            yield shlex.split(found[1], comments=True)


ALL = [(page, words) for page in PAGES for words in commands(page)]
NAMES = [f'{page.name}: {" ".join(words)[:70]}' for page, words in ALL]


def executables() -> dict[str, str]:
    """Return the package's programs with their modules."""
    return dict(re.findall(r"'(\w+) = ([\w.]+):main'", (ROOT / 'setup.py').read_text()))


def test_there_are_commands_of_each_kind():
    kinds = {words[0] for _, words in ALL}
    assert {'ros2', 'python3', 'scripts/demo', 'scripts/test'} <= kinds


@pytest.mark.parametrize(('page', 'words'), ALL, ids=NAMES)
def test_a_command_names_what_there_is(page: Path, words: list[str]):
    match words:
        case ['ros2', 'run', 'mirror_explainer', program, *rest]:
            assert program in executables()
            require_parameters(program, rest)
        case ['ros2', 'launch', 'mirror_explainer', file, *rest]:
            launched = (ROOT / 'launch' / file).read_text()
            known = launched + (ROOT / 'launch' / 'explainer.launch.py').read_text()
            for word in rest:
                assert f"'{word.split(':=')[0]}'" in known
        case ['python3' | 'python', '-m', module, *rest] if module.startswith('mirror_explainer'):
            importlib.import_module(module)
            require_options(module, rest)
        case [script, *_] if script.startswith('scripts/'):
            assert (ROOT / script).exists()


@pytest.mark.parametrize('page', PAGES, ids=lambda page: page.name)
def test_a_page_with_commands_of_ros_says_that_they_need_it(page: Path):
    text = ' '.join(page.read_text().split())
    ros = any(words[0] == 'ros2' for words in commands(page))
    assert not ros or "a robot's ROS" in text


def require_parameters(program: str, words: list[str]) -> None:
    """Require that the explainer has the parameters that are given to it."""
    given = [word.split(':=')[0] for before, word in pairwise(words) if before == '-p']
    if program == 'explainer_node':
        pytest.importorskip('rclpy', reason='needs ROS 2')
        from mirror_explainer.node.parameters import PARAMETERS

        assert set(given) <= {name for name, *_ in PARAMETERS} | {'use_sim_time'}


def require_options(module: str, words: list[str]) -> None:
    """Require that a command knows the options that are given to it."""
    for word in words:
        if word.startswith('--'):
            assert word.split('=')[0] in usage(module)


@cache
def usage(module: str) -> str:
    """Return what a command says of its options."""
    command = [sys.executable, '-m', module, '--help']
    return subprocess.run(command, capture_output=True, text=True, cwd=ROOT).stdout


@pytest.mark.parametrize('name', RUN)
def test_commands_that_need_no_robot_do_what_they_should(name: str, tmp_path: Path):
    page = next(page for page in PAGES if page.name == name)
    (clone := tmp_path / 'clone').mkdir()
    (clone / 'config').symlink_to(ROOT / 'config')
    write_tutorials_files(tmp_path)
    environment = os.environ | {'PYTHONPATH': f'{ROOT}:{os.environ.get("PYTHONPATH", "")}'}
    ran = [words for words in commands(page) if words[0].startswith('python')]
    ran = [words for words in ran if words[2].startswith('mirror_explainer')]
    assert ran
    for words in ran:
        done = subprocess.run(
            [sys.executable, *words[1:]],
            cwd=clone,
            env=environment,
            capture_output=True,
            text=True,
        )
        assert done.returncode == 0, done.stderr
        assert 'I will' in done.stdout


def write_tutorials_files(folder: Path) -> None:
    """Write the files that the tutorial has one save."""
    blocks = re.findall(r'```\w*\n(.*?)```', (ROOT / 'docs' / 'tutorial.md').read_text(), re.S)
    (folder / 'library').mkdir()
    for file, text in zip(('domain.pddl', 'problem.pddl', 'plan.txt'), blocks[:3], strict=True):
        (folder / 'library' / file).write_text(text)


def test_the_example_in_python_works(tmp_path: Path):
    [block] = re.findall(r'```python\n(.*?)```', (ROOT / 'docs' / 'api.md').read_text(), re.S)
    done = subprocess.run(
        [sys.executable, '-c', block],
        cwd=ROOT,
        env=os.environ | {'PYTHONPATH': f'{ROOT}:{os.environ.get("PYTHONPATH", "")}'},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    assert 'I will' in done.stdout
