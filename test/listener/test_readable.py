"""What robots say without a template, each sentence as a person would say it."""

import re

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mirror_explainer.listener.readable import Readables
from mirror_explainer.listener.roles import roles_of
from mirror_explainer.listener.sentences import Sentences, sentences_for
from mirror_explainer.listener.user_model import UserModel
from mirror_explainer.listener.wording import Template, Wording
from mirror_explainer.pddl import Task, read_task
from mirror_explainer.pddl.progress import StepStatus

NO_TEMPLATES = UserModel(())


WALK = (
    '(:action walk :parameters (?a ?b - room) :precondition (at ?a) '
    ':effect (and (not (at ?a)) (at ?b)))'
)


def robot(actions: str, predicates: str, objects: str, init: str = '') -> Task:
    """Return a task with these parts of a domain and of a problem."""
    kinds = 'thing lamp robot person horse film gate'
    types = f'room bay level - object storey - room {kinds} - object'
    return read_task(
        f'(define (domain d) (:requirements :strips :typing :negative-preconditions)'
        f'(:types {types}) (:predicates {predicates}) {actions} {WALK})',
        f'(define (problem p) (:domain d) (:objects {objects}) (:init {init}) (:goal (and)))',
    )


def action(name: str, parameters: str, effect: str, precondition: str = '') -> str:
    return (
        f'(:action {name} :parameters ({parameters}) :precondition (and {precondition}) '
        f':effect (and {effect}))'
    )


PREDICATES = (
    '(at ?r - room) (in ?r - room) (on-shelf ?t - thing ?r - room) (held ?t - thing) (hand-free)'
    '(stored ?t - thing ?b - bay) (bay-free ?b - bay) (lit ?l - lamp) (charged) (fuel ?l - level)'
    '(shown ?t - thing ?f - film) (greeted ?p - person) (given ?t - thing ?p - person)'
    '(passed ?g - gate) (seen ?r - room) (gate-open ?a ?b - room) (fed ?h - horse)'
    '(filled ?b - bay ?t - thing) (pressed ?t - thing) (met ?c - robot)'
    '(has ?p - person ?t - thing) (in-there ?t - thing ?r - room) (in-mug ?t ?u - thing)'
    '(adorned ?t ?u - thing ?f - film)'
    '(shelved ?t - thing ?s - storey) (aboard ?p - person ?g - gate)'
)
OBJECTS = (
    'big_hall cold-store upstairs - room level_0 left - storey bay_1 - bay '
    'red_Mug tin7 my_desk - thing '
    'desk_lamp - lamp full half - level Ms_Ito anna nurse dr_who old_man - person colour - film '
    'east_gate - gate x - room bella - horse vinny gripper - robot'
)
MOVE = '(not (at ?a)) (at ?b)'

SPOKEN = [
    (action('move', '?a ?b - room', MOVE, '(at ?a)'), 'x big_hall', 'move to the big hall'),
    (action('goto', '?a ?b - room', MOVE, '(at ?a)'), 'x cold-store', 'go to the cold store'),
    (action('turn_to', '?b ?a - room', MOVE, '(at ?a)'), 'level_0 x', 'turn to level 0'),
    (action('up', '?a ?b - room', MOVE, '(at ?a)'), 'x level_0', 'go up to level 0'),
    (action('enter-room', '?a ?b - room', MOVE, '(at ?a)'), 'big_hall x', 'enter room x'),
    (
        action('drive', '?a ?b - room ?l ?m - level', MOVE + '(not (fuel ?l)) (fuel ?m)'),
        'x big_hall full half',
        'drive to the big hall',
    ),
    (
        action(
            'pick', '?t - thing ?r - room', '(held ?t) (not (on-shelf ?t ?r)) (not (hand-free))'
        ),
        'red_mug cold-store',
        'pick up the red Mug from the cold store',
    ),
    (
        action('dropOff', '?t - thing ?r - room', '(not (held ?t)) (on-shelf ?t ?r)', '(at ?r)'),
        'tin7 x',
        'drop off tin7 in room x',
    ),
    (
        action('take', '?t - thing ?b - bay', '(stored ?t ?b) (not (bay-free ?b))'),
        'tin7 bay_1',
        'take tin7',
    ),
    (
        action('put_in_bay', '?t - thing ?b - bay', '(stored ?t ?b) (not (bay-free ?b))'),
        'tin7 bay_1',
        'put tin7 in bay 1',
    ),
    (action('switch_off', '?l - lamp', '(not (lit ?l))'), 'desk_lamp', 'switch off the desk lamp'),
    (action('lamp-light', '?l - lamp', '(lit ?l)'), 'desk_lamp', 'light the desk lamp'),
    (action('recharge', '?r - room', '(charged)', '(at ?r)'), 'x', 'recharge'),
    (
        action('take-picture', '?t - thing ?f - film', '(shown ?t ?f)'),
        'red_mug colour',
        'take a picture of the red Mug with the colour film',
    ),
    (
        action('check_lights', '?r - room', '(seen ?r)', '(at ?r)'),
        'x',
        'check the lights in room x',
    ),
    (action('greet', '?p - person', '(greeted ?p)'), 'ms_ito', 'greet Ms Ito'),
    (action('greet', '?p - person', '(greeted ?p)'), 'anna', 'greet anna'),
    (action('feed', '?h - horse', '(fed ?h)'), 'bella', 'feed bella'),
    (
        action('hand_over', '?t - thing ?p - person', '(given ?t ?p) (not (held ?t))'),
        'red_mug nurse',
        'hand over the red Mug to the nurse',
    ),
    (action('exit', '?g - gate', '(passed ?g)'), 'east_gate', 'exit through the east gate'),
    (
        action('floor-cleaning', '?r - room', '(seen ?r)'),
        'big_hall',
        'clean the floor in the big hall',
    ),
    (action('search_area', '?r - storey', '(seen ?r)'), 'level_0', 'search level 0'),
    (
        action('pick_from', '?t - thing ?r - room', '(held ?t) (not (on-shelf ?t ?r))'),
        'tin7 x',
        'pick up tin7 from room x',
    ),
    # The two of them do the same: which one is no matter to anybody.
    (
        action('load-first', '?t - thing ?b - bay', '(stored ?t ?b)')
        + action('load-second', '', ''),
        'tin7 bay_1',
        'load tin7 into bay 1',
    ),
    (
        action('open_gate', '?a ?b - room', '(gate-open ?a ?b) (gate-open ?b ?a)', '(at ?a)'),
        'big_hall x',
        'open the gate between the big hall and room x',
    ),
    (
        action('dispense', '?t - thing ?b - bay', '(not (held ?t)) (filled ?b ?t)'),
        'tin7 bay_1',
        'dispense tin7 into bay 1',
    ),
    (
        action('tip-into-press', '?t - thing', '(not (held ?t)) (pressed ?t)'),
        'red_mug',
        'tip the red Mug into the press',
    ),
    (
        action('take-out-of', '?t - thing ?r - room', '(held ?t) (not (on-shelf ?t ?r))'),
        'tin7 x',
        'take tin7 out of room x',
    ),
    (
        action('pick-grapes', '?r - room', '(seen ?r)', '(at ?r)'),
        'big_hall',
        'pick the grapes in the big hall',
    ),
    (action('greet', '?c - robot', '(met ?c)'), 'vinny', 'greet vinny'),
    (action('greet', '?c - robot', '(met ?c)'), 'gripper', 'greet the gripper'),
    (action('do-polish', '?t - thing', '(held ?t)'), 'red_mug', 'polish the red Mug'),
    (action('wait-2', '', '(charged)'), '', 'wait 2'),
    (action('tag-thing-4', '?t - thing', '(pressed ?t)'), 'red_mug', 'tag the red Mug'),
    (
        action('ask_visitors_to_leave', '?r - room', '(seen ?r)', '(at ?r)'),
        'big_hall',
        'ask the visitors in the big hall to leave',
    ),
    (action('help-to-stand-up', '?p - person', '(greeted ?p)'), 'anna', 'help anna to stand up'),
    (
        action('remind_person_to_take_thing', '?p - person ?t - thing', '(given ?t ?p)'),
        'ms_ito red_mug',
        'remind Ms Ito to take the red Mug',
    ),
    (
        action('wait_for_person_to_pass', '?p - person', '(greeted ?p)'),
        'nurse',
        'wait for the nurse to pass',
    ),
    (
        action('tell_person_to_wait_at_gate', '?p - person ?g - gate', '(greeted ?p)(passed ?g)'),
        'nurse east_gate',
        'tell the nurse to wait at the east gate',
    ),
    # "To bay" is a verb as well.
    (
        action('allow_to_bay', '?t - thing ?b - bay', '(stored ?t ?b)'),
        'red_mug bay_1',
        'allow the red Mug to bay 1',
    ),
    (action('say-goodbye', '?p - person', '(greeted ?p)'), 'nurse', 'say goodbye to the nurse'),
    (
        action('call_for_help', '?r - room', '(seen ?r)', '(at ?r)'),
        'big_hall',
        'call for help in the big hall',
    ),
    (action('film_and_charge', '?f - film', '(charged)'), 'colour', 'film and charge'),
    (action('charge_and_gate', '?g - gate', '(charged)'), 'east_gate', 'charge and gate'),
    (action('start-charging', '', '(charged)'), '', 'start charging'),
    (action('go_home', '?a ?b - room', MOVE, '(at ?a)'), 'x big_hall', 'go home to the big hall'),
    # What somebody has is given, and not they.
    (
        action('give', '?t - thing ?p - person', '(not (held ?t)) (has ?p ?t)'),
        'tin7 anna',
        'give tin7 to anna',
    ),
    (
        action('take', '?t - thing ?p - person', '(held ?t) (not (has ?p ?t))'),
        'tin7 anna',
        'take tin7 from anna',
    ),
    (
        action('switch', '?p - person ?t ?u - thing', '(has ?p ?u) (not (has ?p ?t))'),
        'anna red_mug tin7',
        'switch anna to tin7',
    ),
    # What the verb lacks before what it is done to.
    (action('look', '?t - thing', '(held ?t)'), 'tin7', 'look at tin7'),
    (action('look-for', '?t - thing', '(held ?t)'), 'tin7', 'look for tin7'),
    (action('wait', '?p - person', '(greeted ?p)'), 'anna', 'wait for anna'),
    (action('dock', '?b - bay', '(bay-free ?b)'), 'bay_1', 'dock at bay 1'),
    (action('dock', '?a ?b - room', MOVE, '(at ?a)'), 'x big_hall', 'dock at the big hall'),
    # How, and not what.
    (
        action('drive_fast', '?a ?b - room', MOVE, '(at ?a)'),
        'x big_hall',
        'drive fast to the big hall',
    ),
    (
        action('carry-slow', '?t - thing ?a ?b - room', '(not (on-shelf ?t ?a)) (on-shelf ?t ?b)'),
        'tin7 x big_hall',
        'carry tin7 slow to the big hall',
    ),
    (
        action('show', '?t - thing ?f - film', '(shown ?t ?f)')
        + action('show-heated', '?t - thing ?f - film', '(shown ?t ?f)'),
        'red_mug colour',
        'show the red Mug to the colour',
    ),
    (action('serve-chilled', '?t - thing', '(held ?t)'), 'tin7', 'serve tin7 chilled'),
    # What the name calls the place, the thing or the robot is not said beside it.
    (
        action('return_to_base', '?a ?b - room', MOVE, '(at ?a)'),
        'x big_hall',
        'return to the big hall',
    ),
    (action('move_base', '?a ?b - room', MOVE, '(at ?a)'), 'x big_hall', 'move to the big hall'),
    (
        action('deliver-big-parcel', '?t - thing ?r - room', '(not (held ?t)) (on-shelf ?t ?r)'),
        'tin7 big_hall',
        'deliver tin7 to the big hall',
    ),
    (
        action('pick-cup', '?t - thing ?r - room', '(held ?t) (not (on-shelf ?t ?r))', '(at ?r)'),
        'tin7 x',
        'pick up tin7 from room x',
    ),
    # A door on the way is what one goes through, and not what is behind it.
    (
        action('go_through', '?g - gate ?a ?b - room', MOVE, '(at ?a) (passed ?g)'),
        'east_gate x big_hall',
        'go through the east gate to the big hall',
    ),
    (
        action('clean_with', '?l - lamp ?t - thing ?r - room', '(lit ?l)', '(at ?r)'),
        'desk_lamp tin7 x',
        'clean the desk lamp with tin7',
    ),
    (
        action('test', '?t - thing ?f - film', '(shown ?t ?f)'),
        'tin7 colour',
        'test tin7 for the colour',
    ),
    (
        action('serve', '?t - thing ?p - person', '(given ?t ?p)'),
        'tin7 anna',
        'serve tin7 to anna',
    ),
    (
        action('serve', '?t - thing ?r - room', '(on-shelf ?t ?r)'),
        'tin7 big_hall',
        'serve tin7 at the big hall',
    ),
    (
        action('put', '?t - thing ?r - room', '(not (held ?t)) (in-there ?t ?r)', '(at ?r)'),
        'tin7 big_hall',
        'put tin7 in the big hall',
    ),
    (
        action('board', '?p - person ?g - gate', '(aboard ?p ?g)'),
        'anna east_gate',
        'board anna onto the east gate',
    ),
    (action('self_test', '', '(charged)'), '', 'do the self test'),
    (action('tool_change', '', '(charged)'), '', 'change the tool'),
    (action('do-full-scan', '?r - room', '(seen ?r)', '(at ?r)'), 'x', 'do a full scan of room x'),
    (action('object-detection', '', '(charged)'), '', 'do the object detection'),
    (action('ask_charge', '', '(charged)'), '', 'ask for the charge'),
    (action('say_hello', '?p - person', '(greeted ?p)'), 'anna', 'say hello to anna'),
    (action('stay_idle', '', '(charged)'), '', 'stay idle'),
    (
        action('decorate', '?t ?u - thing ?f - film', '(adorned ?t ?u ?f)'),
        'tin7 red_mug colour',
        'decorate tin7 with the red Mug and the colour film',
    ),
    (action('go-in', '?a ?b - room', MOVE, '(at ?a)'), 'x big_hall', 'go into the big hall'),
    # What the name calls the object the object's own name says, too: a tin is no other tin.
    (action('inspect-tin', '?t - thing', '(held ?t)'), 'tin7', 'inspect tin7'),
    (
        action('put-into-mug', '?t ?u - thing', '(in-mug ?t ?u) (not (held ?t))'),
        'tin7 red_mug',
        'put tin7 into the red Mug',
    ),
    (
        action('wipe', '?t - thing ?s - storey', '(shelved ?t ?s)'),
        'tin7 left',
        'wipe tin7 in the left storey',
    ),
    (action('undock', '?b - bay', '(not (bay-free ?b))'), 'bay_1', 'undock from bay 1'),
    (action('turn_off_fan', '?r - room', '(not (seen ?r))'), 'x', 'turn off the fan in room x'),
    (action('ask_for_help', '?p - person', '(greeted ?p)'), 'anna', 'ask for the help of anna'),
    (action('wait_until_dry', '?t - thing', '(held ?t)'), 'tin7', 'wait for tin7 until dry'),
    (action('mark_as_done', '?t - thing', '(held ?t)'), 'tin7', 'mark tin7 as done'),
    (action('let_cool', '?t - thing', '(held ?t)'), 'tin7', 'let tin7 cool'),
    (
        action('pick_with_left_hand', '?t - thing', '(held ?t)'),
        'tin7',
        'pick up tin7 with the left hand',
    ),
    (action('move_to_home_pose', '', '(charged)'), '', 'move to the home pose'),
    (action('go_to_home', '', '(charged)'), '', 'go home'),
    (action('sing', '?t - thing ?p - person', '(given ?t ?p)'), 'tin7 anna', 'sing tin7 to anna'),
    (action('play_chess', '?p - person', '(greeted ?p)'), 'anna', 'play the chess with anna'),
    # Who the name says that it is done to goes first, and is not called anything else.
    (
        action('attend-person', '?p - person ?t - thing', '(given ?t ?p) (not (held ?t))'),
        'anna tin7',
        'attend to anna with tin7',
    ),
    (action('inform_human', '?p - person', '(greeted ?p)'), 'dr_who', 'inform dr who'),
    (action('greet', '?p - person', '(greeted ?p)'), 'old_man', 'greet the old man'),
    (action('move', '?a ?b - room', MOVE, '(at ?a)'), 'x upstairs', 'move upstairs'),
    (action('scan', '?r - room', '(seen ?r)'), 'upstairs', 'scan upstairs'),
    (action('inspect', '?t - thing', '(held ?t)'), 'my_desk', 'inspect my desk'),
    (action('opengate', '?g - gate', '(passed ?g)'), 'east_gate', 'open the east gate'),
    (action('askcharge', '', '(charged)'), '', 'ask for the charge'),
    (action('re-localize', '', '(charged)'), '', 'relocalize'),
    (action('nav', '?a ?b - room', MOVE, '(at ?a)'), 'x big_hall', 'navigate to the big hall'),
]


@pytest.mark.parametrize(('domain', 'arguments', 'said'), SPOKEN, ids=[s[2] for s in SPOKEN])
def test_an_action_is_said_by_what_it_brings_about(domain: str, arguments: str, said: str) -> None:
    task = robot(domain, PREDICATES, OBJECTS)

    sentence = sentences_for(task, NO_TEMPLATES).of(f'({task.model.actions[0].name} {arguments})')

    assert sentence == f'I will {said}.'


FLEET = """
(define (domain yard) (:requirements :strips :typing)
  (:types crane truck yard box)
  (:predicates (crane-at ?c - crane ?y - yard) (truck-at ?t - truck ?y - yard)
    (box-at ?b - box ?y - yard) (in ?b - box ?t - truck) (weighed ?b - box ?c - crane))
  (:action drive-truck :parameters (?t - truck ?a ?b - yard) :precondition (truck-at ?t ?a)
    :effect (and (not (truck-at ?t ?a)) (truck-at ?t ?b)))
  (:action load-truck :parameters (?b - box ?t - truck ?y - yard)
    :precondition (and (truck-at ?t ?y) (box-at ?b ?y))
    :effect (and (not (box-at ?b ?y)) (in ?b ?t)))
  (:action unload_truck :parameters (?b - box ?t - truck ?y - yard)
    :precondition (and (truck-at ?t ?y) (in ?b ?t))
    :effect (and (box-at ?b ?y) (not (in ?b ?t))))
  (:action weigh :parameters (?b - box ?c - crane) :effect (weighed ?b ?c)))
"""
YARD = """
(define (problem p) (:domain yard)
  (:objects c - crane truck1 t2 - truck north-yard y2 - yard b1 BOX_A - box) (:init) (:goal (and)))
"""


def test_what_the_name_of_an_action_says_its_object_is_stands_before_a_code() -> None:
    sentences = sentences_for(read_task(FLEET, YARD), NO_TEMPLATES)

    assert sentences.of('(drive-truck t2 y2 north-yard)') == (
        'I will drive truck t2 to the north yard.'
    )
    assert sentences.of('(load-truck b1 truck1 y2)') == 'I will load b1 into truck1.'
    assert sentences.of('(unload_truck box_a t2 y2)') == (
        'I will unload BOX A from truck t2 in yard y2.'
    )
    assert sentences.of('(weigh b1 c)') == 'I will weigh b1 with crane c.'


def test_what_an_action_changes_the_number_of_is_said() -> None:
    domain = (
        '(define (domain d) (:requirements :typing :numeric-fluents) (:types trough robot)'
        '(:predicates (ready)) (:functions (level ?t - trough) (charge ?r - robot))'
        '(:action top-up :parameters (?r - robot ?t - trough) :precondition (ready)'
        ' :effect (and (increase (level ?t) 20) (decrease (charge ?r) 1)))'
        '(:action rest :parameters (?r - robot) :effect (increase (charge ?r) 9)))'
    )
    problem = (
        '(define (problem p) (:domain d) (:objects trough-2 - trough r - robot)'
        '(:init (= (level trough-2) 0) (= (charge r) 5)) (:goal (and)))'
    )
    sentences = sentences_for(read_task(domain, problem), NO_TEMPLATES)

    assert sentences.of('(top-up r trough-2)') == 'I will top up trough 2.'
    assert sentences.of('(rest r)') == 'I will rest.'


def test_a_code_with_the_kind_of_its_object_needs_no_wider_kind() -> None:
    domain = (
        '(define (domain d) (:requirements :strips :typing) (:types brush net - tool)'
        '(:predicates (held ?t - tool))'
        '(:action pick-up-tool :parameters (?t - tool) :effect (held ?t)))'
    )
    problem = '(define (problem p) (:domain d) (:objects brush-1 b2 - brush) (:goal (and)))'
    sentences = sentences_for(read_task(domain, problem), NO_TEMPLATES)

    assert sentences.of('(pick-up-tool brush-1)') == 'I will pick up brush 1.'
    assert sentences.of('(pick-up-tool b2)') == 'I will pick up tool b2.'


def test_what_moves_the_robot_tells_of_places_though_the_user_model_has_its_sentence() -> None:
    task = robot(action('refill_soap', '?r - room', '(seen ?r)', '(at ?r)'), PREDICATES, OBJECTS)
    walk = Template(Wording("I'll go to {b}."))
    sentences = sentences_for(task, UserModel((), templates={'walk': walk}))

    assert sentences.of('(walk x big_hall)') == "I'll go to big hall."
    assert sentences.of('(refill_soap big_hall)') == 'I will refill the soap in the big hall.'


BAR = """
(define (domain bar) (:requirements :strips :typing)
  (:types hand vessel drink spot - object glass jug - vessel)
  (:predicates (on ?v - vessel ?s - spot) (holding ?h - hand ?v - vessel) (hand-free ?h - hand)
    (contains ?v - vessel ?d - drink) (empty ?v - vessel) (clean ?v - vessel) (shaken ?d - drink))
  (:action grasp :parameters (?h - hand ?v - vessel ?s - spot)
    :precondition (and (on ?v ?s) (hand-free ?h))
    :effect (and (not (on ?v ?s)) (not (hand-free ?h)) (holding ?h ?v)))
  (:action fill-glass :parameters (?g - glass ?d - drink) :precondition (empty ?g)
    :effect (and (contains ?g ?d) (not (empty ?g)) (not (clean ?g))))
  (:action pour-jug-into-clean-glass :parameters (?j - jug ?g - glass ?d - drink)
    :effect (and (contains ?g ?d) (not (contains ?j ?d)) (empty ?j) (not (clean ?g))))
  (:action empty-jug :parameters (?j - jug ?d - drink)
    :effect (and (not (contains ?j ?d)) (empty ?j)))
  (:action grasp-two :parameters (?h ?k - hand ?v ?w - vessel)
    :effect (and (holding ?h ?v) (holding ?k ?w))))
"""


def test_what_is_held_or_filled_is_not_said_of_the_hand() -> None:
    problem = (
        '(define (problem p) (:domain bar) (:objects left right - hand g1 g2 - glass kettle - jug '
        'tea - drink table - spot) (:init) (:goal (and)))'
    )
    sentences = sentences_for(read_task(BAR, problem), NO_TEMPLATES)

    assert sentences.of('(grasp left g1 table)') == 'I will grasp g1 from the table.'
    assert sentences.of('(fill-glass g1 tea)') == 'I will fill glass g1 with the tea.'
    assert sentences.of('(pour-jug-into-clean-glass kettle g1 tea)') == (
        'I will pour the tea into glass g1.'
    )
    assert sentences.of('(empty-jug kettle tea)') == 'I will empty the kettle of the tea.'
    # Of four objects three are said.
    assert sentences.of('(grasp-two left right g1 g2)').count('g') == 3


UNTYPED = """
(define (domain mars) (:requirements :strips)
  (:predicates (probe ?p) (site ?s) (at ?p ?s) (sampled ?p ?s) (antenna ?a) (sent ?s) (on ?a))
  (:action travel :parameters (?p ?a ?b)
    :precondition (and (probe ?p) (site ?a) (site ?b) (at ?p ?a))
    :effect (and (not (at ?p ?a)) (at ?p ?b)))
  (:action sample_dust :parameters (?p ?s) :precondition (and (probe ?p) (site ?s) (at ?p ?s))
    :effect (sampled ?p ?s))
  (:action send-dust-data :parameters (?p ?s ?a)
    :precondition (and (probe ?p) (site ?s) (antenna ?a) (sampled ?p ?s)) :effect (sent ?s)))
"""


def mars(probes: str) -> Sentences:
    facts = ' '.join(f'(probe {probe})' for probe in probes.split())
    problem = (
        f'(define (problem p) (:domain mars) (:objects {probes} rim floor dish)'
        f'(:init {facts} (site rim) (site floor) (antenna dish)) (:goal (and)))'
    )
    return sentences_for(read_task(UNTYPED, problem), NO_TEMPLATES)


def test_the_only_robot_is_i_and_one_of_several_is_named() -> None:
    alone, several = mars('scout'), mars('scout digger')

    assert alone.of('(travel scout rim floor)') == 'I will travel to the floor.'
    assert several.of('(travel scout rim floor)') == 'I will travel the scout to the floor.'
    assert alone.of('(sample_dust scout rim)') == 'I will sample the dust at the rim.'
    assert several.of('(sample_dust scout rim)') == (
        'I will sample the dust at the rim using the scout.'
    )
    assert alone.of('(send-dust-data scout rim dish)') == 'I will send the dust data of the rim.'


def test_what_one_of_several_robots_brings_gets_there_and_not_the_robot() -> None:
    carry = action(
        'carry',
        '?c - robot ?t - thing ?a ?b - room',
        '(not (robot-in ?c ?a)) (robot-in ?c ?b) (not (on-shelf ?t ?a)) (on-shelf ?t ?b)',
    )
    task = robot(carry, PREDICATES + '(robot-in ?c - robot ?r - room)', OBJECTS)
    sentences = sentences_for(task, NO_TEMPLATES)

    assert sentences.of('(carry vinny tin7 x big_hall)') == (
        'I will carry tin7 to the big hall using vinny.'
    )


def test_without_types_what_is_stated_of_an_object_is_its_kind() -> None:
    home = (
        '(define (domain home) (:predicates (room ?r) (person ?p) (in ?r) (given ?t ?p))'
        '(:action go :parameters (?a ?b) :precondition (and (room ?a) (room ?b) (in ?a))'
        ' :effect (and (not (in ?a)) (in ?b)))'
        '(:action hand-over :parameters (?t ?p) :precondition (person ?p) :effect (given ?t ?p)))'
    )
    problem = (
        '(define (problem p) (:domain home) (:objects rooma roomb tom cup)'
        '(:init (room rooma) (room roomb) (person tom) (in rooma)) (:goal (in roomb)))'
    )
    sentences = sentences_for(read_task(home, problem), NO_TEMPLATES)

    assert sentences.of('(go rooma roomb)') == 'I will go to room b.'
    assert sentences.of('(hand-over cup tom)') == 'I will hand over the cup to tom.'


LIFTS = """
(define (domain lifts) (:requirements :strips :typing) (:types lift stop)
  (:predicates (at ?s - stop) (stops ?l - lift ?s - stop))
  (:action take-lift :parameters (?l - lift ?a ?b - stop)
    :precondition (and (at ?a) (stops ?l ?a) (stops ?l ?b))
    :effect (and (not (at ?a)) (at ?b))))
"""


@pytest.mark.parametrize(
    ('stops', 'said'),
    [
        # Lift b has one top stop, and its name is told without the letter,
        ('(stops lift_b top_b) (stops lift_b base_b)', 'I will take lift b to the top.'),
        # but not where it stops at another one that differs in nothing else.
        ('(stops lift_b top_b) (stops lift_b top_a)', 'I will take lift b to top b.'),
    ],
)
def test_a_letter_is_not_said_twice_where_that_leaves_no_doubt(stops: str, said: str) -> None:
    problem = (
        '(define (problem p) (:domain lifts) (:objects lift_a lift_b - lift top_a top_b base_b - '
        f'stop) (:init (stops lift_a top_a) {stops}) (:goal (and)))'
    )
    sentences = sentences_for(read_task(LIFTS, problem), NO_TEMPLATES)

    assert sentences.of('(take-lift lift_b base_b top_b)') == said


COFFEE = """
(define (domain bar) (:requirements :strips :typing) (:types cup recipe - object)
  (:predicates (ready) (warm ?c - cup) (has ?c - cup ?r - recipe) (empty ?c - cup))
  (:action brew :parameters (?c - cup ?r - recipe) :effect (and (not (empty ?c)) (has ?c ?r)))
  (:action rinse :parameters (?c - cup ?r - recipe) :effect (empty ?c))
  (:action start :parameters (?c - cup) :effect (ready)))
"""


def coffee(*plan: str) -> Sentences:
    problem = (
        '(define (problem p) (:domain bar) (:objects cup1 cup2 - cup mocha tea - recipe)'
        '(:init) (:goal (and)))'
    )
    return sentences_for(read_task(COFFEE, problem), NO_TEMPLATES, plan)


def test_steps_are_told_apart_only_by_what_lasts_to_the_plans_end() -> None:
    sentences = coffee('(start cup1)', '(start cup2)', '(rinse cup1 tea)', '(brew cup1 mocha)')

    assert sentences.of('(start cup1)') == sentences.of('(start cup2)') == 'I will start.'
    assert sentences.of('(brew cup1 mocha)') == 'I will brew cup1 with the mocha recipe.'


def test_names_in_capitals_only_are_not_shouted() -> None:
    task = read_task(COFFEE.upper(), (
        '(DEFINE (PROBLEM P) (:DOMAIN BAR) (:OBJECTS CUP1 - CUP MOCHA - RECIPE)'
        '(:INIT) (:GOAL (AND)))'
    ))  # fmt: skip

    sentences = sentences_for(task, NO_TEMPLATES)

    assert sentences.of('(brew cup1 mocha)') == 'I will brew cup1 with the mocha recipe.'


def test_what_the_user_model_calls_an_object_is_said_in_default_sentences_too(task: Task) -> None:
    model = UserModel((), objects={'red_cube': 'the heavy one'})

    sentences = sentences_for(task, model)

    assert sentences.of('(grab red_cube red_room)') == (
        'I will grab the heavy one from the red room.'
    )


def test_a_default_sentence_is_said_in_all_tenses(task: Task) -> None:
    sentences = sentences_for(task, NO_TEMPLATES)

    assert sentences.said('(exit bottom_door right)', StepStatus.RUNNING) == (
        'I am exiting through the bottom door.'
    )
    assert sentences.said('(grab blue_cube blue_room)', StepStatus.DONE) == (
        'I have grabbed the blue cube from the blue room.'
    )


WORDS = (
    'pick up put down to the room tool go and or of left first 2 a ing do perform scanning xyzzy '
    'Open CLOSE at from item _ __ is'
)
ATOMS = (
    '(on ?i ?r)', '(at ?r)', '(at ?q)', '(holding ?h ?i)', '(free ?h)', '(level ?n)', '(flag)',
    '(made ?i ?h ?r)',
)  # fmt: skip


@settings(max_examples=200, deadline=None, derandomize=True)
@given(
    st.lists(st.sampled_from(WORDS.split()), min_size=1, max_size=5),
    st.lists(st.sampled_from(ATOMS), max_size=4),
    st.lists(st.sampled_from(ATOMS), max_size=3),
    st.integers(0, 6),
)
def test_every_action_has_a_sentence_whatever_its_name_and_effects(
    words: list[str], made: list[str], undone: list[str], more: int
) -> None:
    name = '-'.join(words)
    effects = ' '.join([*made, *(f'(not {atom})' for atom in undone if atom not in made)])
    task = read_task(
        '(define (domain d) (:requirements :strips :typing) (:types item room hand level)'
        '(:predicates (on ?i - item ?r - room) (at ?r - room) (holding ?h - hand ?i - item)'
        '(free ?h - hand) (level ?n - level) (flag) (made ?i - item ?h - hand ?r - room))'
        f'(:action {name} :parameters (?h - hand ?i - item ?r ?q - room ?n - level)'
        f':precondition (at ?q) :effect (and {effects} (flag))))',
        '(define (problem p) (:domain d) (:objects h1 h_2 - hand __ - item Hall - room '
        'n-1 - level) (:init) (:goal (and)))',
    )
    roles = roles_of(task)
    action = task.model.actions[0].name

    sentence = Readables(roles, {}, frozenset({'item'})).of(action, more).sentence

    assert re.fullmatch(r'I will [^{}]+( \{[hirqn]\}|[^{}]+)*\.', sentence)
    assert len(set(re.findall(r'\{.\}', sentence))) == sentence.count('{')
    said = sentences_for(task, NO_TEMPLATES).of(f'({action} h1 __ hall hall n-1)')
    assert said.startswith('I will ') and '{' not in said
