"""What an input costs at the default limits: `scripts/benchmark input_limits`.

Processor seconds of the worst texts of their size that we know.
"""

import time
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from test_nasty_input import CHAIN_DOMAIN, GOAL, LIMITS, chain, chain_plan

from mirror_explainer.errors import InputError
from mirror_explainer.listener.prior import belief_prior
from mirror_explainer.listener.user_model import read_user_model
from mirror_explainer.pddl import Task, read_task
from mirror_explainer.pddl.plan_check import check_plan
from mirror_explainer.pddl.plan_text import read_plan

SWITCH = """
(define (domain switch) (:requirements :adl) (:predicates (on) (lit ?a ?b ?c))
  (:action press :parameters () :precondition CONDITION :effect EFFECT))
"""


def switch_texts(
    condition: str = '()', effect: str = '(on)', objects: int = 0, goal: str = '(on)'
) -> list[str]:
    names = ' '.join(f'o{number}' for number in range(objects))
    problem = f'(define (problem p) (:domain switch) (:objects {names}) (:init) (:goal {goal}))'
    return [SWITCH.replace('CONDITION', condition).replace('EFFECT', effect), problem]


def switch(**parts: Any) -> Task:
    return read_task(*switch_texts(**parts), limits=LIMITS)


def told(what: str, run: Callable[[], object]) -> None:
    started = time.process_time()
    try:
        run()
        result = 'taken'
    except InputError as error:
        result = f'refused: {error.reason[:60]}'
    print(f'| {what} | {time.process_time() - started:.2f} s | {result} |', flush=True)


def check(task: Task, plan: str) -> None:
    check_plan(task, read_plan(plan, limits=LIMITS), limits=LIMITS)


def main() -> None:
    few = LIMITS.max_words - 50
    told('20 MB of anything', lambda: read_task(CHAIN_DOMAIN, '(' * 20_000_000, limits=LIMITS))
    effects = f'(and {"(on)" * few})'
    told('domain: 10,000 words of effects', lambda: switch(effect=effects))
    told(
        'the same domain, for a problem with an unknown name',
        lambda: switch(effect=effects, goal='(off)'),
    )
    timed = switch_texts(effect=f'(and {"(at end (on))" * (few // 3)})')
    timed[0] = timed[0].replace(':parameters ()', ':parameters () :duration (= ?duration 1)')
    timed[0] = timed[0].replace(':action', ':durative-action').replace('precon', 'con')
    timed[0] = timed[0].replace(':adl', ':durative-actions')
    told('domain: 10,000 words of timed effects', lambda: read_task(*timed, limits=LIMITS))
    denials = f'(and {"(not(on))" * (few // 2)})'
    told('domain: 10,000 words of conditions', lambda: switch(condition=denials))
    told('problem: 10,000 words of goal', lambda: switch(goal=denials))
    links = '(link p0 p1) ' * 75_000
    facts = chain(1000).replace('(:init ', f'(:init {links}')
    told('problem: 1 MB of initial facts', lambda: read_task(CHAIN_DOMAIN, facts, limits=LIMITS))
    told('problem: 2000 objects', lambda: read_task(CHAIN_DOMAIN, chain(2000), limits=LIMITS))
    task = read_task(CHAIN_DOMAIN, chain(1001))
    told('plan: 1000 actions', lambda: check(task, chain_plan(1001)))
    often = switch(condition='(forall (?a) (not (lit ?a ?a ?a)))', objects=25)
    told('plan: 1000 actions of 25 instances', lambda: check(often, '(press)\n' * 1000))
    every = switch(condition='(forall (?a ?b ?c) (not (lit ?a ?b ?c)))', objects=30)
    told('plan: 27,000 instances of a forall', lambda: check(every, '(press)'))
    with TemporaryDirectory() as folder:
        path = Path(folder) / 'model.yaml'
        path.write_text(
            GOAL + 'objects: {' + ', '.join(f'o{n}: name' for n in range(70_000)) + '}'
        )
        told('user model: 1 MB', lambda: read_user_model(path, limits=LIMITS))
        atoms = '(holding red_cube) ' * 40
        path.write_text(
            'goals:\n' + ''.join(f'- goal: (and {atoms} (g{n}))\n' for n in range(1000))
        )
        told(
            'user model: 1000 goals of 40 atoms',
            lambda: read_user_model(path, task, limits=LIMITS),
        )
        names = [f'p{n}' for n in range(101)]
        facts = ''.join(f'- {{fact: (at {name}), probability: 0.4}}\n' for name in names[1:])
        path.write_text('goals: [{goal: (at p100)}]\nuncertain_facts:\n' + facts)
        model = read_user_model(path, task, limits=LIMITS)
        told('user model: 100 uncertain facts, 1024 beliefs', lambda: belief_prior(task, model))


if __name__ == '__main__':
    main()
