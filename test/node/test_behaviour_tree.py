"""What a tree of py_trees means to do, and what the robot says of it."""

from collections.abc import Sequence as Listed
from pathlib import Path
from typing import Any

import pytest
from task_robot import robot_of
from test_live_explainer import operator

from mirror_explainer.errors import InputError
from mirror_explainer.node.behaviour_tree import failure_reason, tree_tasks

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
    signs = {'done': '+', 'running': '>', 'ahead': '', 'failed': '!', 'skipped': '-'}
    return ' '.join(signs[task[1]] + task[0] for task in tree_tasks(root, Task))


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
    assert told(root, 2) == '-wave >dock charge'
    assert told(root, 1) == '-wave >dock charge'  # it failed once
    assert told(root, 2) == '-wave !dock charge'


def any_of(*children: Any) -> Any:
    return py_trees.composites.Parallel(
        'any', py_trees.common.ParallelPolicy.SuccessOnOne(), [*children]
    )


class Slow(Task):
    """Something that takes long."""

    ticks = 9


@pytest.mark.parametrize(
    ('optional', 'after'),
    [
        (Selector('s', True, [Task('wave', Status.FAILURE), Condition('or not')]), '-wave'),
        (Selector('s', True, [Task('wave', Status.FAILURE), Leaf('wait')]), '-wave'),
        (Selector('s', True, [Condition('waved?'), Task('wave')]), '-wave'),
        (py_trees.decorators.Inverter('i', Task('wave', Status.FAILURE)), '-wave'),
        (
            py_trees.decorators.FailureIsSuccess(
                'o', Sequence('s', True, [Condition('seen?', Status.FAILURE), Task('wave')])
            ),
            '-wave',
        ),
        (any_of(Slow('wave'), Task('nod')), '-wave +nod'),
    ],
)
def test_what_the_tree_does_without_is_skipped(optional: Any, after: str) -> None:
    root = Sequence('work', memory=True, children=[optional, Task('dock')])

    before = told(root)
    assert before == after.replace('-', '').replace('+', '') + ' dock'
    assert told(root, 3).startswith(after)


def test_a_tree_at_a_branch_without_tasks_has_nothing_to_do() -> None:
    job = Sequence('job', True, [Condition('order?', Status.FAILURE), Task('drive')])
    assert told(Selector('root', False, [job, Leaf('idle')]), 1) == ''


class Excused(Condition):
    """A condition that says why it fails."""

    def update(self) -> Any:
        self.feedback_message = 'The blade is not sharp.'
        return super().update()


class Shaver(Task):
    """A task that does so."""

    def terminate(self, new_status: Any) -> None:
        self.feedback_message = 'the ice is too thin' if new_status == Status.FAILURE else ''


def because(*children: Any) -> tuple[str, str]:
    """Return what a sequence tells when it has failed, and why it did."""
    root = Sequence('work', True, [*children])
    tasks = told(root, 1)
    while root.status == Status.RUNNING:
        tasks = told(root, 1)
    return tasks, failure_reason(root, Task)


def test_why_a_tree_failed_is_what_the_node_says_or_the_name_of_a_condition() -> None:
    fails = Status.FAILURE

    def after_driving(*children: Any) -> tuple[str, str]:
        return because(Task('drive'), *children)

    assert after_driving(Condition('blade is sharp', fails), Task('shave')) == (
        '+drive !shave',
        'This check failed: blade is sharp',
    )
    assert after_driving(Excused('sharp?', fails), Task('shave'))[1] == 'The blade is not sharp.'
    assert after_driving(py_trees.behaviours.Failure('boards up'), Task('shave'))[1] == (
        'This check failed: boards up'
    )
    inverter = py_trees.decorators.Inverter
    dull = inverter('blade is not dull', Excused('dull?'))
    assert after_driving(dull, Task('shave'))[1] == 'The blade is not sharp.'
    dull = inverter('blade is not dull', Condition('dull?'))
    assert after_driving(dull, Task('shave'))[1] == 'This check failed: blade is not dull'
    assert after_driving(Shaver('shave', fails)) == ('+drive !shave', 'the ice is too thin')
    assert after_driving(Task('shave', fails)) == ('+drive !shave', '')
    assert after_driving() == ('+drive', '')
    # Nothing had begun: only a condition that says so is a fault.
    assert because(Condition('order?', fails), Task('shave'))[0] == ''
    assert because(Excused('sharp?', fails), Task('shave'))[0] == '!shave'


def test_what_may_fail_is_left_out_for_the_reason_that_it_says() -> None:
    optional = py_trees.decorators.FailureIsSuccess('o', Shaver('shave', Status.FAILURE))
    dry = Condition('dry?', Status.FAILURE)
    root = Sequence('work', True, [optional, Task('flood'), dry, Task('park')])
    left_out = ('shave', 'skipped', 'the ice is too thin')

    told(root, 2)
    assert tree_tasks(root, Task) == [left_out, ('flood', 'running'), ('park', 'ahead')]
    root.tick_once()
    assert tree_tasks(root, Task) == [left_out, ('flood', 'done'), ('park', 'failed')]


def test_a_guard_that_says_why_stops_the_task_that_the_tree_was_at() -> None:
    guard = Excused('sharp?')
    work = Sequence('work', True, [Task('drive'), Task('shave'), Task('flood')])
    root = Sequence('guarded', False, [guard, work])

    told(root, 2)
    before = tree_tasks(root, Task)
    guard.end = Status.FAILURE
    root.tick_once()
    stuck = tree_tasks(root, Task, before)

    assert before == [('drive', 'done'), ('shave', 'running'), ('flood', 'ahead')]
    assert stuck == [('drive', 'done'), ('shave', 'failed'), ('flood', 'ahead')]
    assert tree_tasks(root, Task, stuck) == stuck
    both = [('drive', 'running'), ('shave', 'done'), ('flood', 'running')]
    assert tree_tasks(root, Task, both)[-1] == ('flood', 'ahead')
    # In the next round it is at the first.
    first = [('drive', 'failed'), ('shave', 'ahead'), ('flood', 'ahead')]
    assert tree_tasks(root, Task, [(name, 'done') for name, _ in before]) == first


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

    assert after(1) == 'I am opening hive 3.\nI will treat hive 3 and feed the bees.'
    assert after(1) == 'I have changed my plan.\nI am writing the card.\nI will feed the bees.'
    assert after(2) == 'I am done.'
    mites.end = Status.SUCCESS  # the next round
    feed.end = Status.FAILURE
    assert after(1) == (
        'I have a new task.\nI am opening hive 3.\nI will treat hive 3 and feed the bees.'
    )
    # What is left of the goal is another, but what was done for it counts.
    assert after(3).startswith('I have changed my plan.\n')
    assert 'I am calling the beekeeper.' in robot.published[-1][0]
    with pytest.raises(InputError, match='"Feed bees" is none of the tasks .*"Feed the bees"'):
        robot.tasks.tell_tree(root, Task, ['Feed bees'])


RINK = """
goals:
  - name: prepare the ice
    goal: (and (done drive_onto_the_ice) (done greet_the_skaters) (done shave_the_ice)
               (done flood_the_ice))
    probability: 3
  - {name: sweep, goal: (and (done drive_to_the_stands) (done sweep_the_stands)), probability: 3}
  - {name: charge, goal: (and (done drive_to_the_dock) (done charge_my_battery)), probability: 1}
"""
BEGUN = ['drives onto the ice', 'greets the skaters']
ROUND = [*BEGUN, 'shaves the ice', 'floods the ice', 'is through']
# What happens, tick by tick; before "|" what is done to the tree before that.
STORIES = {
    'A round': [*ROUND, 'begins the next one'],
    'A condition that fails': ['dull|drives onto the ice', BEGUN[1], 'fails', 'begins anew'],
    'A step that may fail': ['shy|drives onto the ice', *ROUND[1:]],
    'Given up': [*BEGUN, 'stop|is stopped', 'drives onto the ice'],
    'Begun anew': [*ROUND[:3], 'reset|is reset and drives onto the ice', *BEGUN[1:]],
    'Something more urgent': [
        *ROUND[:3],
        'low|drives to the dock',
        'charges its battery',
        'is through with that',
        'charged|drives onto the ice',
        *ROUND[1:],
    ],
}


class Rink:
    """The tree of a robot that prepares the ice of a rink, and drives to its dock if need be."""

    def __init__(self) -> None:
        self.low = Condition('battery is low', Status.FAILURE)
        self.sharp = Excused('blade is sharp')
        self.greet = Task('greet the skaters')
        optional = py_trees.decorators.FailureIsSuccess('optional', self.greet)
        dock = [self.low, Task('drive to the dock'), Task('charge my battery')]
        ice = [Task('drive onto the ice'), optional, self.sharp]
        ice += [Task('shave the ice'), Task('flood the ice')]
        self.root = Selector(
            'rink', False, [Sequence('dock', True, dock), Sequence('ice', True, ice)]
        )

    def change(self, change: str) -> bool:
        """Let something happen; return whether the tree goes on."""
        ends = {'low': self.low, 'charged': self.low, 'dull': self.sharp, 'shy': self.greet}
        if change in ends:
            ends[change].end = Status.SUCCESS if change == 'low' else Status.FAILURE
        if change in ('stop', 'reset'):
            self.root.stop(Status.INVALID)
        return change != 'stop'


def story(robot: Any, moments: Listed[str]) -> str:
    """Return, as a table, what a robot answers at each moment."""
    rink, lines = Rink(), ['| the robot | answers |', '|---|---|']
    tree = py_trees.trees.BehaviourTree(rink.root)
    tree.add_post_tick_handler(lambda tree: robot.tasks.tell_tree(tree.root, Task))
    for moment in moments:
        change, _, happens = moment.rpartition('|')
        if rink.change(change):
            tree.tick()
        else:
            robot.tasks.tell_tree(tree.root, Task)
        lines.append(f'| {happens} | {" ".join(robot.explainer.ask().message.splitlines())} |')
    return '\n'.join(lines)


@pytest.mark.parametrize('title', STORIES)
def test_a_robot_tells_what_goes_wrong_as_the_page_says(
    operator: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, title: str
) -> None:
    monkeypatch.setattr('mirror_explainer.node.updates.SETTLING_SECONDS', 0.0)
    page = (Path(__file__).parents[2] / 'docs' / 'behaviour_trees.md').read_text()
    model = tmp_path / 'rink.yaml'
    model.write_text(RINK)

    told = story(robot_of(operator, str(model)), STORIES[title])
    assert f'**{title}**\n\n{told}\n' in page, f'docs/behaviour_trees.md lacks:\n{told}'
