"""P(B): the enumerated beliefs against plain enumeration of all of them."""

import functools
import itertools
import math
from dataclasses import replace

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from mirror_explainer.listener.prior import Prior, belief_prior
from mirror_explainer.listener.user_model import CandidateGoal, UserModel
from mirror_explainer.listener.wording import Template, Wording
from mirror_explainer.pddl import Task, read_task
from mirror_explainer.pddl.episode import goal_of
from mirror_explainer.planning import Belief

FACTS = ('(a)', '(b)', '(c)')
GROUPS = (('(r1)', '(r2)', '(r3)'), ('(s1)', '(s2)'))
DOMAIN = """
(define (domain d)
  (:predicates (a) (b) (c) (r1) (r2) (r3) (s1) (s2) (g0) (g1) (g2))
  (:action win :parameters () :precondition (a) :effect (g0)))
"""


@functools.cache
def task_with(initially: frozenset[str], goal: str = '(g0)') -> Task:
    init = ' '.join(sorted(initially))
    return read_task(DOMAIN, f'(define (problem p) (:domain d) (:init {init}) (:goal {goal}))')


def candidates(*weights: tuple[str, float]) -> tuple[CandidateGoal, ...]:
    total = sum(weight for _, weight in weights)
    return tuple(
        CandidateGoal(f'{number}: {goal}', goal, weight / total)
        for number, (goal, weight) in enumerate(weights)
    )


def probability_of(prior: Prior) -> dict[Belief, float]:
    return dict(zip(prior.beliefs, prior.probabilities, strict=True))


# Two of these are one goal; the robot's own is (g0).
GOALS = st.sampled_from(['(g0)', '(g1)', '(and (g0) (g1))', '(and (g1) (g0))', '(not (g2))'])
PROBABILITIES = st.sampled_from([0.0, 0.25, 0.3, 0.5, 0.9, 1.0])


@st.composite
def user_models(draw: st.DrawFn) -> UserModel:
    weights = draw(st.lists(st.tuples(GOALS, st.integers(0, 5)), min_size=1, max_size=5))
    assume(any(weight for _, weight in weights))
    facts = draw(st.lists(st.sampled_from(FACTS), unique=True))
    groups = []
    for names in draw(st.lists(st.sampled_from(GROUPS), unique=True)):
        shares = [draw(st.integers(0, 4)) for _ in names]
        assume(any(shares))
        groups.append(
            {name: share / sum(shares) for name, share in zip(names, shares, strict=True)}
        )
    return UserModel(
        goals=candidates(*weights),
        uncertain_facts={fact: draw(PROBABILITIES) for fact in facts},
        one_of=tuple(groups),
        unlisted_goal_probability=draw(st.sampled_from([0.0, 0.05, 0.5])),
    )


INITIALLY = st.sets(st.sampled_from(['(a)', '(b)', '(r1)', '(r2)', '(s2)'])).map(frozenset)
LITERALS = {
    '(g0)': {'g0'},
    '(g1)': {'g1'},
    '(and (g0) (g1))': {'g0', 'g1'},
    '(and (g1) (g0))': {'g0', 'g1'},
    '(not (g2))': {'not g2'},
}


def enumerated(
    user_model: UserModel, initially: frozenset[str]
) -> tuple[dict[Belief, float], Belief]:
    """Return P(b) of every belief of positive probability, and b_R, straight from the method."""
    goal_probabilities: dict[frozenset[str], float] = {}
    for goal in user_model.goals:
        key = frozenset(LITERALS[goal.goal])
        goal_probabilities[key] = goal_probabilities.get(key, 0.0) + goal.probability
    robot_goal = frozenset({'g0'})
    if robot_goal not in goal_probabilities:
        unlisted = user_model.unlisted_goal_probability
        goal_probabilities = {g: (1 - unlisted) * p for g, p in goal_probabilities.items()}
        goal_probabilities[robot_goal] = unlisted
    variables = [
        [({fact}, p), (set(), 1 - p)] for fact, p in user_model.uncertain_facts.items()
    ] + [[({fact}, p) for fact, p in group.items()] for group in user_model.one_of]
    # Goals of probability 0 come last.
    goal_probabilities = dict(
        sorted(goal_probabilities.items(), key=lambda item: not item[1] and item[0] != robot_goal)
    )
    probabilities: dict[Belief, float] = {}
    for index, p_goal in enumerate(goal_probabilities.values()):
        for outcome in itertools.product(*variables):
            p = p_goal * math.prod(p for _, p in outcome)
            if p > 0:
                facts = frozenset().union(*(facts for facts, _ in outcome))
                probabilities[Belief(index, facts)] = p
    open_facts = {*user_model.uncertain_facts, *itertools.chain(*user_model.one_of)}
    robot = Belief([*goal_probabilities].index(robot_goal), frozenset(initially & open_facts))
    if robot not in probabilities:
        probabilities = {belief: p * (1 - 1e-6) for belief, p in probabilities.items()}
        probabilities[robot] = 1e-6
    return probabilities, robot


@settings(max_examples=120, deadline=None, derandomize=True)
@given(user_models(), INITIALLY)
def test_all_beliefs_have_the_probabilities_of_plain_enumeration(
    user_model: UserModel, initially: frozenset[str]
) -> None:
    expected, robot = enumerated(user_model, initially)

    prior = belief_prior(task_with(initially), user_model, max_beliefs=10_000)

    assert probability_of(prior) == pytest.approx(expected, abs=0, rel=1e-9)
    assert prior.beliefs[prior.robot_belief] == robot
    assert prior.covered_mass == pytest.approx(1.0, abs=1e-12)
    assert prior.covered_mass <= 1.0
    assert sorted(prior.probabilities, reverse=True) == [*prior.probabilities]
    assert sum(goal.probability for goal in prior.goals) == pytest.approx(1.0)


def test_a_limit_does_not_part_goals_that_are_as_probable_as_one_another():
    weights = [('(g0)', 3), ('(g1)', 2), ('(g2)', 1), ('(and (g1) (g2))', 1)]
    prior = belief_prior(task_with(frozenset()), UserModel(candidates(*weights)), max_beliefs=3)
    assert [belief.goal for belief in prior.beliefs] == [0, 1]


@settings(max_examples=120, deadline=None, derandomize=True)
@given(user_models(), INITIALLY, st.integers(1, 40))
def test_a_limit_keeps_the_most_probable_beliefs_and_the_robots_own(
    user_model: UserModel, initially: frozenset[str], max_beliefs: int
) -> None:
    expected, robot = enumerated(user_model, initially)

    prior = belief_prior(task_with(initially), user_model, max_beliefs)

    taken = probability_of(prior)
    assert taken == pytest.approx({b: expected[b] for b in taken}, abs=0, rel=1e-9)
    most = min(max_beliefs, len(expected))
    assert most / 2 < len(prior.beliefs) <= most
    if len(prior.beliefs) < most:  # the next ones are alike, and there is no room for them all
        left_out = [p for b, p in expected.items() if b not in taken]
        alike = [p for p in left_out if p == pytest.approx(max(left_out), abs=0, rel=1e-9)]
        assert len(prior.beliefs) + len(alike) > max_beliefs
    assert prior.beliefs[prior.robot_belief] == robot
    others = sorted((p for b, p in expected.items() if b != robot), reverse=True)
    taken_others = sorted((p for b, p in taken.items() if b != robot), reverse=True)
    assert taken_others == pytest.approx(others[: len(taken_others)], abs=0, rel=1e-9)
    assert sorted(prior.probabilities, reverse=True) == [*prior.probabilities]
    assert prior.covered_mass == pytest.approx(math.fsum(taken.values()))


@settings(max_examples=100, deadline=None, derandomize=True)
@given(user_models(), INITIALLY)
def test_goals_and_facts_of_probability_zero_change_nothing(
    user_model: UserModel, initially: frozenset[str]
) -> None:
    task = task_with(initially)
    prior = belief_prior(task, user_model)
    listed = {frozenset(LITERALS[goal.goal]) for goal in user_model.goals}
    assume(frozenset({'g0'}) in listed)  # the goals keep their numbers, then

    more = replace(
        user_model,
        goals=(*user_model.goals, CandidateGoal('never', '(and (g1) (g2))', 0.0)),
        uncertain_facts={**user_model.uncertain_facts, '(g2)': 0.0},
        one_of=tuple({**group, f'(g{i})': 0.0} for i, group in enumerate(user_model.one_of)),
    )

    assert probability_of(belief_prior(task, more)) == probability_of(prior)
    assert belief_prior(task, more).space == prior.space  # nor is anything planned for them


def test_scaling_all_weights_changes_nothing(read_model, task: Task) -> None:
    def file(scale: float) -> str:
        weights = [f'{scale * weight:e}' for weight in (1, 2, 5, 3, 1)]
        return (
            'goals: [{{goal: (holding red_circle), probability: {}}},'
            '{{goal: (holding blue_cube), probability: {}}},'
            '{{goal: (outside bottom_door), probability: {}}}]\n'
            'one_of: [{{facts: {{(item-at red_cube red_room): {},'
            ' (item-at red_cube blue_room): {}}}}}]'
        ).format(*weights)

    plain = belief_prior(task, read_model(file(1.0)))
    for scale in (0.001, 7.3, 1e300):
        scaled = belief_prior(task, read_model(file(scale)))

        assert probability_of(scaled) == pytest.approx(probability_of(plain))


def test_a_small_prior_by_hand() -> None:
    user_model = UserModel(
        candidates(('(g0)', 3), ('(g1)', 1)),
        uncertain_facts={'(a)': 0.6},
        one_of=({'(r1)': 0.7, '(r2)': 0.3},),
    )

    prior = belief_prior(task_with(frozenset({'(a)', '(r2)', '(b)'})), user_model)

    assert probability_of(prior) == pytest.approx(
        {
            Belief(0, frozenset({'(a)', '(r1)'})): 0.315,  # 0.75 · 0.6 · 0.7
            Belief(0, frozenset({'(r1)'})): 0.21,  # 0.75 · 0.4 · 0.7
            Belief(0, frozenset({'(a)', '(r2)'})): 0.135,  # 0.75 · 0.6 · 0.3
            Belief(1, frozenset({'(a)', '(r1)'})): 0.105,  # 0.25 · 0.6 · 0.7
            Belief(0, frozenset({'(r2)'})): 0.09,  # 0.75 · 0.4 · 0.3
            Belief(1, frozenset({'(r1)'})): 0.07,  # 0.25 · 0.4 · 0.7
            Belief(1, frozenset({'(a)', '(r2)'})): 0.045,  # 0.25 · 0.6 · 0.3
            Belief(1, frozenset({'(r2)'})): 0.03,  # 0.25 · 0.4 · 0.3
        }
    )
    assert prior.beliefs[prior.robot_belief] == Belief(0, frozenset({'(a)', '(r2)'}))
    assert prior.robot_belief == 2  # the third most probable
    assert prior.space.goals == ('(g0)', '(g1)')
    assert prior.space.uncertain_facts == ('(a)', '(r1)', '(r2)')
    assert prior.warnings == ()


def test_a_goal_that_is_not_listed_is_added_with_a_warning() -> None:
    user_model = UserModel(candidates(('(g1)', 3), ('(g2)', 1)), unlisted_goal_probability=0.2)

    prior = belief_prior(task_with(frozenset(), '(and (g0) (not (g1)))'), user_model)

    assert [goal.probability for goal in prior.goals] == pytest.approx(
        [0.6, 0.2, 0.2]  # 0.75 · 0.8, 0.25 · 0.8, 0.2
    )
    assert prior.goals[2].name == '(and (g0) (not (g1)))'
    assert prior.beliefs[prior.robot_belief] == Belief(2)
    assert prior.warnings == (
        "the robot's goal (and (g0) (not (g1))) is not among the user model's candidates; "
        'it was added with probability 0.2',
    )


def test_what_several_goals_have_in_common_is_known_by_the_texts_of_an_episodes_goal() -> None:
    task = task_with(frozenset(['(a)']), '(and (g0) (not (g2)))')
    one = candidates(('(and (not (g2)) (g0))', 1.0))
    several = candidates(('(and (not (g2)) (g0))', 1.0), ('(and (g1) (not (g2)))', 1.0))

    assert belief_prior(task, UserModel(one)).common_parts == frozenset()
    common = belief_prior(task, UserModel(several)).common_parts
    assert len(common) == 1
    assert common < goal_of(task)


def test_equal_candidates_are_one_goal_under_the_first_name_with_a_warning() -> None:
    goals = candidates(('(and (g0) (g1))', 1), ('(g2)', 2), ('(and (and (g1)) (g0))', 1))

    prior = belief_prior(task_with(frozenset(), '(and (g1) (g0))'), UserModel(goals))

    assert [(goal.name, goal.probability) for goal in prior.goals] == [
        ('0: (and (g0) (g1))', 0.5),  # 1/4 + 1/4
        ('1: (g2)', 0.5),
    ]
    assert prior.beliefs[prior.robot_belief] == Belief(0)
    assert prior.warnings == (
        'the candidates "0: (and (g0) (g1))" and "2: (and (and (g1)) (g0))" are the same goal',
    )


@pytest.mark.parametrize(
    ('user_model', 'said'),
    [
        (UserModel(candidates(('(g0)', 1)), {'(a)': 0.0}), '(a) holds'),
        (UserModel(candidates(('(g0)', 1)), {'(c)': 1.0}), '(c) does not hold'),
        (
            UserModel(candidates(('(g0)', 0), ('(g1)', 1))),
            'the goal "0: (g0)" has probability 0',
        ),
        (
            UserModel(candidates(('(g0)', 1)), one_of=({'(a)': 0.5, '(b)': 0.5},)),
            'more than one of (a), (b) holds: (a), (b)',
        ),
        (
            UserModel(candidates(('(g0)', 1)), one_of=({'(r1)': 0.5, '(r2)': 0.5},)),
            'none of (r1), (r2) holds',
        ),
        (
            UserModel(candidates(('(g0)', 1)), one_of=({'(a)': 0.0, '(c)': 1.0},)),
            '(a) holds',
        ),
    ],
)
def test_a_robot_that_the_user_rules_out_gets_a_millionth_and_a_warning(
    user_model: UserModel, said: str
) -> None:
    prior = belief_prior(task_with(frozenset({'(a)', '(b)'})), user_model)

    assert prior.probabilities[prior.robot_belief] == 1e-6
    assert prior.covered_mass == pytest.approx(1.0, abs=1e-12)
    assert prior.warnings == (f'the user model rules out what is true of the robot: {said}',)


TRUE_GOAL = (
    'goals: [{goal: (and (holding blue_cube) (holding red_circle) (outside bottom_door))}]\n'
)
WHEN = 'sentences: {move: {template: "On.", when: {b: {%s: "In."}}}}\n'


def test_an_object_that_is_misspelt_is_warned_of_and_one_that_is_merely_not_there_is_not(
    read_model, task: Task
) -> None:
    names = 'objects: {red_circel: a circle, red_cube: a cube, yellow_ball: a ball}\n'

    prior = belief_prior(task, read_model(TRUE_GOAL + names + WHEN % 'red_rom'))

    assert prior.warnings == (
        'the user model names the object "red_circel", which the problem does not have '
        '(did you mean "red_circle"?)',
        'the user model names the object "red_rom", which the problem does not have '
        '(did you mean "red_room"?)',
    )


@pytest.mark.parametrize(
    ('objects', 'when'),
    [('red_room: the red one', 'red_rom'), ('red_rom: the red one', 'red_room')],
    ids=['in a wording', 'among the objects'],
)
def test_a_misspelt_object_is_warned_of_though_it_is_spelt_well_elsewhere(
    read_model, task: Task, objects: str, when: str
) -> None:
    prior = belief_prior(task, read_model(f'{TRUE_GOAL}objects: {{{objects}}}\n{WHEN % when}'))

    assert prior.warnings == (
        'the user model names the object "red_rom", which the problem does not have '
        '(did you mean "red_room"?)',
    )


@pytest.mark.parametrize(
    ('objects', 'when'),
    [({'hall': 'the hall', 'halls': 'all halls'}, 'halls'), ({'hall': 'the hall'}, 'room_1')],
    ids=['named beside it', 'another number'],
)
def test_an_object_of_another_problem_is_not_taken_for_a_like_one(
    objects: dict[str, str], when: str
) -> None:
    places = '(:objects hall room_2 - place)'
    task = read_task(
        DOMAIN.replace('(:predicates', '(:types place) (:predicates'),
        f'(define (problem p) (:domain d) {places} (:init) (:goal (g0)))',
    )
    templates = {'win': Template(Wording('I win.'), {'r': {when: Wording('I win there.')}})}
    user_model = UserModel(candidates(('(g0)', 1)), templates=templates, objects=objects)

    assert belief_prior(task, user_model).warnings == ()


def test_an_unlisted_goal_of_probability_zero_still_leaves_the_robot_possible() -> None:
    user_model = UserModel(candidates(('(g1)', 1)), unlisted_goal_probability=0.0)

    prior = belief_prior(task_with(frozenset()), user_model)

    assert probability_of(prior) == {Belief(0): 1 - 1e-6, Belief(1): 1e-6}
    assert len(prior.warnings) == 2


def test_a_probability_too_small_for_a_float_still_leaves_the_robot_possible() -> None:
    facts = {'(a)': 1e-200, '(b)': 1e-200}

    prior = belief_prior(
        task_with(frozenset({'(a)', '(b)'})), UserModel(candidates(('(g0)', 1)), facts)
    )

    assert prior.probabilities[prior.robot_belief] == 1e-6


def test_a_robot_ruled_out_is_still_more_probable_than_what_is_rarer_than_a_millionth() -> None:
    user_model = UserModel(candidates(('(g1)', 1), ('(g0)', 0)), {'(b)': 1e-9})

    prior = belief_prior(task_with(frozenset()), user_model)

    rare = frozenset({'(b)'})
    assert prior.beliefs == (Belief(0), Belief(1), Belief(0, rare))
    assert prior.probabilities == pytest.approx((1 - 1e-6, 1e-6, 1e-9), abs=1e-8)
    assert prior.robot_belief == 1


def test_the_most_probable_of_very_many_beliefs_come_at_once() -> None:
    names = [f'f{i}' for i in range(200)]
    domain = f"""(define (domain d) (:predicates (g0) {' '.join(f'({n})' for n in names)})
      (:action win :parameters () :effect (g0)))"""
    task = read_task(domain, '(define (problem p) (:domain d) (:init) (:goal (g0)))')
    facts = {f'({name})': 0.1 for name in names}

    prior = belief_prior(task, UserModel(candidates(('(g0)', 1)), facts), max_beliefs=201)

    # of 2^200 beliefs the one without any fact, then those with one
    assert [len(belief.true_facts) for belief in prior.beliefs] == [0] + 200 * [1]
    assert prior.covered_mass == pytest.approx(0.9**200 + 200 * 0.1 * 0.9**199)
