"""The documentation says what there is: the answer's keys, and few words to begin with."""

import json
import re
import subprocess
import sys
from pathlib import Path

from mirror_explainer import explain_files

ROOT = Path(__file__).parents[2]
WAREHOUSE = ROOT / 'config' / 'warehouse'
# What the page names beside keys: values, settings, parts of a call.
WORDS = {
    'message', 'inputs', 'done', 'running', 'ahead', 'first', 'replanned', 'again', 'remember',
    'threshold', 'skipped', 'restarted', 'resumed',
    'unforeseen', 'partial_goals', 'interest_in_facts', 'interest_in_way',
}  # fmt: skip


def answer_for(user_model: str) -> dict[str, object]:
    """Return the warehouse's answer of three sentences for one of its listeners."""
    files = {'domain': 'domain.pddl', 'problem': 'problem.pddl', 'plan': 'plan.txt'}
    files['user-model'] = user_model
    options = [word for n, f in files.items() for word in (f'--{n}', str(WAREHOUSE / f))]
    command = [sys.executable, '-m', 'mirror_explainer.verbalize', *options, '--json', '-n', '3']
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    return json.loads(done.stdout)


def test_the_readmes_example_is_what_the_robot_says():
    answer = answer_for('user_model.yaml')
    readme = (ROOT / 'README.md').read_text()
    assert '\n'.join(f'> {line}' for line in answer['spoken'].split('\n')) in readme
    understood = [row['understanding'] for row in answer['baselines']]
    likely = [f'*{round(100 * p)} % likely*' for p in (*understood, answer['understanding'])]
    assert ' | '.join(likely) in readme


FLEET = """(define (domain fleet) (:requirements :strips :typing) (:types robot area)
  (:predicates (clean ?a - area))
  (:action clean :parameters (?robot - robot ?area - area) :effect (clean ?area)))"""


def test_a_plan_for_several_robots_says_who_does_what(tmp_path):
    page = (ROOT / 'docs' / 'user_model.md').read_text()
    sentences = re.search(r'"I" does not tell who.*?```yaml\n(.*?)```', page, re.DOTALL)[1]
    goal = '(and (clean gate_b2) (clean gate_a14))'
    (tmp_path / 'domain.pddl').write_text(FLEET)
    (tmp_path / 'problem.pddl').write_text(
        '(define (problem p) (:domain fleet) (:objects buffy shiny - robot '
        f'gate_A14 gate_B2 - area) (:goal {goal}))'
    )
    (tmp_path / 'plan.txt').write_text('(clean shiny gate_b2)\n(clean buffy gate_a14)')
    (tmp_path / 'user.yaml').write_text(f'goals: [{{goal: {goal}}}]\n{sentences}')
    texts = (tmp_path / 'domain.pddl', tmp_path / 'problem.pddl', tmp_path / 'plan.txt')

    spoken = explain_files(*texts, user_model=tmp_path / 'user.yaml').spoken

    assert spoken == 'Shiny will clean gate B2.\nI will clean gate A14.'


def test_each_key_of_the_answer_is_explained():
    page = (ROOT / 'docs' / 'answer.md').read_text()
    named = set(re.findall(r'`(\w+)`', page))
    answer = answer_for('visitor.yaml')
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
