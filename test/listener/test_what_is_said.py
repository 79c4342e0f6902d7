"""Little robots, each made to mislead, and what a person must hear of them (method, section 5)."""

import math
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import pytest
from prepared import prepared

from mirror_explainer.experiments.warehouse_files import read_warehouse
from mirror_explainer.explainer import explain
from mirror_explainer.listener.explanation import Explanation
from mirror_explainer.listener.preparation import Preparation
from mirror_explainer.listener.user_model import read_user_model
from mirror_explainer.pddl import read_task
from mirror_explainer.planning import Planner
from mirror_explainer.settings import Question

COURIER = """
(define (domain courier)
  (:requirements :strips :typing)
  (:types place parcel door)
  (:predicates (at ?p - place) (path ?a ?b - place) (gate ?d - door ?a ?b - place)
               (open ?d - door) (key-at ?p - place) (have-key)
               (waits ?x - parcel ?p - place) (loaded ?x - parcel)
               (for ?x - parcel ?p - place) (delivered ?x - parcel)
               (charged) (charger ?p - place) (dock ?p - place) (docked) (free))
  (:action go :parameters (?a ?b - place)
    :precondition (and (at ?a) (path ?a ?b) (free))
    :effect (and (not (at ?a)) (at ?b)))
  (:action pass :parameters (?d - door ?a ?b - place)
    :precondition (and (at ?a) (gate ?d ?a ?b) (open ?d) (free))
    :effect (and (not (at ?a)) (at ?b)))
  (:action fetch-key :parameters (?p - place)
    :precondition (and (at ?p) (key-at ?p)) :effect (have-key))
  (:action open-up :parameters (?d - door ?a ?b - place)
    :precondition (and (at ?a) (gate ?d ?a ?b) (have-key)) :effect (open ?d))
  (:action load :parameters (?x - parcel ?p - place)
    :precondition (and (at ?p) (waits ?x ?p) (charged))
    :effect (and (loaded ?x) (not (waits ?x ?p))))
  (:action deliver :parameters (?x - parcel ?p - place)
    :precondition (and (at ?p) (loaded ?x) (for ?x ?p))
    :effect (and (delivered ?x) (not (loaded ?x))))
  (:action charge :parameters (?p - place)
    :precondition (and (at ?p) (charger ?p)) :effect (charged))
  (:action park :parameters (?p - place)
    :precondition (and (at ?p) (dock ?p)) :effect (and (docked) (not (free))))
  (:action leave-dock :parameters (?p - place)
    :precondition (and (at ?p) (docked)) :effect (and (free) (not (docked)))))
"""
SENTENCES = """
sentences:
  go: "I will go to the {b}."
  pass: "I will go through the {d}."
  fetch-key: "I will fetch the key."
  open-up: "I will open the {d}."
  load: "I will load the {x}."
  deliver: "I will deliver the {x}."
  charge: "I will charge my battery."
  park: "I will go back to my dock."
  leave-dock: "I will leave my dock."
"""


@pytest.fixture(scope='module')
def planner() -> Iterator[Planner]:
    with Planner() as planner:
        yield planner


@pytest.fixture
def known(planner: Planner, tmp_path: Path) -> Callable[..., Preparation]:
    """Return what is known of a courier, from objects, facts, a goal, a model and a plan."""

    def prepare(
        objects: str, facts: str, goal: str, model: str, plan: str | None = None, **settings: float
    ) -> Preparation:
        problem = (
            f'(define (problem p) (:domain courier) (:objects {objects}) (:init {facts}) '
            f'(:goal {goal}))'
        )
        task = read_task(COURIER, problem)
        path = tmp_path / 'user.yaml'
        path.write_text(model + SENTENCES)
        return prepared(task, plan, read_user_model(path, task), planner, **settings)

    return prepare


def answers(preparation: Preparation, sizes: Sequence[int] = (1, 2, 3, 4)) -> list[list[str]]:
    """What is said of each N, in plan order."""
    return [list(asked(preparation, n).sentences) for n in sizes]


def asked(preparation: Preparation, n: int, listener: str = '') -> Explanation:
    return explain(preparation, Question(n=n, listener=listener))


def corridor(*places: str) -> str:
    pairs = zip(places, places[1:], strict=False)
    return ' '.join(f'(path {a} {b}) (path {b} {a})' for a, b in pairs)


def test_where_it_goes_is_told_not_by_which_rooms(known) -> None:
    places = ('bay', 'hall', 'office', 'lab', 'library')
    goals = ''.join(f'- {{goal: (at {place})}}\n' for place in places[1:])

    preparation = known(
        f'{" ".join(places)} - place', f'(at bay) (free) {corridor(*places)}', '(at library)',
        f'goals:\n{goals}',
    )  # fmt: skip

    # Each room on the way is an end of another candidate, and says nothing of this one.
    assert answers(preparation) == [['I will go to the library.']] * 4


def test_what_stands_in_the_way_of_the_deliveries_is_not_told(known) -> None:
    preparation = known(
        'hall office lab - place letter box - parcel gate - door',
        '(at hall) (free) (charged) (key-at hall) (gate gate hall office) (gate gate office hall) '
        f'{corridor("office", "lab")} (waits letter hall) (waits box hall) '
        '(for letter office) (for box lab)',
        '(and (delivered letter) (delivered box))',
        """goals:
- {name: key, goal: (have-key)}
- {name: gate, goal: (open gate)}
- {name: letter, goal: (delivered letter)}
- {name: both, goal: (and (delivered letter) (delivered box))}
""",
    )
    both = ['I will deliver the letter.', 'I will deliver the box.']

    assert answers(preparation, (2, 3, 4)) == [both] * 3


def test_what_was_so_and_is_so_again_is_told_where_it_is_a_goal(known) -> None:
    preparation = known(
        'hall lab - place letter box - parcel',
        f'(at hall) (docked) (dock hall) (charged) {corridor("hall", "lab")} '
        '(waits letter hall) (waits box hall) (for letter lab) (for box lab)',
        '(and (delivered letter) (docked))',
        """goals:
- {name: letter, goal: (delivered letter)}
- {name: letter and dock, goal: (and (delivered letter) (docked))}
- {name: box, goal: (delivered box)}
- {name: box and dock, goal: (and (delivered box) (docked))}
""",
    )

    assert answers(preparation, (2,)) == [
        ['I will deliver the letter.', 'I will go back to my dock.']
    ]
    assert asked(preparation, 2).understanding > 0.9


def test_an_unexpectedly_low_battery_is_told_beside_the_delivery(known) -> None:
    places = ('hall', 'lab', 'office', 'store')
    parcels = ('letter', 'box', 'crate')
    preparation = known(
        f'{" ".join(places)} - place {" ".join(parcels)} - parcel',
        f'(at hall) (free) (charger hall) {corridor(*places)} '
        + ' '.join(f'(waits {x} hall)' for x in parcels)
        + ' (for letter lab) (for box office) (for crate store)',
        '(delivered box)',
        'goals:\n'
        + ''.join(f'- {{goal: (delivered {x})}}\n' for x in parcels)
        + 'uncertain_facts: [{fact: (charged), probability: 0.7}]\n',
    )
    delivery, charging = 'I will deliver the box.', 'I will charge my battery.'

    assert answers(preparation) == [[delivery], *[[charging, delivery]] * 3]


def test_of_eight_deliveries_as_many_are_told_as_were_asked_for(known) -> None:
    parcels = [f'parcel{i}' for i in range(8)]
    goal = f'(and {" ".join(f"(delivered {x})" for x in parcels)})'
    preparation = known(
        f'hall lab - place {" ".join(parcels)} - parcel',
        f'(at hall) (free) (charged) {corridor("hall", "lab")} '
        + ' '.join(f'(waits {x} hall) (for {x} lab)' for x in parcels),
        goal,
        f'goals: [{{goal: "{goal}"}}]\n',
    )

    for n, sentences in enumerate(answers(preparation, range(1, 9)), start=1):
        assert len(sentences) == n
        assert all(sentence.startswith('I will deliver') for sentence in sentences)
    assert len(answers(preparation, (9,))[0]) == 8


def test_a_list_that_lacks_a_single_end_is_whole_where_there_is_room(known) -> None:
    parcels = ('letter', 'box', 'crate')
    preparation = known(
        f'hall lab - place {" ".join(parcels)} - parcel',
        f'(at hall) (free) (charged) {corridor("hall", "lab")} '
        + ' '.join(f'(waits {x} hall) (for {x} lab)' for x in parcels),
        '(and (delivered letter) (delivered box) (delivered crate))',
        """goals:
- {goal: (delivered letter)}
- {goal: (and (delivered letter) (delivered box) (delivered crate))}
""",
        '\n'.join(f'(load {x} hall)' for x in parcels)
        + '\n(go hall lab)\n'
        + '\n'.join(f'(deliver {x} lab)' for x in parcels),
    )
    two, three = asked(preparation, 2), asked(preparation, 3)

    # That the letter is delivered all candidates have in common.
    assert (
        two.sentences
        == three.sentences
        == ('I will deliver the box.', 'I will deliver the crate.')
    )
    assert two.spoken == 'I will deliver the box, the crate and one more.'
    assert three.spoken == 'I will deliver the letter, the box and the crate.'


def test_a_needless_step_is_never_told_for_its_own_sake(known) -> None:
    places = ('hall', 'lab', 'office')
    plan = (
        '(go hall office) (go office hall) (load letter hall) (go hall lab) (deliver letter lab)'
    ).replace(') (', ')\n(')
    preparation = known(
        f'{" ".join(places)} - place letter box - parcel',
        f'(at hall) (free) (charged) {corridor("hall", "lab")} {corridor("hall", "office")} '
        '(waits letter hall) (waits box hall) (for letter lab) (for box lab)',
        '(delivered letter)',
        'goals: [{goal: (delivered letter)}, {goal: (delivered box)}]\n',
        plan,
    )

    assert answers(preparation) == [['I will deliver the letter.']] * 4
    alone = {row['sentence']: row['information_gain'] for row in asked(preparation, 1).plan}
    assert alone['I will go to the office.'] < 0.02


def test_a_needless_step_does_not_tell_of_the_battery_either(known) -> None:
    preparation = known(
        'hall lab office - place letter box - parcel',
        f'(at hall) (free) (charged) {corridor("hall", "lab")} {corridor("hall", "office")} '
        '(charger hall) (waits letter hall) (waits box hall) (for letter lab) (for box lab)',
        '(delivered letter)',
        'goals: [{goal: (delivered letter)}, {goal: (delivered box)}]\n'
        'uncertain_facts: [{fact: (charged), probability: 0.2}]\n',
        '(go hall office)\n(go office hall)\n(load letter hall)\n(go hall lab)\n'
        '(deliver letter lab)',
    )

    assert answers(preparation) == [['I will deliver the letter.']] * 4


def test_the_same_goal_in_other_words_is_the_candidate(known) -> None:
    preparation = known(
        'hall lab - place letter box - parcel',
        f'(at hall) (free) (charged) {corridor("hall", "lab")} '
        '(waits letter hall) (waits box hall) (for letter lab) (for box lab)',
        '(forall (?any - parcel) (delivered ?any))',
        """goals:
- {name: everything, goal: "(and (delivered box) (and (delivered letter)))"}
- {name: the letter, goal: (delivered letter)}
""",
    )

    assert preparation.warnings == ()
    told = asked(preparation, 2)
    assert told.true_goal == 'everything'
    # That the letter is delivered both candidates have in common.
    assert told.sentences == ('I will deliver the box.',)
    assert told.understanding > 0.9


def test_a_free_step_for_nothing_leaves_the_listeners_own_plan_beside_the_robots(
    planner: Planner, tmp_path: Path
) -> None:
    domain = """
    (define (domain greeter) (:requirements :strips :action-costs)
      (:predicates (here) (there) (greeted)) (:functions (total-cost))
      (:action walk :parameters () :precondition (here)
        :effect (and (not (here)) (there) (increase (total-cost) 1)))
      (:action greet :parameters () :effect (greeted)))
    """
    problem = """
    (define (problem p) (:domain greeter) (:init (here) (= (total-cost) 0)) (:goal (there))
      (:metric minimize (total-cost)))
    """
    task = read_task(domain, problem)
    path = tmp_path / 'user.yaml'
    path.write_text('goals: [{goal: (there)}, {goal: (and (there) (greeted))}]\n')
    model = read_user_model(path, task)

    one, many = (
        prepared(task, '(greet)\n(walk)', model, planner, plans_per_belief=count)
        for count in (1, 300)
    )

    # One plan a belief: the robot's stands for it. More: both, each half as likely.
    before = [asked(known, 1, 'planner').cross_entropy_before for known in (one, many)]
    assert before == pytest.approx([math.log(2), math.log(4)])


def test_that_further_plans_need_an_extra_is_told_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr('mirror_explainer.planning.planner.find_kstar', lambda: '')
    task, model = read_warehouse()
    with Planner() as planner:
        known = prepared(task, None, model, planner, plans_per_belief=10)

    solved = [result for result in known.results.values() if result.plans]
    assert {(len(result.plans), result.cut) for result in solved} == {(1, 'planner')}
    assert known.warnings == (
        f'no further plans for {len(solved)} of {len(known.results)} beliefs: '
        "they need the extra [plans]: pip install 'kstar-planner>=1.6,<2'",
    )
    assert asked(known, 3).plans_cut == len(solved)


def test_what_was_not_planned_for_in_time_is_told_and_no_plan_stands_in(known) -> None:
    places = [f'p{i}' for i in range(12)]
    parcels = [f'x{i}' for i in range(6)]
    goal = f'(and {" ".join(f"(delivered {x})" for x in parcels[:4])})'
    preparation = known(
        f'{" ".join(places)} - place {" ".join(parcels)} - parcel',
        f'(at p0) (free) (charged) {corridor(*places)} '
        + ' '.join(
            f'(waits {x} p{3 * i % 12}) (for {x} p{7 * i % 12})' for i, x in enumerate(parcels)
        ),
        goal,
        'goals:\n'
        + ''.join(f'- {{goal: (delivered {x})}}\n' for x in parcels)
        + f'- {{goal: "{goal}"}}\n',
        plan=None,
        deadline=60,
    )
    model = preparation.model

    told = asked(preparation, 3)
    assert told.planned == model.planned
    assert told.complete == (told.planned == 1.0)
    assert told.unknown_mass == pytest.approx(1.0 - told.planned)
    assert set(told.sentences) <= {f'I will deliver the {x}.' for x in parcels[:4]}
