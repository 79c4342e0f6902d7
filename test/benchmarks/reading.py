"""How long it takes to start, and to read a large problem: `scripts/benchmark reading`.

Each figure is the least of three runs in processes of their own, in processor time, and is set
against `import unified_planning.shortcuts` in the same run. Exit status 1 if a large problem
takes more than twice as long as that, or 150 MB more, or much more than twice as long as one of
half its size; or if another state of a problem, with 1,000 facts, takes more than a hundredth.
"""

import resource
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

WAREHOUSE = Path(__file__).parents[2] / 'config' / 'warehouse'
RUNS = 3
DOMAIN = """
(define (domain depot)
  (:types thing place)
  (:predicates (at ?t - thing ?p - place) (near ?a ?b - place) (held ?t - thing))
  (:action grab :parameters (?t - thing ?p - place) :precondition (at ?t ?p)
    :effect (and (held ?t) (not (at ?t ?p)))))
"""


def unified_planning() -> None:
    """Import unified-planning as programs do that call its engines."""
    import unified_planning.shortcuts

    assert unified_planning.shortcuts.OneshotPlanner


def explaining() -> None:
    """Import what explains a plan, and explain the example's."""
    from mirror_explainer import explain_files

    files = [str(WAREHOUSE / name) for name in ('domain.pddl', 'problem.pddl')]
    plan, user_model = WAREHOUSE / 'plan.txt', WAREHOUSE / 'user_model.yaml'
    assert explain_files(*files, plan=str(plan), user_model=str(user_model))


def nothing() -> None:
    """Import what reads tasks."""
    import mirror_explainer.pddl.task_reader

    assert mirror_explainer.pddl.task_reader.TaskReader


def problem(objects: int, facts: int, moved: int = 0) -> str:
    """Return a problem with so many objects, half of them places, and so many facts."""
    half = objects // 2
    things = ' '.join(f't{number}' for number in range(half))
    places = ' '.join(f'p{number}' for number in range(half))
    near = [(n % half, (n * 7 + n // half) % half) for n in range(facts - half)]
    init = [f'(at t{n} p{(n + moved) % half})' for n in range(half)]
    init += [f'(near p{a} p{b})' for a, b in near]
    return (
        f'(define (problem d) (:domain depot) (:objects {things} - thing {places} - place)\n'
        f'(:init {" ".join(init)})\n(:goal (held t0)))'
    )


def large() -> None:
    """Read a problem of 5,000 objects and 50,000 facts."""
    from mirror_explainer.pddl.task_reader import TaskReader

    assert len(TaskReader().read(DOMAIN, problem(5_000, 50_000)).initial_facts) == 50_000


def half_as_large() -> None:
    """Read a problem of 2,500 objects and 25,000 facts."""
    from mirror_explainer.pddl.task_reader import TaskReader

    assert len(TaskReader().read(DOMAIN, problem(2_500, 25_000)).initial_facts) == 25_000


STATES = 50


def states() -> None:
    """Read a problem of 1,000 facts, and then 50 times another state of it."""
    from mirror_explainer.pddl.task_reader import TaskReader

    reader = TaskReader()
    for moved in range(STATES + 1):
        task = reader.read(DOMAIN, problem(500, 1_000, moved))
    assert f'(at t0 p{STATES})' in task.initial_facts


def first_state() -> None:
    """Read a problem of 1,000 facts, and make the texts of 50 other states."""
    from mirror_explainer.pddl.task_reader import TaskReader

    TaskReader().read(DOMAIN, problem(500, 1_000))
    for moved in range(STATES):
        problem(500, 1_000, moved)


def measured(what: Callable[[], None]) -> tuple[float, float]:
    """Return the seconds of processor time and the MB that it takes in a process of its own."""
    code = f'import reading; reading.tell(reading.{what.__name__})'
    runs = []
    for _ in range(RUNS):
        command = [sys.executable, '-c', code]
        printed = subprocess.run(
            command, cwd=Path(__file__).parent, capture_output=True, text=True, check=True
        ).stdout
        runs.append([float(figure) for figure in printed.split()[-2:]])
    seconds, memory = zip(*runs, strict=True)
    return min(seconds), min(memory)


def tell(what: Callable[[], None]) -> None:
    """Do something, and print the seconds and the MB that it took, those of Python included."""
    what()
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1000
    print(time.process_time(), memory)


def main() -> int:
    """Print the table; return 1 where the promise is not kept."""
    measures = (unified_planning, nothing, explaining, large, half_as_large, first_state, states)
    found = {what: measured(what) for what in measures}
    unit, least = found[unified_planning][0], found[nothing]
    print('| what | s | imports of unified-planning | MB |')
    print('|---|---|---|---|')

    def row(what: str, seconds: float, memory: float) -> float:
        print(f'| {what} | {seconds:.3f} | {seconds / unit:.4f} | {memory:.0f} |')
        return seconds / unit

    def above(what: Callable[[], None]) -> tuple[float, float]:
        return found[what][0] - least[0], found[what][1] - least[1]

    row('`import unified_planning.shortcuts`', *found[unified_planning])
    row('our imports, and to explain the example', *found[explaining])
    reading = row('to read 5,000 objects and 50,000 facts, above the imports', *above(large))
    half = row('to read half of that', *above(half_as_large))
    seconds = (found[states][0] - found[first_state][0]) / STATES
    state = row('to read another state with 1,000 facts', seconds, 0.0)
    small = above(large)[1] <= 150.0 and reading <= 2.5 * half
    return int(not (small and reading <= 2.0 and state <= reading / 100))


if __name__ == '__main__':
    sys.exit(main())
