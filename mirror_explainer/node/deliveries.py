"""Messages that come twice, since a topic is heard by two subscriptions."""

from collections import defaultdict, deque

_REMEMBERED = 100  # messages a topic


class Deliveries:
    """Tells the second delivery of a message from a message that says the same again.

    One subscription may be behind the other, and bring what was overtaken after what is newer:
    that one counts again when it comes a second time, for it is what the robot said last.
    """

    def __init__(self) -> None:
        self._sent: defaultdict[str, deque[int]] = defaultdict(lambda: deque(maxlen=_REMEMBERED))

    def take(self, topic: str, sent: int) -> bool:
        """Note a delivery, and say whether it counts; `sent` is its publisher's time, in ns.

        Where a middleware tells no time (0), each does.
        """
        before = self._sent[topic]
        if sent and sent in before and sent <= before[-1]:
            return False
        before.append(sent)
        return True
