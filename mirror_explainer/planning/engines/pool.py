"""The general way: any unified-planning engine by name, one call for each belief.

Slow, and the referee of the fast way. The engines run in worker processes
(`engine_worker.py`), which are ended when a time is over or the work is cancelled.
"""

import time
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from multiprocessing.connection import wait
from pathlib import Path

from mirror_explainer.errors import PlanningError
from mirror_explainer.planning.beliefs import Belief, BeliefSpace
from mirror_explainer.planning.limits import TICK, Limits, Resources
from mirror_explainer.planning.messages import Attempt, Done, Refusal, Setup, unknown
from mirror_explainer.planning.processes.worker import Worker

_PROGRAM = Path(__file__).with_name('worker_program.py')

# What a dying worker was at is tried once more, in a new process.
_TRIES = 2


@dataclass
class _Seat:
    """A worker, the space it knows, and since when it is at which belief (None: reading)."""

    worker: Worker
    space: BeliefSpace | None = None
    busy: bool = False
    belief: Belief | None = None
    since: float = 0.0


class EnginePool:
    """Worker processes of one engine; started when first needed, kept between calls."""

    def __init__(self, engine: str, resources: Resources) -> None:
        self._engine = engine
        self._resources = resources
        self._timeout = resources.planning_timeout
        self._seats: list[_Seat] = []

    def plan(
        self,
        space: BeliefSpace,
        beliefs: Sequence[Belief],
        limits: Limits,
        record: Callable[[Belief, Attempt], None],
    ) -> Done:
        """Plan for each belief and record the results as they come, until the limits.

        Returns what it took. Raises Cancelled, InputError for
        texts that cannot be read, and PlanningError for an engine that is not
        there or does not support the problem.
        """
        work = _Work(space, deque(beliefs), record)
        for seat in [seat for seat in self._seats if not seat.worker.alive]:
            self._dismiss(seat)
        try:
            while work.pending or self._busy():
                limits.check()
                if limits.expired:
                    break
                self._hand_out(work)
                self._take_in(work)
        finally:
            for seat in self._busy():
                self._dismiss(seat)
        return Done(work.calls, work.searching, f'one call of {self._engine} a belief')

    def _hand_out(self, work: '_Work') -> None:
        in_hand = sum(seat.belief is not None for seat in self._seats)
        wanted = min(self._resources.workers, in_hand + len(work.pending))
        while len(self._seats) < wanted:
            self._seats.append(_Seat(Worker(_PROGRAM)))
        for seat in self._seats:
            if seat.busy or not work.pending:
                continue
            seat.busy = True
            if seat.space == work.space:
                seat.belief = work.pending.popleft()
                seat.since = time.monotonic()
                seat.worker.send(seat.belief)
                work.calls += 1
            else:
                seat.space = None  # what it knew is gone, also if it refuses the new one
                seat.worker.send(Setup(self._engine, work.space, self._resources))

    def _take_in(self, work: '_Work') -> None:
        busy = self._busy()
        began = time.monotonic()
        ready = wait([seat.worker.connection for seat in busy], TICK)
        if any(seat.belief for seat in busy):
            work.searching += time.monotonic() - began
        for seat in busy:
            if seat.worker.connection in ready:
                self._take_answer(seat, work)
            elif seat.belief and time.monotonic() - seat.since > self._timeout:
                work.record(seat.belief, unknown(f'no plan within {self._timeout:g} s'))
                self._dismiss(seat)

    def _take_answer(self, seat: _Seat, work: '_Work') -> None:
        belief = seat.belief
        try:
            answer = seat.worker.receive()
        except EOFError:
            reason = f'the process of {self._engine} died: {seat.worker.last_words()}'.rstrip(': ')
            self._dismiss(seat)
            work.failures[belief] = work.failures.get(belief, 0) + 1
            if work.failures[belief] < _TRIES:
                work.pending.extendleft([belief] if belief else [])
            elif belief:
                work.record(belief, unknown(reason, crashed=True))
            else:
                raise PlanningError(
                    f'planning does not start: {reason}',
                    cure='Raise planner_memory_limit, or name another engine as the planner.',
                ) from None
            return
        seat.busy = False
        seat.belief = None
        if belief:
            work.record(belief, answer)
        elif isinstance(answer, Refusal):
            raise answer.error()
        else:
            seat.space = work.space

    def _busy(self) -> list[_Seat]:
        return [seat for seat in self._seats if seat.busy]

    def _dismiss(self, seat: _Seat) -> None:
        self._seats.remove(seat)
        seat.worker.kill()

    def close(self) -> None:
        """End every process at once."""
        while self._seats:
            self._seats.pop().worker.kill()


@dataclass
class _Work:
    """One call of `EnginePool.plan`: what is still to do, and what it took so far."""

    space: BeliefSpace
    pending: deque[Belief]
    record: Callable[[Belief, Attempt], None]
    calls: int = 0
    searching: float = 0.0
    failures: dict[Belief | None, int] = field(default_factory=dict)
