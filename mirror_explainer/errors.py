"""The package's errors: few, named, and worded for the person who must act on them."""


class InputError(ValueError):
    """Something given to the explainer is wrong: a text, a file, a message.

    `source` names the file or topic, `line` is counted from 1 (None where no
    single line is to blame), and `reason` is one plain sentence.
    """

    def __init__(self, source: str, reason: str, line: int | None = None) -> None:
        reason = ' '.join(reason.split())  # one line, whatever the texts quoted in it
        self.source = source
        self.reason = reason
        self.line = line
        place = source if line is None else f'{source}, line {line}'
        super().__init__(f'{place}: {reason}')


class NoPlanError(InputError):
    """The robot has no current plan, and its goal is not reached either."""


class PlanningError(RuntimeError):
    """Planning as a whole failed: no such engine, unsupported problem, no answer in time."""


class Cancelled(Exception):
    """The work was stopped on request: newer input came, or the program ends."""
