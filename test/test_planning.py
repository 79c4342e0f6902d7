"""Planning for beliefs, through real engines in real processes."""

import os
import signal
import tempfile
import threading
import time
from pathlib import Path

import pytest
from pddl_cases import (
    TOOLS_DOMAIN,
    TOOLS_PROBLEM,
    WAREHOUSE_DOMAIN,
    WAREHOUSE_PROBLEM,
    gripper,
)

from mirror_explainer.errors import Cancelled, InputError, PlanningError
from mirror_explainer.planning import Belief, BeliefSpace, Plan, Planner, Status

TOOLS = BeliefSpace(TOOLS_DOMAIN, TOOLS_PROBLEM, ('(polished)', '(lost)'), ('(saw-sharp)',))
SHARP = frozenset(['(saw-sharp)'])
HARD = BeliefSpace(*gripper(30)[:2], goals=(gripper(30)[2], '(robot-at there)'))


@pytest.fixture(params=['fast-downward-opt'])
def engine(request: pytest.FixtureRequest) -> str:
    return request.param


def processes_of(session: int) -> list[int]:
    """Return the living processes of a session, from /proc."""
    found = []
    for stat in Path('/proc').glob('[0-9]*/stat'):
        try:
            state, _, _, its_session = stat.read_text().rpartition(') ')[2].split()[:4]
        except (FileNotFoundError, ProcessLookupError):
            continue
        if int(its_session) == session and state != 'Z':
            found.append(int(stat.parent.name))
    return found


def child_sessions() -> set[int]:
    """Return the sessions that children of this process lead."""
    sessions = set()
    for stat in Path('/proc').glob('[0-9]*/stat'):
        try:
            _, parent, _, session = stat.read_text().rpartition(') ')[2].split()[:4]
        except (FileNotFoundError, ProcessLookupError):
            continue
        if int(parent) == os.getpid() and session == stat.parent.name:
            sessions.add(int(session))
    return sessions


def private_directories() -> list[Path]:
    return list(Path(tempfile.gettempdir()).glob('mirror_explainer_*'))


def wait_until(condition, seconds: float = 10.0) -> bool:
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if condition():
            return True
        time.sleep(0.01)
    return False


def test_costs_are_in_the_metric_and_actions_in_canonical_text(engine: str) -> None:
    with Planner(engine) as planner:
        report = planner.plan(TOOLS, [Belief(0), Belief(0, SHARP)])

    slow, fast = report.results
    assert slow.plans == (Plan(('(cut-slowly)', '(polish)'), 7 + 1),)
    assert fast.plans == (Plan(('(cut-fast)', '(polish)'), 2 + 1),)


def test_without_a_metric_the_cost_is_the_number_of_actions(engine: str) -> None:
    space = BeliefSpace(
        WAREHOUSE_DOMAIN,
        WAREHOUSE_PROBLEM,
        ('(AND (Holding RED_CIRCLE) (outside bottom_door))',),
        ('(charged)',),
    )
    with Planner(engine) as planner:
        report = planner.plan(space, [Belief(0, frozenset(['(charged)'])), Belief(0)])

    charged, flat = (result.plans[0] for result in report.results)
    # center, doors, red room, grab, doors, right, exit; a recharge at the center on the way
    assert charged.cost == len(charged.actions) == 7
    assert charged.actions[-1] == '(exit bottom_door right)'
    assert flat.cost == len(flat.actions) == 8
    assert '(recharge center)' in flat.actions


def test_no_plan_is_told_apart_from_a_goal_that_holds_already(engine: str) -> None:
    space = BeliefSpace(TOOLS_DOMAIN, TOOLS_PROBLEM, ('(lost)', '(raw)', '(and (raw) (cut))'))
    with Planner(engine) as planner:
        report = planner.plan(space, [Belief(0), Belief(1), Belief(2)])

    lost, raw, both = report.results
    assert lost.status is Status.UNSOLVABLE and lost.plans == ()
    assert raw.plans == (Plan((), 0),)
    assert both.status is Status.UNSOLVABLE


def test_a_satisficing_engine_does_not_claim_optimal_plans() -> None:
    with Planner('fast-downward') as planner:
        report = planner.plan(TOOLS, [Belief(0, SHARP)])

    assert report.results[0].status is Status.SOLVED
    assert not report.results[0].plans[0].optimal


def test_pyperplan_plans_without_fast_downward() -> None:
    space = BeliefSpace(
        WAREHOUSE_DOMAIN,
        WAREHOUSE_PROBLEM,
        ('(holding red_cube)', '(holding blue_cube)'),
        ('(item-at red_cube red_room)',),
    )
    with Planner('pyperplan-opt') as planner:
        report = planner.plan(space, [Belief(0), Belief(1)])

    gone, found = report.results
    assert gone.status is not Status.SOLVED
    assert found.plans[0].actions[-1] == '(grab blue_cube blue_room)'
    # center, doors, blue room, grab
    assert found.plans[0].cost == 4
    assert found.plans[0].optimal


def test_asking_again_costs_no_planner_call(engine: str) -> None:
    with Planner(engine) as planner:
        first = planner.plan(TOOLS, [Belief(0), Belief(0, SHARP)])
        again = planner.plan(TOOLS, [Belief(0, SHARP), Belief(0)])

    assert first.planner_calls > 0
    assert again.planner_calls == 0
    assert again.results == first.results[::-1]


def test_a_changed_problem_is_planned_anew(engine: str) -> None:
    changed = BeliefSpace(
        TOOLS_DOMAIN, TOOLS_PROBLEM.replace('(raw)', '(cut)'), TOOLS.goals, TOOLS.uncertain_facts
    )
    with Planner(engine) as planner:
        planner.plan(TOOLS, [Belief(0)])
        report = planner.plan(changed, [Belief(0)])

    assert report.results[0].plans == (Plan(('(polish)',), 1),)


def test_progress_is_told_for_each_belief(engine: str) -> None:
    told: list[tuple[int, int]] = []
    with Planner(engine) as planner:
        planner.plan(
            TOOLS,
            [Belief(0), Belief(0, SHARP), Belief(1)],
            progress=lambda done, total: told.append((done, total)),
        )

    assert told[-1] == (3, 3)
    assert [done for done, _ in told] == sorted(done for done, _ in told)


def test_a_belief_without_a_plan_in_time_stays_unknown_and_the_others_do_not() -> None:
    with Planner('pyperplan-opt', planning_timeout=2.0) as planner:
        report = planner.plan(HARD, [Belief(0), Belief(1)])

    hard, easy = report.results
    assert hard.status is Status.UNKNOWN
    assert 'within 2 s' in hard.reason
    assert easy.status is Status.SOLVED


def test_after_the_deadline_the_rest_stays_unknown() -> None:
    with Planner('pyperplan-opt') as planner:
        report = planner.plan(HARD, [Belief(0)], deadline=1.5)

    assert report.results[0].status is Status.UNKNOWN
    assert 'deadline' in report.results[0].reason


@pytest.mark.parametrize('engine', ['fast-downward-opt', 'pyperplan-opt'])
def test_cancelling_ends_the_search_and_leaves_nothing_running(engine: str) -> None:
    cancelled = threading.Event()
    before = child_sessions()
    outcome: list[BaseException] = []

    def ask() -> None:
        try:
            planner.plan(HARD, [Belief(0)], cancelled=cancelled)
        except Cancelled as error:
            outcome.append(error)

    with Planner(engine) as planner:
        thread = threading.Thread(target=ask)
        thread.start()
        assert wait_until(lambda: child_sessions() - before)
        sessions = child_sessions() - before
        time.sleep(3.0)  # well into the search
        searching = {pid for session in sessions for pid in processes_of(session)}
        cancelled.set()
        thread.join(timeout=5.0)
        assert not thread.is_alive()
        assert isinstance(outcome[0], Cancelled)
        # the planner is still good for the next question
        assert planner.plan(TOOLS, [Belief(0)] if 'pyp' not in engine else []).results is not None

    assert searching
    assert not any(processes_of(session) for session in sessions)
    assert child_sessions() == before


def test_closing_from_another_thread_cancels_and_leaves_no_process_or_file() -> None:
    before, directories = child_sessions(), private_directories()
    planner = Planner('fast-downward-opt')
    outcome: list[BaseException] = []

    def ask() -> None:
        try:
            planner.plan(HARD, [Belief(0)])
        except Cancelled as error:
            outcome.append(error)

    thread = threading.Thread(target=ask)
    thread.start()
    assert wait_until(lambda: child_sessions() - before)
    sessions = child_sessions() - before
    planner.close()
    thread.join(timeout=5.0)

    assert outcome
    assert child_sessions() == before
    assert not any(processes_of(session) for session in sessions)
    assert set(private_directories()) <= set(directories)


def test_a_killed_worker_is_replaced(engine: str) -> None:
    before = child_sessions()
    with Planner(engine) as planner:
        planner.plan(TOOLS, [Belief(0)])
        for session in child_sessions() - before:
            os.kill(session, signal.SIGKILL)
        report = planner.plan(TOOLS, [Belief(0, SHARP)])

    assert report.results[0].plans[0].cost == 2 + 1


def test_an_unknown_engine_is_named_together_with_the_installed_ones() -> None:
    with Planner('slow-upward') as planner, pytest.raises(PlanningError) as caught:
        planner.plan(TOOLS, [Belief(0)])

    assert 'slow-upward' in str(caught.value)
    assert 'pyperplan' in str(caught.value)


def test_what_an_engine_does_not_support_is_named() -> None:
    with Planner('pyperplan') as planner, pytest.raises(PlanningError, match='actions cost'):
        planner.plan(TOOLS, [Belief(0)])


def test_an_unreadable_problem_is_an_input_error(engine: str) -> None:
    space = BeliefSpace(TOOLS_DOMAIN, '(define (problem', ('(polished)',))
    with Planner(engine) as planner, pytest.raises(InputError):
        planner.plan(space, [Belief(0)])


def test_a_belief_outside_the_space_is_refused(engine: str) -> None:
    with Planner(engine) as planner:
        with pytest.raises(ValueError, match='no goal 5'):
            planner.plan(TOOLS, [Belief(5)])
        with pytest.raises(ValueError, match='not uncertain'):
            planner.plan(TOOLS, [Belief(0, frozenset(['(raw)']))])
