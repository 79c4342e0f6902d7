"""Planning that runs out of time or memory: what is known then, and why."""

from dataclasses import replace

from processes import HARD

from mirror_explainer.planning import Belief, Planner, Status


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


def test_what_has_no_optimal_plan_in_time_is_unknown_with_the_reason() -> None:
    with Planner('fast-downward-opt', planning_timeout=0.5) as planner:
        report = planner.plan(HARD, [Belief(0), Belief(1)])

    hard, easy = report.results
    assert (hard.status, hard.plans) == (Status.UNKNOWN, ())
    assert hard.reason == 'no optimal plan within 0.5 s'
    assert easy.plans[0].optimal and easy.reason == ''


def test_what_the_deadline_cut_off_is_unknown_and_not_kept() -> None:
    kept: list[Belief] = []
    with Planner('fast-downward-opt') as planner:
        planner.plan(HARD, [Belief(1)])  # so that its process is up
        report = planner.plan(HARD, [Belief(0)], deadline=0.5)
        planner.plan(HARD, [Belief(0)], deadline=0.1, found=lambda belief, _: kept.append(belief))

    assert report.results[0].reason == 'the deadline passed'
    assert not kept


def test_a_search_that_needs_too_much_memory_leaves_its_belief_unknown() -> None:
    # With derived predicates there is one search to try, which remembers every state.
    derived = '(:predicates (everything-there)', '(:derived (everything-there) {})'
    domain = HARD.domain.replace('(:predicates', derived[0])
    domain = f'{domain.rstrip()[:-1]} {derived[1].format(HARD.goals[0])})'
    space = replace(HARD, domain=domain, goals=('(everything-there)',))
    with Planner('fast-downward-opt', memory_limit=60) as planner:
        report = planner.plan(space, [Belief(0)])

    assert report.results[0].status is Status.UNKNOWN
    assert 'memory' in report.results[0].reason
