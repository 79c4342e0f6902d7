"""The GPL translator is imported in one folder only, and only in a process of its own."""

import ast
import subprocess
import sys
from pathlib import Path

PACKAGE = Path(__file__).parents[2] / 'mirror_explainer'


def imported(file: Path) -> set[str]:
    """Return the top names of all that a file imports."""
    names: set[str] = set()
    for node in ast.walk(ast.parse(file.read_text())):
        if isinstance(node, ast.Import):
            names |= {alias.name.split('.')[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            names.add(node.module.split('.')[0])
    return names


def test_one_folder_alone_imports_the_translator() -> None:
    importing = {
        file.parent.relative_to(PACKAGE).as_posix()
        for file in PACKAGE.rglob('*.py')
        if imported(file) & {'fast_downward', 'up_fast_downward', 'kstar_planner'}
    }

    assert importing == {'planning/downward/grounding'}


def test_who_imports_the_package_does_not_load_the_translator() -> None:
    code = (
        'import sys, mirror_explainer, mirror_explainer.planning\n'
        "assert not any(name.startswith('fast_downward') for name in sys.modules)"
    )
    subprocess.run([sys.executable, '-c', code], cwd=PACKAGE.parent, check=True)
