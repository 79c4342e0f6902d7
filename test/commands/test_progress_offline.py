"""`verbalize` for a robot that is on its way: what is done, what is going on, what is ahead."""

import json
from pathlib import Path

import pytest

from mirror_explainer.commands.verbalize import main
from mirror_explainer.listener.robot_tasks import named_tasks, problem_text

DOMAIN = """
(define (domain kitchen)
  (:requirements :strips :typing :durative-actions)
  (:types spot thing)
  (:predicates (at-spot ?s - spot) (lies ?t - thing ?s - spot) (has ?t - thing))
  (:durative-action drive :parameters (?a ?b - spot) :duration (= ?duration 6)
    :condition (at start (at-spot ?a))
    :effect (and (at start (not (at-spot ?a))) (at end (at-spot ?b))))
  (:durative-action pick :parameters (?t - thing ?s - spot) :duration (= ?duration 2)
    :condition (and (over all (at-spot ?s)) (at start (lies ?t ?s)))
    :effect (and (at start (not (lies ?t ?s))) (at end (has ?t)))))
"""
PLAN = """
0: (drive dock sink) [6]
6: (pick cup sink) [2]
8: (drive sink oven) [6]
14: (pick cake oven) [2]
"""
USER_MODEL = """
goals:
  - {goal: (has cup)}
  - {goal: (has cake)}
  - {goal: (and (has cup) (has cake))}
sentences:
  drive: "I will drive to the {b}."
  pick: "I will take the {t}."
"""
AT_START = '(at-spot dock) (lies cup sink) (lies cake oven)'
ON_THE_WAY = '(has cup) (lies cake oven)'
AT_END = '(has cup) (has cake) (at-spot oven)'


@pytest.fixture
def verbalize(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """Return a function that explains the plan in a state, with further arguments."""

    def run(
        facts: str, *arguments: str, progress: str | None = None, user_model: str = USER_MODEL
    ) -> str:
        problem = (
            '(define (problem p) (:domain kitchen) (:objects dock sink oven - spot '
            f'cup cake - thing) (:init {facts}) (:goal (and (has cup) (has cake))))'
        )
        texts = {'domain': DOMAIN, 'problem': problem, 'plan': PLAN, 'user-model': user_model}
        if progress is not None:
            texts['progress'] = progress
        given = []
        for name, text in texts.items():
            (tmp_path / name).write_text(text)
            given += [f'--{name}', str(tmp_path / name)]
        status = main([*given, *arguments])
        out, err = capsys.readouterr()
        return out if status == 0 else err

    return run


def test_what_is_done_is_told_in_the_past_and_the_rest_in_the_future(verbalize) -> None:
    assert verbalize(ON_THE_WAY).startswith(
        'I have taken the cup.\nI am driving to the oven.\nI will take the cake.\n\n'
    )
    assert verbalize(AT_START).startswith('I will take the cup and the cake.\n\n')


def test_the_state_of_each_step_is_reported(verbalize) -> None:
    report = json.loads(verbalize(ON_THE_WAY, '--json'))

    assert [row['status'] for row in report['plan']] == ['done', 'done', 'running', 'ahead']
    assert [row['sentence'] for row in report['plan']] == [
        'I have driven to the sink.',
        'I have taken the cup.',
        'I am driving to the oven.',
        'I will take the cake.',
    ]
    assert (report['episode']['number'], report['episode']['reason']) == (1, 'first')


def test_understanding_is_the_same_wherever_the_robot_is_in_its_plan(verbalize) -> None:
    reports = [json.loads(verbalize(facts, '--json')) for facts in (AT_START, ON_THE_WAY, AT_END)]

    assert len({round(report['understanding'], 9) for report in reports}) == 1
    assert len({tuple(report['positions']) for report in reports}) == 1


def test_a_robot_that_is_done_says_what_it_did(verbalize) -> None:
    assert verbalize(AT_END).startswith('I have taken the cup and the cake.\nI am done.\n')


def test_what_is_left_unsaid_is_told_in_its_tense(verbalize) -> None:
    assert 'Left unsaid: I have taken the cup.' in verbalize(AT_END, '-n', '1')
    assert 'Left unsaid: I am taking the cup.' in verbalize(
        AT_START, '-n', '1', progress='running: (pick cup sink)'
    )


def test_what_is_past_is_not_told_where_it_is_known(verbalize) -> None:
    assert verbalize(ON_THE_WAY, '--no-tell-past').startswith(
        'I am driving to the oven.\nI will take the cake.\n'
    )
    assert verbalize(AT_END, '--no-tell-past').startswith('I am done.\n')


def test_progress_may_be_told_instead_of_being_read_off_the_state(verbalize) -> None:
    told = verbalize(AT_START, progress='done: (drive dock sink)\nrunning: (pick cup sink)\n')

    assert told.startswith('I am taking the cup.\nI will take the cake.\n')


def test_what_is_going_on_is_told_where_none_of_that_was_chosen(verbalize, tmp_path) -> None:
    driving = 'running: (drive dock sink)'
    both = f'{driving}\nrunning: (pick cup sink)'
    heard = tmp_path / 'heard.txt'
    heard.write_text('I will take the cup.\nI will take the cake.')

    assert verbalize(AT_START, progress=driving).startswith(
        'I am driving to the sink.\nI will take the cup and the cake.\n\n'
    )
    assert verbalize(AT_START, progress=both).startswith('I am taking the cup.\nI will take')
    # As many as were asked for, and ends before means.
    assert verbalize(AT_START, '-n', '1', progress=both).startswith(
        'I am taking the cup.\nI will take the cake.\n\n'
    )
    assert verbalize(AT_START, '--said', str(heard), progress=driving).startswith(
        'I am driving to the sink.\nThe rest is only details.\n\n'
    )
    # It sounds the same, and is not said twice.
    alike = USER_MODEL.replace('I will take the {t}.', 'I will take something.')
    assert verbalize(AT_START, progress=both, user_model=alike).startswith(
        'I am taking something.\n\n'
    )
    in_one_tense = USER_MODEL.replace('I will take the {t}.', 'Something is taken.')
    assert verbalize(AT_START, progress=both, user_model=in_one_tense).startswith(
        'Something is taken.\n\n'
    )


def test_a_step_that_failed_is_told_first(verbalize) -> None:
    told = verbalize(AT_START, progress='done: (drive dock sink)\nfailed: (pick cup sink)')

    assert told.startswith('I am stuck: I cannot take the cup.\nI meant to take the cake.\n\n')


def test_a_step_that_was_skipped_for_a_reason_is_told_whatever_tells_more(verbalize) -> None:
    skipped = 'done: (drive dock sink)\nskipped: (pick cup sink) because the sink is hot\n'
    why = 'I did not take the cup.\nThe sink is hot.\n'

    assert verbalize(AT_START, '-n', '1', progress=skipped).startswith(
        f'{why}I will take the cake.\n\n'
    )
    # It is one of those that were asked for.
    assert verbalize(AT_START, '-n', '2', '--strategy', 'increasing', progress=skipped).startswith(
        f'I have driven to the sink.\n{why}\n'
    )
    going_on = f'{skipped}running: (drive sink oven)'
    assert verbalize(AT_START, '--no-tell-past', progress=going_on).startswith(
        f'{why}I am driving to the oven.\nI will take the cake.\n\n'
    )
    over = f'{skipped}done: (drive sink oven)\ndone: (pick cake oven)'
    assert verbalize(AT_START, progress=over).startswith(
        f'{why}I have taken the cake.\nI am done.\n'
    )


def test_progress_that_names_no_step_is_refused(verbalize) -> None:
    told = verbalize(AT_START, progress='done: (fly dock sink)')

    assert 'line 1: (fly dock sink) is no step of the plan' in told


def test_what_is_told_to_be_done_was_done_by_this_plan_also_where_the_state_has_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    tasks = Path(__file__).parents[2] / 'config' / 'tasks'
    steps = ['(do drive_to_the_kitchen)', '(do boil_water)', '(do bring_the_tea)']
    done = ' '.join(step.replace('do', 'done') for step in steps)
    known = {*named_tasks((tasks / 'user_model.yaml').read_text())}
    texts = {
        'problem': problem_text(known, {'drive_to_the_kitchen', 'boil_water'}, f'(and {done})'),
        'plan': '\n'.join(steps),
        'progress': f'done: {steps[0]}\ndone: {steps[1]}',
    }
    given = [
        '--domain',
        str(tasks / 'domain.pddl'),
        '--user-model',
        str(tasks / 'user_model.yaml'),
    ]
    for name, text in texts.items():
        (tmp_path / name).write_text(text)
        given += [f'--{name}', str(tmp_path / name)]

    assert main(given) == 0
    assert capsys.readouterr().out.startswith('I have boiled water.\nI will bring the tea.\n\n')
