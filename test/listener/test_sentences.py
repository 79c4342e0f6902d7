"""What each ground action sounds like."""

from conftest import WAREHOUSE

from mirror_explainer.listener.phrases import Phrases
from mirror_explainer.listener.sentences import Sentences, action_parameters, sentences_for
from mirror_explainer.listener.user_model import UserModel
from mirror_explainer.listener.wording import Template, Wording
from mirror_explainer.pddl import Task, read_task
from mirror_explainer.pddl.progress import StepStatus


def test_an_action_that_nothing_is_known_of_is_said_with_all_of_its_objects() -> None:
    sentences = Sentences({'pick-up': ('what', 'where')})

    assert sentences.of('(pick-up box1 shelf_2)') == 'I will pick up box1 shelf 2.'


def test_an_action_without_arguments_has_a_default_sentence_too() -> None:
    assert Sentences({'re_charge': ()}).of('(re_charge)') == 'I will re charge.'


def test_objects_are_called_what_the_user_model_says() -> None:
    sentences = Sentences({'grab': ('i', 'r')}, objects={'box_1': 'the Big box'})

    assert sentences.of('(grab box_1 room_2)') == 'I will grab the Big box room 2.'


def test_a_template_takes_the_objects_of_the_parameters_that_it_names() -> None:
    sentences = Sentences(
        {'grab': ('i', 'r')},
        {'grab': Template(Wording('From {r} I take {i}, yes: {i}.'))},
        {'box_1': 'the box'},
    )

    assert sentences.of('(grab box_1 room_2)') == 'From room 2 I take the box, yes: the box.'


def test_the_first_parameter_whose_object_has_a_wording_decides() -> None:
    sentences = Sentences(
        {'move': ('a', 'b')},
        {
            'move': Template(
                Wording('Off to {b}.'),
                {
                    'b': {'hall': Wording('Into the hall from {a}.'), 'roof': Wording('Up.')},
                    'a': {'roof': Wording('Down to {b}.')},
                },
            )
        },
    )

    assert sentences.of('(move hall cellar)') == 'Off to cellar.'
    assert sentences.of('(move cellar hall)') == 'Into the hall from cellar.'
    assert sentences.of('(move cellar roof)') == 'Up.'
    assert sentences.of('(move roof hall)') == 'Down to hall.'  # "a" comes first in the action


def test_actions_with_the_same_sentence_are_one_observation() -> None:
    sentences = Sentences({'grab': ('i', 'r')}, {'grab': Template(Wording('I grab {i}.'))})

    assert sentences.of('(grab cup kitchen)') == sentences.of('(grab cup hall)')
    assert sentences.of('(grab cup kitchen)') != sentences.of('(grab pan kitchen)')


def test_a_sentence_is_one_line_and_braces_can_be_written() -> None:
    sentences = Sentences(
        {'a': ('x',)}, {'a': Template(Wording('I  do\n {{{x}}}. '))}, {'o': ' an\tO '}
    )

    assert sentences.of('(a o)') == 'I do { an O }.'


def test_the_warehouse_actions_have_their_parameters_in_order(task: Task) -> None:
    assert action_parameters(task) == {
        'move': ('a', 'b'),
        'grab': ('i', 'r'),
        'recharge': ('p',),
        'exit': ('d', 'p'),
    }


def test_a_step_has_the_same_observation_in_all_tenses() -> None:
    sentences = Sentences({'grab': ('i',)}, {'grab': Template(Wording('I will grab the {i}.'))})

    said = {status: sentences.said('(grab cup)', status) for status in StepStatus}

    assert said == {
        StepStatus.AHEAD: 'I will grab the cup.',
        StepStatus.RUNNING: 'I am grabbing the cup.',
        StepStatus.DONE: 'I have grabbed the cup.',
        StepStatus.SKIPPED: 'I did not grab the cup.',
    }
    assert sentences.of('(grab cup)') == 'I will grab the cup.'


def test_tenses_that_are_given_are_said_and_the_others_made_or_marked() -> None:
    wordings = {
        'a': Wording('I will lie here.', past='I lay here.'),
        'b': Wording('Ich hole {x}.', present='Ich hole gerade {x}.', past='Ich habe {x} geholt.'),
        'c': Wording('Ich gehe.'),
    }
    templates = {name: Template(wording) for name, wording in wordings.items()}
    parameters = {'a': (), 'b': ('x',), 'c': ()}
    phrases = Phrases(already='Schon erledigt: {sentence}')
    sentences = Sentences(parameters, templates, {'x1': 'das Buch'}, phrases=phrases)

    running = [sentences.said(a, StepStatus.RUNNING) for a in ('(a)', '(b x1)', '(c)')]
    done = [sentences.said(a, StepStatus.DONE) for a in ('(a)', '(b x1)', '(c)')]

    assert running == ['I am lying here.', 'Ich hole gerade das Buch.', 'Ich gehe.']
    assert done == ['I lay here.', 'Ich habe das Buch geholt.', 'Schon erledigt: Ich gehe.']
    assert sentences.said('(c)', StepStatus.SKIPPED) == 'Left out: Ich gehe.'


def test_wordings_by_type_are_for_the_objects_of_the_problem(task: Task) -> None:
    template = Template(
        Wording('I will go to {b}.'), {'b': {'type place': Wording('I will go somewhere.')}}
    )
    model = UserModel((), templates={'move': template})

    sentences = sentences_for(task, model)

    assert sentences.of('(move left center)') == 'I will go somewhere.'


def tasks_said(*names: str, user_model: UserModel | None = None) -> dict[str, list[str]]:
    """Return what is said of tasks ahead, going on and done, in the domain of `config/tasks`."""
    domain = (WAREHOUSE.parent / 'tasks' / 'domain.pddl').read_text()
    objects = ' '.join(names)
    task = read_task(
        domain, f'(define (problem p) (:domain tasks) (:objects {objects} - task) (:goal (and)))'
    )
    sentences = sentences_for(task, user_model or UserModel(()))
    tenses = (StepStatus.AHEAD, StepStatus.RUNNING, StepStatus.DONE)
    return {n: [sentences.said(f'(do {n.lower()})', s) for s in tenses] for n in names}


def test_where_a_task_has_the_verb_it_is_said_in_its_tenses_without_a_sentence_of_ones_own() -> (
    None
):
    assert tasks_said(
        'boil_water', 'Drive_to_the_kitchen', 'MoveToPose', 'take_cup_and_plate'
    ) == {
        'boil_water': ['I will boil water.', 'I am boiling water.', 'I have boiled water.'],
        'Drive_to_the_kitchen': [
            'I will drive to the kitchen.',
            'I am driving to the kitchen.',
            'I have driven to the kitchen.',
        ],
        'MoveToPose': ['I will move to pose.', 'I am moving to pose.', 'I have moved to pose.'],
        # Is the plate taken, or is something plated?
        'take_cup_and_plate': [
            'I will take cup and plate.',
            'I will take cup and plate.',
            'Already done: I will take cup and plate.',
        ],
    }


def test_a_sentence_of_ones_own_may_have_a_task_in_the_place_of_its_verb() -> None:
    wording = Wording("I'll now {task}, with care.", past='{task}: this is done.')
    model = UserModel((), templates={'do': Template(wording)}, objects={'tea': 'bring the tea'})

    assert tasks_said('tea', user_model=model)['tea'] == [
        "I'll now bring the tea, with care.",
        "I'm now bringing the tea, with care.",
        'bring the tea: this is done.',
    ]


def test_names_are_spelt_as_they_were_told() -> None:
    model = UserModel((), templates={'do': Template(Wording('Gleich: {task}.'))})

    assert tasks_said('Öffne_Beute_3', user_model=model)['Öffne_Beute_3'][0] == (
        'Gleich: Öffne Beute 3.'
    )
