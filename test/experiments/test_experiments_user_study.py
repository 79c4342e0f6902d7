"""The simulated user study: its scenarios, observers, measures, tests, and files."""

import math
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

pd = pytest.importorskip('pandas', reason='the extra [experiments] is not installed')

from mirror_explainer.errors import PlanningError  # noqa: E402
from mirror_explainer.experiments.averages import holm, mean_interval, paired_p  # noqa: E402
from mirror_explainer.experiments.markdown import markdown_table  # noqa: E402
from mirror_explainer.experiments.study.design import (  # noqa: E402
    DONT_KNOW,
    Answer,
    assignment,
    verbalizations,
)
from mirror_explainer.experiments.study.observers import (  # noqa: E402
    KINDS,
    Habits,
    Theory,
    misheard,
    theory,
    with_habits,
)
from mirror_explainer.experiments.study.participants import Noise, choose, simulate  # noqa: E402
from mirror_explainer.experiments.study.plans import plan_scenario  # noqa: E402
from mirror_explainer.experiments.study.report import results, write_report  # noqa: E402
from mirror_explainer.experiments.study.scenarios import CORRIDORS, scenarios  # noqa: E402
from mirror_explainer.experiments.study.statistics import (  # noqa: E402
    answer_table,
    at_percents,
    curves,
    earliest_steps,
    mean_tests,
    reached_at,
)
from mirror_explainer.experiments.study.user_study import main  # noqa: E402
from mirror_explainer.experiments.study.warehouse_floor import read_floor  # noqa: E402
from mirror_explainer.explainer import robot_plan  # noqa: E402
from mirror_explainer.planning import Planner  # noqa: E402
from mirror_explainer.settings import STRATEGIES  # noqa: E402

SMALL = ['--scenarios', '4', '--participants', '3', '--seed', '109']
NOISELESS = Noise(temperature=0.0, lapse=0.0, confidence=0.5)


@pytest.fixture(scope='module')
def floor():
    return read_floor()


@pytest.fixture(scope='module')
def planned(floor):
    """Two planned scenarios, one of each battery state."""
    drawn = scenarios(floor, 2, 4)
    with Planner() as planner:
        return [plan_scenario(scenario, planner) for scenario in drawn]


@pytest.fixture(scope='module')
def run(tmp_path_factory):
    """The folder that a small study leaves behind."""
    folder = tmp_path_factory.mktemp('study')
    assert main(['simulate', *SMALL, '--output', str(folder)]) == 0
    return folder


# Scenarios


@pytest.mark.parametrize('seed', range(8))
def test_every_scenario_is_as_the_paper_describes_it(floor, seed):
    drawn = scenarios(floor, 12, seed)

    assert sum(not scenario.charged for scenario in drawn) == 6
    for scenario in drawn:
        assert list(scenario.items) == ['red_room', 'blue_room']
        for room, items in scenario.items.items():
            assert 1 <= len(set(items)) == len(items) <= 3
            assert {item.split('_')[0] for item in items} == {room.split('_')[0]}
        assert scenario.start in CORRIDORS
        count = len(scenario.all_items)
        assert len(scenario.goals) == math.comb(count, 2) * 3
        assert len({frozenset([*g.items, g.door]) for g in scenario.goals}) == len(scenario.goals)
        assert len(set(scenario.shown)) == 3
        assert scenario.goal in scenario.shown


def test_scenarios_follow_from_the_seed(floor):
    assert scenarios(floor, 12, 4) == scenarios(floor, 12, 4)
    assert scenarios(floor, 12, 4) != scenarios(floor, 12, 5)


def test_the_true_goal_is_shown_in_every_place(floor):
    drawn = [scenario for seed in range(20) for scenario in scenarios(floor, 12, seed)]
    places = [scenario.shown.index(scenario.goal) for scenario in drawn]

    assert {places.count(place) > 40 for place in range(3)} == {True}


def test_plans_are_valid_and_recharge_where_needed(planned):
    assert {item.scenario.charged for item in planned} == {True, False}
    for item in planned:
        text = '\n'.join(item.plan.actions)
        assert robot_plan(item.task, text).plan.cost == len(item.plan.actions) == item.plan.cost
        assert ('(recharge center)' in item.plan.actions) != item.scenario.charged


def test_the_robot_finds_all_goals_of_a_scenario_equally_likely_and_itself_among_them(planned):
    for item in planned:
        model = item.model
        assert model.complete
        assert model.goal_posterior()[:-1] == pytest.approx(1 / len(item.scenario.goals))
        assert model.goals[model.hypotheses[model.robot].goal].goal == (
            item.scenario.goals[item.scenario.goal].pddl
        )


def test_a_scenario_that_cannot_be_planned_in_time_is_an_error_that_names_a_goal(planned):
    with Planner() as planner, pytest.raises(PlanningError, match='no plan for ".* door"'):
        plan_scenario(planned[0].scenario, planner, deadline=0.0)


# Design


def test_strategies_are_balanced_over_participants_and_scenarios():
    rows = assignment(participants=9, number=12, seed=1)

    for row in rows:
        assert [row.count(strategy) for strategy in STRATEGIES] == [4, 4, 4]
    for column in zip(*rows, strict=True):
        assert [column.count(strategy) for strategy in STRATEGIES] == [3, 3, 3]
    assert len(set(rows)) == 9
    assert rows == assignment(9, 12, 1) != assignment(9, 12, 2)


def test_each_step_says_one_more_sentence_that_was_not_said_before(planned):
    model = planned[0].model
    sentences = model.sentences
    steps = {strategy: verbalizations(model, strategy) for strategy in STRATEGIES}
    firsts = sorted(sentences.index(sentence) for sentence in set(sentences))
    lasts = sorted(
        len(sentences) - 1 - sentences[::-1].index(sentence) for sentence in set(sentences)
    )

    assert len(firsts) < len(sentences)  # some corridor is passed twice
    assert steps['increasing'][-1] == tuple(firsts)
    assert steps['decreasing'][-1] == steps['informative'][-1] == tuple(lasts)
    for said in steps.values():
        for n, positions in enumerate(said, start=1):
            assert len({sentences[position] for position in positions}) == len(positions) == n
        for before, after in zip(said, said[1:], strict=False):
            assert set(before) < set(after)


def test_the_best_sets_tell_at_least_as_much_as_the_informative_order(planned):
    for item in planned:
        order = verbalizations(item.model, 'informative')
        sets = verbalizations(item.model, 'informative', 'sets')
        for in_order, best in zip(order, sets, strict=True):
            assert len(best) == len(in_order)
            gain = item.model.information_gain
            assert gain(best) >= gain(in_order) - 1e-9


# Observers


def test_the_same_observer_believes_what_the_mirror_model_says(planned):
    for item in planned:
        thinks = theory('same', item)
        for strategy in STRATEGIES:
            for positions in verbalizations(item.model, strategy):
                posterior = item.model.goal_posterior(positions)[list(item.scenario.shown)]
                heard = [item.model.sentences[position] for position in positions]
                belief = thinks.belief(heard, item.scenario.shown)
                assert belief == pytest.approx(posterior / posterior.sum())


def test_every_other_observer_believes_something_else(planned):
    item = max(planned, key=lambda item: len(item.scenario.goals))
    everywhere = range(len(item.scenario.goals))
    firsts = [[s] for s in dict.fromkeys(item.model.sentences)]
    thinks = {kind: theory(kind, item) for kind in KINDS}
    same = [thinks['same'].belief(heard, everywhere) for heard in firsts]

    for kind in KINDS:
        beliefs = [thinks[kind].belief(heard, everywhere) for heard in firsts]
        for belief in beliefs:
            assert belief.sum() == pytest.approx(1.0)
        alike = np.allclose(beliefs, same)
        assert alike == (kind in ('same', 'other-prior')), kind  # habits are personal


def test_an_observer_of_another_beta_does_not_rule_out_needless_work(planned):
    item = next(item for item in planned if item.scenario.charged)
    goals = range(len(item.scenario.goals))
    heard = ['I will recharge my battery.']

    assert theory('other-beta', item).belief(heard, goals).min() > 0
    # To the same observer this says nothing at all: nobody recharges a charged battery.
    assert (
        theory('same', item).likelihood[:, theory('same', item).vocabulary.index(*heard)].max()
        == 0
    )


def test_habits_weigh_goals_by_what_they_name(planned):
    item = planned[0]
    goals = item.scenario.goals
    weights = dict.fromkeys([*item.scenario.all_items, *item.scenario.floor.doors], 1.0)
    door = goals[0].door
    own = Habits(weights | {door: 4.0})

    belief = with_habits(theory('same', item), item, own).belief([], range(len(goals)))

    # One door in three weighs 4, the others 1: its goals have 4/6 of the mass.
    through = [index for index, goal in enumerate(goals) if goal.door == door]
    assert belief[through].sum() == pytest.approx(4 / 6)


def test_some_sentences_are_misheard_as_others_of_the_same_action(planned):
    item = planned[0]
    random = np.random.default_rng(0)
    pairs = [
        (said, heard)
        for _ in range(300)
        for said, heard in zip(item.model.sentences, misheard(item, random), strict=True)
    ]
    wrong = [(said, heard) for said, heard in pairs if said != heard]

    assert len(wrong) / len(pairs) == pytest.approx(0.1, abs=0.02)
    for said, heard in wrong:
        assert said.startswith('I will grab') == heard.startswith('I will grab')
        assert said.startswith('I will exit') == heard.startswith('I will exit')


def test_a_belief_that_nothing_fits_is_even():
    thinks = Theory(np.array([0, 1]), np.array([0.5, 0.5]), ('a', 'b'), np.eye(2))

    assert thinks.belief(['a', 'b'], [0, 1]).tolist() == [0.5, 0.5]


def test_without_noise_the_most_likely_goal_is_named_once_it_is_likely_enough():
    random, whim = np.random.default_rng(0), np.array([9.0, 0.0, 0.0])

    assert choose(np.array([0.2, 0.7, 0.1]), NOISELESS, whim, random) == 1
    assert choose(np.array([0.3, 0.4, 0.3]), NOISELESS, whim, random) is None


def test_at_temperature_one_goals_are_named_as_often_as_they_are_believed():
    random, noise = np.random.default_rng(0), Noise(1.0, 0.0, 0.0)
    belief = np.array([0.7, 0.3, 0.0])

    drawn = [choose(belief, noise, random.gumbel(size=3), random) for _ in range(4000)]

    assert [drawn.count(goal) / 4000 for goal in range(3)] == pytest.approx(belief, abs=0.03)


def test_a_slip_is_any_answer_alike():
    random, noise = np.random.default_rng(0), Noise(0.0, 1.0, 0.0)

    drawn = [choose(np.array([1.0, 0.0, 0.0]), noise, np.zeros(3), random) for _ in range(4000)]

    for answer in (0, 1, 2, None):
        assert drawn.count(answer) / 4000 == pytest.approx(0.25, abs=0.03)


def test_a_larger_study_contains_the_smaller_one(planned):
    rows = assignment(4, 2, 0)
    few = list(simulate(planned, 'other-prior', rows[:2], Noise(), seed=3))
    many = list(simulate(planned, 'other-prior', rows, Noise(), seed=3))

    assert many[: len(few)] == few


# Measures and tests


def scripted(participant, strategy, answers, scenario='s'):
    """Answers of one scenario from a script: r(ight), w(rong), or ? for "I don't know"."""
    said = {'r': 'goal', 'w': 'other', '?': DONT_KNOW}
    return [
        Answer(
            participant,
            'people',
            scenario,
            strategy,
            step,
            len(answers),
            len(answers),
            '',
            'goal',
            said[a],
        )
        for step, a in enumerate(answers, start=1)
    ]


def test_hit_ratios_are_those_computed_by_hand():
    table = answer_table(
        [*scripted('a', 'informative', '?rwr'), *scripted('b', 'informative', 'rrrr')]
    )

    curve = curves(table).set_index('percent')

    # Four steps: 10 % is step 1, 40 % step 2, 70 % step 3 (2.8), 100 % step 4.
    # Step 1: "a" predicts nothing, "b" hits: 1/1 of predictions; (0 + 1)/2 of answers.
    assert curve.loc[10, ['hit_ratio', 'hit_ratio_of_answers']].tolist() == [1.0, 0.5]
    assert curve.loc[40, ['hit_ratio', 'hit_ratio_of_answers']].tolist() == [1.0, 1.0]
    assert curve.loc[70, ['hit_ratio', 'hit_ratio_of_answers']].tolist() == [0.5, 0.5]
    assert curve.loc[70, ['hit_ratio_low', 'hit_ratio_high']].tolist() == [0.0, 1.0]
    assert math.isnan(curve.loc[10, 'hit_ratio_low'])  # one value has no band
    # From 90 % (3.6, step 4) on both are right; at 80 % (3.2) it is still step 3.
    assert reached_at(curve.reset_index(), 'people', 'informative', 'hit_ratio', 0.85) == 90


def test_the_share_of_a_plan_counts_its_steps_and_not_its_different_sentences():
    # A plan of 10 steps with 4 different sentences: 20 % of it is two, 50 % and more all four.
    answers = [replace(a, plan_length=10) for a in scripted('a', 'informative', 'wrrr')]

    said = at_percents(answer_table(answers)).set_index('percent')['step']

    assert said.loc[[10, 20, 30, 50, 100]].tolist() == [1, 2, 3, 4, 4]


def test_a_participants_scenarios_are_averaged_before_participants_are():
    table = answer_table(
        [
            *scripted('a', 'informative', 'r', 's1'),
            *scripted('a', 'informative', 'r', 's2'),
            *scripted('a', 'informative', 'w', 's3'),
            *scripted('b', 'informative', 'w', 's1'),
        ]
    )

    # (2/3 + 0/1) / 2, not 2/4.
    assert curves(table)['hit_ratio'].tolist() == pytest.approx([1 / 3] * 10)


@pytest.mark.parametrize(
    ('answers', 'first', 'settled'),
    [('rrrr', 1, 1), ('?rwr', 2, 4), ('??rr', 3, 3), ('rrrw', 1, 5), ('w?ww', 5, 5)],
)
def test_earliest_steps_are_those_computed_by_hand(answers, first, settled):
    [row] = earliest_steps(answer_table(scripted('a', 'increasing', answers))).to_dict('records')

    assert (row['first_right'], row['settled']) == (first, settled)


def test_the_paired_test_is_exact_and_one_sided():
    sooner, later = [1, 2, 3, 4, 5], [2, 3, 4, 5, 6]

    # Of the 2⁵ exchanges within pairs only the one observed is as low as this.
    assert paired_p(sooner, later) == pytest.approx(1 / 32)
    assert paired_p(later, sooner) == 1.0
    assert paired_p(sooner, sooner) == 1.0
    assert math.isnan(paired_p([1], [2]))


def test_pairs_of_a_cluster_are_exchanged_together():
    sooner, later = [1, 2, 3, 4, 5, 6], [2, 3, 4, 5, 6, 7]

    # Of the 2³ exchanges of three clusters only the one observed is as low as this.
    assert paired_p(sooner, later, clusters='aabbcc') == pytest.approx(1 / 8)
    assert math.isnan(paired_p(sooner, later, clusters='aaaaaa'))


def test_a_mean_is_no_surer_for_more_instances_of_the_same_problem():
    few, many = [0.0, 1.0, 1.0], [0.0] * 50 + [1.0] * 100

    mean, low, high = mean_interval(many, 999, clusters='a' * 50 + 'b' * 50 + 'c' * 50)

    assert (mean, low, high) == pytest.approx(mean_interval(few, 999))
    assert math.isnan(mean_interval(many, 999, clusters='a' * 150)[1])  # one problem tells nothing


def test_a_family_of_tests_is_corrected_by_holm():
    # 0.01 · 3, then 0.03 · 2, then 0.04 · 1, none below the one before; what is no test stays.
    assert holm([0.04, 0.01, 0.03]) == pytest.approx([0.06, 0.03, 0.06])
    assert holm([math.nan, 0.2])[1] == 0.2


def test_the_participant_is_the_unit_however_many_the_scenarios():
    answers = [
        answer
        for person in 'abc'
        for number in range(8)
        for strategy, script in (
            ('informative', 'rrrr'),
            ('increasing', '???r'),
            ('decreasing', 'rrrr'),
        )
        for answer in scripted(person, strategy, script, f'{strategy}-{number}')
    ]

    earliest = earliest_steps(answer_table(answers))
    found = mean_tests(earliest).set_index(['measure', 'baseline'])

    row = found.loc[('settled', 'increasing')]
    assert (row['participants'], row['mean_informative'], row['mean_baseline']) == (3, 1.0, 4.0)
    assert row['p'] == pytest.approx(1 / 8)  # 2³ exchanges, not 2²⁴
    assert found.loc[('settled', 'decreasing'), 'p'] == 1.0


# The command


def test_a_run_leaves_every_answer_behind(run):
    answers = pd.read_csv(run / 'answers.csv')

    assert list(answers.columns) == [
        'participant', 'observer', 'scenario', 'strategy', 'step', 'steps', 'plan_length', 'said',
        'goal', 'answer', 'listener', 'predicted', 'correct',
    ]  # fmt: skip
    assert set(answers['observer']) == set(KINDS)
    shown = answers.groupby(['participant', 'scenario'])
    assert len(shown) == len(KINDS) * 3 * 4
    for _, asked in shown:
        assert asked['strategy'].nunique() == asked['goal'].nunique() == 1
        assert asked['step'].tolist() == list(range(1, asked['steps'].iloc[0] + 1))
        assert [len(str(said).split()) for said in asked['said']] == asked['step'].tolist()
        assert set(asked['answer']) <= {DONT_KNOW} | set(answers['answer'])
    assert (answers['correct'] == (answers['goal'] == answers['answer'])).all()


def test_a_run_leaves_measures_and_tests_that_follow_from_the_answers(run):
    answers = pd.read_csv(run / 'answers.csv')
    found = results(answers, seed=109)

    for name, table in (('hit_ratio', found.curves), ('tests', found.tests)):
        written = pd.read_csv(run / f'{name}.csv')
        pd.testing.assert_frame_equal(written, table, check_dtype=False, rtol=1e-6)
    assert len(found.curves) == len(KINDS) * 3 * 10
    assert len(found.tests) == len(KINDS) * 2 * 2


def test_a_run_leaves_a_report_and_a_figure(run):
    report = (run / 'report.md').read_text()

    assert 'user_study simulate --participants 3 --scenarios 4 --seed 109' in report
    assert "| the paper's 10 people |" in report
    assert '0 of 4 scenarios are left out' in report
    assert 'nan' not in report
    for kind in KINDS:
        assert f'| {kind} ' in report
    assert (run / 'user_study.png').read_bytes().startswith(b'\x89PNG')
    assert '<svg' in (run / 'user_study.svg').read_text()


def test_a_run_is_repeated_exactly(run, tmp_path):
    assert main(['simulate', *SMALL, '--output', str(tmp_path)]) == 0

    assert {file.name for file in run.iterdir()} == {file.name for file in tmp_path.iterdir()}
    for file in run.iterdir():
        assert (tmp_path / file.name).read_bytes() == file.read_bytes(), file.name


def test_words_for_each_listener_are_heard_by_the_same_people(tmp_path):
    few = ['--studies', '1', '--scenarios', '3', '--participants', '2']
    assert main(['speakers', *few, '--output', str(tmp_path)]) == 0

    answers = pd.read_csv(tmp_path / 'speaker_answers.csv')
    table = pd.read_csv(tmp_path / 'speakers.csv')

    people = answers.groupby('speaker')['participant'].agg(set)
    assert people['open'] == people['planner']
    assert len(people['open']) == 2 * len(KINDS)
    assert (table['more'] - (table['open'] - table['planner'])).abs().max() < 1e-5
    end = table[table['percent'] == 100]  # all is said, whoever chose the words
    assert end['more'].tolist() == pytest.approx([0.0] * len(KINDS))
    assert (
        'user_study speakers --studies 1 --scenarios 3' in (tmp_path / 'speakers.md').read_text()
    )


def test_scenarios_left_out_are_named_in_the_report(planned, tmp_path):
    rows = assignment(3, 2, 0)
    table = answer_table(simulate(planned, 'same', rows, Noise(), seed=0))

    write_report(results(table, 0), planned, {'scenario-9': 'too slow'}, tmp_path, 'a command')

    report = (tmp_path / 'report.md').read_text()
    assert '1 of 3 scenarios are left out' in report
    assert '- scenario-9: too slow' in report


def test_what_is_missing_is_a_dash_and_a_heading_stays_as_it_is():
    table = pd.DataFrame({'the nan share': [0.5, math.nan], 'p': [math.nan, 0.01234]})

    heading, _, *rows = markdown_table(table).split('\n')

    assert heading.split() == ['|', 'the', 'nan', 'share', '|', 'p', '|']
    assert [row.split() for row in rows] == [
        ['|', '0.50', '|', '–', '|'],
        ['|', '–', '|', '0.0123', '|'],
    ]


@pytest.mark.parametrize(
    ('arguments', 'reason'),
    [
        ([], 'the following arguments are required: command'),
        (['simulate', '--participants', '1'], '"1" is no whole number from 2 up'),
        (['simulate', '--scenarios', '2'], '"2" is no whole number from 3 up'),
        (['simulate', '--seed', '-1'], '"-1" is no whole number from 0 up'),
        (['simulate', '--lapse', '1.5'], '"1.5" is no number from 0 to 1'),
        (['simulate', '--confidence', 'high'], '"high" is no number from 0 to 1'),
        (['simulate', '--temperature', 'inf'], '"inf" is no number from 0 up'),
        (['simulate', '--observer', 'cat'], "invalid choice: 'cat'"),
    ],
)
def test_bad_arguments_end_with_2_and_a_sentence(arguments, reason, capsys):
    with pytest.raises(SystemExit) as ended:
        main(arguments)

    assert ended.value.code == 2
    assert reason in capsys.readouterr().err


def test_an_output_that_is_a_file_ends_with_2_and_its_name(tmp_path, capsys):
    file = tmp_path / 'taken'
    file.write_text('')

    assert main(['simulate', *SMALL, '--output', str(file)]) == 2
    assert str(file) in capsys.readouterr().err


def test_without_pandas_the_command_says_what_to_install(monkeypatch, capsys, tmp_path):
    monkeypatch.setitem(sys.modules, 'pandas', None)

    assert main(['simulate', '--output', str(tmp_path / 'results')]) == 2
    said = capsys.readouterr().err
    assert 'pip install matplotlib pandas rich scipy tabulate tqdm' in said
    assert '[experiments]' in said
    assert not Path(tmp_path / 'results').exists()
