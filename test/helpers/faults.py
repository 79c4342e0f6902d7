"""Faults as they are reported: what the caller hears, what diagnostics say, how soon it is good.

`pytest test/test_faults_*.py --fault-table FILE` writes a Markdown table of them.
"""

import json
import re
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from patience import eventually
from ros_peer import Peer, last_diagnostic

_HEAD = """\
| fault | what the caller hears | diagnostics | good again after |
|:--|:--|:--|--:|
"""


@dataclass
class FaultTable:
    """The faults of a run, in the order in which they were injected."""

    rows: list[str] = field(default_factory=list)

    def add(self, fault: str, heard: str, diagnosed: str, seconds: float | None) -> None:
        """Report a fault; `seconds` is None where answers stay good all along."""
        again = 'always good' if seconds is None else f'{seconds:.1f} s'
        row = f'| {fault} | {heard} | {diagnosed} | {again} |'
        self.rows.append(re.sub(r'/\S*/pytest-\d+/', '…/', row))

    def write(self, path: Path) -> None:
        """Write the table as Markdown."""
        path.write_text(_HEAD + ''.join(f'{row}\n' for row in self.rows))


LEVELS = {b'\0': 'OK', b'\1': 'WARN', b'\2': 'ERROR'}


def diagnosed(peer: Peer, message: str) -> str:
    """Wait until the diagnostics have the message; return their level."""
    eventually(
        lambda: message in last_diagnostic(peer)['message'],
        f'diagnostics with "{message}"',
    )
    return LEVELS[bytes(last_diagnostic(peer)['level'])]


def injected(
    table: FaultTable,
    peer: Peer,
    fault: str,
    inject: Callable[[], object],
    words: str,
    mend: Callable[[], object],
) -> tuple[str, str]:
    """Inject a fault until a call fails with these words, and mend it until one succeeds.

    Returns what was heard: the failure, and the answer afterwards.
    """
    inject()
    failure = peer.failure(words)
    level = diagnosed(peer, failure)
    assert level == 'ERROR', failure
    mend()
    mended = time.monotonic()
    answer = peer.answer()
    table.add(fault, f'"{failure}"', level, time.monotonic() - mended)
    return failure, answer


def answered_without(
    table: FaultTable,
    peer: Peer,
    fault: str,
    inject: Callable[[], object],
    words: str,
    mend: Callable[[], object],
) -> tuple[str, str]:
    """Inject a fault of the planner until diagnostics have these words, and mend it.

    Returns what was heard: the answer that was made without planning, and the complete one
    afterwards.
    """
    eventually(lambda: words not in last_diagnostic(peer)['message'], 'the end of a fault before')
    inject()
    level = diagnosed(peer, words)
    reason = last_diagnostic(peer)['message']
    assert level == 'ERROR', reason
    reports = peer.hear('mirror_explainer/explanation')

    def answer(complete: bool) -> str:
        heard = peer.answer()
        eventually(lambda: reports and json.loads(reports[-1])['spoken'] == heard, 'the report')
        return heard if json.loads(reports[-1])['complete'] is complete else ''

    without = answer(complete=False)
    warning = f'answered without planning: {reason}'
    eventually(lambda: warning in last_diagnostic(peer).get('warnings', ''), 'the warning')
    mend()
    mended = time.monotonic()
    after = eventually(lambda: answer(complete=True), 'a complete answer')
    seconds = time.monotonic() - mended
    table.add(fault, 'the answer, made without planning', f'{level}: {reason}', seconds)
    return without, after
