"""What happened to the explainer so far: how updates ended, and how calls were answered."""

import logging
from collections.abc import Iterator
from dataclasses import dataclass, field, replace

from mirror_explainer.errors import with_cure
from mirror_explainer.node.moment import Moment
from mirror_explainer.node.readiness import Phase, Readiness


@dataclass(frozen=True)
class History:
    """What the present readiness alone does not tell.

    `outcome` is how the last update ended, and `since` when updates began to end in
    that phase. `last_call` is how many seconds the last call took.
    """

    outcome: Readiness = field(
        default_factory=lambda: Readiness(Phase.WAITING, 'waiting for inputs')
    )
    since: Moment = field(default_factory=Moment)
    updates: int = 0
    last_error: Readiness | None = None
    calls_answered: int = 0
    calls_failed: int = 0
    last_call: float | None = None

    def after_update(self, outcome: Readiness) -> 'History':
        """Return the history with one more update that ended so."""
        after = replace(self, outcome=outcome, updates=self.updates + 1)
        if outcome.phase is not self.outcome.phase:
            after = replace(after, since=outcome.since)
        if outcome.phase is Phase.ERROR:
            after = replace(after, last_error=outcome)
        return after

    def after_call(self, answered: bool, seconds: float) -> 'History':
        """Return the history with one more call."""
        return replace(
            self,
            calls_answered=self.calls_answered + answered,
            calls_failed=self.calls_failed + (not answered),
            last_call=seconds,
        )


def news(before: Readiness, now: Readiness) -> Iterator[tuple[int, str]]:
    """Yield what a log should say of an update, as levels and lines.

    A robot may replan ten times a second: that it still can be explained is no news.
    """
    preparation = now.preparation
    if preparation is None or now.phase is Phase.ERROR:
        level = logging.ERROR if now.phase is Phase.ERROR else logging.INFO
        yield level, with_cure(now.message, now.cure)
    if preparation is None:
        return
    known = before.preparation.warnings if before.preparation else ()
    for warning in preparation.warnings:
        if warning not in known:
            yield logging.WARNING, warning
    if now.phase is Phase.ERROR:
        return
    yield (
        logging.INFO if before.preparation is None else logging.DEBUG,
        f'ready: a plan of {len(preparation.model.sentences)} actions',
    )
    yield (
        logging.DEBUG,
        f'{len(preparation.model.hypotheses)} hypotheses, {preparation.planner_calls} planner '
        f'calls in {preparation.seconds.planning:.2f} s',
    )
