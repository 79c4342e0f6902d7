"""What is said of the two-room warehouse, with the real planner (section 5 of the method)."""

import itertools
import json
import math
from collections.abc import Iterator, Sequence
from pathlib import Path

import pytest

from mirror_explainer.errors import InputError, NoPlanError, PlanningError
from mirror_explainer.explainer import Explanation, Preparation, explain, prepare, robot_plan
from mirror_explainer.listener.user_model import CandidateGoal, UserModel, read_user_model
from mirror_explainer.pddl import Task, read_task
from mirror_explainer.planning import Planner
from mirror_explainer.selection.algorithm import curve, decreasing, increasing, informative_order

EXIT = 'I will exit from the bottom door.'
CUBE = 'I will grab a blue cube.'
CIRCLE = 'I will grab a red circle.'
DOORS = "I will reach the warehouses' doors."


@pytest.fixture(scope='module')
def planner() -> Iterator[Planner]:
    with Planner(workers=2) as planner:
        yield planner


@pytest.fixture(scope='module')
def operator(warehouse: Path, task: Task, planner: Planner) -> Preparation:
    """Return the mirror model of the operator, who thinks all 30 goals equally likely."""
    plan = robot_plan(task, (warehouse / 'plan.txt').read_text())
    return prepare(task, plan, read_user_model(warehouse / 'user_model.yaml', task), planner)


@pytest.fixture(scope='module')
def visitor(warehouse: Path, task: Task, planner: Planner) -> Preparation:
    """Return the mirror model of the visitor, who is unsure of charge and blue cube too."""
    plan = robot_plan(task, (warehouse / 'plan.txt').read_text())
    return prepare(task, plan, read_user_model(warehouse / 'visitor.yaml', task), planner)


def said_of(action: str) -> str:
    """Say an action of the example, by hand."""
    name, *arguments = action.strip('()').split()
    if name == 'move':
        return {
            'center': 'I will navigate to the central corridor.',
            'left': 'I will navigate to the left corridor.',
            'right': 'I will navigate to the right corridor.',
            'doors': DOORS,
            'red_room': 'I will enter the red warehouse.',
            'blue_room': 'I will enter the blue warehouse.',
        }[arguments[1]]
    thing = arguments[0].replace('_', ' ')
    return {
        'grab': f'I will grab a {thing}.',
        'exit': f'I will exit from the {thing}.',
        'recharge': 'I will recharge my battery.',
    }[name]


def gain(told: dict, positions: Sequence[int]) -> float:
    """Return IG(o) = log P(o|π_R) − log E[P(o|π)] from the hypotheses of a JSON answer."""

    def likelihood(plan: list[str]) -> float:
        heard = [said_of(action) for action in plan]
        return math.prod(heard.count(robot_says[i]) / len(heard) for i in positions)

    robot = next(h for h in told['hypotheses'] if h['robot'])
    robot_says = [said_of(action) for action in robot['plan']]
    expected = sum(h['probability'] * likelihood(h['plan']) for h in told['hypotheses'])
    return math.log(likelihood(robot['plan'])) - math.log(expected)


def test_one_sentence_names_the_exit(operator: Preparation) -> None:
    told = explain(operator, n=1)

    # 10 of the 30 goals have this door: plans of 10 actions for the 6 pairs in two rooms,
    # of 8 for the 4 in one: log 1/10 − log((6/10 + 4/8)/30)
    assert told.sentences == (EXIT,)
    assert told.selection.information_gain == pytest.approx(math.log(30 / 10 / 1.1))


def test_two_sentences_name_the_two_grabs(operator: Preparation) -> None:
    told = explain(operator, n=2, selection_budget=None).as_dict()

    # 3 goals have both objects, by plans of 10, 10 and 11 actions:
    # log 1/100 − log((2/100 + 1/121)/30) = log(30/2.83)
    assert told['sentences'] == [CUBE, CIRCLE]
    assert told['information_gain'] == pytest.approx(math.log(30 / (2 + 100 / 121)))
    assert told['information_gain'] == pytest.approx(2.36, abs=0.005)
    assert told['cross_entropy_before'] == pytest.approx(math.log(30))
    assert told['cross_entropy_before'] == pytest.approx(3.40, abs=0.005)
    assert told['cross_entropy_after'] == pytest.approx(1.04, abs=0.005)
    assert told['understanding_before'] == pytest.approx(1 / 30)
    assert told['understanding'] == pytest.approx(0.35, abs=0.005)  # 1/2.83
    assert told['true_goal'] == 'red circle and blue cube, bottom door'
    assert told['optimal'] is True
    assert told['gap'] == 0.0


def test_the_pair_found_one_by_one_tells_less(operator: Preparation) -> None:
    model = operator.model

    first, second = informative_order(model.evidence())[:2]

    # 4 goals have this door and the cube: log 1/100 − log((3/100 + 1/64)/30)
    assert [model.sentences[step.position] for step in (first, second)] == [EXIT, CUBE]
    pair = first.information_gain + second.information_gain
    assert pair == pytest.approx(math.log(30 / (3 + 100 / 64)))
    assert pair == pytest.approx(1.88, abs=0.005)


def test_three_sentences_add_the_exit_and_tell_everything(operator: Preparation) -> None:
    told = explain(operator, n=3).as_dict()

    assert told['sentences'] == [CUBE, CIRCLE, EXIT]
    assert told['information_gain'] == pytest.approx(math.log(30))
    assert told['cross_entropy_after'] == pytest.approx(0.0, abs=1e-9)
    assert told['understanding'] == pytest.approx(1.0)


def test_what_every_plan_has_comes_among_the_last(operator: Preparation) -> None:
    order = [step.position for step in informative_order(operator.model.evidence())]

    sentences = [operator.model.sentences[position] for position in order]
    assert sorted(order) == [*range(10)]
    assert set(sentences[:3]) == {EXIT, CUBE, CIRCLE}
    assert DOORS not in sentences[:5]
    assert sentences[5:].count(DOORS) == 3


@pytest.mark.parametrize('who', ['operator', 'visitor'])
def test_the_informative_choice_is_the_best_of_all_and_never_below_a_baseline(
    who: str, request: pytest.FixtureRequest
) -> None:
    preparation = request.getfixturevalue(who)
    told = explain(preparation).as_dict()
    evidence = preparation.model.evidence()

    for n, best in enumerate(curve(evidence)):
        every = [gain(told, chosen) for chosen in itertools.combinations(range(10), n)]
        assert best.information_gain == pytest.approx(max(every), abs=1e-9)
        assert best.information_gain == pytest.approx(gain(told, best.positions), abs=1e-9)
        assert best.optimal
        for baseline, positions in (
            (increasing(evidence, n), range(n)),
            (decreasing(evidence, n), range(10 - n, 10)),
        ):
            assert baseline.positions == tuple(positions)
            assert baseline.information_gain == pytest.approx(gain(told, positions), abs=1e-9)
            assert best.information_gain >= baseline.information_gain - 1e-9


@pytest.mark.parametrize('strategy', ['informative', 'increasing', 'decreasing'])
@pytest.mark.parametrize('who', ['operator', 'visitor'])
def test_only_true_actions_are_said_in_plan_order(
    who: str, strategy: str, warehouse: Path, request: pytest.FixtureRequest
) -> None:
    true_actions = (warehouse / 'plan.txt').read_text().splitlines()[:10]
    preparation = request.getfixturevalue(who)

    for n in range(12):
        told = explain(preparation, strategy=strategy, n=n).as_dict()

        assert told['n'] == len(told['sentences']) == min(n, 10)
        assert told['positions'] == sorted(set(told['positions']))
        assert told['actions'] == [true_actions[i] for i in told['positions']]
        assert told['sentences'] == [said_of(action) for action in told['actions']]


def test_the_answer_is_spoken_one_sentence_a_line(operator: Preparation) -> None:
    assert explain(operator, n=2).text == f'{CUBE}\n{CIRCLE}'


# H after one sentence 2.40, after two 1.04, after three 0.
@pytest.mark.parametrize(
    ('threshold', 'n', 'count'),
    [(3.0, None, 1), (2.3, None, 2), (1.1, None, 2), (1.0, None, 3), (1e-6, 10, 3), (1e-6, 1, 1)],
)
def test_a_threshold_takes_as_few_as_bring_the_cross_entropy_below_it(
    operator: Preparation, threshold: float, n: int | None, count: int
) -> None:
    told = explain(operator, threshold=threshold, n=n)

    assert len(told.sentences) == count
    assert told.selection == explain(operator, n=count).selection


def test_below_the_threshold_already_there_is_nothing_to_say(operator: Preparation) -> None:
    told = explain(operator, threshold=3.5)  # H = log 30 = 3.40

    assert told.sentences == ()
    assert told.text == 'There is nothing that you need to hear of my plan.'
    assert told.as_dict()['n'] == 0


@pytest.mark.parametrize('strategy', ['increasing', 'decreasing'])
@pytest.mark.parametrize('threshold', [3.0, 2.0, 1.0, 1e-6])
def test_a_threshold_holds_for_the_baselines_too(
    operator: Preparation, strategy: str, threshold: float
) -> None:
    told = explain(operator, strategy=strategy, threshold=threshold, n=None)

    entropies = [
        explain(operator, strategy=strategy, n=n).as_dict()['cross_entropy_after']
        for n in range(11)
    ]
    assert len(told.sentences) == next(n for n, h in enumerate(entropies) if h < threshold)
    assert len(explain(operator, strategy=strategy, threshold=threshold, n=1).sentences) == 1


def test_what_was_said_is_taken_as_known_and_not_said_again(operator: Preparation) -> None:
    told = explain(operator, n=2, said=[EXIT, EXIT]).as_dict()

    # Known: the exit, H = 3.40 − 1.00. The two grabs leave one goal of the ten.
    assert told['sentences'] == [CUBE, CIRCLE]
    assert told['cross_entropy_before'] == pytest.approx(math.log(11))  # log 30 − log 30/11
    assert told['information_gain'] == pytest.approx(math.log(11))
    assert told['understanding_before'] == pytest.approx(1 / 11)
    assert told['understanding'] == pytest.approx(1.0)
    assert sum(goal['prior'] for goal in told['goals']) == pytest.approx(1.0)
    assert {goal['prior'] > 0 for goal in told['goals'] if 'bottom' not in goal['name']} == {False}


@pytest.mark.parametrize('times', [1, 2, 3, 4])
def test_a_sentence_that_was_said_several_times_counts_as_often_as_the_plan_has_it(
    operator: Preparation, times: int
) -> None:
    doors = [i for i, said in enumerate(operator.model.sentences) if said == DOORS]

    told = explain(operator, n=1, said=[DOORS] * times).as_dict()

    assert len(doors) == 3
    before = operator.model.cross_entropy(doors[: min(times, 3)])
    assert told['cross_entropy_before'] == pytest.approx(before)
    assert DOORS not in told['sentences']


def test_the_threshold_is_for_what_is_left_after_what_was_said(operator: Preparation) -> None:
    told = explain(operator, threshold=2.0, n=None, said=[EXIT])

    # H after the exit and the cube is 3.40 − 1.88 = 1.52.
    assert told.sentences == (CUBE,)


def test_asking_again_and_again_tells_every_sentence_once(operator: Preparation) -> None:
    heard: list[str] = []
    answers: list[Explanation] = []
    while not answers or answers[-1].sentences:
        answers.append(explain(operator, n=2, said=heard))
        heard += answers[-1].sentences

    # The doors are reached three times: all three are one sentence, said in two answers at
    # most only because both stand in one answer.
    assert set(heard) == set(operator.model.sentences)
    for earlier, later in itertools.combinations(answers, 2):
        assert not set(earlier.sentences) & set(later.sentences)
    entropies = [answer.as_dict()['cross_entropy_after'] for answer in answers]
    assert entropies[1] <= entropies[0] + 1e-9
    assert answers[-1].text == 'You have heard every step of my plan.'


def test_a_sentence_that_is_not_in_the_plan_cannot_have_been_said(operator: Preparation) -> None:
    with pytest.raises(InputError) as refused:
        explain(operator, said=[EXIT, 'I will fly.'], said_source='said.txt')

    assert str(refused.value) == 'said.txt: no step of the plan is said as "I will fly."'


def test_the_visitor_learns_of_goal_charge_and_cube(visitor: Preparation) -> None:
    told = explain(visitor, n=2).as_dict()

    # 4 goals · 2 (charged or not) · 2 (the cube in either room), all of them reachable
    assert len(told['hypotheses']) == 16
    assert told['complete'] is True
    assert told['goals'][1]['prior'] == pytest.approx(0.2)
    # P(b_R) = 0.2 · 0.5 · 0.7
    assert told['cross_entropy_before'] == pytest.approx(-math.log(0.2 * 0.5 * 0.7))
    robot = next(h for h in told['hypotheses'] if h['robot'])
    assert robot['true_facts'] == ['(charged)', '(item-at blue_cube blue_room)']
    assert robot['goal'] == 'red circle and blue cube, bottom door'
    recharging = {h['plan'].count('(recharge center)') for h in told['hypotheses']}
    assert recharging == {0, 1}
    for hypothesis in told['hypotheses']:
        recharges = '(recharge center)' in hypothesis['plan']
        assert recharges == ('(charged)' not in hypothesis['true_facts'])


NUMBER = (int, float)
TYPES = {
    'strategy': str,
    'n': int,
    'sentences': [str],
    'positions': [int],
    'actions': [str],
    'information_gain': NUMBER,
    'cross_entropy_before': NUMBER,
    'cross_entropy_after': NUMBER,
    'understanding_before': NUMBER,
    'understanding': NUMBER,
    'true_goal': str,
    'optimal': bool,
    'gap': NUMBER,
    'complete': bool,
    'covered_mass': NUMBER,
    'unsolvable_mass': NUMBER,
    'unknown_mass': NUMBER,
    'stand_in_plans': int,
    'goals': [{'name': str, 'prior': NUMBER, 'posterior': NUMBER}],
    'plan': [{'position': int, 'action': str, 'sentence': str, 'information_gain': NUMBER}],
    'hypotheses': [
        {
            'goal': str,
            'true_facts': [str],
            'plan': [str],
            'cost': NUMBER,
            'probability': NUMBER,
            'optimal_plan': bool,
            'robot': bool,
        }
    ],
    'seconds': {'read': NUMBER, 'planning': NUMBER, 'selection': NUMBER},
    'planner_calls': int,
}


def matches(value: object, types: object) -> bool:
    """Return whether a JSON value has exactly these keys and types throughout."""
    if isinstance(types, dict):
        return (
            isinstance(value, dict)
            and value.keys() == types.keys()
            and all(matches(value[key], types[key]) for key in types)
        )
    if isinstance(types, list):
        return isinstance(value, list) and all(matches(item, types[0]) for item in value)
    # bool is an int in Python, but not in JSON
    return isinstance(value, types) and isinstance(value, bool) == (types is bool)


@pytest.mark.parametrize('who', ['operator', 'visitor'])
def test_the_json_has_the_documented_keys_and_types(
    who: str, request: pytest.FixtureRequest
) -> None:
    explanation = explain(request.getfixturevalue(who), n=2, said=[DOORS])

    told = json.loads(json.dumps(explanation.as_dict(), allow_nan=False))

    assert matches(told, TYPES)
    assert sum(h['probability'] for h in told['hypotheses']) == pytest.approx(1.0)
    assert [h['robot'] for h in told['hypotheses']].count(True) == 1
    assert sum(goal['prior'] for goal in told['goals']) == pytest.approx(1.0)
    assert sum(goal['posterior'] for goal in told['goals']) == pytest.approx(1.0)
    assert [step['position'] for step in told['plan']] == [*range(10)]
    assert told['information_gain'] == pytest.approx(
        told['cross_entropy_before'] - told['cross_entropy_after']
    )
    short = explanation.as_dict(hypotheses=False)
    assert short.keys() == TYPES.keys() - {'hypotheses'}


def test_the_plan_in_the_json_has_the_gain_of_each_single_sentence(operator: Preparation) -> None:
    told = explain(operator).as_dict()

    for step in told['plan']:
        assert step['information_gain'] == pytest.approx(gain(told, [step['position']]), abs=1e-9)


def test_without_a_plan_the_robots_own_is_planned_too(
    warehouse: Path, task: Task, planner: Planner, visitor: Preparation
) -> None:
    model = read_user_model(warehouse / 'visitor.yaml', task)

    preparation = prepare(task, None, model, planner)

    assert preparation.model.plan.cost == 10.0
    robot_plan(task, '\n'.join(preparation.model.plan.actions))  # raises if it is none
    for n in range(11):  # another order of the same actions, at most
        gain = explain(visitor, n=n).selection.information_gain
        assert explain(preparation, n=n).selection.information_gain == pytest.approx(gain)


def test_every_plan_of_every_belief_can_be_carried_out_and_is_optimal(
    warehouse: Path, visitor: Preparation
) -> None:
    domain = (warehouse / 'domain.pddl').read_text()
    problem = (warehouse / 'problem.pddl').read_text()
    for hypothesis in visitor.model.hypotheses:
        own = problem.replace('(item-at blue_cube blue_room)', '').replace('\n    (charged))', ')')
        own = own.replace('(:init', f'(:init {" ".join(hypothesis.true_facts)}')
        goal = visitor.model.goals[hypothesis.goal].goal
        own = f'{own[: own.index("(:goal")]}(:goal {goal}))'

        plan = robot_plan(read_task(domain, own), '\n'.join(hypothesis.plan.actions))

        assert plan.cost == hypothesis.plan.cost
        assert hypothesis.plan.optimal
    # Both circles, in two rooms, by the bottom door: 10 steps, 11 with recharging.
    circles = {len(h.plan.actions) for h in visitor.model.hypotheses if h.goal == 0}
    assert circles == {10, 11}


def test_a_reached_goal_leaves_nothing_to_say(warehouse: Path, planner: Planner) -> None:
    problem = (warehouse / 'problem.pddl').read_text()
    goal = '(:goal (robot-at left)))'
    task = read_task(
        (warehouse / 'domain.pddl').read_text(), problem[: problem.index('(:goal')] + goal
    )
    candidates = tuple(
        CandidateGoal(goal, goal, 0.5) for goal in ('(robot-at left)', '(outside bottom_door)')
    )

    preparation = prepare(task, robot_plan(task, '; nothing'), UserModel(candidates), planner)

    for threshold in (0.0, 0.1):
        for strategy in ('informative', 'increasing', 'decreasing'):
            told = explain(preparation, strategy=strategy, threshold=threshold)
            assert told.text == 'Nothing is left to do: my goal is reached.'
            assert matches(json.loads(json.dumps(told.as_dict(), allow_nan=False)), TYPES)
            assert told.as_dict()['understanding'] == pytest.approx(0.5)


def test_an_empty_plan_with_the_goal_unreached_is_no_current_plan(task: Task) -> None:
    for text in ('', '; cost = 0', '(reach-goal)'):
        with pytest.raises(NoPlanError) as refused:
            robot_plan(task, text, '/robot/plan')

        assert str(refused.value) == '/robot/plan: the robot has no current plan'


def test_a_robot_with_an_unlisted_goal_is_explained_with_a_warning(
    task: Task, warehouse: Path, planner: Planner
) -> None:
    plan = robot_plan(task, (warehouse / 'plan.txt').read_text())
    model = UserModel((CandidateGoal('door', '(outside bottom_door)', 1.0),))

    preparation = prepare(task, plan, model, planner)

    told = explain(preparation, n=1)
    # The way to the door alone is by center and right: this is the first step beside it.
    assert told.sentences == ('I will move to the doors.',)
    assert told.as_dict()['understanding_before'] == pytest.approx(0.05)
    assert told.as_dict()['understanding'] == pytest.approx(1.0)
    assert 'is not among the user model' in preparation.model.warnings[0]


def test_an_unreachable_goal_of_the_robot_or_of_the_user_is_told(
    warehouse: Path, task: Task, planner: Planner
) -> None:
    problem = (warehouse / 'problem.pddl').read_text().replace('(station-at center)', '')
    stuck = read_task((warehouse / 'domain.pddl').read_text(), problem.replace('(charged))', ')'))
    candidates = (
        CandidateGoal('leave', '(outside bottom_door)', 0.5),
        CandidateGoal('stay', '(robot-at center)', 0.5),
    )

    with pytest.raises(PlanningError) as refused:
        prepare(stuck, None, UserModel(candidates), planner)

    assert str(refused.value) == ("the robot's own goal cannot be reached from its initial state")
    away = problem.replace('(charged))', ')')
    away = away[: away.index('(:goal')] + '(:goal (robot-at center)))'
    moving = read_task((warehouse / 'domain.pddl').read_text(), away)
    preparation = prepare(moving, None, UserModel(candidates), planner)
    assert preparation.model.unsolvable_mass == 0.5
    assert preparation.model.complete
    assert preparation.model.warnings == (
        'candidate goals that cannot be reached are left out: "leave"',
    )
