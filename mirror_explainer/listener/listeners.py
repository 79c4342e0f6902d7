"""Two listeners by name: `open`, and `planner`, who is the paper's (method, section 1)."""

from dataclasses import dataclass, replace


@dataclass(frozen=True)
class Listener:
    """What a listener allows for, and what they ask.

    `unforeseen` (μ) is the probability that the robot goes about its goal in a way that they
    cannot foresee; `partial_goals` (ω) the share of that for goals that lack one part of what
    they have in mind; `other_ends` (δ) how unlikely an end is on a way that is not for it.
    `interest_in_facts` (λ_f) and `interest_in_way` (λ_w) weigh what the doubt counts besides
    the goal. A sentence that brings no more than `min_gain` nats is a filler; None: exactly
    as many sentences as asked for.
    """

    kind: str = 'open'
    unforeseen: float = 0.5
    partial_goals: float = 0.5
    other_ends: float = 0.05
    interest_in_facts: float = 0.05
    interest_in_way: float = 0.0
    min_gain: float | None = 0.02

    @property
    def is_open(self) -> bool:
        """Whether what a way contains tells this listener, not how long it is."""
        return self.kind == 'open'


OPEN = Listener()
PLANNER = Listener('planner', 0.0, 0.0, 1.0, 1.0, 1.0, None)
LISTENERS = {'open': OPEN, 'planner': PLANNER}


def chosen(own: Listener, kind: str, min_gain: float = -1.0) -> Listener:
    """Return the user model's `own` listener, or that of another kind with this kind's numbers.

    A `min_gain` from 0 up takes the place of the listener's.
    """
    listener = LISTENERS[kind] if kind else own
    return replace(listener, min_gain=min_gain) if min_gain >= 0.0 else listener
