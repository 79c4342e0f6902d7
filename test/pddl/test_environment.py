"""unified-planning without its engines: what tasks need of it is there, and little else."""

import subprocess
import sys

from unified_planning import environment
from unified_planning.environment import Environment

from mirror_explainer.pddl import forget_expressions, read_task
from mirror_explainer.pddl.environment import TaskEnvironment

EXPLAINS = """
import sys
from pathlib import Path
from mirror_explainer.explainer import explain, robot_plan
from mirror_explainer.listener.preparation import prepare
from mirror_explainer.listener.user_model import read_user_model
from mirror_explainer.pddl import read_task

folder = Path(sys.argv[1])
domain, problem, plan = (
    (folder / name).read_text() for name in ('domain.pddl', 'problem.pddl', 'plan.txt')
)
task = read_task(domain, problem)
user_model = read_user_model(folder / 'user_model.yaml', task)
print(explain(prepare(task, robot_plan(task, plan), user_model)).spoken)
print(*(name for name in ('scipy.stats', 'ConfigSpace') if name in sys.modules))
"""


def test_what_engines_are_made_of_is_not_loaded_to_explain_a_plan(warehouse):
    *said, loaded = subprocess.run(
        [sys.executable, '-c', EXPLAINS, str(warehouse)],
        capture_output=True,
        text=True,
        check=True,
    ).stdout.split('\n')[:-1]

    assert said[0].startswith('I will')
    assert loaded == ''


def test_each_part_is_of_the_kind_that_unified_planning_has():
    theirs, ours = Environment(), TaskEnvironment()
    parts = [name for name, part in vars(Environment).items() if isinstance(part, property)]
    assert 'expression_manager' in parts
    for name in parts:
        if name != 'credits_stream':  # a stream there, and none here
            assert type(getattr(ours, name)) is type(getattr(theirs, name)), name


def test_a_program_that_has_begun_with_unified_planning_keeps_its_environment(monkeypatch):
    theirs = Environment()
    monkeypatch.setattr(environment, 'GLOBAL_ENVIRONMENT', theirs)
    domain = '(define (domain d) (:predicates (on)))'
    task = read_task(domain, '(define (problem p) (:domain d) (:init (on)) (:goal (on)))')
    assert task.model.environment is theirs
    forget_expressions()
    assert isinstance(environment.get_environment(), TaskEnvironment)
