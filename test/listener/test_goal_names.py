"""What goals are called that the user model does not name."""

import pytest

from mirror_explainer.listener.goal_names import goal_names
from mirror_explainer.listener.sentences import sentences_for
from mirror_explainer.listener.user_model import UserModel
from mirror_explainer.listener.wording import Template, Wording
from mirror_explainer.pddl import read_task

DOMAIN = """
(define (domain office)
  (:types robot room cup)
  (:predicates (in ?r - robot ?a - room) (clean ?c - cup) (holds ?r - robot ?c - cup)
               (brought ?c - cup ?a - room) (night) (shown ?c - cup))
  (:action show :parameters (?c - cup) :effect (shown ?c))
  (:action go :parameters (?r - robot ?a ?b - room) :precondition (in ?r ?a)
    :effect (and (not (in ?r ?a)) (in ?r ?b)))
  (:action wash :parameters (?r - robot ?c - cup) :effect (and (clean ?c) (not (holds ?r ?c))))
  (:action bring :parameters (?r - robot ?c - cup ?a - room) :effect (brought ?c ?a)))
"""
OWN = {
    'go': Template(Wording('I will visit the {b}.')),
    'show': Template(Wording('I will show a {c}.')),
    'bring': Template(Wording('Ich bringe {c}.')),
}


@pytest.mark.parametrize(
    ('goal', 'name', 'in_own_words'),
    [
        (['(clean red_cup)'], 'wash the red cup', 'wash the red cup'),
        (
            ['(brought red_cup lab)', '(in robby hall)', '(clean red_cup)'],
            'bring the red cup to the lab, go to the hall and wash the red cup',
            '',
        ),
        (['(in robby hall)'], 'go to the hall', 'visit the hall'),
        (
            ['(clean red_cup)', '(clean blue_cup)', '(in robby hall)'],
            'wash the red cup and the blue cup, and go to the hall',
            'wash the red cup and the blue cup, and visit the hall',
        ),
        (
            ['(brought red_cup lab)', '(brought blue_cup lab)', '(brought blue_cup hall)'],
            'bring the red cup and the blue cup to the lab, and bring the blue cup to the hall',
            '',
        ),
        # What is washed is in no hand any more, too: that is not what one would think of.
        (['(clean red_cup)', '(not (holds robby red_cup))'], '', ''),
        (['(shown red_cup)'], 'show the red cup', 'show a red cup'),
        (['(shown old_cup)'], 'show the old cup', 'show an old cup'),
        (['(night)'], '', ''),
        ([], '', ''),
        (['(or (in robby hall) (in robby lab))'], '', ''),
    ],
)
def test_goals_are_called_what_brings_them_about(
    goal: list[str], name: str, in_own_words: str
) -> None:
    assert [called(goal), called(goal, OWN)] == [name, in_own_words]


def test_of_two_robots_it_must_be_said_which_is_meant() -> None:
    assert called(['(in robby hall)'], OWN, robots='robby tobby') == ''


def called(
    goal: list[str], templates: dict[str, Template] | None = None, robots: str = 'robby'
) -> str:
    objects = f'{robots} - robot hall lab - room red_cup blue_cup old_cup - cup'
    problem = f'(define (problem p) (:domain office) (:objects {objects}) (:init) (:goal (night)))'
    task = read_task(DOMAIN, problem)
    sentences = sentences_for(task, UserModel((), templates=templates or {}))
    return goal_names(task, sentences, ()).of(goal)


YARD = """
(define (domain yard)
  (:types place movable - object van parcel - movable)
  (:predicates (at ?m - movable ?p - place) (in ?x - parcel ?v - van) (weighed ?m - movable)
    (marked ?m - movable) (seen ?m - movable ?p - place))
  (:action label :parameters (?m ?n - movable ?p - place) :effect (and (marked ?m) (seen ?n ?p)))
  (:action weigh :parameters (?m - movable) :effect (weighed ?m))
  (:action drive :parameters (?v - van ?a ?b - place) :precondition (at ?v ?a)
    :effect (and (not (at ?v ?a)) (at ?v ?b)))
  (:action swap :parameters (?x ?y - parcel ?v - van ?p - place) :precondition (at ?v ?p)
    :effect (and (at ?x ?p) (in ?y ?v)))
  (:action unload :parameters (?x - parcel ?v - van ?p - place) :precondition (at ?v ?p)
    :effect (and (at ?x ?p) (not (in ?x ?v)))))
"""


@pytest.mark.parametrize(
    ('part', 'name'),
    [
        # What drives is a van, and the parcel is unloaded by a step of the plan.
        ('(at p1 hall)', 'unload p1 at hall'),
        ('(at {parcel2} {place})', 'swap {parcel2} at {place}'),
        ('(at v1 hall)', 'drive to hall'),
        ('(weighed p1)', 'weigh p1'),
        ('(marked p1)', 'label p1'),
        ('(weighed {parcel})', 'weigh {parcel}'),
    ],
)
def test_a_goal_is_called_by_an_action_that_takes_such_objects(part: str, name: str) -> None:
    objects = 'hall lab - place v1 - van p1 p2 - parcel'
    problem = f'(define (problem p) (:domain yard) (:objects {objects}) (:init) (:goal (and)))'
    task = read_task(YARD, problem)
    templates = {
        'drive': Template(Wording('I will drive to {b}.')),
        'swap': Template(Wording('I will swap {x} at {p}.')),
        'unload': Template(Wording('I will unload {x} at {p}.')),
        'label': Template(Wording('I will label {m} with {n} and {p}.')),
        'weigh': Template(Wording('I will weigh {m}.')),
    }
    plan = ['(swap p2 p1 v1 lab)', '(unload p1 v1 hall)']
    names = goal_names(task, sentences_for(task, UserModel((), templates=templates)), plan)

    assert names.of([part]) == name


def test_a_goal_calls_things_what_the_sentence_of_its_action_does() -> None:
    domain = (
        '(define (domain roof) (:types mode thing) (:predicates (seen ?t - thing ?m - mode))'
        '(:action photograph :parameters (?t - thing ?m - mode) :effect (seen ?t ?m)))'
    )
    problem = (
        '(define (problem p) (:domain roof) (:objects ridge - thing infrared - mode)'
        '(:init) (:goal (seen ridge infrared)))'
    )
    task = read_task(domain, problem)
    names = goal_names(task, sentences_for(task, UserModel(())), ())

    assert names.of(['(seen ridge infrared)']) == 'photograph the ridge in the infrared mode'
