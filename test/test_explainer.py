"""What is said of the two-room warehouse, with the real planner (section 5 of the method)."""

import itertools
import json
import math
from collections.abc import Iterator
from pathlib import Path

import pytest

from mirror_explainer.errors import InputError, NoPlanError, PlanningError
from mirror_explainer.explainer import explain, robot_plan
from mirror_explainer.listener.explanation import Explanation
from mirror_explainer.listener.listeners import PLANNER
from mirror_explainer.listener.own_plan import plan_for_robot
from mirror_explainer.listener.preparation import (
    Preparation,
    prepare,
    refine,
)
from mirror_explainer.listener.user_model import CandidateGoal, UserModel, read_user_model
from mirror_explainer.pddl import Task, read_task
from mirror_explainer.planning import Planner
from mirror_explainer.settings import PlanningSettings, Question

EXIT = 'I will exit from the bottom door.'
CUBE = 'I will grab a blue cube.'
CIRCLE = 'I will grab a red circle.'
DOORS = "I will reach the warehouses' doors."
LISTENERS = ('open', 'planner')


def asked(**named: object) -> Question:
    """The question with as much time to choose as it takes."""
    return Question(**{'selection_budget': 10.0, **named})


@pytest.fixture(scope='module')
def planner() -> Iterator[Planner]:
    with Planner(workers=2) as planner:
        yield planner


def planned(warehouse: Path, task: Task, planner: Planner, user_model: str) -> Preparation:
    plan = robot_plan(task, (warehouse / 'plan.txt').read_text())
    return refine(prepare(task, plan, read_user_model(warehouse / user_model, task)), planner)


@pytest.fixture(scope='module')
def operator(warehouse: Path, task: Task, planner: Planner) -> Preparation:
    """What is known of the operator, who thinks all 30 goals equally likely."""
    return planned(warehouse, task, planner, 'user_model.yaml')


@pytest.fixture(scope='module')
def visitor(warehouse: Path, task: Task, planner: Planner) -> Preparation:
    """What is known of the visitor, who is unsure of charge and blue cube too."""
    return planned(warehouse, task, planner, 'visitor.yaml')


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


@pytest.mark.parametrize('listener', LISTENERS)
@pytest.mark.parametrize(
    ('n', 'sentences'), [(1, [EXIT]), (2, [CUBE, CIRCLE]), (3, [CUBE, CIRCLE, EXIT])]
)
def test_one_names_the_exit_two_the_grabs_three_both(
    operator: Preparation, n: int, sentences: list[str], listener: str
) -> None:
    told = explain(operator, asked(n=n, listener=listener))

    assert list(told.sentences) == sentences
    assert told.optimal
    assert told.complete


def test_the_open_listener_is_told_three_where_four_were_asked_for(operator: Preparation) -> None:
    assert explain(operator, asked(n=4)).sentences == (CUBE, CIRCLE, EXIT)
    assert len(explain(operator, asked(n=4, listener='planner')).sentences) == 4


def test_the_papers_listener_gains_what_the_paper_says(operator: Preparation) -> None:
    one, two, three = (explain(operator, asked(n=n, listener='planner')) for n in (1, 2, 3))

    # 10 of the 30 goals have this door: plans of 10 actions for the 6 pairs in two rooms,
    # of 8 for the 4 in one: log 1/10 − log((6/10 + 4/8)/30)
    assert one.information_gain == pytest.approx(math.log(30 / 10 / 1.1))
    # 3 goals have both objects, by plans of 10, 10 and 11 actions:
    # log 1/100 − log((2/100 + 1/121)/30) = log(30/2.83)
    assert two.information_gain == pytest.approx(math.log(30 / (2 + 100 / 121)))
    assert two.cross_entropy_before == pytest.approx(math.log(30))
    assert two.cross_entropy_after == pytest.approx(1.04, abs=0.005)
    assert two.understanding_before == pytest.approx(1 / 30)
    assert two.understanding == pytest.approx(1 / (2 + 100 / 121))
    assert two.doubt_before == two.cross_entropy_before
    assert three.information_gain == pytest.approx(math.log(30))
    assert three.cross_entropy_after == pytest.approx(0.0, abs=1e-9)
    assert three.understanding == pytest.approx(1.0)


def test_the_open_listener_is_less_sure_and_says_of_what(operator: Preparation) -> None:
    told = explain(operator, asked(n=2))

    assert told.true_goal == 'a red circle and a blue cube, the bottom door'
    assert told.unmentioned == ['(outside bottom_door)']
    # Two other goals have both grabs, and so have these three without a door.
    assert 0.2 < told.understanding < 1 / 3
    assert explain(operator, asked(n=3)).understanding > 0.8
    # Of each goal's three parts, the three goals that lack one are as likely: a quarter in all.
    assert told.goals[-1]['name'] is None
    assert told.goals[-1]['prior'] == pytest.approx(0.25)


def test_what_every_plan_has_comes_last_in_the_informative_order(operator: Preparation) -> None:
    from mirror_explainer.selection.choice import informative_order

    model = operator.model_for(PLANNER)
    order = [model.sentences[a.position] for a in informative_order(model.evidence())]

    assert sorted(order) == sorted(set(model.sentences))
    assert order[:3] == [EXIT, CUBE, CIRCLE]
    assert DOORS not in order[:4]


@pytest.mark.parametrize('strategy', ['informative', 'increasing', 'decreasing'])
@pytest.mark.parametrize('who', ['operator', 'visitor'])
@pytest.mark.parametrize('listener', LISTENERS)
def test_only_true_actions_are_said_in_plan_order_none_twice(
    who: str, strategy: str, listener: str, warehouse: Path, request: pytest.FixtureRequest
) -> None:
    true_actions = (warehouse / 'plan.txt').read_text().splitlines()[:10]
    preparation = request.getfixturevalue(who)

    for n in range(1, 12):
        told = explain(preparation, asked(strategy=strategy, n=n, listener=listener)).as_dict()

        assert told['n'] == len(told['sentences']) == len(set(told['sentences'])) <= n
        assert told['positions'] == sorted(set(told['positions']))
        assert told['actions'] == [true_actions[i] for i in told['positions']]
        assert told['sentences'] == [said_of(action) for action in told['actions']]
        if listener == 'planner' or strategy != 'informative':
            assert told['n'] == min(n, 8)  # of ten steps three are one sentence


@pytest.mark.parametrize('listener', LISTENERS)
@pytest.mark.parametrize('who', ['operator', 'visitor'])
def test_the_informative_choice_is_never_below_a_baseline(
    who: str, listener: str, request: pytest.FixtureRequest
) -> None:
    preparation = request.getfixturevalue(who)
    for n in range(1, 9):
        best, first, last = (
            explain(preparation, asked(strategy=s, n=n, listener=listener)).information_gain
            for s in ('informative', 'increasing', 'decreasing')
        )
        assert best >= max(first, last) - (0.02 if listener == 'open' else 0.0) - 1e-9


def test_the_answer_is_spoken_with_like_steps_in_one_sentence(operator: Preparation) -> None:
    assert explain(operator, asked(n=2)).spoken == 'I will grab a blue cube and a red circle.'
    assert explain(operator, asked(n=1)).spoken == EXIT


# H after one sentence 2.40, after two 1.04, after three 0.
@pytest.mark.parametrize(
    ('threshold', 'n', 'count'),
    [(3.0, 99, 1), (2.3, 99, 2), (1.1, 99, 2), (1.0, 99, 3), (1e-6, 10, 3), (1e-6, 1, 1)],
)
def test_a_threshold_takes_as_few_as_bring_the_doubt_below_it(
    operator: Preparation, threshold: float, n: int, count: int
) -> None:
    told = explain(operator, asked(threshold=threshold, n=n, listener='planner'))

    assert len(told.sentences) == count
    best = explain(operator, asked(n=count, listener='planner'))
    assert told.positions == best.positions


def test_below_the_threshold_already_there_is_nothing_more_to_say(operator: Preparation) -> None:
    question = asked(threshold=3.5, listener='planner')  # H = log 30 = 3.40

    assert len(explain(operator, question).sentences) == 1  # a first answer has a sentence
    again = explain(operator, question, [EXIT])
    assert again.sentences == ()
    assert again.spoken == 'The rest is only details.'


@pytest.mark.parametrize('strategy', ['increasing', 'decreasing'])
@pytest.mark.parametrize('threshold', [3.0, 2.0, 1.0, 1e-6])
def test_a_threshold_holds_for_the_baselines_too(
    operator: Preparation, strategy: str, threshold: float
) -> None:
    def told(n: int, threshold: float = 0.0) -> Explanation:
        question = asked(strategy=strategy, n=n, threshold=threshold, listener='planner')
        return explain(operator, question)

    doubts = [told(n).doubt_after for n in range(1, 9)]
    enough = next((n for n, doubt in enumerate(doubts, start=1) if doubt < threshold), 8)
    assert len(told(99, threshold).sentences) == enough
    assert len(told(1, threshold).sentences) == 1


def test_what_was_said_is_taken_as_known_and_not_said_again(operator: Preparation) -> None:
    told = explain(operator, asked(n=2, listener='planner'), [EXIT, EXIT]).as_dict()

    # Known: the exit, H = 3.40 − 1.00. The two grabs leave one goal of the ten.
    assert told['sentences'] == [CUBE, CIRCLE]
    assert told['cross_entropy_before'] == pytest.approx(math.log(11))  # log 30 − log 30/11
    assert told['information_gain'] == pytest.approx(math.log(11))
    assert told['understanding_before'] == pytest.approx(1 / 11)
    assert told['understanding'] == pytest.approx(1.0)
    candidates = [goal for goal in told['goals'] if goal['name']]
    assert {goal['prior'] > 0 for goal in candidates if 'bottom' not in goal['name']} == {False}


@pytest.mark.parametrize('listener', LISTENERS)
def test_asking_again_and_again_tells_no_sentence_twice_and_ends(
    operator: Preparation, listener: str
) -> None:
    heard: list[str] = []
    answers: list[Explanation] = []
    while not answers or answers[-1].sentences:
        answers.append(explain(operator, asked(n=2, listener=listener), heard))
        heard += answers[-1].sentences

    assert {EXIT, CUBE, CIRCLE} <= set(heard)
    assert len(heard) == len(set(heard))
    assert answers[-1].spoken in (
        'You have heard all that I am up to.',
        'The rest is only details.',
    )


def test_a_sentence_that_is_not_in_the_plan_cannot_have_been_said(operator: Preparation) -> None:
    with pytest.raises(InputError) as refused:
        explain(operator, said=[EXIT, 'I will fly.'], said_source='said.txt')

    assert str(refused.value) == 'said.txt: no step of the plan is said as "I will fly."'


def test_the_visitor_learns_of_goal_charge_and_cube(visitor: Preparation) -> None:
    told = explain(visitor, asked(n=2, listener='planner')).as_dict()

    # 4 goals · 2 (charged or not) · 2 (the cube in either room), all of them reachable
    assert len(told['hypotheses']) == 16
    assert told['complete'] is True
    assert told['goals'][1]['prior'] == pytest.approx(0.2)
    # P(b_R) = 0.2 · 0.5 · 0.7
    assert told['cross_entropy_before'] == pytest.approx(-math.log(0.2 * 0.5 * 0.7))
    robot = next(h for h in told['hypotheses'] if h['robot'])
    assert robot['true_facts'] == ['(charged)', '(item-at blue_cube blue_room)']
    assert robot['goal'] == 'red circle and blue cube, bottom door'
    for hypothesis in told['hypotheses']:
        recharges = '(recharge center)' in hypothesis['plan']
        assert recharges == ('(charged)' not in hypothesis['true_facts'])


def test_a_battery_that_is_unexpectedly_low_is_told_beside_the_ends(
    warehouse: Path, planner: Planner
) -> None:
    task = read_task(
        (warehouse / 'domain.pddl').read_text(),
        (warehouse / 'low_battery_problem.pddl').read_text(),
    )
    plan = robot_plan(task, (warehouse / 'low_battery_plan.txt').read_text())
    preparation = prepare(task, plan, read_user_model(warehouse / 'visitor.yaml', task))

    told = explain(refine(preparation, planner), asked(n=4))

    assert told.sentences == ('I will recharge my battery.', CUBE, CIRCLE, EXIT)
    charged = next(fact for fact in told.facts if fact['fact'] == '(charged)')
    assert charged['prior'] == pytest.approx(0.5)
    assert charged['posterior'] < 0.3
    assert charged['true'] is False


def test_there_is_an_answer_before_anything_is_planned(
    warehouse: Path, task: Task, operator: Preparation
) -> None:
    plan = robot_plan(task, (warehouse / 'plan.txt').read_text())

    at_once = prepare(task, plan, read_user_model(warehouse / 'user_model.yaml', task))

    for n in (1, 2, 3, 4):
        told = explain(at_once, asked(n=n))
        assert told.sentences == explain(operator, asked(n=n)).sentences
        assert told.planned == 0.0
        assert not told.complete
        assert told.unknown_mass == 1.0


def test_planning_refines_what_is_known_step_by_step(
    warehouse: Path, task: Task, planner: Planner
) -> None:
    plan = robot_plan(task, (warehouse / 'plan.txt').read_text())
    at_once = prepare(task, plan, read_user_model(warehouse / 'user_model.yaml', task))
    steps: list[tuple[int, int]] = []
    meanwhile: list[Preparation] = []

    with Planner(workers=1, downward_binary='') as fresh:
        done = refine(
            at_once,
            fresh,
            on_refined=meanwhile.append,
            progress=lambda *step: steps.append(step),
        )

    assert steps[-1] == (30, 30)
    assert done.model.planned == 1.0
    shares = [preparation.model.planned for preparation in meanwhile]
    assert shares == sorted(shares)


def test_files_are_explained_in_one_call(warehouse: Path) -> None:
    import mirror_explainer as me

    told = me.explain_files(
        warehouse / 'domain.pddl',
        warehouse / 'problem.pddl',
        warehouse / 'plan.txt',
        user_model=warehouse / 'user_model.yaml',
        n=2,
    )

    assert told.spoken == 'I will grab a blue cube and a red circle.'
    assert told.complete
    assert {name for name in me.__all__ if getattr(me, name)} == set(me.__all__)
    with pytest.raises(AttributeError, match='no attribute'):
        me.nothing_of_this_name  # noqa: B018


NUMBER = (int, float)
TEXT_OR_NONE = (str, type(None))
TYPES = {
    'strategy': str,
    'n': int,
    'sentences': [str],
    'spoken': str,
    'positions': [int],
    'actions': [str],
    'information_gain': NUMBER,
    'doubt_before': NUMBER,
    'doubt_after': NUMBER,
    'cross_entropy_before': NUMBER,
    'cross_entropy_after': NUMBER,
    'understanding_before': NUMBER,
    'understanding': NUMBER,
    'true_goal': str,
    'unmentioned': [str],
    'in_words': dict,
    'optimal': bool,
    'gap': NUMBER,
    'complete': bool,
    'planned': NUMBER,
    'covered_mass': NUMBER,
    'unsolvable_mass': NUMBER,
    'unknown_mass': NUMBER,
    'plans_cut': int,
    'listener': {
        'kind': str,
        'unforeseen': NUMBER,
        'partial_goals': NUMBER,
        'other_ends': NUMBER,
        'interest_in_facts': NUMBER,
        'interest_in_way': NUMBER,
        'min_gain': NUMBER,
    },
    'goals': [{'name': TEXT_OR_NONE, 'prior': NUMBER, 'posterior': NUMBER}],
    'facts': [{'fact': str, 'prior': NUMBER, 'posterior': NUMBER, 'true': bool}],
    'baselines': [{'strategy': str, 'positions': [int], 'understanding': NUMBER}],
    'plan': [
        {
            'position': int,
            'action': str,
            'sentence': str,
            'status': str,
            'tenses': {'ahead': str, 'running': str, 'done': str, 'skipped': str},
            'information_gain': NUMBER,
        }
    ],
    'episode': {'number': int, 'began': TEXT_OR_NONE, 'reason': str},
    'hypotheses': list,
    'seconds': {'read': NUMBER, 'planning': NUMBER, 'selection': NUMBER},
    'planner_calls': int,
}
FORESEEN = {
    'goal': str,
    'true_facts': [str],
    'plan': [str],
    'cost': NUMBER,
    'probability': NUMBER,
    'robot': bool,
}
UNFORESEEN = {
    'goal': TEXT_OR_NONE,
    'true_facts': type(None),
    'plan': type(None),
    'cost': type(None),
    'probability': NUMBER,
    'robot': bool,
    'parts': [str],
    'ends': [int],
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
    explanation = explain(request.getfixturevalue(who), asked(n=2), [DOORS])

    told = json.loads(json.dumps(explanation.as_dict(), allow_nan=False))

    assert matches(told, TYPES)
    for hypothesis in told['hypotheses']:
        assert matches(hypothesis, UNFORESEEN if hypothesis['plan'] is None else FORESEEN)
    assert sum(h['probability'] for h in told['hypotheses']) == pytest.approx(1.0)
    assert [h['robot'] for h in told['hypotheses']].count(True) == 1
    assert sum(goal['prior'] for goal in told['goals']) == pytest.approx(1.0)
    assert sum(goal['posterior'] for goal in told['goals']) == pytest.approx(1.0)
    assert [step['position'] for step in told['plan']] == [*range(10)]
    assert told['information_gain'] == pytest.approx(told['doubt_before'] - told['doubt_after'])
    short = explanation.as_dict(hypotheses=False)
    assert short.keys() == TYPES.keys() - {'hypotheses'}


def test_the_keys_are_attributes_and_a_notebook_shows_the_answer(operator: Preparation) -> None:
    told = explain(operator, asked(n=3))

    for key, value in told.as_dict().items():
        if key not in ('seconds', 'planner_calls'):
            shown = getattr(told, key)
            assert list(shown) == value if key == 'sentences' else shown == value
    assert CUBE[:-1] in repr(told)
    assert '<table>' in told._repr_html_()


def test_the_answer_can_be_recomputed_from_the_hypotheses(visitor: Preparation) -> None:
    told = explain(visitor, asked(n=3)).as_dict()
    said = set(told['sentences'])
    own_ends = {EXIT, CUBE, CIRCLE}

    left = 0.0
    true = 0.0
    for h in told['hypotheses']:
        if h['plan'] is not None:
            fits = float(said <= {said_of(action) for action in h['plan']})
        else:
            ends = {told['plan'][place]['sentence'] for place in h['ends']}
            fits = math.prod(
                0.05 if s in own_ends - ends else 20.0 if s in ends - own_ends else 1.0
                for s in said
            )
        left += h['probability'] * fits
        true += h['probability'] * fits * (h['goal'] == told['true_goal'])
    assert told['understanding'] == pytest.approx(true / left)


def test_the_plan_in_the_json_has_the_gain_of_each_single_sentence(operator: Preparation) -> None:
    told = explain(operator, asked())

    for step in told.plan:
        alone = told.model.information_gain([step['position']])
        assert step['information_gain'] == pytest.approx(alone, abs=1e-9)


def test_without_a_plan_the_robots_own_is_planned_too(
    warehouse: Path, task: Task, planner: Planner
) -> None:
    model = read_user_model(warehouse / 'visitor.yaml', task)

    plan = plan_for_robot(task, model, planner, PlanningSettings())

    assert plan.cost == 10.0
    robot_plan(task, '\n'.join(plan.actions))  # raises if it is none


def test_every_plan_of_every_belief_can_be_carried_out_and_is_optimal(
    warehouse: Path, visitor: Preparation
) -> None:
    domain = (warehouse / 'domain.pddl').read_text()
    problem = (warehouse / 'problem.pddl').read_text()
    model = visitor.model_for(PLANNER)
    for hypothesis in model.hypotheses:
        assert hypothesis.plan and hypothesis.belief
        own = problem.replace('(item-at blue_cube blue_room)', '').replace('\n    (charged))', ')')
        own = own.replace('(:init', f'(:init {" ".join(hypothesis.belief.true_facts)}')
        goal = model.goals[hypothesis.goal].goal
        own = f'{own[: own.index("(:goal")]}(:goal {goal}))'

        found = robot_plan(read_task(domain, own), '\n'.join(hypothesis.plan.actions)).plan

        assert found.cost == hypothesis.plan.cost
        assert hypothesis.plan.optimal
    # Both circles, in two rooms, by the bottom door: 10 steps, 11 with recharging.
    circles = {len(h.plan.actions) for h in model.hypotheses if h.goal == 0 and h.plan}
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

    preparation = refine(
        prepare(task, robot_plan(task, '; nothing'), UserModel(candidates)), planner
    )

    for threshold in (0.0, 0.1):
        for strategy in ('informative', 'increasing', 'decreasing'):
            told = explain(preparation, asked(strategy=strategy, threshold=threshold))
            assert told.spoken == 'I am done.'
            assert matches(json.loads(json.dumps(told.as_dict(), allow_nan=False)), TYPES)
            assert told.understanding == pytest.approx(0.5)


def test_an_empty_plan_with_the_goal_unreached_is_no_current_plan(task: Task) -> None:
    for text in ('', '; cost = 0', '(reach-goal)'):
        with pytest.raises(NoPlanError) as refused:
            robot_plan(task, text, '/robot/plan')

        assert (
            str(refused.value) == '/robot/plan: the plan is empty, and the goal does not hold yet'
        )


def test_a_robot_with_an_unlisted_goal_is_explained_with_a_warning(
    task: Task, warehouse: Path, planner: Planner
) -> None:
    plan = robot_plan(task, (warehouse / 'plan.txt').read_text())
    model = UserModel((CandidateGoal('door', '(outside bottom_door)', 1.0),))

    preparation = refine(prepare(task, plan, model), planner)

    told = explain(preparation, asked(n=2))
    # What the listener had not thought of: the two things that it fetches as well.
    assert told.actions == ['(grab blue_cube blue_room)', '(grab red_circle red_room)']
    assert told.understanding_before < 0.05
    assert told.understanding > 0.9
    assert 'is not among the user model' in preparation.warnings[0]


def test_goals_without_a_name_and_what_is_unsaid_are_put_in_words(
    task: Task, warehouse: Path
) -> None:
    plan = robot_plan(task, (warehouse / 'plan.txt').read_text())
    both = '(and (holding red_circle) (outside bottom_door))'
    model = UserModel(
        (
            CandidateGoal(both, both, 0.5),
            CandidateGoal('leave', '(outside bottom_door)', 0.3),
            CandidateGoal('(charged)', '(charged)', 0.2),
        )
    )

    told = explain(prepare(task, plan, model), asked(n=1)).as_dict()

    assert told['unmentioned'] == ['(holding red_circle)', '(outside bottom_door)']
    circle, door = 'grab the red circle', 'exit through the bottom door'
    assert told['in_words'] == {
        told['true_goal']: f'{circle} and the blue cube, and {door}',
        both: f'{circle} and {door}',
        '(charged)': 'recharge',
        '(holding red_circle)': circle,
        '(outside bottom_door)': door,
    }


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
        plan_for_robot(stuck, UserModel(candidates), planner, PlanningSettings())
    assert "robot's own goal cannot be reached" in str(refused.value)

    at_center = read_task(
        (warehouse / 'domain.pddl').read_text(),
        f'{stuck.problem[: stuck.problem.index("(:goal")]}(:goal (robot-at center)))',
    )
    plan = plan_for_robot(at_center, UserModel(candidates), planner, PlanningSettings())
    own = robot_plan(at_center, '\n'.join(plan.actions))
    preparation = refine(prepare(at_center, own, UserModel(candidates)), planner)

    assert preparation.model.understanding() == pytest.approx(1.0)
    [warning] = preparation.warnings
    assert warning == 'candidate goals that cannot be reached are left out: "leave"'


def test_permuting_goals_and_splitting_one_change_no_gain(
    task: Task, warehouse: Path, planner: Planner
) -> None:
    plan = robot_plan(task, (warehouse / 'plan.txt').read_text())
    doors = ('bottom_door', 'top_left_door', 'top_right_door')
    goals = [f'(and (holding red_circle) (holding blue_cube) (outside {door}))' for door in doors]
    whole = [CandidateGoal(goal, goal, 1 / 3) for goal in goals]
    # The first one in two halves, one of them with its parts in another order.
    other = '(and (outside bottom_door) (and (holding blue_cube) (holding red_circle)))'
    halves = [CandidateGoal(goal, goal, 1 / 6) for goal in (goals[0], other)]

    gains = []
    for candidates in (whole, whole[::-1], [*halves, *whole[1:]]):
        preparation = refine(prepare(task, plan, UserModel(tuple(candidates))), planner)
        gains.append(
            [
                explain(preparation, asked(n=n, listener=who)).information_gain
                for n, who in itertools.product((1, 2, 3), LISTENERS)
            ]
        )

    assert gains[1] == pytest.approx(gains[0], abs=1e-9)
    assert gains[2] == pytest.approx(gains[0], abs=1e-9)
