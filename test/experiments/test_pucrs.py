"""Goal-recognition problems of the paper's six domains, where the data set is at hand.

MIRROR_EXPLAINER_PUCRS names a folder with DOMAIN/INSTANCE/{domain.pddl, template.pddl,
hyps.dat, real_hyp.dat}, as in Pereira and Meneguzzi's data set (doi 10.5281/zenodo.825877).
"""

import json
import os
from pathlib import Path

import pytest

from mirror_explainer.commands.verbalize import main

DOMAINS = ('blocks-world', 'intrusion-detection', 'logistics', 'miconic', 'rovers', 'satellite')
FOLDER = os.environ.get('MIRROR_EXPLAINER_PUCRS', '')


@pytest.mark.skipif(not FOLDER, reason='MIRROR_EXPLAINER_PUCRS does not name the data set')
@pytest.mark.parametrize('domain', DOMAINS)
def test_the_informative_choice_is_never_below_the_baselines(domain: str, tmp_path: Path) -> None:
    instance = min((Path(FOLDER) / domain).iterdir())
    real = (instance / 'real_hyp.dat').read_text().strip()
    template = (instance / 'template.pddl').read_text()
    problem, user_model = tmp_path / 'problem.pddl', tmp_path / 'user.yaml'
    answer = tmp_path / 'answer.json'
    problem.write_text(template.replace('<HYPOTHESIS>', real.replace(',', ' ')))
    user_model.write_text(f'hyps_file: {instance}/hyps.dat\n')
    candidates = [line for line in (instance / 'hyps.dat').read_text().splitlines() if line]

    few = ['--plans-per-belief', '1'] if domain == 'miconic' else []  # hundreds take seconds
    status = main(
        ['--domain', f'{instance}/domain.pddl', '--problem', str(problem), *few]
        + ['--user-model', str(user_model), '--json', '--curve', '--output', str(answer)]
        + ['--selection-budget', '60']  # s, far more than it takes
    )

    told = json.loads(answer.read_text())
    assert status == 0
    assert told['optimal'] is told['complete'] is True
    assert len(told['goals']) == len(candidates)  # the true one among them
    robot = next(h for h in told['hypotheses'] if h['robot'])
    assert robot['goal'] == real
    assert told['understanding_before'] == pytest.approx(1 / len(candidates))
    assert told['understanding'] > told['understanding_before']
    assert len(told['curve']) == len(told['plan'])
    for row in told['curve'][:5]:
        best = row['informative']
        assert best['gap'] == 0.0
        for baseline in (row['increasing'], row['decreasing']):
            assert best['information_gain'] >= baseline['information_gain'] - 1e-9
