"""Streams of bad messages to the real node: it outlives them, and answers none of them.

MIRROR_EXPLAINER_FUZZ sets how many messages are sent, about (250 without).
"""

import os
from collections.abc import Iterator

import pytest

pytest.importorskip('rclpy', reason='needs ROS 2')

from fuzzing import NOISE, damaged
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st
from rclpy.serialization import serialize_message
from ros_peer import (
    DOMAIN,
    PLAN,
    PROBLEM,
    THREE_SENTENCES,
    Peer,
    Process,
    explainer,
    new_namespace,
)
from std_msgs.msg import String

STREAM = 25
STREAMS = -(-int(os.environ.get('MIRROR_EXPLAINER_FUZZ', '250')) // (2 * STREAM))
GOOD = {'domain': DOMAIN, 'problem': PROBLEM, 'plan': PLAN}
WORDS = ['(and', '(not', '(:goal', 'left', 'red_room', '?a', '1e999999999', 'define', '(:init']
MESSAGES = st.sampled_from(sorted(GOOD)).flatmap(
    lambda topic: st.tuples(
        st.just(topic), damaged([GOOD[topic]], WORDS) | NOISE | st.sampled_from([*GOOD.values()])
    )
)

pytestmark = pytest.mark.usefixtures('ros')


@pytest.fixture(scope='module')
def node(ros: None, tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Peer, Process]]:
    """A peer, and the node that hears it."""
    peer = Peer(new_namespace())
    with explainer(peer, tmp_path_factory.mktemp('node')) as process:
        yield peer, process
    peer.close()


def sendable(text: str) -> str:
    """Return what of a text a ROS message can carry."""
    return text.replace('\0', '').encode('utf-8', 'replace').decode()


@settings(
    max_examples=STREAMS,
    phases=[Phase.generate],
    deadline=None,
    derandomize=True,
    database=None,
    suppress_health_check=list(HealthCheck),
)
@given(stream=st.lists(MESSAGES, min_size=STREAM, max_size=3 * STREAM))
def test_a_stream_of_bad_messages_is_outlived_and_never_answered_from(
    node: tuple[Peer, Process], stream: list[tuple[str, str]]
) -> None:
    peer, process = node
    for topic, text in stream:
        peer.publish(topic, sendable(text))
    peer.call()  # it returns, whatever it says
    for topic, text in GOOD.items():
        peer.publish(topic, text)
    assert peer.answer() == THREE_SENTENCES
    peer.publish('plan', '(move left center) and so on')
    refused = peer.failure('/plan, line 1')

    assert '\n' not in refused
    assert process.popen.poll() is None
    assert 'internal error' not in process.log
    assert 'Traceback' not in process.log


@pytest.mark.parametrize(
    'text', [b'\xff\xfe\xed\xa0', b'(\x80 a)', b'\xc3(a)', b'\x1b[2J'], ids=repr
)
def test_bytes_that_are_no_text_are_refused_like_any_bad_plan(
    node: tuple[Peer, Process], text: bytes
) -> None:
    peer, process = node
    for topic, good in GOOD.items():
        peer.publish(topic, good)
    assert peer.answer() == THREE_SENTENCES

    message = serialize_message(String(data='A' * len(text))).replace(b'A' * len(text), text)
    peer.publish('plan', message)

    assert '/plan, line 1' in peer.failure('/plan, line 1')
    assert '\x1b' not in process.log.split('line 1', 1)[-1]
    assert process.popen.poll() is None


def test_a_stream_of_twenty_megabyte_messages_delays_good_ones_by_little(
    node: tuple[Peer, Process],
) -> None:
    peer, process = node
    for text in ('(a b)\n' * 3_300_000, '(' * 20_000_000, '\n' * 20_000_000):
        for topic in GOOD:
            peer.publish(topic, text)
    for topic, text in GOOD.items():
        peer.publish(topic, text)

    assert peer.answer() == THREE_SENTENCES
    assert process.popen.poll() is None
