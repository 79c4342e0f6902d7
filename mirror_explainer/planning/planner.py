"""Plans for many beliefs, by worker processes, within limits of time and memory.

The way in to this package: it keeps the last space's results, and decides how
the rest is found.
"""

import logging
import threading
import time
from collections.abc import Callable, Iterable, Sequence

from mirror_explainer.errors import PlanningError
from mirror_explainer.planning.beliefs import (
    Belief,
    BeliefPlans,
    BeliefSpace,
    PlanningReport,
    Status,
)
from mirror_explainer.planning.downward.program import find_downward, find_kstar
from mirror_explainer.planning.downward.way import DownwardWay
from mirror_explainer.planning.engines.pool import EnginePool
from mirror_explainer.planning.limits import Limits, Resources, Stop
from mirror_explainer.planning.messages import Attempt, Done
from mirror_explainer.settings import FAST, PlanningSettings

_NOTHING = Done(0, 0.0, 'all known')
_log = logging.getLogger(__name__)

_LATE = BeliefPlans(Status.UNKNOWN, reason='the deadline passed')


class Planner:
    """Finds plans for beliefs with one planning engine, named as unified-planning names it.

    `workers` processes plan at a time. A belief without a plan after
    `planning_timeout` seconds stays unknown; a planning process may use
    `memory_limit` MiB. `downward_binary` is the path of a Fast Downward search
    program to use instead of the one that comes with up-fast-downward. Without
    `shortcuts` every belief gets an engine call of its own. The processes run
    until `close`, or the end of the `with` block:

        with Planner('fast-downward-opt') as planner:
            report = planner.plan(space, [Belief(0), Belief(1)], deadline=5.0)

    """

    def __init__(
        self,
        engine: str = PlanningSettings.planner,
        *,
        workers: int = PlanningSettings.workers,
        planning_timeout: float = PlanningSettings.planning_timeout,
        memory_limit: int = PlanningSettings.planner_memory_limit,
        downward_binary: str = '',
        shortcuts: bool = True,
    ) -> None:
        self._engine = engine
        resources = Resources(workers, planning_timeout, memory_limit)
        self._pool = EnginePool(engine, resources)
        downward = find_downward(downward_binary) if shortcuts and engine == FAST else None
        self._fast = DownwardWay(downward, find_kstar(), resources) if downward else None
        self._busy = threading.Lock()
        self._closed = threading.Event()
        self._known_space: BeliefSpace | None = None
        self._known: dict[int, dict[Belief, Attempt]] = {}  # by the plans asked for

    @classmethod
    def of(cls, settings: PlanningSettings) -> 'Planner':
        """Return a planner as the settings have it."""
        return cls(
            settings.planner,
            workers=settings.workers,
            planning_timeout=settings.planning_timeout,
            memory_limit=settings.planner_memory_limit,
            downward_binary=settings.downward_binary,
        )

    def plan(
        self,
        space: BeliefSpace,
        beliefs: Sequence[Belief],
        *,
        plans_per_belief: int = 1,
        deadline: float | None = None,
        cancelled: Stop | None = None,
        found: Callable[[Belief, BeliefPlans], None] | None = None,
    ) -> PlanningReport:
        """Return what is known about each belief once it is planned for, in the order given.

        The first belief is planned for first, then the others, goals in the order in which they
        come. `plans_per_belief` is how many plans a belief should get, which are looked
        for when each belief has one; without kstar-planner, or with another engine, it gets one.
        After `deadline` seconds the rest stays unknown. Setting `cancelled` in another thread
        ends the call and its planning within some 50 ms. `found` is told each belief's result as
        it comes, that of a belief known already at once, and again if further plans join it.

        Raises Cancelled; InputError for texts that cannot be read; PlanningError
        when the engine is not there, does not support the problem, or crashed on
        every belief; ValueError for a belief outside the space.
        """
        end = float('inf') if deadline is None else time.monotonic() + deadline
        events: tuple[Stop, ...] = (self._closed, cancelled) if cancelled else (self._closed,)
        limits = Limits(end, events)
        _require_inside(space, beliefs)
        with self._busy:
            limits.check()
            if self._known_space != space:
                self._known_space, self._known = space, {}
            known_plans = self._known.setdefault(plans_per_belief, {})
            results = _Results(known_plans, beliefs, found)
            missing = [belief for belief in dict.fromkeys(beliefs) if not results.has(belief)]
            done = (
                self._plan(space, missing, plans_per_belief, limits, results)
                if missing
                else _NOTHING
            )
            known = tuple(results.get(belief) for belief in beliefs)
            nothing_known = all(result.status is Status.UNKNOWN for result in known)
            if missing and nothing_known and results.failed.issuperset(beliefs):
                raise PlanningError(
                    f'the planning engine "{self._engine}" failed on every belief; on the last '
                    f'one: {results.last_reason}',
                    cure='Name another engine as the planner.',
                )
        _log.debug('%d beliefs: %s, %d calls', len(beliefs), done.way, done.calls)
        return PlanningReport(
            known, done.calls, done.way, done.searching, len(results.failed), done.worked
        )

    def _plan(
        self,
        space: BeliefSpace,
        beliefs: Sequence[Belief],
        plans_per_belief: int,
        limits: Limits,
        results: '_Results',
    ) -> Done:
        if self._fast:
            answer = self._fast.plan(space, beliefs, plans_per_belief, limits, results.record)
            if isinstance(answer, Done):
                return answer
            level = logging.WARNING if answer.unexpected else logging.DEBUG
            _log.log(level, 'not the fast way: %s', answer.reason)
        missing = [belief for belief in beliefs if not results.has(belief)]
        return self._pool.plan(space, missing, limits, results.record)

    def close(self) -> None:
        """End every planning process at once; a call of `plan` in another thread is cancelled."""
        self._closed.set()
        with self._busy:
            self._pool.close()
            if self._fast:
                self._fast.close()

    def __enter__(self) -> 'Planner':
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


class _Results:
    """Results for the beliefs asked about, as they come in: those worth keeping go to `known`.

    `failed` are the beliefs at which the engine failed.
    """

    def __init__(
        self,
        known: dict[Belief, Attempt],
        asked: Iterable[Belief],
        found: Callable[[Belief, BeliefPlans], None] | None,
    ) -> None:
        self._known = known
        self._unknown: dict[Belief, BeliefPlans] = {}
        self._found = found
        self.failed: set[Belief] = set()
        self.last_reason = ''
        for belief in dict.fromkeys(asked):
            if found and belief in known:
                found(belief, known[belief].result)

    def record(self, belief: Belief, attempt: Attempt) -> None:
        """Take in one result; what was known before stays if nothing was found this time."""
        if attempt.result.status is Status.UNKNOWN:
            self._unknown[belief] = attempt.result
        else:
            self._known[belief] = attempt
        (self.failed.add if attempt.crashed else self.failed.discard)(belief)
        self.last_reason = attempt.result.reason
        if self._found:
            self._found(belief, self.get(belief))

    def has(self, belief: Belief) -> bool:
        """Say whether there is a result, and more time would not better it."""
        known = self._known.get(belief)
        return belief in self._unknown or (known is not None and known.lasting)

    def get(self, belief: Belief) -> BeliefPlans:
        """Return the belief's result."""
        known = self._known.get(belief)
        return known.result if known else self._unknown.get(belief, _LATE)


def _require_inside(space: BeliefSpace, beliefs: Sequence[Belief]) -> None:
    facts = frozenset(space.uncertain_facts)
    for belief in beliefs:
        if not 0 <= belief.goal < len(space.goals):
            raise ValueError(f'the space has no goal {belief.goal}, only {len(space.goals)}')
        if not belief.true_facts <= facts:
            raise ValueError(f'not uncertain in the space: {sorted(belief.true_facts - facts)}')
