"""One task from beginning to end: which messages go on with it, and how far it is."""

from random import Random

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from mirror_explainer.errors import InputError
from mirror_explainer.pddl import Task, fluent_expression, read_task
from mirror_explainer.pddl.episode import begin
from mirror_explainer.pddl.following import follow
from mirror_explainer.pddl.plan_text import read_plan
from mirror_explainer.pddl.progress import Progress, StepStatus
from mirror_explainer.pddl.simulation import carry_out
from mirror_explainer.pddl.states import Evaluator, State

# A robot that fetches things; like PlanSys2's, its actions change the state when they begin.
DOMAIN = """
(define (domain fetch)
  (:requirements :strips :typing :durative-actions :fluents)
  (:types robot spot thing)
  (:predicates (at-spot ?r - robot ?s - spot) (lies ?t - thing ?s - spot)
               (has ?r - robot ?t - thing) (wet ?s - spot) (greeted))
  (:functions (battery ?r - robot) (odometer ?r - robot))
  (:durative-action drive :parameters (?r - robot ?a ?b - spot) :duration (= ?duration 6)
    :condition (and (at start (at-spot ?r ?a)) (at start (>= (battery ?r) 1)))
    :effect (and (at start (not (at-spot ?r ?a))) (at end (at-spot ?r ?b))
                 (at end (decrease (battery ?r) 1)) (at end (increase (odometer ?r) 6))))
  (:durative-action pick :parameters (?r - robot ?t - thing ?s - spot) :duration (= ?duration 2)
    :condition (and (over all (at-spot ?r ?s)) (at start (lies ?t ?s)))
    :effect (and (at start (not (lies ?t ?s))) (at end (has ?r ?t))))
  (:durative-action drop :parameters (?r - robot ?t - thing ?s - spot) :duration (= ?duration 2)
    :condition (and (over all (at-spot ?r ?s)) (at start (has ?r ?t)))
    :effect (and (at start (not (has ?r ?t))) (at end (lies ?t ?s)))))
"""
FACTS = '(at-spot r dock) (lies cup lab) (lies book shop) (= (battery r) 10) (= (odometer r) 7)'
GOAL = '(and (has r cup) (has r book))'
PLAN = """
0.000: (drive r dock lab) [6.000]
6.001: (pick r cup lab) [2.000]
8.002: (drive r lab shop) [6.000]
14.003: (pick r book shop) [2.000]
"""
DONE, RUNNING, AHEAD = StepStatus.DONE, StepStatus.RUNNING, StepStatus.AHEAD


def fetching(facts: str = FACTS, goal: str = GOAL) -> Task:
    problem = (
        '(define (problem p) (:domain fetch) (:objects r - robot dock lab shop - spot '
        f'cup book - thing) (:init {facts}) (:goal {goal}))'
    )
    return read_task(DOMAIN, problem)


def shown(progress: Progress | None) -> str:
    """Return "dra" for one step done, one running, and one ahead."""
    assert progress is not None
    return ''.join(status.value[0] for status in progress.steps)


def state_of(task: Task) -> State:
    return Evaluator(task).first_state()


def continued(
    facts: str, plan: str | None = PLAN, known: str = 'aaaa', goal: str = GOAL
) -> Progress | None:
    """Return the progress that later facts, and a plan, show in the episode of PLAN."""
    task = fetching(facts, goal)
    episode, _ = begin(fetching(goal=goal), read_plan(PLAN))
    statuses = {status.value[0]: status for status in StepStatus}
    return follow(
        episode,
        state_of(task),
        Progress(tuple(statuses[letter] for letter in known)),
        None if plan is None else read_plan(plan),
        task=task,
    )


NUMBERS = '(= (battery r) 8) (= (odometer r) 7)'
LATER = {
    'nothing has happened': (FACTS, 'aaaa'),
    'the first step is going on': (f'(lies cup lab) (lies book shop) {NUMBERS}', 'raaa'),
    'the first is done': (f'(at-spot r lab) (lies cup lab) (lies book shop) {NUMBERS}', 'daaa'),
    'the second is going on': (f'(at-spot r lab) (lies book shop) {NUMBERS}', 'draa'),
    'two are done': (f'(has r cup) (at-spot r lab) (lies book shop) {NUMBERS}', 'ddaa'),
    'the third is going on': (f'(has r cup) (lies book shop) {NUMBERS}', 'ddra'),
    'all are done': (f'(at-spot r shop) (has r cup) (has r book) {NUMBERS}', 'dddd'),
}


@pytest.mark.parametrize('name', LATER)
def test_a_later_state_with_the_whole_plan_or_none_shows_how_far_it_is(name: str) -> None:
    facts, expected = LATER[name]

    assert shown(continued(facts)) == expected
    assert shown(continued(facts, None)) == expected


@pytest.mark.parametrize('name', LATER)
def test_the_first_state_that_is_heard_may_lie_anywhere_in_the_plan(name: str) -> None:
    facts, expected = LATER[name]

    episode, progress = begin(fetching(facts), read_plan(PLAN))

    assert shown(progress) == expected
    assert episode.left_out == 0
    assert episode.first.facts == state_of(fetching()).facts
    assert shown(follow(episode, state_of(fetching(facts)), progress)) == expected


@pytest.mark.parametrize(('left', 'expected'), [(1, 'daaa'), (2, 'ddaa'), (3, 'ddda')])
def test_the_plan_that_remains_with_its_state_goes_on(left: int, expected: str) -> None:
    lines = PLAN.strip().split('\n')
    task = fetching()
    run = carry_out(task, read_plan(PLAN))
    facts = ' '.join(run.passed[2 * left].facts) + NUMBERS

    assert shown(continued(facts, '\n'.join(lines[left:]))) == expected


def test_a_step_that_goes_on_may_be_named_in_what_remains_or_not() -> None:
    facts = LATER['the third is going on'][0]
    lines = PLAN.strip().split('\n')

    assert shown(continued(facts, '\n'.join(lines[2:]))) == 'ddra'
    assert shown(continued(facts, lines[3])) == 'ddra'


def test_a_plan_that_comes_before_or_after_its_state_does_not_end_the_episode() -> None:
    rest = '\n'.join(PLAN.strip().split('\n')[1:])

    assert shown(continued(FACTS, rest)) == 'aaaa'
    assert shown(continued(LATER['two are done'][0], rest)) == 'ddaa'


def test_what_does_not_matter_may_drift() -> None:
    facts = LATER['two are done'][0].replace('8', '3.5').replace('7', '100')

    assert shown(continued(f'{facts} (wet dock) (greeted)')) == 'ddaa'
    # It matters whether there is a charge left for what is still to be driven.
    assert continued(facts.replace('3.5', '0.5')) is None


def test_what_the_listener_is_unsure_of_matters() -> None:
    task = fetching(f'{LATER["two are done"][0]} (wet dock)')
    episode, known = begin(fetching(), read_plan(PLAN))

    assert shown(follow(episode, state_of(task), known, task=task)) == 'ddaa'
    assert follow(episode, state_of(task), known, uncertain=['(wet dock)'], task=task) is None


@pytest.mark.parametrize(
    'facts',
    [
        f'(at-spot r dock) (lies cup lab) {NUMBERS}',  # somebody took the book
        f'(at-spot r shop) (lies cup lab) (lies book shop) {NUMBERS}',  # elsewhere
        f'(at-spot r shop) (lies cup lab) (has r book) {NUMBERS}',  # another order
    ],
)
def test_a_state_that_the_plan_does_not_lead_through_is_no_progress(facts: str) -> None:
    assert continued(facts, None) is None


def test_another_plan_is_no_progress() -> None:
    assert continued(FACTS, PLAN.replace('cup lab', 'book lab')) is None
    # Here the steps that are left would do, as the cup has been brought by somebody.
    brought = FACTS.replace('(lies cup lab)', '(has r cup)')
    left = '(drive r dock shop)\n(pick r book shop)'
    assert continued(brought, left) is None


def test_a_state_before_what_was_known_is_no_progress() -> None:
    facts = LATER['the first is done'][0]

    assert continued(facts, known='draa') is None
    assert shown(continued(facts, known='raaa')) == 'daaa'


ROUND = """
(drive r dock lab)
(drive r lab dock)
(drive r dock lab)
(pick r cup lab)
"""


def test_a_state_that_fits_two_places_is_the_later_one_not_before_what_was_known() -> None:
    episode, known = begin(fetching(goal='(has r cup)'), read_plan(ROUND))
    facts = f'(lies cup lab) (lies book shop) {NUMBERS}'
    at_lab, at_dock = (
        fetching(f'(at-spot r {spot}) {facts}', '(has r cup)') for spot in ('lab', 'dock')
    )

    assert shown(follow(episode, state_of(at_dock), known, task=at_dock)) == 'ddaa'
    there = follow(episode, state_of(at_lab), known, task=at_lab)
    assert shown(there) == 'ddda'
    assert there is not None
    assert follow(episode, state_of(at_dock), there, task=at_dock) is None
    # The plan that remains tells them apart.
    rest = read_plan('\n'.join(ROUND.strip().split('\n')[1:]))
    assert shown(follow(episode, state_of(at_lab), known, rest, task=at_lab)) == 'daaa'


def test_where_steps_cannot_be_taken_back_the_longest_rest_of_the_plan_is_the_episode() -> None:
    facts = f'(at-spot r shop) (lies book shop) (has r cup) {NUMBERS}'
    plan = '(pick r cup lab)\n(pick r book shop)\n(drive r shop dock)'

    episode, progress = begin(fetching(facts), read_plan(plan))

    assert episode.actions == ('(pick r book shop)', '(drive r shop dock)')
    assert (episode.left_out, shown(progress)) == (1, 'aa')


@pytest.mark.parametrize(
    ('facts', 'plan', 'said'),
    [
        # From the shop it is not on its way from the dock, whatever is not at the dock.
        (f'(at-spot r shop) (lies cup lab) (lies book shop) {NUMBERS}', PLAN,
         'plan, line 2: (drive r dock lab) cannot be carried out as step 1 of 4: '
         '(at-spot r dock) does not hold'),
        (FACTS, '(drive r dock shop)', 'plan: the plan does not reach the goal: '
         '(has r cup) does not hold, (has r book) does not hold'),
        (FACTS, '(drive r dock)', 'plan, line 1: (drive r dock): "drive" takes 3 arguments, '
         '(?r - robot ?a - spot ?b - spot), not 2'),
        (FACTS, '', 'plan: the plan does not reach the goal: '
         '(has r cup) does not hold, (has r book) does not hold'),
    ],
)  # fmt: skip
def test_a_plan_that_has_nothing_to_do_with_the_state_is_refused(
    facts: str, plan: str, said: str
) -> None:
    with pytest.raises(InputError) as refused:
        begin(fetching(facts), read_plan(plan))

    assert str(refused.value) == said


def test_robots_that_work_side_by_side_need_not_be_in_step() -> None:
    def two(facts: str) -> Task:
        return read_task(
            DOMAIN,
            '(define (problem p) (:domain fetch) (:objects r s - robot dock lab shop - spot '
            f'cup book - thing) (:init {facts} (= (battery r) 9) (= (battery s) 9)'
            '(= (odometer r) 0) (= (odometer s) 0)) (:goal (and (has r cup) (has s book))))',
        )

    plan = read_plan(
        '0: (drive r dock lab) [6]\n0: (drive s dock shop) [6]\n'
        '6.1: (pick r cup lab) [2]\n6.1: (pick s book shop) [2]'
    )
    start = '(at-spot r dock) (at-spot s dock) (lies cup lab) (lies book shop)'
    episode, known = begin(two(start), plan)
    # r has the cup, and s is still on its way; or has not even left.
    late = two('(at-spot r lab) (has r cup) (lies book shop)')
    later = two('(at-spot r lab) (has r cup) (at-spot s dock) (lies book shop)')

    assert shown(follow(episode, state_of(late), known, task=late)) == 'drda'
    assert shown(follow(episode, state_of(later), known, task=later)) == 'dada'


RANDOM_DOMAIN = """
(define (domain random) (:requirements :adl :durative-actions)
  (:predicates (p ?x) (q ?x) (idle ?x))
  {actions})
"""
ITEMS = 'abc'


def random_task(random: Random) -> Task | None:
    """Return a task with random actions, with durations and without, over six atoms."""
    actions = []
    for number in range(5):
        literals = [
            [random_literal(random) for _ in range(random.randint(least, 2))]
            for least in (0, 0, 0, 1)
        ]
        if random.random() < 0.5:
            actions.append(
                f'(:action act{number} :parameters (?x ?y) '
                f':precondition (and {" ".join(literals[0])}) '
                f':effect (and {" ".join([*literals[3], *literals[2]])}))'
            )
        else:
            phases = ['at start', 'over all', 'at start', 'at end']
            needs, _, first, last = (
                ' '.join(f'({phase} {literal})' for literal in of_phase)
                for phase, of_phase in zip(phases, literals, strict=True)
            )
            actions.append(
                f'(:durative-action act{number} :parameters (?x ?y) :duration (= ?duration 1) '
                f':condition (and {needs}) :effect (and {first} {last}))'
            )
    facts = [f'({name} {item})' for name in 'pq' for item in ITEMS if random.random() < 0.5]
    try:
        return read_task(
            RANDOM_DOMAIN.format(actions='\n'.join(actions)),
            f'(define (problem p) (:domain random) (:objects {" ".join(ITEMS)}) '
            f'(:init {" ".join(facts)}) (:goal (and)))',
        )
    except InputError:  # an action that says two things of one atom, perhaps
        return None


def random_literal(random: Random) -> str:
    atom = f'({random.choice("pq")} {random.choice(["?x", "?y"])})'
    return atom if random.random() < 0.6 else f'(not {atom})'


def random_plan(task: Task, random: Random) -> list[str]:
    """Return actions that can be carried out one after the other."""
    plan: list[str] = []
    for _ in range(40):
        name = random.choice(task.model.actions).name
        tried = [*plan, f'({name} {random.choice(ITEMS)} {random.choice(ITEMS)})']
        if carry_out(task, read_plan('\n'.join(tried))).failure is None:
            plan = tried
        if len(plan) == 6:
            break
    return plan


@settings(
    max_examples=60,
    derandomize=True,
    deadline=None,
    suppress_health_check=list(HealthCheck),
    database=None,
)
@given(seed=st.integers(0, 2**32))
def test_the_progress_found_is_the_true_one_or_a_later_one_with_the_same_state(seed: int) -> None:
    random = Random(seed)
    task = random_task(random)
    plan = random_plan(task, random) if task else []
    if task is None or not plan:
        return
    run = carry_out(task, read_plan('\n'.join(plan)))
    held = sorted(run.passed[-1].facts)
    goals = random.sample(held, min(len(held), random.randint(0, 2)))
    task.model.clear_goals()
    for fact in goals:
        task.model.add_goal(fluent_expression(task.model, fact))
    episode, known = begin(task, read_plan('\n'.join(plan)))
    for _ in range(8):
        true = random.randrange(len(run.passed))
        if Progress.after(run.happenings, true).happened < known.happened:
            continue
        loose = [f'(idle {item})' for item in ITEMS] + [
            f'({name} {item})' for name in 'pq' for item in ITEMS
        ]
        drift = {
            atom: random.random() < 0.5 for atom in loose if atom not in episode.matters[true]
        }
        state = run.passed[true].after(drift)
        left = None
        if random.random() < 0.5:
            ahead = Progress.after(run.happenings, true).positions(StepStatus.AHEAD)
            left = read_plan('\n'.join(plan[position] for position in ahead))

        found = follow(episode, state, known, left)

        assert found is not None
        assert found.happened >= Progress.after(run.happenings, true).happened
        count = next(
            k
            for k in range(len(run.passed))
            if Progress.after(run.happenings, k).steps == found.steps
        )
        for atom in episode.matters[count]:
            assert (atom in state.facts) == (atom in run.passed[count].facts)
        known = found
