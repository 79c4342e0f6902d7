"""What a tree of py_trees means to do, and what the robot says of it."""

from pathlib import Path
from typing import Any

import pytest
from task_robot import robot_of
from test_live_explainer import operator

from mirror_explainer.errors import InputError
from mirror_explainer.node.behaviour_tree import tree_tasks

py_trees: Any = pytest.importorskip('py_trees', reason='needs py-trees')
Status, Behaviour = py_trees.common.Status, py_trees.behaviour.Behaviour
Sequence, Selector = py_trees.composites.Sequence, py_trees.composites.Selector
__all__ = ['operator']  # the fixture


class Leaf(Behaviour):  # type: ignore[misc]
    """Takes one tick, and then ends as it is told; a condition ends at once."""

    ticks = 1

    def __init__(self, name: str, end: Any = Status.SUCCESS) -> None:
        super().__init__(name)
        self.end = end

    def initialise(self) -> None:
        self.left = self.ticks

    def update(self) -> Any:
        self.left -= 1
        return Status.RUNNING if self.left >= 0 else self.end


class Task(Leaf):
    """Something that the robot does."""


class Condition(Leaf):
    """Something that the robot looks at."""

    ticks = 0


def told(root: Any, ticks: int = 0) -> str:
    """Return the tasks that a tree tells after so many ticks, such as "+a >b c !d"."""
    for _ in range(ticks):
        root.tick_once()
    signs = {'done': '+', 'running': '>', 'ahead': '', 'failed': '!'}
    return ' '.join(signs[standing] + name for name, standing in tree_tasks(root, Task))


@pytest.mark.parametrize('memory', [True, False])
def test_a_selector_means_its_first_branch_and_then_the_one_that_it_is_at(memory: bool) -> None:
    treat = Sequence('treat', memory=True, children=[Condition('ill?'), Task('treat')])
    deal = Selector('deal', memory=memory, children=[treat, Task('note')])
    root = Sequence('round', memory=True, children=[Task('drive'), deal, Task('return')])
    ill = treat.children[0]

    assert told(root) == 'drive treat return'
    assert told(root, 1) == '>drive treat return'
    assert told(root, 1) == '+drive >treat return'
    assert told(root, 1) == '+drive +treat >return'
    assert told(root, 1) == '+drive +treat +return'
    ill.end = Status.FAILURE
    assert told(root, 1) == '>drive treat return'
    assert told(root, 1) == '+drive >note return'
    assert told(root, 2) == '+drive +note +return'


def test_a_task_that_failed_is_told_only_where_nothing_takes_its_place() -> None:
    feed = Task('feed', Status.FAILURE)
    call = Task('call')
    root = Sequence(
        'round', memory=True, children=[Selector('s', True, [feed, call]), Task('return')]
    )

    assert told(root, 1) == '>feed return'
    assert told(root, 1) == '>call return'
    call.end = Status.FAILURE
    assert told(root, 1) == '!call return'


def test_a_tree_whose_condition_ends_all_of_its_tasks_has_nothing_to_do() -> None:
    safe = Condition('safe?')
    root = Sequence('work', memory=False, children=[safe, Task('drive'), Task('clean')])

    assert told(root, 1) == '>drive clean'
    safe.end = Status.FAILURE
    assert told(root, 1) == ''


def test_a_condition_that_fails_on_the_way_keeps_the_robot_from_its_next_task() -> None:
    dry = Condition('dry?', Status.FAILURE)
    root = Sequence(
        'work', memory=True, children=[Task('drive'), dry, Task('open'), Task('close')]
    )

    assert told(root, 2) == '+drive !open close'


def test_of_a_parallel_all_branches_are_meant() -> None:
    both = [Task('look'), Sequence('drive', True, [Task('start'), Task('stop')])]
    root = py_trees.composites.Parallel(
        'both', py_trees.common.ParallelPolicy.SuccessOnAll(), both
    )

    assert told(root, 1) == '>look >start stop'
    assert told(root, 1) == '+look +start >stop'


def test_what_is_tried_again_goes_on_and_what_may_fail_is_left_out() -> None:
    decorators = py_trees.decorators
    again = decorators.Retry('again', Task('dock', Status.FAILURE), 2)
    optional = decorators.FailureIsSuccess('optional', Task('wave', Status.FAILURE))
    root = Sequence('work', memory=True, children=[optional, again, Task('charge')])

    assert told(root) == 'wave dock charge'
    assert told(root, 2) == '>dock charge'
    assert told(root, 1) == '>dock charge'  # it failed once
    assert told(root, 2) == '!dock charge'


def test_what_is_of_the_class_is_one_task_whatever_is_below_it() -> None:
    class Chore(Sequence):  # type: ignore[misc]
        pass

    root = Sequence('day', True, [Chore('tea', True, [Task('boil'), Task('serve')]), Task('rest')])

    assert tree_tasks(root, (Chore, Task)) == [('tea', 'ahead'), ('rest', 'ahead')]


APIARY = """
goals:
  - {name: treat, goal: (and (done treat_hive_3) (done feed_the_bees)), probability: 3}
  - {name: healthy, goal: (and (done write_the_card) (done feed_the_bees)), probability: 3}
  - {name: call, goal: (and (done treat_hive_3) (done call_the_beekeeper)), probability: 1}
  - {name: harvest, goal: (and (done take_the_frames) (done put_on_a_super)), probability: 2}
sentences: {do: "I will {task}."}
"""
ENDS = ['Treat hive 3', 'Feed the bees', 'Write the card', 'Call the beekeeper']


def test_a_robot_with_a_fallback_tells_the_truth_in_each_round(
    operator: Any, tmp_path: Path
) -> None:
    model = tmp_path / 'apiary.yaml'
    model.write_text(APIARY)
    robot = robot_of(operator, str(model), n=2, remember=True)
    mites = Condition('Mites?', Status.FAILURE)
    treat, feed = Sequence('treat', True, [mites, Task('Treat hive 3')]), Task('Feed the bees')
    root = Sequence(
        'round',
        True,
        [
            Task('Open hive 3'),
            Selector('deal', True, [treat, Task('Write the card')]),
            Selector('feed', True, [feed, Task('Call the beekeeper')]),
        ],
    )

    def after(ticks: int) -> str:
        for _ in range(ticks):
            root.tick_once()
        robot.tasks.tell_tree(root, Task, ENDS)
        answer: str = robot.answer()
        return answer

    assert after(1) == 'I will treat hive 3 and feed the bees.'
    assert after(1) == 'I have changed my plan.\nI am writing the card.\nI will feed the bees.'
    assert after(2) == 'I am done.'
    mites.end = Status.SUCCESS  # the next round
    feed.end = Status.FAILURE
    assert after(1) == 'I have a new task.\nI will treat hive 3 and feed the bees.'
    # What is left of the goal is another, but what was done for it counts.
    assert after(3).startswith('I have changed my plan.\n')
    assert 'I am calling the beekeeper.' in robot.published[-1][0]
    with pytest.raises(InputError, match='"Feed bees" is none of the tasks .*"Feed the bees"'):
        robot.tasks.tell_tree(root, Task, ['Feed bees'])
