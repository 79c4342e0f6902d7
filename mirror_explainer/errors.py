"""The package's errors: few, named, and worded for the person who must act on them."""


class InputError(ValueError):
    """Something given to the explainer is wrong: a text, a file, a message.

    `source` names the file or topic, `line` is counted from 1 (None where no
    single line is to blame), and `reason` is one plain sentence. `cure` says what
    to do about it, where the reason does not make that plain.
    """

    def __init__(
        self, source: str, reason: str, line: int | None = None, *, cure: str = ''
    ) -> None:
        reason = ' '.join(reason.split())  # one line, whatever the texts quoted in it
        self.source = source
        self.reason = reason
        self.line = line
        self.cure = cure
        place = source if line is None else f'{source}, line {line}'
        super().__init__(f'{place}: {reason}')


class NoPlanError(InputError):
    """The robot has no current plan, and its goal is not reached either."""


class PlanningError(RuntimeError):
    """Planning as a whole failed: no such engine, unsupported problem, no answer in time.

    `cure` says what to do about it, where the reason does not.
    """

    def __init__(self, reason: str, *, cure: str = '') -> None:
        self.cure = cure
        super().__init__(reason)


class Cancelled(Exception):
    """The work was stopped on request: newer input came, or the program ends."""


def told(error: Exception) -> str:
    """Return an error as a person at a terminal is told it, with its cure if it has one."""
    return with_cure(str(error), getattr(error, 'cure', ''))


def with_cure(message: str, cure: str) -> str:
    """Return one line that says what is wrong and what to do about it."""
    if not cure:
        return message
    return f'{message}{"" if message.endswith(("?", ".")) else "."} {cure}'
