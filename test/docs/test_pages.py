"""The documentation says what there is: the answer's keys, and few words to begin with."""

import json
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
WAREHOUSE = ROOT / 'config' / 'warehouse'
# What the page names beside keys: values, settings, parts of a call.
WORDS = {
    'message', 'inputs', 'done', 'running', 'ahead', 'first', 'replanned', 'remember', 'threshold',
    'unforeseen', 'partial_goals', 'interest_in_facts', 'interest_in_way',
}  # fmt: skip


def test_each_key_of_the_answer_is_explained():
    files = {'domain': 'domain.pddl', 'problem': 'problem.pddl', 'plan': 'plan.txt'}
    files['user-model'] = 'visitor.yaml'
    options = [word for n, f in files.items() for word in (f'--{n}', str(WAREHOUSE / f))]
    command = [sys.executable, '-m', 'mirror_explainer.verbalize', *options, '--json']
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    page = (ROOT / 'docs' / 'answer.md').read_text()
    named = set(re.findall(r'`(\w+)`', page))
    answer = json.loads(done.stdout)
    assert set(answer) <= named
    assert named - WORDS <= keys(answer), 'the page names what is not'


def keys(value: object) -> set[str]:
    """Return all keys in the answer."""
    found: set[str] = set()
    if isinstance(value, dict):
        found |= value.keys()
        for part in value.values():
            found |= keys(part)
    if isinstance(value, list):
        for part in value:
            found |= keys(part)
    return found


def test_the_readme_is_short():
    assert len((ROOT / 'README.md').read_text().split()) <= 1500
