"""Names in messages that look like options, paths, commands or formats: what becomes of them."""

import pytest

from mirror_explainer.errors import InputError
from mirror_explainer.explainer import robot_plan
from mirror_explainer.pddl import read_task
from mirror_explainer.planning import Belief, BeliefSpace, Planner

DOMAIN = """(define (domain DOMAIN)
  (:predicates (here ?a) (FACT ?a))
  (:action ACTION :parameters (?a) :precondition (here ?a) :effect (FACT ?a)))"""
PROBLEM = """(define (problem PROBLEM) (:domain DOMAIN) (:objects OBJECT)
  (:init (here OBJECT)) (:goal (FACT OBJECT)))"""
PLACES = {
    'DOMAIN': 'd', 'PROBLEM': 'p', 'OBJECT': 'o', 'ACTION': 'act', 'FACT': 'done'
}  # fmt: skip

# No PDDL: a name has letters, digits, - and _, and begins with a letter.
REFUSED = [
    '--help', '../../x', '/etc/passwd', '$(touch', '`id`', 'a;rm', 'a|sh', 'a"b', 'a%s%n', '{a}',
    '@goal0', 'a\x1b[31m',
]  # fmt: skip

# PDDL, but words of the planner's own formats, of PDDL, or like options.
LEGAL = ['end_operator', 'begin_state', 'atom', 'define', 'goal', 'a--help', 'rm-rf', 'con']


def texts(**names: str) -> tuple[str, str]:
    """Return domain and problem with these names in their places."""
    domain, problem = DOMAIN, PROBLEM
    for place, name in (PLACES | names).items():
        domain, problem = domain.replace(place, name), problem.replace(place, name)
    return domain, problem


@pytest.mark.parametrize('name', REFUSED)
def test_what_could_be_an_option_a_path_or_a_command_is_no_name(name: str) -> None:
    for place in PLACES:
        with pytest.raises(InputError):
            read_task(*texts(**{place: name}))


def test_such_words_in_a_plan_are_no_action_of_the_domain() -> None:
    task = read_task(*texts())
    for name in REFUSED:
        with pytest.raises(InputError):
            robot_plan(task, f'({name} o)')
        with pytest.raises(InputError):
            robot_plan(task, f'(act {name})')


@pytest.mark.parametrize(
    ('engine', 'shortcuts'),
    [('fast-downward-opt', True), ('fast-downward-opt', False), ('pyperplan-opt', False)],
    ids=['grounded once', 'by files', 'pyperplan'],
)
def test_every_engine_gives_legal_names_back_as_they_were(engine: str, shortcuts: bool) -> None:
    domain, problem = texts(
        DOMAIN='b--help',
        PROBLEM='begin_goal',
        ACTION='begin_operator',
        FACT='end_goal',
        OBJECT=' '.join(LEGAL),
    )
    here = ' '.join(f'(here {name})' for name in LEGAL)
    problem = problem.replace(f'(here {" ".join(LEGAL)})', here)
    problem = problem.replace(f'(end_goal {" ".join(LEGAL)})', '(end_goal con)')
    read_task(domain, problem)
    goals = tuple(f'(end_goal {name})' for name in LEGAL)
    all_of_them = f'(and {" ".join(goals)})'
    with Planner(engine, shortcuts=shortcuts) as planner:
        report = planner.plan(BeliefSpace(domain, problem, (all_of_them,)), [Belief(0)])

    (result,) = report.results
    assert sorted(result.plans[0].actions) == sorted(f'(begin_operator {name})' for name in LEGAL)
