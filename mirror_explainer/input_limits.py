"""How much may come in: what bounds the time and memory that one input can cost."""

from dataclasses import dataclass

from mirror_explainer.errors import InputError


@dataclass(frozen=True)
class InputLimits:
    """The most that is taken of everything. The node has a parameter for each.

    Readers without limits take all: files that their owner reads offline.
    """

    max_message_bytes: int = 1_000_000
    max_objects: int = 2000
    max_words: int = 10_000
    max_plan_length: int = 1000
    max_instances: int = 30_000
    max_goals: int = 1000
    max_uncertain_facts: int = 100

    def require(self, limit: str, found: int, what: str, source: str) -> None:
        """Raise InputError if more of something was found than the limit of that name allows."""
        most = getattr(self, limit)
        if found > most:
            raise InputError(
                source,
                f'{what} ({found}) are more than {limit} allows (now {most})',
                cure=f'If the robot needs more, set the parameter {limit} higher.',
            )

    def require_bytes(self, text: str, source: str) -> None:
        """Raise InputError for a text that is too long; at once, however long it is."""
        found = len(text)
        if found <= self.max_message_bytes:
            found = len(text.encode('utf-8', 'replace'))
        self.require('max_message_bytes', found, 'its bytes', source)
