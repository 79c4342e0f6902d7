"""A robot that sends one update after another, and the check of what callers heard meanwhile."""

import bisect
import time
from collections.abc import Iterable
from dataclasses import dataclass, field

from crowd import Answer, Calls
from parcels import RightAnswers, number_in, plan, problem
from patience import PATIENCE
from rclpy.duration import Duration
from ros_peer import LATCHED, Peer
from std_msgs.msg import String

from mirror_explainer.listener.phrases import Phrases
from mirror_explainer.node.updates import DOUBTFUL_SECONDS

NOT_READY = Phrases.not_ready


@dataclass(frozen=True)
class Times:
    """When each update was on its way, by number from 0, in seconds of time.monotonic().

    `published` has the time before each was published, `heard` the time after which
    the node's middleware was known to have it.
    """

    published: list[float] = field(default_factory=list)
    heard: list[float] = field(default_factory=list)


class RobotStream:
    """Publishes numbered updates: a new problem, and its plan."""

    def __init__(self, peer: Peer) -> None:
        self._problem = peer.node.create_publisher(String, 'problem', LATCHED)
        self._plan = peer.node.create_publisher(String, 'plan', LATCHED)
        self.times = Times()

    @property
    def newest(self) -> int:
        """The number of the newest update."""
        return len(self.times.published) - 1

    def send(self) -> None:
        """Publish the next update, and wait until the node's middleware has it."""
        number = len(self.times.published)
        texts = problem(number), plan(number)
        self.times.published.append(time.monotonic())
        for publisher, text in zip((self._problem, self._plan), texts, strict=True):
            publisher.publish(String(data=text))
        for publisher in (self._problem, self._plan):
            assert publisher.wait_for_all_acked(Duration(seconds=PATIENCE)), 'the node is deaf'
        self.times.heard.append(time.monotonic())

    def send_many(self, count: int, rate: float) -> float:
        """Publish so many updates, `rate` a second; return the rate that came out."""
        began = time.monotonic()
        for index in range(count):
            time.sleep(max(0.0, began + index / rate - time.monotonic()))
            self.send()
        return count / max(time.monotonic() - began, 1 / rate)


@dataclass(frozen=True)
class Verdict:
    """How many calls got what. Only the first three are no faults.

    `right`: the right answer to an update that was the robot's newest at some
    time during the call. `not_ready`: a refusal that says so. `under_way`: another refusal, while
    the middleware took longer with an update than the node doubts that its halves do not fit.
    `stale`: the answer to an update when a newer one had been heard before the call began.
    `wrong`: anything else. `lost`: no answer at all.
    """

    right: int = 0
    not_ready: int = 0
    under_way: int = 0
    stale: int = 0
    wrong: int = 0
    lost: int = 0
    examples: tuple[str, ...] = ()

    @property
    def calls(self) -> int:
        """How many calls there were."""
        return self.right + self.not_ready + self.under_way + self.faults

    @property
    def faults(self) -> int:
        """How many calls got what no call may get."""
        return self.stale + self.wrong + self.lost


def judge(calls: Calls, times: Times, right: RightAnswers) -> Verdict:
    """Check each answer against the updates that it could have been made from."""
    kinds = ('right', 'not_ready', 'under_way', 'stale', 'wrong')
    found: dict[str, list[Answer]] = {kind: [] for kind in kinds}
    for answer in calls.answers:
        found[_kind(answer, times, right)].append(answer)
    return Verdict(
        **{kind: len(answers) for kind, answers in found.items()},
        lost=calls.lost,
        examples=tuple(a.message for a in _firsts(found['stale'], found['wrong'])),
    )


def _kind(answer: Answer, times: Times, right: RightAnswers) -> str:
    if not answer.success:
        if answer.message == NOT_READY:
            return 'not_ready'
        return 'under_way' if _is_under_way(answer, times) else 'wrong'
    number = number_in(answer.message)
    surely_heard = bisect.bisect_right(times.heard, answer.began) - 1
    newest = bisect.bisect_right(times.published, answer.ended) - 1
    if number is None or number > newest or not right.are(answer.message, number):
        return 'wrong'
    return 'right' if number >= surely_heard else 'stale'


def _is_under_way(answer: Answer, times: Times) -> bool:
    """Say whether an update was for too long on its way at some time during the call."""
    return any(
        published < answer.ended and heard > answer.began
        for published, heard in zip(times.published, times.heard, strict=False)
        if heard - published > DOUBTFUL_SECONDS
    )


def _firsts(*kinds: list[Answer]) -> Iterable[Answer]:
    return (answer for answers in kinds for answer in answers[:2])
