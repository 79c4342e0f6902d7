import io
import json
import os
import tarfile
from pathlib import Path

import pytest

pytest.importorskip('pandas', reason='the extra [experiments] is not installed')

import pandas as pd

from mirror_explainer.experiments.averages import said_at
from mirror_explainer.experiments.benchmark import pucrs
from mirror_explainer.experiments.benchmark.dataset import find_instances, read_instance
from mirror_explainer.experiments.benchmark.ground_actions import distances_to_goal, ground_action
from mirror_explainer.experiments.benchmark.protocol import Settings, run_instance
from mirror_explainer.experiments.benchmark.pucrs import main
from mirror_explainer.pddl import read_task

# Rooms a-b-c-d in a row, another door from a to e; a key in c, a map in e, the ghost nowhere.
_DOMAIN = """
(define (domain rooms)
  (:requirements :strips :typing)
  (:types room item)
  (:predicates (at ?r - room) (door ?from ?to - room) (in ?i - item ?r - room) (held ?i - item))
  (:action go :parameters (?from ?to - room)
    :precondition (and (at ?from) (door ?from ?to))
    :effect (and (not (at ?from)) (at ?to)))
  (:action take :parameters (?i - item ?r - room)
    :precondition (and (at ?r) (in ?i ?r))
    :effect (and (not (in ?i ?r)) (held ?i))))
"""
_TEMPLATE = """
(define (problem toy) (:domain rooms)
  (:objects a b c d e - room key map ghost - item)
  (:init (at a) (door a b) (door b a) (door b c) (door c b) (door c d) (door d c) (door a e)
         (door e a) (in key c) (in map e))
  (:goal (and <HYPOTHESIS>)))
"""
_POOL = ['(held key)', '(held MAP),(at a)', '(at d)', '(at e)', '(held map), (held key)']
_FILES = {
    'domain.pddl': _DOMAIN,
    'template.pddl': _TEMPLATE,
    'hyps.dat': '\n'.join(_POOL),
    'real_hyp.dat': '(held key)',
}


def _folder(path: Path, **changed: str) -> None:
    path.mkdir(parents=True)
    for name, text in (
        _FILES | {k.replace('_dat', '.dat'): v for k, v in changed.items()}
    ).items():
        (path / name.replace('_pddl', '.pddl')).write_text(text)


def _archive(path: Path, files: dict[str, str]) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    with tarfile.open(path, 'w:bz2') as archive:
        for name, text in files.items():
            member = tarfile.TarInfo(name)
            member.size = len(text.encode())
            archive.addfile(member, io.BytesIO(text.encode()))


def _arguments(dataset: Path, output: Path, *more: str) -> list[str]:
    return ['--dataset', str(dataset), '--output', str(output), '--jobs', '1', *more]


@pytest.fixture(scope='module')
def dataset(tmp_path_factory):
    """Two domains of two instances: one in folders, one in archives as they are published."""
    root = tmp_path_factory.mktemp('dataset')
    _folder(root / 'rooms' / 'rooms_p01_hyp-0')
    _folder(
        root / 'rooms' / 'rooms_p02_hyp-0',
        hyps_dat='\n'.join([*_POOL, '(held ghost)']),
        template_pddl=_TEMPLATE.replace('problem toy', 'problem other'),
    )
    observed = '(go a b)\n(go b c)\n(take key c)\n'
    for number in (1, 2):
        name = f'halls_p0{number}_hyp-0'
        _archive(
            root / 'halls' / '100' / f'{name}_full.tar.bz2',
            {f'./{file}': text for file, text in _FILES.items()} | {'./obs.dat': observed},
        )
        _archive(root / 'halls' / '10' / f'{name}_10_0.tar.bz2', _FILES | {'obs.dat': '(go a b)'})
    return root


@pytest.fixture(scope='module')
def results(dataset, tmp_path_factory):
    output = tmp_path_factory.mktemp('results')
    assert main(_arguments(dataset, output, '--seed', '3')) == 0
    return output


def _require_sound(rows: pd.DataFrame) -> None:
    assert rows['G_inf'].min() >= -1e-9
    assert rows['D_G'].between(0, 1).all()
    assert rows['understanding'].between(0, 1).all()
    for _, instance in rows.groupby(['domain', 'instance']):
        length = instance['plan_length'].iloc[0]
        for _, strategy in instance.groupby('strategy'):
            assert list(strategy['N']) == list(range(1, length + 1))
        said = instance[instance['N'] == length]
        assert said['H'].max() - said['H'].min() < 1e-9  # the whole plan, whoever says it
        before = instance['H'] + instance['IG']
        assert before.max() - before.min() < 1e-9  # the same uncertainty before


def test_every_instance_strategy_and_n_is_in_the_csv_and_informative_is_never_behind(results):
    rows = pd.read_csv(results / 'pucrs.csv')

    assert sorted(set(zip(rows['domain'], rows['instance'], strict=True))) == [
        ('halls', 'halls_p01_hyp-0'),
        ('halls', 'halls_p02_hyp-0'),
        ('rooms', 'rooms_p01_hyp-0'),
        ('rooms', 'rooms_p02_hyp-0'),
    ]
    assert set(rows['strategy']) == {'informative', 'decreasing', 'increasing'}
    assert rows[rows['strategy'] == 'informative']['G_inf'].abs().max() < 1e-9
    _require_sound(rows)


def test_the_averages_are_those_of_the_rows_at_ten_to_a_hundred_percent(results):
    rows = pd.read_csv(results / 'pucrs.csv')
    means = pd.read_csv(results / 'pucrs_averages.csv')

    wanted = rows['plan_length'].map(lambda length: max(1, round(0.5 * length)))
    half = rows[(rows['N'] == wanted) & (rows['domain'] == 'rooms')]
    expected = half[half['strategy'] == 'increasing']['H'].mean()
    found = means.query(
        "domain == 'rooms' and strategy == 'increasing' and percent == 50 and measure == 'H'"
    ).iloc[0]
    assert found['mean'] == pytest.approx(expected)
    assert found['low'] <= found['mean'] <= found['high']
    assert found['instances'] == found['problems'] == 2
    assert means[means['domain'] == 'halls'][['low', 'high']].isna().all(axis=None)  # one problem
    assert sorted(means['percent'].unique()) == list(range(10, 101, 10))


def test_the_table_of_domains_has_both_readings_of_plan_length(results):
    domains = pd.read_csv(results / 'pucrs_domains.csv').set_index('domain')

    halls, rooms = domains.loc['halls'], domains.loc['rooms']
    assert halls['predicates'] == 4 and halls['actions'] == 2 and halls['initial facts'] == 11
    assert halls['goals'] == 5 and rooms['goals'] == 5.5
    assert halls['optimal plan'] == 3  # go, go, take
    assert halls['recorded plan'] == 3 and halls['with recorded plan'] == 2
    assert rooms['with recorded plan'] == 0
    assert 'Not every instance of rooms' in (results / 'report.md').read_text()


def test_the_figure_is_written_as_png_and_svg(results):
    assert (results / 'pucrs.png').read_bytes().startswith(b'\x89PNG')
    assert '<svg' in (results / 'pucrs.svg').read_text()


def test_the_report_states_each_finding_with_its_numbers_and_the_command(results):
    report = (results / 'report.md').read_text()

    assert '--instances 10 --seed 3' in report
    assert 'min G_inf = ' in report and '0 below −1e-9' in report
    for claim in ('first 10 %', 'Decreasing is consistently', 'near the goal', 'similar to that'):
        assert claim in report
    assert '0 of 4 instances are left out' in report


def test_the_results_are_the_same_for_any_number_of_jobs(dataset, results, tmp_path):
    assert main(_arguments(dataset, tmp_path, '--seed', '3', '--jobs', '2')) == 0

    for name in (
        'pucrs.csv', 'pucrs_averages.csv', 'pucrs_domains.csv', 'pucrs_findings.csv',
        'pucrs.svg', 'report.md',
    ):  # fmt: skip
        assert (tmp_path / name).read_bytes() == (results / name).read_bytes(), name


def test_another_seed_draws_other_goals_and_facts(dataset):
    location = find_instances(dataset)['halls'][0]
    problem = read_instance(location, dataset)

    one, other = (run_instance(location, problem, Settings(seed=seed)) for seed in (3, 4))

    assert (one.goals, one.uncertain_facts) != (other.goals, other.uncertain_facts)


def test_an_interrupted_run_resumes_with_what_is_missing(dataset, tmp_path, monkeypatch):
    ran = []
    run_instance = pucrs.run_instance

    def spy(location, problem, settings):
        ran.append(location.name)
        if len(ran) == 2:
            raise KeyboardInterrupt
        return run_instance(location, problem, settings)

    monkeypatch.setattr(pucrs, 'run_instance', spy)
    arguments = _arguments(dataset, tmp_path, '--domains', 'halls')
    assert main(arguments) == 130
    assert not (tmp_path / 'report.md').exists()

    assert main(arguments) == 0
    assert ran == ['halls_p01_hyp-0', 'halls_p02_hyp-0', 'halls_p02_hyp-0']

    assert main([*arguments, '--seed', '1', '--instances', '1']) == 0  # another seed runs again
    assert len(ran) == 4


def test_what_cannot_be_measured_is_named_and_left_out(tmp_path, capsys):
    data = tmp_path / 'data'
    _folder(data / 'rooms' / 'good')
    _folder(data / 'rooms' / 'few', hyps_dat='\n'.join([*_POOL[:3], _POOL[0]]))
    _folder(data / 'rooms' / 'ghost', hyps_dat='\n'.join([*_POOL[:4], '(held ghost)']))
    _folder(data / 'rooms' / 'ghosts', hyps_dat='\n'.join([*_POOL[:3], '(held ghost)']))
    _folder(data / 'rooms' / 'unknown', hyps_dat='\n'.join([*_POOL, '(held sword)']))
    _folder(data / 'rooms' / 'nogoal', template_pddl=_TEMPLATE.replace('<HYPOTHESIS>', ''))
    (data / 'rooms' / 'broken_full.tar.bz2').write_bytes(b'BZh91AY&SY no archive')
    _archive(data / 'rooms' / 'partial_full.tar.bz2', {'domain.pddl': _DOMAIN})

    assert main(_arguments(data, tmp_path / 'out')) == 0

    report = (tmp_path / 'out' / 'report.md').read_text()
    assert '6 of 8 instances are left out' in report
    said = capsys.readouterr()
    assert '2 of 8 instances measured' in said.out
    for words in (
        'few: the pool has 3 goals',
        'ghosts: only 3 goals of the pool can be reached',
        'no object "sword"',
        'template.pddl has no <HYPOTHESIS>',
        'the archive is broken',
        'the instance lacks template.pddl, hyps.dat, real_hyp.dat',
    ):
        assert words in report and words in said.err
    rows = pd.read_csv(tmp_path / 'out' / 'pucrs.csv')
    assert set(rows['instance']) == {'good', 'ghost'}
    means = pd.read_csv(tmp_path / 'out' / 'pucrs_averages.csv')
    assert set(means['instances']) == {2}


def test_an_unsolvable_hypothesis_is_named_and_another_goal_drawn(tmp_path):
    ghosts = [f'(held ghost), {goal}' for goal in _POOL]
    _folder(tmp_path / 'data' / 'rooms' / 'haunted', hyps_dat='\n'.join([*_POOL, *ghosts]))

    assert main(_arguments(tmp_path / 'data', tmp_path / 'out')) == 0

    [file] = (tmp_path / 'out').rglob('haunted.json')
    result = json.loads(file.read_text())['result']
    assert len(result['goals']) == 4
    assert not any('ghost' in goal for goal in result['goals'])
    assert {'ghost' in goal for goal in result['unsolvable']} == {True}
    report = (tmp_path / 'out' / 'report.md').read_text()
    assert f'{len(result["unsolvable"])} drawn goals cannot be reached' in report


def test_a_plan_whose_preconditions_do_not_hold_initially_is_left_out(tmp_path, capsys):
    free = _DOMAIN.replace('(and (at ?from) (door ?from ?to))', '(and)')
    free = free.replace('(and (at ?r) (in ?i ?r))', '(and)').replace('(not (in ?i ?r))', '')
    _folder(tmp_path / 'data' / 'rooms' / 'free', domain_pddl=free)

    assert main(_arguments(tmp_path / 'data', tmp_path / 'out')) == 1

    assert "no precondition of the robot's plan holds initially" in capsys.readouterr().err


def test_too_little_time_leaves_an_instance_out(tmp_path, capsys):
    _folder(tmp_path / 'data' / 'rooms' / 'slow')

    arguments = _arguments(tmp_path / 'data', tmp_path / 'out', '--deadline', '1e-6')
    assert main(arguments) == 1

    assert 'no plan was found for the goal' in capsys.readouterr().err


@pytest.mark.parametrize(
    ('arguments', 'words'),
    [
        ([], 'give the data set'),
        (['--dataset', '{tmp}/nowhere'], 'there is no such folder'),
        (['--dataset', '{tmp}'], 'this is no data set'),
        (['--dataset', '{data}', '--domains', 'rooms', 'cellars'], 'no domain cellars is there'),
    ],
)
def test_wrong_arguments_end_with_one_sentence(
    arguments, words, dataset, tmp_path, monkeypatch, capsys
):
    monkeypatch.delenv(pucrs.ENVIRONMENT, raising=False)
    filled = [a.format(tmp=tmp_path, data=dataset) for a in arguments]

    assert main([*filled, '--output', str(tmp_path / 'out')]) == 2

    error = capsys.readouterr().err
    assert words in error and error.count('\n') == 1


def test_a_missing_extra_is_named_with_the_way_to_install_it(dataset, monkeypatch, capsys):
    from mirror_explainer.commands import extras

    monkeypatch.setattr(extras, 'find_spec', lambda name: None if name == 'pandas' else name)

    assert main(['--dataset', str(dataset)]) == 2

    assert capsys.readouterr().err == (
        'pucrs_benchmark: the experiments need pandas, of the extra [experiments]: '
        'pip install matplotlib pandas rich scipy tabulate tqdm\n'
    )


def test_an_archive_writes_nothing_to_the_disk(tmp_path):
    inside = {f'../../{name}': text for name, text in _FILES.items()}
    _archive(tmp_path / 'data' / 'rooms' / 'evil_full.tar.bz2', inside)
    before = sorted(tmp_path.rglob('*'))

    [location] = find_instances(tmp_path / 'data')['rooms']
    problem = read_instance(location, tmp_path / 'data')

    assert problem.true_goal == '(and (held key))'
    assert sorted(tmp_path.rglob('*')) == before


def test_the_fully_observed_archive_is_taken_and_goals_are_read_whatever_their_form(dataset):
    locations = find_instances(dataset)['halls']

    problem = read_instance(locations[0], dataset)

    assert [location.path.parent.name for location in locations] == ['100', '100']
    assert problem.observed == 3
    assert problem.goals[1] == '(and (at a) (held map))'
    assert '(:goal (and (at d)))' in problem.problem('(and (at d))')


def test_what_a_ground_action_needs_and_changes():
    task = read_task(_DOMAIN, _TEMPLATE.replace('<HYPOTHESIS>', '(held key)'))

    action = ground_action(task, '(go a b)')

    assert action.preconditions == {'(at a)', '(door a b)'}
    assert action.added == {'(at b)'}
    assert action.deleted == {'(at a)'}


def test_the_distance_to_the_goal_counts_the_actions_up_to_the_next_goal_predicate():
    goal = '(held map) (held key)'
    task = read_task(_DOMAIN, _TEMPLATE.replace('<HYPOTHESIS>', goal))
    plan = ['(go a e)', '(take map e)', '(go e a)', '(go a b)', '(go b c)', '(take key c)']

    # take map is 1 step from go a e; take key 3, 2, 1 steps from the three moves after it.
    assert distances_to_goal(task, plan) == [1 / 6, 0, 3 / 6, 2 / 6, 1 / 6, 0]


def test_n_is_the_rounded_share_of_the_plan_and_at_least_one():
    assert [said_at(percent, 8) for percent in (10, 20, 50, 100)] == [1, 2, 4, 8]
    assert said_at(10, 3) == 1


@pytest.mark.skipif(not os.environ.get(pucrs.ENVIRONMENT), reason='the PUCRS data set is not here')
def test_on_the_data_set_informative_is_never_behind(tmp_path):
    arguments = ['--output', str(tmp_path), '--domains', 'miconic', 'blocks-world']

    assert main([*arguments, '--instances', '1', '--jobs', '2', '--planning-timeout', '3']) == 0

    rows = pd.read_csv(tmp_path / 'pucrs.csv')
    assert set(rows['domain']) == {'miconic', 'blocks-world'}
    _require_sound(rows)
