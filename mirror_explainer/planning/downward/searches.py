"""Run the searches that nothing spares, a few at a time, each within its time.

When an optimal search runs out of time, a plan that stands in is better than
none: one known from another belief, or one that a quick search finds.
"""

import selectors
import time
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from mirror_explainer.errors import PlanningError
from mirror_explainer.planning.beliefs import Belief, Status
from mirror_explainer.planning.downward.program import OPTIMAL_AXIOMS, QUICK, Outcome, Search
from mirror_explainer.planning.downward.subject import Finding, Subject, Subjects
from mirror_explainer.planning.messages import Ask, Attempt, unknown

# Before the deadline, this share of the time, and so many seconds at most, are for stand-ins.
_RESERVE = 0.25
_LONGEST_RESERVE = 5.0

_NEAR = 'the deadline was near'

# When so many searches have failed, and none has not, no more are tried.
_MOST_FAILURES = 10

Report = Callable[[Sequence[Belief], Attempt], None]


@dataclass(eq=False)
class _Job:
    """What is searched for a subject: an optimal plan, or any because of `reason`.

    `text` is the search's input, `left` the optimal configurations still to try.
    `proves` says whether a quick search that ends without a plan proves there is
    none: not with axioms. `crashed` says that a search failed that was no first try.
    """

    subjects: Subjects
    subject: Subject
    reason: str = ''
    text: bytes = b''
    left: tuple[str, ...] = ()
    proves: bool = True
    crashed: bool = False


class Searches:
    """The searches of one call: `calls` many, `searching` the seconds spent on their processes.

    That is to start them, and to wait while there is nothing else to do.
    """

    def __init__(self, ask: Ask, report: Report) -> None:
        self._ask = ask
        self._report = report
        self._end = time.monotonic() + ask.seconds
        self._hurry = self._end - min(_RESERVE * ask.seconds, _LONGEST_RESERVE)
        self._queue: deque[_Job] = deque()
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
            self._begin_stand_in(job, self._too_long())
        else:
            self._queue.append(job)

    def _begin_stand_in(self, job: _Job, reason: str) -> None:
        job.reason = reason
        plan = job.subjects.stand_in(job.subject)
        if plan is not None:
            self._settle(job, Finding(plan, optimal=False))
        else:
            self._queue.appendleft(job)

    def _fill(self, selector: selectors.BaseSelector) -> None:
        while self._queue and len(self._running) < self._ask.workers:
            job = self._queue.popleft()
            if not job.reason and time.monotonic() > self._hurry:
                self._begin_stand_in(job, _NEAR)
                continue
            if not job.text:
                finding = job.subjects.known(job.subject)  # by what was found while it waited
                if finding is not None:
                    self._settle(job, finding)
                    continue
                job.text, job.left = job.subjects.search_input(job.subject)
                job.proves = job.left != OPTIMAL_AXIOMS
            began = time.monotonic()
            configuration = QUICK if job.reason else job.left[0]
            try:
                search = Search(
                    self._ask.downward, job.text, configuration, self._ask.planning_timeout
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
        return min(search.since + seconds, self._end if job.reason else self._hurry)

    def _has_next(self, job: _Job) -> bool:
        """Say whether a job's search is a first try, to be followed by another."""
        patient = self._ask.planning_timeout > job.subjects.first_try
        return not job.reason and len(job.left) > 1 and patient

    def _leave(self, selector: selectors.BaseSelector, search: Search) -> None:
        selector.unregister(search)
        del self._running[search]

    def _stopped(self, job: _Job, now: float) -> None:
        if now >= self._end:
            return
        if job.reason:
            self._give_up(job, unknown(f'no plan within {self._ask.planning_timeout:g} s'))
        elif now >= self._hurry:
            self._begin_stand_in(job, _NEAR)
        elif self._has_next(job):
            self._next(job)
        else:
            job.subject.hopeless = True
            self._begin_stand_in(job, self._too_long())

    def _next(self, job: _Job) -> None:
        job.left = job.left[1:]
        self._queue.appendleft(job)

    def _ended(self, job: _Job, outcome: Outcome) -> None:
        plan: tuple[str, ...] | None = None
        if outcome.status is Status.SOLVED:
            plan = job.subjects.checked(job.subject, outcome.actions)
            if plan is None:
                reason = 'downward gave a wrong plan'
                outcome = Outcome(Status.UNKNOWN, reason=reason, crashed=True)
        self._count(outcome)
        if outcome.status is Status.UNSOLVABLE and job.reason and not job.proves:
            outcome = Outcome(Status.UNKNOWN, reason='a quick search found no plan')
        if outcome.status is not Status.UNKNOWN:
            self._settle(job, Finding(plan, optimal=not job.reason))
        elif outcome.crashed and self._has_next(job):
            self._next(job)
        elif outcome.crashed and not job.crashed:
            job.crashed = True
            self._queue.appendleft(job)
        elif outcome.crashed or job.reason:
            self._give_up(job, unknown(outcome.reason, outcome.crashed))
        else:
            job.subject.hopeless = True
            self._begin_stand_in(job, outcome.reason)

    def _count(self, outcome: Outcome) -> None:
        """Count failures; raise PlanningError when that is all there is."""
        self._failures += outcome.crashed
        self._all_failed &= outcome.crashed
        if self._all_failed and self._failures >= _MOST_FAILURES:
            raise PlanningError(
                f'the planner fails at whatever it is asked: {outcome.reason}',
                cure=f'See what is wrong with {self._ask.downward}, or name another planner.',
            )

    def _settle(self, job: _Job, finding: Finding) -> None:
        job.subjects.settle(job.subject, finding)
        reason = '' if finding.optimal else f'a plan that stands in: {job.reason}'
        result = job.subjects.result(job.subject, finding, reason)
        if result is not None:
            provisional = job.subjects.provisional and finding.optimal and finding.plan is not None
            lasting = not provisional and job.reason != _NEAR
            self._report(job.subject.members, Attempt(result, lasting=lasting))

    def _give_up(self, job: _Job, attempt: Attempt) -> None:
        job.subjects.settle(job.subject, None)
        if job.subjects.required:
            self._report(job.subject.members, attempt)
            return
        result = job.subjects.result(job.subject, Finding(None), attempt.result.reason)
        if result is not None:
            self._report(job.subject.members, replace(attempt, result=result, lasting=False))

    def _too_long(self) -> str:
        return f'no optimal plan within {self._ask.planning_timeout:g} s'
