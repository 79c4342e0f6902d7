"""How much may come in: what bounds the time and memory that one input can cost."""

from dataclasses import dataclass

from mirror_explainer.errors import InputError
from mirror_explainer.settings import setting


@dataclass(frozen=True)
class InputLimits:
    """The most that is taken of everything. The node has a parameter for each.

    Readers without limits take all: files that their owner reads offline.
    """

    max_message_bytes: int = setting(
        1_000_000, 'bytes of a message, or of a file', least=1000, most=1 << 30
    )
    max_objects: int = setting(2000, 'objects of a problem, with constants', least=1, most=1 << 20)
    max_words: int = setting(
        10_000,
        'words of a domain or problem, initial facts left out',
        least=10,
        most=1 << 30,
    )
    max_plan_length: int = setting(1000, 'actions of a plan', least=1, most=1 << 20)
    max_instances: int = setting(
        30_000,
        'conditions and effects to look at to check a plan',
        least=1,
        most=1 << 30,
    )
    max_goals: int = setting(1000, 'goals of a user model', least=1, most=1 << 20)
    max_uncertain_facts: int = setting(
        100,
        'uncertain facts of a user model, those of one_of included',
        least=0,
        most=10_000,
    )

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
