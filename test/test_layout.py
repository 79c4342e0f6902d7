"""The package's layout: few folders, and imports that run one way (setup.cfg says which)."""

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PACKAGE = ROOT / 'mirror_explainer'


def test_imports_run_one_way_and_in_no_circle():
    pytest.importorskip('importlinter', reason='needs import-linter')
    done = subprocess.run(
        [Path(sys.executable).parent / 'lint-imports', '--no-cache'],
        cwd=ROOT,
        env={'PYTHONPATH': str(ROOT)},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_packages_top_is_a_table_of_contents():
    inside = [path for path in PACKAGE.iterdir() if path.name != '__pycache__']
    assert len([path for path in inside if path.is_dir()]) <= 9
    assert len([path for path in inside if path.is_file()]) <= 8
