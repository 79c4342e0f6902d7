"""Who understands what: the tasks, what is judged, and the tables made from it."""

from pathlib import Path
from random import Random

import pytest
from kstar import needs_kstar

pd = pytest.importorskip('pandas', reason='the extra [experiments] is not installed')

from mirror_explainer.experiments.documented import filled  # noqa: E402
from mirror_explainer.experiments.understanding import report  # noqa: E402
from mirror_explainer.experiments.understanding.judged import (  # noqa: E402
    EQUALS,
    Judged,
    judgements,
    plan_task,
)
from mirror_explainer.experiments.understanding.report import against, means, regret  # noqa: E402
from mirror_explainer.experiments.understanding.robots import ROBOTS  # noqa: E402
from mirror_explainer.experiments.understanding.tasks import own_tasks  # noqa: E402
from mirror_explainer.experiments.understanding.who_understands import main  # noqa: E402
from mirror_explainer.pddl import read_task  # noqa: E402
from mirror_explainer.planning import Planner  # noqa: E402

DOCS = Path(__file__).parents[2] / 'docs'


@pytest.fixture(scope='module')
def inspection():
    """A task of the robot that inspects a plant, planned for."""
    [drawn] = (task for task in own_tasks(1, 0) if task.domain == 'inspection')
    with Planner(workers=1) as planner:
        return plan_task(drawn, planner, 60.0)


@pytest.mark.parametrize('robot', ROBOTS)
def test_a_drawn_robot_can_be_read_with_each_of_its_goals(robot: str) -> None:
    problem = ROBOTS[robot](Random(3))

    assert len(set(problem.goals)) == len(problem.goals) > 8
    for goal in problem.goals:
        read_task(problem.domain, problem.problem(goal))
    assert problem == ROBOTS[robot](Random(3)) != ROBOTS[robot](Random(4))


@needs_kstar
def test_a_task_has_several_equally_good_plans(inspection) -> None:
    assert max(len(result.plans) for result in inspection.many.results.values()) > 2
    assert {len(result.plans) for result in inspection.one.results.values()} <= {0, 1}
    most = inspection.known(2).results.values()
    assert max(len(result.plans) for result in most) == 2


@needs_kstar
def test_each_speaker_is_judged_by_each_listener_at_each_n(inspection) -> None:
    rows = pd.DataFrame([vars(row) for row in judgements(inspection, counts=(1, 300))])

    places = rows.groupby(['speaker', 'plans', 'judge'])['N'].agg(list)
    assert {tuple(sizes) for sizes in places} == {(1, 2, 3, 4)}
    # Two speakers × counts × judges; two orders, and the planner's equals, × judges.
    assert len(places) == 2 * 2 * 2 + 3 * 2
    assert rows['understanding'].between(0, 1).all()
    own = rows[(rows['plans'] != 1) & (rows['judge'] == 'planner')]
    doubt = own.pivot(index='N', columns='speaker', values='doubt')
    for other in ('open', 'increasing', 'decreasing'):
        assert (doubt['planner'] <= doubt[other] + 1e-9).all()  # its own words leave least to it
    assert doubt['planner'].tolist() == pytest.approx(doubt[EQUALS].tolist())


def row(task: str, speaker: str, understanding: float, **changed: object) -> Judged:
    values = {
        'group': 'g', 'domain': 'd', 'problem': task[0], 'plans': 300, 'N': 1, 'judge': 'open',
        'said': 1, 'doubt': 1.0 - understanding, 'hypotheses': 9, 'cut': 0,
    }  # fmt: skip
    values |= {'task': task, 'speaker': speaker, 'understanding': understanding}
    return Judged(**(values | changed))  # type: ignore[arg-type]


def test_tables_are_those_computed_by_hand() -> None:
    # Two tasks of the world a, one of the world b.
    rows = [
        row('a1', 'open', 0.9), row('a1', 'planner', 0.5), row('a2', 'open', 0.7),
        row('a2', 'planner', 0.5), row('b1', 'open', 0.8), row('b1', 'planner', 0.8),
        row('a1', 'open', 0.6, plans=1), row('a2', 'open', 0.7, plans=1),
    ]  # fmt: skip
    judged = pd.DataFrame([vars(r) for r in rows])

    mean = means(judged).set_index(['speaker', 'plans'])
    more = against(judged[judged['plans'] == 300]).iloc[0]
    lost = regret(judged).set_index(['speaker', 'plans'])

    assert mean.loc[('open', 300), 'mean'] == pytest.approx(0.8)
    assert mean.loc[('open', 300), 'problems'] == 2
    assert more['more'] == pytest.approx(0.2)  # (0.4 + 0.2 + 0) / 3
    assert (more['low'], more['high']) == pytest.approx((0.0, 0.3))  # b alone, a alone
    assert more['p'] == pytest.approx(0.5)  # of ±0.6 ± 0: half are as high
    assert lost.loc[('open', 1), 'lost'] == pytest.approx(0.15)  # (0.3 + 0) / 2
    assert lost.loc[('open', 1), 'lost_worst'] == pytest.approx(0.3)
    assert lost.loc[('open', 1), 'doubt_more'] == pytest.approx(0.15)


def test_a_report_says_how_it_is_made_and_of_how_many_tasks_not_all_is_known(tmp_path) -> None:
    rows = [
        row(task, speaker, 0.5, judge=judge, cut=task == 'b1')
        for task in ('a1', 'b1')
        for speaker in ('open', 'planner')
        for judge in ('open', 'planner')
    ]

    report.write_report(rows, 3, tmp_path, 'a command')

    text = (tmp_path / 'understanding.md').read_text()
    assert 'Regenerated by `a command`.' in text
    assert '2 of 3 tasks; in 1 of them time cut' in text and 'fewer than there are (d 1)' in text
    assert pd.read_csv(tmp_path / 'understanding.csv')['mean'].tolist() == [0.5] * 4


def test_bad_input_ends_with_a_sentence(tmp_path, capsys) -> None:
    assert main(['--dataset', str(tmp_path / 'nowhere')]) == 2
    assert 'there is no such folder' in capsys.readouterr().err


def test_the_tables_of_the_results_page_are_those_of_the_files() -> None:
    page = (DOCS / 'results.md').read_text('utf-8')

    assert page.count('<!-- table ') >= 7
    assert filled(page, DOCS / 'results') == page


def test_what_was_measured_of_both_speakers_is_what_the_results_page_says() -> None:
    table = pd.read_csv(DOCS / 'results' / 'understanding.csv')
    more = pd.read_csv(DOCS / 'results' / 'against.csv')

    for group in ('PUCRS', 'our robots'):
        of = table[(table['group'] == group) & (table['plans'] == 300)]
        mean = of.set_index(['judge', 'speaker', 'N'])['mean']
        for n in (1, 2, 3, 4):
            assert mean['open', 'open', n] > mean['open', 'planner', n]
            # To a planner they differ by less than their intervals are wide.
            assert mean['planner', 'open', n] >= mean['planner', 'planner', n] - 0.05
    pucrs = table[(table['group'] == 'PUCRS') & (table['plans'] == 300)]
    mean = pucrs.set_index(['judge', 'speaker', 'N'])['mean']
    for n in (1, 2, 3):
        assert mean['open', 'open', n] >= 2 * mean['open', EQUALS, n]
    sure = more[(more['group'] == 'PUCRS') & (more['plans'] == 300)].set_index(['judge', 'N'])['p']
    assert (sure['open'] < 0.05).all()
    assert (sure['planner'] > 0.05).all()
