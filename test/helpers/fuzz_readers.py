"""What must come of any text that a reader gets: it is read well, or refused with a place.

With real texts to begin with, and words that each format knows or should not take.
"""

import re
import unicodedata
from collections.abc import Sequence
from pathlib import Path

from fuzzing import NOISE, damaged, require_told_well
from hypothesis import strategies as st
from pddl_cases import TOOLS_DOMAIN, TOOLS_PROBLEM
from unified_planning.engines import SequentialPlanValidator, ValidationResultStatus
from unified_planning.io import PDDLReader
from unified_planning.plans import ActionInstance, SequentialPlan

from mirror_explainer.errors import InputError
from mirror_explainer.input_limits import InputLimits
from mirror_explainer.listener.prior import belief_prior
from mirror_explainer.listener.sentences import sentences_for
from mirror_explainer.listener.user_model import read_user_model
from mirror_explainer.pddl import Task, goal_expression, read_task
from mirror_explainer.pddl.plan_check import check_plan
from mirror_explainer.pddl.plan_text import Step, read_plan, without_dummy
from mirror_explainer.pddl.progress_text import read_progress
from mirror_explainer.text_files import plain_text

LIMITS = InputLimits()
ATOM = re.compile(r'\([a-z-]+( [a-z_]+)*\)')
UNSAYABLE = {'Cc', 'Zl', 'Zp'}  # control characters, and ends of lines

LAMPS = """\
; one lamp
(define (domain lamps)
  (:requirements :adl :action-costs)
  (:types lamp - thing switch - thing)
  (:constants main - switch)
  (:predicates (lit ?l - lamp) (wired ?s - switch ?l - lamp) (power)
    (near ?t - thing))
  (:functions (total-cost) - number (watts ?l - lamp) - number)
  (:action press
    :parameters (?s - switch ?l - lamp)
    :precondition (and (wired ?s ?l) (power) (forall (?x - lamp) (or (= ?x ?l) (not (lit ?x)))))
    :effect (and (lit ?l) (when (near ?s) (near ?l)) (increase (total-cost) (watts ?l)))))
"""
HALL = """\
(define (problem hall)
  (:domain lamps)
  (:objects l1 l2 - lamp s1 - switch)
  (:init (power) ; yes
         (wired s1 l1) (wired main l2)
         (= (watts l1) 40.5) (= (watts l2) 3) (= (total-cost) 0))
  (:goal (and (lit l1) (not (lit l2))))
  (:metric minimize (total-cost)))
"""
DURATIVE = """\
(define (domain ovens)
  (:requirements :durative-actions :typing :derived-predicates)
  (:types pie)
  (:predicates (raw ?p - pie) (baked ?p - pie) (free) (edible ?p - pie))
  (:functions (size ?p - pie))
  (:derived (edible ?p - pie) (and (baked ?p) (free)))
  (:durative-action bake
    :parameters (?p - pie)
    :duration (= ?duration (* 2 (size ?p)))
    :condition (and (at start (raw ?p)) (at start (free)))
    :effect (and (at start (not (free))) (at end (free)) (at end (baked ?p)))))
"""
PIES = """\
(define (problem pies) (:domain ovens) (:objects a b - pie)
  (:init (raw a) (raw b) (free) (= (size a) 1.5) (= (size b) 2))
  (:goal (and (edible a) (baked b))))
"""
PAIRS = [(LAMPS, HALL), (DURATIVE, PIES), (TOOLS_DOMAIN, TOOLS_PROBLEM)]
_PDDL_WORDS = """
    and or not when forall exists imply = < * increase assign (:goal (:init (:metric (:constraints
    :requirements :contingent oneof ?l l1 lit (power) object number 0 -1 1e9999999 1.5 (:derived at
    start over all end #t ?duration total-cost total-time
"""
PROGRESS = [
    'done: (cut-slowly) ; at last\nrunning: (polish)\n',
    'failed: (polish) because it broke',
]
_PROGRESS_WORDS = """
    done: skipped: running failed: ahead because (polish) (cut-slowly) (cut-fast) ended: : ; ( )
"""
PROGRESS_WORDS = _PROGRESS_WORDS.split()
PDDL_WORDS = [
    *_PDDL_WORDS.split(),
    *('- lamp', '(either lamp switch)', '(not (power))', '(at 5 (power))', '(/ 1 0)'),
    '(unknown (power))',
]
PLANS = [
    '; cut, then polish\n(cut-fast)\n(cut-slowly)\n(polish) ; cost = 8 (general cost)\n',
    '0.000: (cut-slowly) [1.0]\n1.5: (polish) [D:1.00; C:0.10]\n(reach-goal)',
    'step 0: CUT-SLOWLY\n     1: POLISH\n',
    'SequentialPlan:\n    cut-slowly\n    polish()\n',
    '(move left center)\n(grab red_circle red_room)\n1e-05: (exit d p) [5]\nplan: move(a, b)',
]
_PLAN_WORDS = """
    (polish) polish cut-slowly 0.5: [1.0] 1e999: -1: nan: plan: SequentialPlan: center , [ ] [[
"""
PLAN_WORDS = [*_PLAN_WORDS.split(), 'step 3: ', '; cost', '(reach-goal)', '9' * 400]
MODELS = [
    """goals:
  - {name: tidy, goal: (and (holding red_cube) (outside bottom_door)), probability: 0.25}
  - goal: (holding blue_cube)
    probability: 3
uncertain_facts:
  - {fact: (charged), probability: 0.5}
one_of:
  - facts: {(item-at red_circle red_room): 0.7, (item-at red_circle blue_room): 0.3}
rationality: 1.0
unlisted_goal_probability: 0.05
sentences:
  grab: "I will grab {i}."
  move: {template: "To {b}.", when: {b: {red_room: "I will enter the red warehouse."}}}
objects: {red_circle: a red circle}
""",
    'hyps_file: hyps.dat\nobjects: {red_cube: "cube \\\\ é"}\nsentences: {move: "{{{a}}}"}\n',
]
_YAML_WORDS = """
    goals: goal: probability: one_of: facts: sentences: hyps_file: /etc/passwd hyps.dat - : ? | >
    --- ... &a *a true null .nan .inf -.inf 1e999 -1 1e-320 0x1F 1:1:1 2001-02-31 2001-01-01
    {b.__class__} {b[0]} {b!r} {b:>1000000000} {b:{c}} {{ }
"""
YAML_WORDS = [
    *_YAML_WORDS.split(),
    *(
        '!!int ',
        '!!bool ',
        '!!timestamp ',
        '!!omap ',
        '!!binary ',
        '!!set ',
        '!!python/object:os.system ',
        '%YAML 9.9',
        '<<: *a',
    ),
    *('"\\e[31m"', '"\\ud800"', '"\\0"', '{a: {b: c}}', '- ', ': ', '9' * 400),
]


def damaged_pairs() -> st.SearchStrategy[tuple[str, str]]:
    """Return domains and problems, one or both of them damaged."""

    def pair(texts: tuple[str, str]) -> st.SearchStrategy[tuple[str, str]]:
        domain, problem = texts
        bad_domain = damaged([domain], PDDL_WORDS)
        bad_problem = damaged([problem], PDDL_WORDS) | NOISE
        return (
            st.tuples(bad_domain, st.just(problem))
            | st.tuples(st.just(domain), bad_problem)
            | st.tuples(bad_domain, bad_problem)
        )

    return st.sampled_from(PAIRS).flatmap(pair)


def try_plan(task: Task, text: str) -> bool:
    """Read a plan of a task and return whether it is taken; it must then really be one."""
    try:
        steps = without_dummy(task, read_plan(text, 'plan', LIMITS))
        check_plan(task, steps, 'plan', LIMITS)
    except InputError as error:
        require_told_well(error, text)
        return False
    assert is_valid(task, steps)
    return True


def try_task(domain: str, problem: str) -> bool:
    """Read a task and return whether it is taken; its state must be as unified-planning reads it.

    Where unified-planning alone can read it at all.
    """
    try:
        read = read_task(domain, problem, 'domain', 'problem', LIMITS)
        assert read.goal_text.startswith('(')
        goal_expression(read.model, read.goal_text)
    except InputError as error:
        text = {'domain': domain, 'problem': problem}.get(error.source, '')
        require_told_well(error, text)
        return False
    plain = None if read.warnings or 'derived' in domain else plain_reading(domain, problem)
    if plain is not None:
        said = {str(k) for k, v in plain.explicit_initial_values.items() if v.is_true()}
        found = read.model.explicit_initial_values
        assert {str(k) for k, v in found.items() if v.is_true()} == said
    return True


def try_progress(actions: Sequence[str], text: str) -> bool:
    """Read progress in a plan and return whether it is taken; reasons are then of its steps."""
    try:
        progress = read_progress(text, 'progress').of(actions)
    except InputError as error:
        require_told_well(error, text)
        return False
    assert len(progress.steps) == len(actions)
    assert {*progress.failed, *progress.reasons} <= {*range(len(actions))}
    return True


def try_goal(task: Task, goal: str) -> bool:
    """Read a goal of a task and return whether it is taken."""
    try:
        goal_expression(task.model, goal)
    except InputError as error:
        require_told_well(error, goal)
        return False
    return True


def try_user_model(warehouse: Task, folder: Path, text: bytes, hypotheses: bytes = b'') -> bool:
    """Read a user model of the warehouse, put into a folder, and return whether it is taken.

    Its beliefs must then have probabilities, and every action a sentence.
    """
    (folder / 'hyps.dat').write_bytes(hypotheses)
    path = folder / 'user.yaml'
    path.write_bytes(text)
    try:
        model = read_user_model(path, warehouse, limits=LIMITS)
        prior = belief_prior(warehouse, model, 64)
    except InputError as error:
        require_told_well(error, text.decode('utf-8', 'replace'))
        return False
    for together in (
        [goal.probability for goal in model.goals],
        *(group.values() for group in model.one_of),
    ):
        assert abs(sum(together) - 1.0) < 1e-6
    for facts in (model.uncertain_facts, *model.one_of):
        assert all(ATOM.fullmatch(fact) and 0.0 <= p <= 1.0 for fact, p in facts.items())
    assert 0.0 < prior.covered_mass <= 1.0
    assert all(0.0 < probability <= 1.0 for probability in prior.probabilities)
    sentences = sentences_for(warehouse, model)
    for action in ('(move left center)', '(exit bottom_door left)', '(grab red_cube red_room)'):
        assert not {unicodedata.category(letter) for letter in sentences.of(action)} & UNSAYABLE
    return True


def is_valid(task: Task, steps: tuple[Step, ...]) -> bool:
    """Let unified-planning's own validator say whether a plan is one of the task."""
    manager = task.model.environment.expression_manager
    plan = SequentialPlan(
        [
            ActionInstance(
                task.model.action(step.words[0]),
                manager.auto_promote([task.model.object(word) for word in step.words[1:]]),
            )
            for step in steps
        ]
    )
    result = SequentialPlanValidator().validate(task.model, plan)
    return bool(result.status is ValidationResultStatus.VALID)


def plain_reading(domain: str, problem: str):
    """Return the problem as unified-planning alone reads it, None if it refuses."""
    try:
        return PDDLReader().parse_problem_string(plain_text(domain), plain_text(problem))
    except Exception:
        return None
