"""Robots without PDDL: lists of tasks, behaviour trees, and what the explainer says of them."""

import json
import re
import subprocess
import sys
from collections.abc import Iterable, Sequence
from types import SimpleNamespace

import pytest
from patience import eventually
from task_robot import robot_of
from test_live_explainer import operator

from mirror_explainer.errors import InputError
from mirror_explainer.listener.robot_tasks import DOMAIN, named_tasks, problem_text, task_name
from mirror_explainer.node.robot_topics import RobotTopics
from mirror_explainer.node.surroundings import Others
from mirror_explainer.node.task_list import TaskList
from mirror_explainer.node.task_texts import TaskTexts, checked_task, parsed_tasks, task_texts
from mirror_explainer.pddl import read_task

__all__ = ['operator']  # the fixture
TEA = ['Drive to the kitchen', 'Boil water', 'Bring the tea']
TEA_AHEAD = ('Bring the tea', 'ahead')


def texts_of(tasks: Iterable[object], ends: Sequence[str] = ()) -> TaskTexts:
    """Return the texts of tasks that `TaskList.tell` is given."""
    return task_texts([checked_task(task) for task in tasks], ends)


def test_a_list_of_tasks_is_a_plan_whose_goal_is_that_all_are_done():
    texts = texts_of([('Boil water', 'done'), ('Bring the tea', 'running')])
    assert texts.plan == '(do boil_water)\n(do bring_the_tea)'
    assert texts.progress == 'done: (do boil_water)\nrunning: (do bring_the_tea)'
    assert texts.goal == '(and (done boil_water) (done bring_the_tea))'
    assert texts.done == {'boil_water'}
    assert texts.names == {'boil_water': 'Boil_water', 'bring_the_tea': 'Bring_the_tea'}


def test_with_ends_only_these_are_the_goal():
    texts = texts_of([('Boil water', 'ahead'), ('Bring the tea', 'ahead')], ['Bring the tea'])
    assert texts.goal == '(and (done bring_the_tea))'


def test_an_end_that_is_none_of_the_tasks_is_refused():
    tasks = [('Boil water', 'ahead'), ('Bring the tea', 'ahead')]
    with pytest.raises(InputError, match='"Bring tea" is none of the tasks .*"Bring the tea"'):
        texts_of(tasks, ['Bring tea'])


def test_a_task_that_comes_twice_is_twice_in_the_plan_and_once_in_the_goal():
    texts = texts_of([('Wait', 'done'), ('Knock', 'done'), ('Wait', 'running')])
    assert texts.plan == '(do wait)\n(do knock)\n(do wait)'
    assert texts.goal == '(and (done wait) (done knock))'


@pytest.mark.parametrize(
    ('task', 'name'),
    [
        ('Fetch the cup', 'Fetch_the_cup'),
        ('  pick-up: box #3 ', 'pick_up_box_3'),
        ('MoveToPose', 'MoveToPose'),
        ('Öffne Beute 3', 'Öffne_Beute_3'),
        ('hive/Open #3 (left)!', 'hive_Open_3_left'),
        ('3rd round', 'task_3rd_round'),
    ],
)
def test_a_name_is_what_pddl_takes(task, name):
    assert task_name(task) == name
    read_task(DOMAIN, problem_text({name}, {name}, f'(and (done {name}))'))


def test_the_domain_in_the_files_is_the_one_that_is_published(warehouse):
    assert (warehouse.parent / 'tasks' / 'domain.pddl').read_text() == DOMAIN


def test_a_task_without_a_name_and_a_standing_that_there_is_not_are_refused():
    with pytest.raises(InputError, match='a task needs a name, which "!" is not'):
        texts_of([('!', 'done')])
    with pytest.raises(InputError, match='not "runing" .did you mean "running"'):
        texts_of([('Boil water', 'runing')])


@pytest.mark.parametrize('tasks', [['Boil water'], {'Boil water': 'done'}, [('Boil water', None)]])
def test_a_task_without_its_standing_is_refused(tasks):
    with pytest.raises(InputError, match=r"each task goes with its standing, \('boil water'"):
        texts_of(tasks)


def test_a_text_names_a_task_a_line():
    text = 'done: Boil water\n\n Running : Bring the tea\nroom 3: clean\n'
    stuck = text + 'failed: Knock because it is late; 9 pm'
    tasks = [('Boil water', 'done'), ('Bring the tea', 'running'), ('room 3: clean', 'ahead')]
    assert parsed_tasks(text) == tasks
    assert parsed_tasks(stuck) == [*tasks, ('Knock', 'failed', 'it is late; 9 pm')]
    away = [('Wait', 'skipped', 'no one came')]
    assert parsed_tasks('skipped: Wait because no one came') == away
    assert parsed_tasks('Skipped: Wait because: no one came') == away


def test_a_text_with_another_word_for_how_a_task_stands_is_refused():
    with pytest.raises(InputError, match='line 2: "runing" is no standing .* "running"') as error:
        parsed_tasks('Boil water\nRuning: bring the tea')
    assert 'ahead, running, done, skipped, failed' in error.value.cure
    with pytest.raises(InputError, match='line 2: .*did you mean "Running: bring tea"') as error:
        parsed_tasks('run home\nRunning bring tea')
    assert error.value.cure.endswith('"ahead: Running bring tea".')


def test_what_failed_or_was_skipped_has_its_reason_on_one_line_without_a_comment():
    tasks = [('Boil water', 'done'), ('Bring the tea', 'failed', 'It is late;\n9 pm.')]
    texts = texts_of(tasks)
    failed = 'failed: (do bring_the_tea) because It is late, 9 pm.'
    assert texts.progress == f'done: (do boil_water)\n{failed}'
    tasks = [('Knock', 'skipped', 'No one\ncame.'), ('Bring the tea', 'failed', ' ')]
    assert texts_of(tasks).progress == (
        'skipped: (do knock) because No one came.\nfailed: (do bring_the_tea)'
    )
    with pytest.raises(InputError, match='"Boil water" is done: it needs no reason'):
        texts_of([('Boil water', 'done', 'It is late.')])


def test_a_user_model_names_tasks(warehouse):
    names = named_tasks((warehouse.parent / 'tasks' / 'user_model.yaml').read_text())
    assert 'water_the_plants' in names
    assert named_tasks('goal: (and ( done boil_water )\n (DONE Tea) (done {t}) (undone x))') == [
        'boil_water',
        'Tea',
    ]


def test_a_list_of_tasks_needs_nothing_that_the_systems_python_lacks():
    needed = 'import mirror_explainer.node.task_list, sys; print(*sys.modules)'
    modules = subprocess.run(
        [sys.executable, '-c', needed], capture_output=True, text=True, check=True
    ).stdout.split()
    assert not {'unified_planning', 'pydantic', 'lemminflect', 'py_trees'} & {*modules}


def test_a_list_is_rehearsed_as_the_page_says(warehouse, tmp_path):
    page = (warehouse.parents[1] / 'docs' / 'behaviour_trees.md').read_text()
    block = re.search(r'```\n(rehearsal=.*?)```', page, re.DOTALL)[1]
    (tmp_path / 'config').symlink_to(warehouse.parent)
    said = subprocess.run(
        ['bash', '-ec', block], cwd=tmp_path, capture_output=True, text=True, check=True
    ).stdout.split('\n')[:2]
    assert said == ['I am boiling water.', 'I will bring the tea.']
    assert ', '.join(f'"{sentence}"' for sentence in said) in page


@pytest.fixture
def robot(operator, warehouse):
    """The example robot with tasks, and who asks it."""
    return robot_of(operator, str(warehouse.parent / 'tasks' / 'user_model.yaml'))


def test_a_robot_without_a_task_has_nothing_to_do(robot):
    robot.tasks.tell([])
    at_first = robot.refusal()
    robot.tasks.tell([(TEA[0], 'done'), *((task, 'ahead') for task in TEA[1:])])
    told = robot.answer()
    robot.tasks.tell([])
    stopped = robot.refusal()
    cups = ['Collect the cups', 'Wipe the table']
    robot.tasks.tell([(cups[0], 'done'), (cups[1], 'running')])
    robot.answer()
    robot.tasks.tell([(task, 'done') for task in cups])
    done = robot.answer()
    robot.tasks.tell([])

    assert at_first == robot.refusal() == 'I have nothing to do right now.'
    assert told.startswith('I will ')
    assert stopped == 'I have stopped. I have nothing to do right now.'
    assert done.endswith('I am done.')


def test_tasks_are_told_in_their_tenses(robot):
    robot.tasks.tell([(TEA[0], 'done'), (TEA[1], 'running'), (TEA[2], 'ahead')])
    assert robot.answer() == 'I am boiling water.\nI will bring the tea.'
    robot.tasks.tell([(task, 'done') for task in TEA])
    assert robot.answer() == 'I have boiled water and brought the tea.\nI am done.'


def test_a_task_whose_words_are_joined_is_the_one_that_the_user_model_names(robot):
    robot.tasks.tell([('DriveToTheKitchen', 'done'), ('boilwater', 'running'), TEA_AHEAD])
    assert robot.answer() == 'I am boiling water.\nI will bring the tea.'
    assert robot.explainer.diagnose(Others()).values['warnings'] == 'none'


def test_tasks_in_the_place_of_some_are_another_plan_and_other_tasks_a_new_one(robot):
    def begun(*tasks: str, ends: Sequence[str] = ()) -> str:
        robot.tasks.tell([(task, 'ahead') for task in tasks], ends)
        return robot.answer().split('\n')[0]

    assert begun(*TEA) == 'I will boil water and bring the tea.'
    assert begun(TEA[0], 'Make coffee', TEA[2]) == 'I have changed my plan.'
    assert json.loads(robot.published[-1][1])['episode']['reason'] == 'new task'
    assert begun('Collect the cups', 'Wipe the table') == 'I have a new task.'
    robot.tasks.tell([('Collect the cups', 'done'), ('Wipe the table', 'done')])
    assert robot.answer().endswith('I am done.')
    # That part is to be done once more, and not: the task before is over.
    assert begun('Collect the cups', 'Fill the can') == 'I have a new task.'
    # A small task that both have makes another plan of it, unless it is no end.
    assert begun('Water the plants', 'Fill the can') == 'I have changed my plan.'
    begun('Wipe the table', 'Fill the can', ends=['Wipe the table'])
    assert begun(*TEA, 'Fill the can', ends=[TEA[2]]) == 'I have a new task.'


def test_a_round_after_one_that_was_heard_of_in_its_middle_is_told_from_its_beginning(robot):
    tasks = ['Collect the cups', 'Wipe the table']
    robot.tasks.tell([(tasks[0], 'done'), (tasks[1], 'running')])
    under_way = robot.answer()
    robot.tasks.tell([(task, 'done') for task in tasks])
    done = robot.answer()
    robot.tasks.tell([(task, 'ahead') for task in tasks])

    assert under_way == 'I have collected the cups.\nI am wiping the table.'
    assert done == 'I have collected the cups and wiped the table.\nI am done.'
    assert robot.answer() == 'I will collect the cups and wipe the table.'
    assert json.loads(robot.published[-1][1])['episode']['reason'] == 'again'


def test_a_robot_that_goes_back_in_its_list_begins_it_again(robot):
    failed = [(TEA[0], 'done'), (TEA[1], 'failed'), (TEA[2], 'ahead')]
    robot.tasks.tell(failed, reason='the tap is shut')
    stuck = robot.answer()
    robot.tasks.tell([(TEA[0], 'running'), (TEA[1], 'ahead'), (TEA[2], 'ahead')])

    assert stuck.split('\n')[:2] == ['I am stuck: I cannot boil water.', 'The tap is shut.']
    assert robot.answer().split('\n')[0] == 'I have started again.'
    assert json.loads(robot.published[-1][1])['plan'][0]['status'] == 'running'


def test_a_task_whose_name_begins_with_no_english_verb_is_said_as_it_is_and_warned_of(robot):
    robot.tasks.tell([('Tür öffnen', 'running'), ('2nd tea', 'failed'), TEA_AHEAD])
    assert robot.answer().split('\n') == [
        'I am stuck: I cannot do this: task 2nd tea.',
        'I am doing this: Tür öffnen.',
        'I meant to bring the tea.',
    ]
    warnings = robot.explainer.diagnose(Others()).values['warnings']
    assert '"Tür öffnen" does not begin with an English verb: give it a sentence' in warnings
    assert 'Bring' not in warnings


def test_a_robot_that_had_to_stop_says_why_and_what_it_could_not_do(robot):
    robot.tasks.tell([(TEA[0], 'done'), (TEA[1], 'running'), (TEA[2], 'ahead')])
    robot.tasks.tell([], reason='Somebody pressed my emergency stop.')
    stopped = robot.answer()
    robot.tasks.tell([], reason='Somebody pressed my emergency stop.')
    still = robot.answer()
    robot.tasks.tell([(TEA[0], 'done'), (TEA[1], 'running'), (TEA[2], 'ahead')])

    assert stopped.split('\n')[:2] == [
        'I am stuck: I cannot boil water.',
        'Somebody pressed my emergency stop.',
    ]
    assert stopped.endswith('I meant to bring the tea.')
    assert still == stopped
    assert robot.answer() == 'I am boiling water.\nI will bring the tea.'
    assert robot.warnings == []


def test_a_robot_that_goes_on_after_a_failure_is_not_stuck(robot):
    why = 'The tap is shut.'
    robot.tasks.tell([(TEA[0], 'done'), (TEA[1], 'failed'), (TEA[2], 'running')], reason=why)
    going_on = robot.answer()
    robot.tasks.tell([(TEA[0], 'done'), (TEA[1], 'failed', why), (TEA[2], 'done')])

    assert going_on == 'I did not boil water.\nThe tap is shut.\nI am bringing the tea.'
    assert robot.answer() == (
        'I did not boil water.\nThe tap is shut.\nI have brought the tea.\nI am done.'
    )


def test_a_list_that_cannot_be_told_is_answered_with_that_and_not_with_the_one_before(robot):
    under_way = [(TEA[0], 'done'), (TEA[1], 'running'), TEA_AHEAD]
    robot.tasks.tell(under_way)
    before = robot.answer()
    with pytest.raises(InputError):
        robot.tasks.tell_text('doing: boil water')
    assert robot.refusal() == (
        '/plan: tasks, line 1: "doing" is no standing of a task (did you mean "done"?)'
    )
    with pytest.raises(InputError):
        robot.tasks.tell([('Boil water', 'doing')])
    assert robot.refusal().startswith('/plan: tasks: a task is ahead, ')
    robot.tasks.tell(under_way)

    assert robot.answer() == before == 'I am boiling water.\nI will bring the tea.'


def test_a_reason_that_is_no_sentence_is_said_with_what_it_is_of(robot):
    robot.tasks.tell_text('failed: boil water because of the waves\nbring the tea')
    stuck = robot.answer()
    robot.tasks.tell_text('skipped: boil water because of the waves.\nrunning: bring the tea')

    assert stuck.split('\n')[0] == 'I am stuck: I cannot boil water because of the waves.'
    assert robot.answer().split('\n')[0] == 'I did not boil water because of the waves.'


def test_a_reason_of_nothing_that_failed_is_told_once_in_the_log(robot):
    for _ in range(2):
        robot.tasks.tell([(TEA[0], 'running')], reason='Why not.')

    assert robot.warnings == ['nobody hears why: "Why not.", since no task was skipped, or failed']


def test_a_robot_goes_back_to_the_task_that_was_put_off_however_the_other_one_went(robot):
    def told(*tasks: tuple[str, str]) -> str:
        robot.tasks.tell(tasks)
        return robot.answer().split('\n')[0]

    water = ('Water the plants', 'ahead')
    told((TEA[0], 'done'), (TEA[1], 'running'), (TEA[2], 'ahead'))
    urgent = told(('Fill the can', 'running'), water)
    in_another_way = told(('Call for help', 'running'), water)
    told(('Call for help', 'done'), (water[0], 'done'))
    detour = robot.published[-1][0]
    back = told((TEA[0], 'done'), (TEA[1], 'running'), (TEA[2], 'ahead'))
    resumed = robot.published[-1][1]
    told(*((task, 'done') for task in TEA))

    assert urgent == 'I have a new task.'
    assert in_another_way == 'I have changed my plan.'
    assert detour.endswith('\nI have not finished what I was doing before.')
    assert back == 'I have gone back to what I was doing.'
    assert json.loads(resumed)['episode']['reason'] == 'resumed'
    assert robot.published[-1][0] == 'I have boiled water and brought the tea.\nI am done.'


@pytest.fixture
def asked(peer, tmp_path, warehouse):
    """A peer whose explainer has the user model of the example robot with tasks."""
    from ros_peer import explainer

    model = warehouse.parent / 'tasks' / 'user_model.yaml'
    with explainer(peer, tmp_path, user_model_file=str(model), n=1):
        yield peer


def test_progress_is_told_with_each_new_plan_and_else_only_when_it_is_new():
    told: list[tuple[str, str]] = []

    def create_publisher(_, topic, __):
        return SimpleNamespace(publish=lambda message: told.append((topic, message.data)))

    topics = RobotTopics(SimpleNamespace(create_publisher=create_publisher))
    running = 'running: (do boil_water)'
    plans = '(do boil_water)\n(do bring_the_tea)', '(do boil_water)'
    topics.tell(progress=running, plan=plans[0])
    topics.tell(progress=running, plan=plans[0])
    topics.tell(progress=running, plan=plans[1])
    topics.tell(progress='done: (do boil_water)', plan=plans[1])

    assert told == [
        *(('progress', running), ('plan', plans[0])),
        *(('progress', running), ('plan', plans[1])),
        ('progress', 'done: (do boil_water)'),
    ]


def test_a_node_of_the_robots_tells_the_explainer_its_tasks(asked):
    known = ['Collect the cups', 'Wipe the table', 'Fill the can', 'Water the plants']
    tasks = TaskList(asked.node, known)
    progress = asked.hear('progress')

    tasks.tell([(TEA[0], 'running'), (TEA[1], 'ahead'), (TEA[2], 'ahead')])

    assert asked.answer() == 'I am driving to the kitchen.\nI will bring the tea.'
    eventually(lambda: progress == ['running: (do drive_to_the_kitchen)'], 'the first progress')
    tasks.tell([(TEA[0], 'done'), (TEA[1], 'running'), (TEA[2], 'ahead')])
    eventually(
        lambda: progress[-1] == 'done: (do drive_to_the_kitchen)\nrunning: (do boil_water)',
        'the progress after a task is done',
    )


def test_a_robot_that_sends_its_tasks_as_a_text_is_explained(asked, tmp_path, warehouse):
    from ros_peer import running

    model = str(warehouse.parent / 'tasks' / 'user_model.yaml')
    namespace = asked.node.get_namespace()
    with running('task_list_robot', namespace, tmp_path, user_model_file=model) as process:
        asked.publish('tasks', 'drive to the kitchen\nboil water\nbring the tea', latched=False)
        assert asked.answer() == 'I will bring the tea.'
        asked.publish('tasks', 'done: !', latched=False)
        eventually(lambda: 'a task needs a name' in process.log, 'what is wrong in the log')
        asked.failure('a task needs a name')
        assert 'incompatible QoS' not in process.log
