"""`verbalize --score`: what sentences that somebody else chose would tell."""

import json
from pathlib import Path

import pytest

from mirror_explainer.commands.verbalize import main

SAID = ['I will exit from the bottom door.', 'I will grab a blue cube.']


@pytest.fixture
def options(warehouse: Path) -> list[str]:
    files = {'domain': 'domain.pddl', 'problem': 'problem.pddl', 'plan': 'plan.txt'}
    files['user-model'] = 'user_model.yaml'
    return [word for n, file in files.items() for word in (f'--{n}', str(warehouse / file))]


def test_sentences_are_scored_alone_and_together(options, capsys):
    assert main([*options, '--json', '--score', *SAID]) == 0

    score = json.loads(capsys.readouterr().out)['score']
    alone = [row['information_gain'] for row in score['sentences']]
    assert [row['sentence'] for row in score['sentences']] == SAID
    assert score['together']['information_gain'] > max(alone) > 0
    assert score['together']['understanding'] > score['sentences'][0]['understanding']


def test_the_robots_own_answer_scores_what_it_tells(options, capsys):
    main([*options, '-n', '2', '--json'])
    answer = json.loads(capsys.readouterr().out)

    main([*options, '--json', '--score', *answer['sentences']])

    together = json.loads(capsys.readouterr().out)['score']['together']
    assert together['information_gain'] == pytest.approx(answer['information_gain'])


def test_scores_are_shown_as_a_table(options, capsys):
    assert main([*options, '--score', *SAID]) == 0

    table = capsys.readouterr().out.split('\n\n')[-1].splitlines()
    assert [line.split('%  ')[-1] for line in table[1:]] == [*SAID, 'all of these']


def test_a_sentence_that_no_step_is_said_as_is_told(options, capsys):
    assert main([*options, '--score', 'I will fly.']) == 2

    assert '--score: no step of the plan is said as "I will fly."' in capsys.readouterr().err

    assert main([*options, '--score', SAID[1].rstrip('.')]) == 2

    assert f'(did you mean "{SAID[1]}"?)' in capsys.readouterr().err
