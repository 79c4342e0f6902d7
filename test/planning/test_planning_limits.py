"""Planning that runs out of time or memory: what is known then, and what stands in."""

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


def test_an_out_of_time_optimal_search_gives_way_to_a_plan_that_stands_in() -> None:
    with Planner('fast-downward-opt', planning_timeout=0.5) as planner:
        report = planner.plan(HARD, [Belief(0), Belief(1)])

    hard, easy = report.results
    assert hard.status is Status.SOLVED
    assert not hard.plans[0].optimal
    assert hard.plans[0].cost >= 30 * 2  # each ball is picked up and dropped
    assert 'within 0.5 s' in hard.reason
    assert easy.plans[0].optimal and easy.reason == ''


def test_near_the_deadline_plans_stand_in_and_are_not_kept() -> None:
    with Planner('fast-downward-opt') as planner:
        planner.plan(HARD, [Belief(1)])  # so that its process is up
        report = planner.plan(HARD, [Belief(0)], deadline=2.0)
        again = planner.plan(HARD, [Belief(0)], deadline=2.0)

    assert report.results[0].status is Status.SOLVED
    assert 'deadline' in report.results[0].reason
    assert again.planner_calls > 0


def test_a_search_that_needs_too_much_memory_gives_way_to_a_plan_that_stands_in() -> None:
    with Planner('fast-downward-opt', memory_limit=60) as planner:
        report = planner.plan(HARD, [Belief(0)])

    assert not report.results[0].plans[0].optimal
    assert 'memory' in report.results[0].reason
