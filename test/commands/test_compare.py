from pathlib import Path

import pytest

pytest.importorskip('tabulate', reason='the extra [experiments] is not installed')

from mirror_explainer.commands.compare import (
    cost_hint,
    either_listener,
    flattens,
    hint,
    levels,
    main,
    reached,
    sufficient,
)
from mirror_explainer.planning import Plan

_WAREHOUSE = Path(__file__).parents[2] / 'config' / 'warehouse'


def _arguments(*more: str) -> list[str]:
    files = {
        '--domain': 'domain.pddl',
        '--problem': 'problem.pddl',
        '--plan': 'plan.txt',
        '--user-model': 'user_model.yaml',
    }
    given = [word for key, name in files.items() for word in (key, str(_WAREHOUSE / name))]
    return [*given, *more]


def _curves(**understanding: list[float]) -> list[dict[str, object]]:
    return [
        {
            'n': n,
            **{
                strategy: {
                    'understanding': values[n - 1],
                    'information_gain': 2.0 * values[n - 1],
                    'doubt': 2.0 * (1 - values[n - 1]),
                }
                for strategy, values in understanding.items()
            },
        }
        for n in range(1, len(understanding['informative']) + 1)
    ]


def test_the_warehouse_is_told_in_three_orders_with_the_n_that_each_needs(tmp_path, capsys):
    written = ('--figure', str(tmp_path / 'figure.png'), '--output', str(tmp_path / 'told.txt'))
    assert main(_arguments(*written, '--listener', 'planner')) == 0

    assert 'Hint' not in capsys.readouterr().out
    lines = (tmp_path / 'told.txt').read_text().splitlines()
    table = lines.index(next(line for line in lines if 'Increasing order' in line))
    first, last = lines[table + 2], lines[table + 9]
    expected = (
        'I will navigate to the central corridor.',
        'I will exit from the bottom door.',
        'I will exit from the bottom door.',
    )
    assert ' '.join(first.split()) == ' '.join(['1', *expected])
    assert last.startswith(' 8  I will exit from the bottom door.')
    # Three sentences tell all ln 30 = 3.40 nats: two of five objects, one of three doors.
    three = next(line for line in lines if line.split()[:1] == ['3'] and '%' in line)
    assert three.split()[-2:] == ['100%', '3.40']
    [level] = [line for line in lines if line.split()[:1] == ['85%'] and 'sure' not in line]
    assert level.split() == ['85%', '6', '8', '3']
    assert any(line.startswith('Hint: n: 3 makes the listener 100% sure') for line in lines)
    # Whoever is asked for in the tables above, both listeners are set side by side.
    [flat] = [line for line in lines if line.startswith('The curves flatten')]
    assert flat.endswith('at n: 3 for open, n: 3 for planner.')
    # Every action of the warehouse costs 1, and its user model has rationality 1.
    [cost] = [line for line in lines if line.startswith('Hint: a step')]
    assert cost.startswith('Hint: a step of the plan costs 1 in the mean. With rationality: 1 ')
    assert (tmp_path / 'figure.png').read_bytes().startswith(b'\x89PNG')
    assert '<svg' in (tmp_path / 'figure.svg').read_text()


def test_a_level_that_a_strategy_never_reaches_is_called_so():
    curves = _curves(informative=[0.6, 0.9], increasing=[0.1, 0.9], decreasing=[0.2, 0.4])

    assert reached(curves, 'informative', 0.85) == 2
    assert reached(curves, 'decreasing', 0.85) is None
    assert 'never' in levels(curves)
    assert 'n: 2 makes' in hint(curves)


def test_the_hint_for_plans_that_sound_the_same_is_to_word_them_apart():
    curves = _curves(informative=[0.4, 0.5], increasing=[0.1, 0.5], decreasing=[0.2, 0.5])

    assert 'leaves the listener 50% sure' in hint(curves)
    assert 'word them apart' in hint(curves)


def test_a_threshold_that_is_never_reached_says_what_tells_all():
    curves = _curves(informative=[0.5, 0.9, 0.9], increasing=[0, 0, 0.9], decreasing=[0, 0, 0.9])

    assert sufficient(curves, 1.5) == 1  # D = 2·(1 − 0.5) = 1 < 1.5
    assert sufficient(curves, 0.1) == 2  # D = 0.2 is as low as it gets


def test_the_hint_says_why_a_threshold_takes_more_and_where_it_is_not_reached():
    curves = _curves(informative=[0.9, 0.95], increasing=[0, 0.95], decreasing=[0, 0.95])

    # D = 2·(1 − 0.9) = 0.2 is no less than -ln 0.85 = 0.16, D = 2·(1 − 0.95) is.
    assert '\n2 of this one. Set n' in hint(curves) and 'unsure of, too' in hint(curves)
    curves = _curves(informative=[0.9], increasing=[0.9], decreasing=[0.9])
    assert '\n1 of this one, which leave the least, 0.20. Set n' in hint(curves)


def test_a_curve_flattens_where_nearly_all_is_told():
    curves = _curves(informative=[0.5, 0.93, 1.0], increasing=[0, 0, 1], decreasing=[0, 0, 1])

    assert flattens(curves, 0.9) == 2  # 2·0.93 nats of 2·1
    assert flattens(curves, 1.0) == 3


def test_either_listener_is_shown_up_to_where_both_know_all():
    soon = _curves(informative=[0.7, 1.0, 1.0, 1.0], increasing=[0] * 4, decreasing=[0] * 4)
    late = _curves(informative=[0.5, 0.6, 0.8, 0.8], increasing=[0] * 4, decreasing=[0] * 4)

    text = either_listener({'open': late, 'planner': soon})

    assert [line.split() for line in text.splitlines() if '%' in line][:3] == [
        ['1', '50%', '70%'],
        ['2', '60%', '100%'],
        ['3', '80%', '100%'],
    ]
    assert text.endswith('at n: 3 for open, n: 2 for planner.')  # 0.6 of 0.8 is no 90 %


@pytest.mark.parametrize(
    ('cost', 'rationality', 'words'),
    [
        (40.0, 0.1, 'costs 10 in the mean. With rationality: 0.1 '),
        (40.0, 0.1, 'is e^1 times less expected. That is as usual.'),
        (40.0, 1.0, 'is e^10 times less expected. rationality: 0.1 would make that e = 2.7 times'),
        (0.0, 1.0, 'rationality plays no part'),
    ],
)
def test_rationality_is_advised_on_from_the_costs_of_the_plan(cost, rationality, words):
    plan = Plan(('(a)', '(b)', '(c)', '(d)'), cost)

    assert words in cost_hint(plan, rationality)


def test_bad_input_is_told_with_its_cure(tmp_path, capsys):
    plan = tmp_path / 'plan.txt'
    plan.write_text('(fly center left)\n')

    assert main(_arguments('--plan', str(plan))) == 2

    error = capsys.readouterr().err
    assert error == (
        f'compare: {plan}, line 1: the domain has no action "fly". Give domain, problem and plan '
        'of one task; this plan seems to be for another.\n'
    )


def test_a_missing_extra_is_named_with_the_way_to_install_it(monkeypatch, capsys):
    from mirror_explainer.commands import extras

    monkeypatch.setattr(extras, 'find_spec', lambda name: None)

    assert main(_arguments()) == 2

    assert 'pip install matplotlib pandas rich scipy tabulate tqdm' in capsys.readouterr().err


def test_help_needs_no_extras(monkeypatch):
    from mirror_explainer.commands import extras

    monkeypatch.setattr(extras, 'find_spec', lambda name: None)

    with pytest.raises(SystemExit) as ended:
        main(['--help'])

    assert ended.value.code == 0
