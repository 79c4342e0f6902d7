"""Run the searches that nothing spares, a few at a time, each within its time."""

import heapq
import itertools
import selectors
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from mirror_explainer.errors import PlanningError
from mirror_explainer.planning.beliefs import Belief, Status
from mirror_explainer.planning.downward.program import Outcome, Search
from mirror_explainer.planning.downward.subject import Finding, Subject, Subjects
from mirror_explainer.planning.messages import Ask, Attempt, unknown

# When so many searches have failed, and none has not, no more are tried.
_MOST_FAILURES = 10

Report = Callable[[Sequence[Belief], Attempt], None]


@dataclass(eq=False)
class _Job:
    """A subject to search for.

    `text` is the search's input, `left` the configurations still to try. `crashed` says
    that a search failed that was no first try.
    """

    subjects: Subjects
    subject: Subject
    text: bytes = b''
    left: tuple[str, ...] = ()
    crashed: bool = False


class Searches:
    """The searches of one call: `calls` many, `searching` the seconds spent on their processes.

    That is to start them, and to wait while there is nothing else to do. Those for the first
    belief come first, then those for the others in the order of their goals.
    """

    def __init__(self, ask: Ask, report: Report) -> None:
        self._ask = ask
        self._report = report
        self._end = time.monotonic() + ask.seconds
        goals = dict.fromkeys(belief.goal for belief in ask.beliefs)
        self._rank = {goal: rank for rank, goal in enumerate(goals)}
        self._numbers = itertools.count()
        self._queue: list[tuple[int, int, _Job]] = []
        self._running: dict[Search, _Job] = {}
        self._failures = 0
        self._all_failed = True
        self.calls = 0
        self.searching = 0.0

    def run(self, all_subjects: Sequence[Subjects], other: int, heard: Callable[[], bool]) -> bool:
        """Plan for all subjects, until the deadline, or `heard` once `other` is readable.

        Returns whether neither came before the end. Raises PlanningError when the
        program fails at whatever it is asked.
        """
        with selectors.DefaultSelector() as selector:
            selector.register(other, selectors.EVENT_READ)
            try:
                while time.monotonic() < self._end:
                    for subjects in all_subjects:
                        while subjects.ready:
                            self._begin(_Job(subjects, subjects.ready.popleft()))
                    self._fill(selector)
                    if any(subjects.ready for subjects in all_subjects):
                        continue
                    if not self._running:
                        return True
                    if self._wait(selector, other) and heard():
                        return False
            finally:
                for search in self._running:
                    search.kill()
        return False

    def _begin(self, job: _Job) -> None:
        """Settle a subject if that takes no search, and queue one otherwise."""
        finding = job.subjects.known(job.subject)
        if finding is not None:
            self._settle(job, finding)
        elif job.subject.hopeless:
            self._settle(job, None, self._too_long())
        else:
            self._queue_up(job, next(self._numbers))

    def _queue_up(self, job: _Job, number: int) -> None:
        members = job.subject.members
        rank = -1 if self._ask.beliefs[0] in members else self._rank[members[0].goal]
        heapq.heappush(self._queue, (rank, number, job))

    def _fill(self, selector: selectors.BaseSelector) -> None:
        while self._queue and len(self._running) < self._ask.workers:
            _, _, job = heapq.heappop(self._queue)
            if not job.text:
                finding = job.subjects.known(job.subject)  # by what was found while it waited
                if finding is not None:
                    self._settle(job, finding)
                    continue
                job.text, job.left = job.subjects.search_input(job.subject)
            began = time.monotonic()
            try:
                search = Search(
                    self._ask.downward, job.text, job.left[0], self._ask.planning_timeout
                )
            except OSError as error:
                reason = f'{self._ask.downward} does not start: {error.strerror}'
                self._ended(job, Outcome(Status.UNKNOWN, reason=reason, crashed=True))
                continue
            self.searching += time.monotonic() - began
            self.calls += 1
            self._running[search] = job
            selector.register(search, selectors.EVENT_READ)

    def _wait(self, selector: selectors.BaseSelector, other: int) -> bool:
        """Wait for something to happen; return whether it is in `other`."""
        began = time.monotonic()
        first_end = min(self._limit(search) for search in self._running)
        ready = {key.fileobj for key, _ in selector.select(max(0.0, first_end - began))}
        now = time.monotonic()
        self.searching += now - began
        for search, job in list(self._running.items()):
            if search in ready:
                self._leave(selector, search)
                self._ended(job, search.outcome())
            elif now >= self._limit(search):
                self._leave(selector, search)
                search.kill()
                self._stopped(job, now)
        return other in ready

    def _limit(self, search: Search) -> float:
        """Return when a search must end."""
        job = self._running[search]
        seconds = self._ask.planning_timeout
        if self._has_next(job):
            seconds = job.subjects.first_try
        return min(search.since + seconds, self._end)

    def _has_next(self, job: _Job) -> bool:
        """Say whether a job's search is a first try, to be followed by another."""
        patient = self._ask.planning_timeout > job.subjects.first_try
        return len(job.left) > 1 and patient

    def _leave(self, selector: selectors.BaseSelector, search: Search) -> None:
        selector.unregister(search)
        del self._running[search]

    def _stopped(self, job: _Job, now: float) -> None:
        if now >= self._end:
            return
        if self._has_next(job):
            self._next(job)
        else:
            job.subject.hopeless = True
            self._settle(job, None, self._too_long())

    def _next(self, job: _Job) -> None:
        job.left = job.left[1:]
        self._queue_up(job, -next(self._numbers))

    def _ended(self, job: _Job, outcome: Outcome) -> None:
        plan: tuple[str, ...] | None = None
        if outcome.status is Status.SOLVED:
            plan = job.subjects.checked(job.subject, outcome.actions)
            if plan is None:
                reason = 'downward gave a wrong plan'
                outcome = Outcome(Status.UNKNOWN, reason=reason, crashed=True)
        self._count(outcome)
        if outcome.status is not Status.UNKNOWN:
            self._settle(job, Finding(plan))
        elif outcome.crashed and self._has_next(job):
            self._next(job)
        elif outcome.crashed and not job.crashed:
            job.crashed = True
            self._queue_up(job, -next(self._numbers))
        else:
            job.subject.hopeless = not outcome.crashed
            self._settle(job, None, unknown(outcome.reason, outcome.crashed))

    def _count(self, outcome: Outcome) -> None:
        """Count failures; raise PlanningError when that is all there is."""
        self._failures += outcome.crashed
        self._all_failed &= outcome.crashed
        if self._all_failed and self._failures >= _MOST_FAILURES:
            raise PlanningError(
                f'the planner fails at whatever it is asked: {outcome.reason}',
                cure=f'See what is wrong with {self._ask.downward}, or name another planner.',
            )

    def _settle(self, job: _Job, finding: Finding | None, failure: Attempt | None = None) -> None:
        """Report what was found, or what the failure leaves."""
        job.subjects.settle(job.subject, finding)
        result = job.subjects.result(job.subject, finding)
        if result is not None:
            kept = not (job.subjects.provisional and result.cut) and not (
                failure and failure.crashed
            )
            attempt = Attempt(result, lasting=kept)
        elif failure is not None and job.subjects.required:
            attempt = failure
        else:
            return
        self._report(job.subject.members, attempt)

    def _too_long(self) -> Attempt:
        return unknown(f'no optimal plan within {self._ask.planning_timeout:g} s')
