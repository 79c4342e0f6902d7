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
@pytest.mark.parametrize('listener', ['open', 'planner'])
def test_the_informative_choice_is_never_below_the_baselines(
    domain: str, listener: str, tmp_path: Path
) -> None:
    instance = min((Path(FOLDER) / domain).iterdir())
    real = (instance / 'real_hyp.dat').read_text().strip()
    template = (instance / 'template.pddl').read_text()
    problem, user_model = tmp_path / 'problem.pddl', tmp_path / 'user.yaml'
    answer = tmp_path / 'answer.json'
    problem.write_text(template.replace('<HYPOTHESIS>', real.replace(',', ' ')))
    user_model.write_text(f'hyps_file: {instance}/hyps.dat\n')
    candidates = [line for line in (instance / 'hyps.dat').read_text().splitlines() if line]

    status = main(
        ['--domain', f'{instance}/domain.pddl', '--problem', str(problem), '--listener', listener]
        + ['--user-model', str(user_model), '--json', '--curve', '--output', str(answer)]
        + ['--selection-budget', '1']
    )

    told = json.loads(answer.read_text())
    assert status == 0
    assert told['complete'] is True
    fillers = told['listener']['min_gain'] or 0.0
    assert len(told['goals']) == len(candidates) + 1  # a last row for parts of them
    robot = next(h for h in told['hypotheses'] if h['robot'])
    assert robot['goal'] == real
    assert told['understanding_before'] <= 1 / len(candidates) + 1e-9
    assert told['understanding'] > told['understanding_before']
    assert len(told['curve']) == len({row['sentence'] for row in told['plan']})
    for row in told['curve'][:4]:  # found in time, whether proved to be the best or not
        best = row['informative']
        for baseline in (row['increasing'], row['decreasing']):
            least = baseline['information_gain'] - fillers
            assert best['information_gain'] >= least - 1e-9
