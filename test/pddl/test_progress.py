"""Progress that a robot tells of itself."""

import pytest

from mirror_explainer.errors import InputError
from mirror_explainer.pddl.progress import Progress, StepStatus
from mirror_explainer.pddl.progress_text import read_progress

PLAN = ('(go dock lab)', '(take cup)', '(go lab dock)', '(go dock lab)', '(put cup)')
DONE, RUNNING, AHEAD = StepStatus.DONE, StepStatus.RUNNING, StepStatus.AHEAD


def test_a_progress_text_says_of_each_step_what_has_become_of_it() -> None:
    text = '; now\ndone: (go dock LAB)\n\nRunning:( take  cup ) ; soon\r\n'

    assert read_progress(text).of(PLAN) == Progress((DONE, RUNNING, AHEAD, AHEAD, AHEAD))


def test_an_empty_progress_text_says_that_nothing_has_begun() -> None:
    assert read_progress('').of(PLAN) == Progress.none(5)


def test_a_step_that_failed_is_still_ahead() -> None:
    text = 'done: (go dock lab)\nfailed: (take cup)'

    assert read_progress(text).of(PLAN) == Progress(
        (DONE, AHEAD, AHEAD, AHEAD, AHEAD), failed=(1,)
    )


def test_why_a_step_failed_or_was_skipped_is_kept() -> None:
    text = (
        'skipped: (drop cup) because it sticks\n'
        'failed: (take cup)  BECAUSE the cup (2) is\thot ; x'
    )

    progress = read_progress(text).of(['(take cup)', '(drop cup)'])

    assert progress.failed == (0,)
    assert progress.reasons == {0: 'the cup (2) is hot', 1: 'it sticks'}
    assert read_progress('failed: (take cup)').of(PLAN).reasons == {}
    with pytest.raises(InputError, match='this is no progress'):
        read_progress('done: (take cup) because it was there').of(PLAN)


def test_what_is_left_out_is_not_waited_for() -> None:
    progress = read_progress('skipped: (take cup)\ndone: (drop cup)').of(
        ['(take cup)', '(drop cup)']
    )

    assert progress == Progress((StepStatus.SKIPPED, DONE))
    assert progress.finished
    assert not read_progress('skipped: (take cup)').of(PLAN).finished


@pytest.mark.parametrize(
    'text',
    ['done: (go dock lab)\nrunning: (go dock lab)', 'running: (go dock lab)\ndone: (go dock lab)'],
)
def test_the_same_step_twice_counts_from_the_first(text: str) -> None:
    assert read_progress('done: (go dock lab)').of(PLAN).positions(DONE) == (0,)

    assert read_progress(text).of(PLAN) == Progress((DONE, AHEAD, AHEAD, RUNNING, AHEAD))


def test_steps_that_were_skipped_or_done_out_of_order_are_what_the_robot_says() -> None:
    text = 'done: (put cup)\ndone: (take cup)'

    assert read_progress(text).of(PLAN) == Progress((AHEAD, DONE, AHEAD, AHEAD, DONE))


FAULTS = {
    '(go dock lab)': 'line 1: this is no progress: "(go dock lab)"',
    'done: (take cup)\nended: (take cup)': 'line 2: this is no progress: "ended: (take cup)"',
    'done: (take cup) (put cup)': 'line 1: this is no progress: "done: (take cup) (put cup)"',
    'done: ()': 'line 1: this is no progress: "done: ()"',
    '\ndone: (tkae cup)': 'line 2: (tkae cup) is no step of the plan (did you mean "(take cup)"?)',
    'done: (take cup)\nrunning: (take cup)': 'line 2: (take cup) is in the plan once, and is '
    'named here once more',
    'done: (go dock lab)\n' * 3: 'line 3: (go dock lab) is in the plan 2 times, and is named '
    'here once more',
}


@pytest.mark.parametrize('text', FAULTS)
def test_what_is_no_progress_is_told_with_its_line(text: str) -> None:
    with pytest.raises(InputError) as refused:
        read_progress(text, '/robot/progress').of(PLAN)

    assert str(refused.value) == f'/robot/progress, {FAULTS[text]}'
