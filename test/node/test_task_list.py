"""Robots without PDDL: lists of tasks, behaviour trees, and what the explainer says of them."""

import pytest
from patience import eventually

from mirror_explainer.errors import InputError
from mirror_explainer.node.task_list import (
    TaskList,
    parsed_tasks,
    problem_text,
    task_name,
    task_texts,
)
from mirror_explainer.pddl import read_task

TEA = ['Drive to the kitchen', 'Boil water', 'Bring the tea']


def test_a_list_of_tasks_is_a_plan_whose_goal_is_that_all_are_done():
    texts = task_texts([('Boil water', 'done'), ('Bring the tea', 'running')])
    assert texts.plan == '(do boil_water)\n(do bring_the_tea)'
    assert texts.progress == 'done: (do boil_water)\nrunning: (do bring_the_tea)'
    assert texts.goal == '(and (done boil_water) (done bring_the_tea))'
    assert texts.done == {'boil_water'}


def test_with_ends_only_these_are_the_goal():
    texts = task_texts([('Boil water', 'ahead'), ('Bring the tea', 'ahead')], ['Bring the tea'])
    assert texts.goal == '(and (done bring_the_tea))'


def test_a_task_that_comes_twice_is_twice_in_the_plan_and_once_in_the_goal():
    texts = task_texts([('Wait', 'done'), ('Knock', 'done'), ('Wait', 'running')])
    assert texts.plan == '(do wait)\n(do knock)\n(do wait)'
    assert texts.goal == '(and (done wait) (done knock))'


@pytest.mark.parametrize(
    ('task', 'name'),
    [
        ('Fetch the cup', 'fetch_the_cup'),
        ('  pick-up: box #3 ', 'pick_up_box_3'),
        ('3rd round', 'task_3rd_round'),
    ],
)
def test_a_name_is_what_pddl_takes(task, name, warehouse):
    assert task_name(task) == name
    domain = (warehouse.parent / 'tasks' / 'domain.pddl').read_text()
    read_task(domain, problem_text({name}, {name}, f'(and (done {name}))'))


def test_a_task_without_a_name_and_a_standing_that_there_is_not_are_refused():
    with pytest.raises(InputError, match='a task needs a name, which "!" is not'):
        task_texts([('!', 'done')])
    with pytest.raises(InputError, match='not "runing" .did you mean "running"'):
        task_texts([('Boil water', 'runing')])


def test_a_text_names_a_task_a_line():
    assert parsed_tasks('done: Boil water\n\n Running : Bring the tea\nroom 3: clean\n') == [
        ('Boil water', 'done'),
        ('Bring the tea', 'running'),
        ('room 3: clean', 'ahead'),
    ]


@pytest.fixture
def asked(peer, tmp_path, warehouse):
    """A peer whose explainer has the user model of the example robot with tasks."""
    from ros_peer import explainer

    model = warehouse.parent / 'tasks' / 'user_model.yaml'
    with explainer(peer, tmp_path, user_model_file=str(model), n=1):
        yield peer


def test_a_behaviour_tree_tells_its_leaves_after_each_tick(asked):
    py_trees = pytest.importorskip('py_trees', reason='needs py-trees')
    standing = {
        py_trees.common.Status.INVALID: 'ahead',
        py_trees.common.Status.RUNNING: 'running',
        py_trees.common.Status.SUCCESS: 'done',
        py_trees.common.Status.FAILURE: 'failed',
    }
    known = ['Collect the cups', 'Wipe the table', 'Fill the can', 'Water the plants']
    tasks = TaskList(asked.node, known)

    def tell(tree: py_trees.trees.BehaviourTree) -> None:
        leaves = [node for node in tree.root.iterate() if not node.children]
        tasks.tell((leaf.name, standing[leaf.status]) for leaf in leaves)

    serve_tea = py_trees.composites.Sequence('Serve tea', memory=True)
    for name in TEA:
        success = py_trees.common.Status.SUCCESS
        serve_tea.add_child(py_trees.behaviours.TickCounter(name, 1, success))
    tree = py_trees.trees.BehaviourTree(serve_tea)
    tree.add_post_tick_handler(tell)
    progress = asked.hear('progress')

    tree.tick()

    assert asked.answer() == 'I will bring the tea.'
    eventually(lambda: progress == ['running: (do drive_to_the_kitchen)'], 'the first progress')
    tree.tick()
    eventually(
        lambda: progress[-1] == 'done: (do drive_to_the_kitchen)\nrunning: (do boil_water)',
        'the progress after a task is done',
    )


def test_a_robot_that_sends_its_tasks_as_a_text_is_explained(asked, tmp_path):
    from ros_peer import running

    known = '[collect the cups, wipe the table, fill the can, water the plants]'
    namespace = asked.node.get_namespace()
    with running('task_list_robot', namespace, tmp_path, known_tasks=known) as process:
        asked.publish('tasks', 'drive to the kitchen\nboil water\nbring the tea')
        assert asked.answer() == 'I will bring the tea.'
        asked.publish('tasks', 'done: !')
        eventually(lambda: 'a task needs a name' in process.log, 'what is wrong in the log')
