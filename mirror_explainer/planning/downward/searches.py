"""Run the searches that nothing spares, a few at a time, each within its processor time."""

import heapq
import itertools
import math
import selectors
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

from mirror_explainer.errors import PlanningError
from mirror_explainer.planning.beliefs import Belief, Status
from mirror_explainer.planning.downward.portfolio import FIRST_TRY, Try, next_try
from mirror_explainer.planning.downward.program import Outcome, Program, Search
from mirror_explainer.planning.downward.subject import Finding, SearchInput, Subject, Subjects
from mirror_explainer.planning.messages import Ask, Attempt, unknown

# When so many searches have failed, and none has not, no more are tried.
_MOST_FAILURES = 10

# A search that takes so many times as long as it works, and some seconds more, hangs.
_PATIENCE, _MORE_PATIENCE = 20.0, 10.0

# What takes long under more facts is tried for so many seconds at a time under fewer.
_HOPELESS = 0.1

# The shortest time between two looks at how much a search has worked.
_LOOK = 0.005

Report = Callable[[Sequence[Belief], Attempt], None]


@dataclass(eq=False)
class _Job:
    """A subject to search for, what tasks like it taught, and what became of it so far.

    `tried` has the longest time that each search was tried for, `now` is the one to come or
    running; so many seconds are `left`. `reason` says what else than time was wanting; `scout`,
    that it is the first of its run.
    """

    subjects: Subjects
    subject: Subject
    left: float
    lesson: Try | None = None
    input: SearchInput | None = None
    now: Try | None = None
    tried: dict[str, float] = field(default_factory=dict)
    reason: str = ''
    crashed: bool = False
    scout: bool = False

    def next_try(self) -> bool:
        """Decide on the next search, and say whether there is one."""
        if self.input is not None:
            self.now = next_try(self.input.members, self.lesson, self.tried, self.left)
        if self.now is not None and self.subject.hopeless and not self.tried:
            self.now = replace(self.now, seconds=min(self.now.seconds, _HOPELESS))
        return self.now is not None


class Searches:
    """The searches of one call: `calls` many, `searching` the seconds spent on their processes.

    That is to start them, and to wait while there is nothing else to do; `worked` is their own
    processor time. Short tries come before
    longer ones; among these, those for the first belief, then the others in the order of
    their goals. What a search taught is made use of where its end is waited for: at the tasks
    below it, and at all that begin after the first task's short tries, which nothing overtakes. So
    it does not matter which of the searches that run side by side ends first.
    """

    def __init__(self, ask: Ask, report: Report) -> None:
        self._first = ask.beliefs[0]
        self._workers = ask.resources.workers
        self._timeout = ask.resources.planning_timeout
        self._report = report
        self._end = time.monotonic() + ask.seconds
        goals = dict.fromkeys(belief.goal for belief in ask.beliefs)
        self._rank = {goal: rank for rank, goal in enumerate(goals)}
        self._numbers = itertools.count()
        self._queue: list[tuple[float, int, int, _Job]] = []
        self._running: dict[Search, _Job] = {}
        self._begun = 0
        self._scouting = True
        self._lesson: Try | None = None
        self._failures = 0
        self._all_failed = True
        self.calls = 0
        self.searching = 0.0
        self.worked = 0.0

    def run(
        self,
        all_subjects: Sequence[Subjects],
        program: Program,
        other: int,
        heard: Callable[[], bool],
    ) -> bool:
        """Plan for all subjects, until the deadline, or `heard` once `other` is readable.

        It is `program` that searches. Returns whether neither came before the end. Raises
        PlanningError when all it was ever asked, by another program too, failed.
        """
        self._program = program
        self._begun, self._scouting, self._lesson = 0, True, None
        with selectors.DefaultSelector() as selector:
            selector.register(other, selectors.EVENT_READ)
            try:
                while time.monotonic() < self._end:
                    waiting = [subjects for subjects in all_subjects if subjects.ready]
                    if waiting:
                        subjects = min(waiting, key=lambda each: self._place(each.ready[0]))
                        self._begin(_Job(subjects, subjects.ready.popleft(), self._timeout))
                    self._fill(selector)
                    if self._running:
                        if self._wait(selector, other, 0.0 if waiting else math.inf) and heard():
                            return False
                    elif not any(subjects.ready for subjects in all_subjects):
                        return True
            finally:
                for search in self._running:
                    search.kill()
        return False

    def _begin(self, job: _Job) -> None:
        """Settle a subject if that takes no search, and queue one otherwise."""
        finding = job.subjects.known(job.subject)
        if finding is not None:
            self._settle(job, finding)
        else:
            self._queue_up(job)

    def _queue_up(self, job: _Job) -> None:
        seconds = job.now.seconds if job.now else 0.0
        if job.scout and seconds > FIRST_TRY:
            self._scouting = False
        if self._scouting and job.now:
            seconds = -1.0
        place = self._place(job.subject)
        heapq.heappush(self._queue, (seconds, place, next(self._numbers), job))

    def _place(self, subject: Subject) -> int:
        """Return where a task comes among others: first the first belief's, then by goals."""
        members = subject.members
        return -1 if self._first in members else self._rank[members[0].goal]

    def _fill(self, selector: selectors.BaseSelector) -> None:
        while self._queue and len(self._running) < self._workers:
            *_, job = self._queue[0]
            if job.input is None:
                if self._scouting and self._begun >= self._workers:
                    return
                alike = job.subject, *job.subject.parents
                lessons = [task.lesson for task in alike if task.lesson]
                job.input = job.subjects.search_input(job.subject)
                default = self._lesson or job.input.lesson
                job.lesson = max(lessons, key=lambda each: each.seconds, default=default)
                job.next_try()
                job.scout = not self._begun
                self._begun += 1
            heapq.heappop(self._queue)
            assert job.now is not None, 'it is queued for it'
            began = time.monotonic()
            try:
                search = Search(
                    self._program, job.input.text, job.now.configuration, job.now.seconds
                )
            except OSError as error:
                reason = f'{self._program.path} does not start: {error.strerror}'
                self._ended(job, Outcome(Status.UNKNOWN, reason=reason, crashed=True))
                continue
            self.searching += time.monotonic() - began
            self.calls += 1
            self._running[search] = job
            selector.register(search, selectors.EVENT_READ)

    def _wait(self, selector: selectors.BaseSelector, other: int, most: float) -> bool:
        """Wait for something to happen, so long at most; return whether it is in `other`."""
        began = time.monotonic()
        # A search cannot work for longer than it runs.
        spare = min(search.seconds - search.used() for search in self._running)
        patience = min(max(spare, _LOOK), self._end - began, most)
        ready = {key.fileobj for key, _ in selector.select(max(0.0, patience))}
        now = time.monotonic()
        self.searching += now - began
        for search, job in list(self._running.items()):
            if search in ready:
                self._leave(selector, search)
                self._ended(job, search.outcome())
            elif search.used() >= search.seconds:
                self._leave(selector, search)
                search.kill()
                self._next(job, search.seconds)
            elif now - search.since > _PATIENCE * search.seconds + _MORE_PATIENCE:
                self._leave(selector, search)
                search.kill()
                reason = f'{self._program.name} hangs'
                self._ended(job, Outcome(Status.UNKNOWN, reason=reason, crashed=True))
        return other in ready

    def _leave(self, selector: selectors.BaseSelector, search: Search) -> None:
        self.worked += search.used()
        selector.unregister(search)
        del self._running[search]

    def _next(self, job: _Job, tried: float, crashed: bool = False) -> None:
        """Go on after a search that was tried for so long, if there is another."""
        assert job.now is not None, 'it was tried'
        job.tried[job.now.configuration] = tried
        job.left -= job.now.seconds
        if job.next_try() and not (job.subject.hopeless and job.now.seconds > _HOPELESS):
            self._queue_up(job)
        else:
            job.subject.hopeless = not crashed
            too_long = f'no optimal plan within {self._timeout:g} s'
            self._settle(job, None, unknown(job.reason or too_long, crashed))

    def _ended(self, job: _Job, outcome: Outcome) -> None:
        finding = None
        if outcome.status is not Status.UNKNOWN:
            finding = job.subjects.checked(job.subject, outcome.plans)
            if finding is None:
                reason = f'{self._program.name} gave a wrong plan'
                outcome = Outcome(Status.UNKNOWN, reason=reason, crashed=True)
        self._count(outcome)
        assert job.input and job.now, 'it was tried'
        if finding is not None:
            job.subject.lesson = Try(job.now.configuration, outcome.seconds)
            self._settle(job, finding)
        elif outcome.crashed and not job.crashed:
            job.crashed = True
            self._queue_up(job)
        else:
            job.reason = outcome.reason
            self._next(job, math.inf, outcome.crashed)

    def _count(self, outcome: Outcome) -> None:
        """Count failures; raise PlanningError when that is all there is."""
        self._failures += outcome.crashed
        self._all_failed &= outcome.crashed
        if self._all_failed and self._failures >= _MOST_FAILURES:
            raise PlanningError(
                f'the planner fails at whatever it is asked: {outcome.reason}',
                cure=f'See what is wrong with {self._program.path}, or name another planner.',
            )

    def _settle(self, job: _Job, finding: Finding | None, failure: Attempt | None = None) -> None:
        """Report what was found, or what the failure leaves."""
        if job.scout and self._scouting:
            self._scouting, self._lesson = False, job.subject.lesson
        result = job.subjects.settle(job.subject, finding)
        if result is not None:
            lasting = not (job.subjects.provisional and result.cut)
            attempt = Attempt(result, lasting=lasting)
            if failure is not None and failure.crashed:
                result = replace(result, reason=failure.result.reason)
                attempt = Attempt(result, crashed=True, lasting=False)
        elif failure is not None:
            attempt = failure
        else:
            return
        self._report(job.subject.members, attempt)
