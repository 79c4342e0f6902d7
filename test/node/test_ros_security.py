"""The node's rights and its words, seen from the ROS side."""

import os
import subprocess
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import pytest
from patience import PATIENCE, eventually

pytest.importorskip('rclpy', reason='needs ROS 2')

from ament_index_python.packages import get_package_prefix, get_package_share_directory
from rclpy.node import NodeNameNonExistentError
from ros_peer import THREE_SENTENCES, USER_MODEL, Peer, Process, explainer, new_namespace, running

POLICY = Path(get_package_share_directory('mirror_explainer')) / 'config/sros2/policy.xml'
# A policy's element and attribute, and what rclpy calls it.
RIGHTS = {
    ('topics', 'publish'): 'publisher',
    ('topics', 'subscribe'): 'subscriber',
    ('services', 'reply'): 'service',
    ('services', 'request'): 'client',
}

pytestmark = pytest.mark.usefixtures('ros')

Answered = tuple[Peer, Process]


def allowed(enclave: str, namespace: str) -> dict[str, set[str]]:
    """Return the full names that the policy allows to an enclave's node in a namespace."""
    found = ElementTree.parse(POLICY).find(f'enclaves/enclave[@path="{enclave}"]/profiles/profile')
    assert found is not None and found.get('ns') == '/'
    beginnings = {'/': '/', '~': f'{namespace}/{found.get("node")}/'}
    names: dict[str, set[str]] = {what: set() for what in RIGHTS.values()}
    for group in found:
        for attribute, value in group.items():
            assert value == 'ALLOW'
            for name in group:
                assert name.text
                start = beginnings.get(name.text[0])
                full = start + name.text.lstrip('~/') if start else f'{namespace}/{name.text}'
                names[RIGHTS[group.tag, attribute]].add(full)
    return names


def test_all_that_stands_in_the_policys_list_of_enclaves_is_an_enclave():
    # `ros2 security generate_artifacts` takes a comment there for an enclave, and fails.
    parser = ElementTree.XMLParser(target=ElementTree.TreeBuilder(insert_comments=True))
    enclaves = ElementTree.parse(POLICY, parser).find('enclaves')
    assert enclaves is not None

    paths = [enclave.get('path') for enclave in enclaves]

    assert paths == [
        '/mirror_explainer',
        '/robot',
        '/plansys2_bridge',
        '/task_list_robot',
        '/operator_page',
        '/operator',
    ]


def used(peer: Peer, node: str) -> dict[str, set[str]]:
    """Return the full names that a node of the peer's namespace uses, as far as it is known."""
    names: dict[str, set[str]] = {}
    with suppress(NodeNameNonExistentError):
        for what in RIGHTS.values():
            find = getattr(peer.node, f'get_{what}_names_and_types_by_node')
            names[what] = {name for name, _ in find(node, peer.node.get_namespace())}
    return names


def used_in_the_end(peer: Peer, node: str, expected: dict[str, set[str]]) -> dict[str, set[str]]:
    """Return what a node uses once that is as expected: what others know of it lags behind."""
    with suppress(AssertionError):
        eventually(lambda: used(peer, node) == expected, '')
    return used(peer, node)


@pytest.fixture(scope='module')
def answered(
    ros: None, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[tuple[Peer, Process]]:
    """A peer and its node, which has answered."""
    peer = Peer(new_namespace())
    with explainer(peer, tmp_path_factory.mktemp('node')) as node:
        peer.publish_warehouse()
        peer.answer()
        yield peer, node
    peer.close()


def test_the_policy_allows_the_node_what_it_uses_and_no_more(answered):
    peer, _ = answered
    expected = allowed('/mirror_explainer', peer.node.get_namespace())

    assert used_in_the_end(peer, 'mirror_explainer', expected) == expected


def test_a_terminal_and_a_format_find_nothing_to_obey_in_a_logged_name(answered):
    peer, node = answered
    peer.publish('plan', '(%s%n%p{0.__class__}$HOME \x1b]0;owned\x07a\x9b31m)')
    reason = peer.failure('%s%n%p{0.__class__}$HOME')
    eventually(lambda: reason in node.log, 'the reason in the log')

    assert not {'\x1b', '\x07', '\x9b'} & set(node.log + reason)


@pytest.mark.parametrize(
    ('enclave', 'name', 'topic'),
    [('/robot', 'warehouse_robot', 'plan'), ('/task_list_robot', 'task_list_robot', 'domain')],
)
def test_the_policy_allows_a_robot_what_it_uses_and_no_more(peer, tmp_path, enclave, name, topic):
    expected = allowed(enclave, peer.node.get_namespace())
    with running(name, peer.node.get_namespace(), tmp_path):
        eventually(lambda: peer.hear(topic), f'the {topic}')
        found = used_in_the_end(peer, name, expected)
    assert found == expected


def test_the_policy_allows_the_bridge_from_plansys2_what_it_uses_and_no_more(peer, tmp_path):
    from plansys2_peer import bridge

    expected = allowed('/plansys2_bridge', peer.node.get_namespace())
    with bridge(peer, tmp_path) as process:
        eventually(lambda: 'is not there' in process.log, 'what it misses in the log')
        found = used_in_the_end(peer, 'plansys2_bridge', expected)
    assert found == expected


def test_the_policy_allows_the_operators_page_what_it_uses_and_no_more(peer, tmp_path):
    pytest.importorskip('django', reason="needs the extra 'web'")
    expected = allowed('/operator_page', peer.node.get_namespace())
    with running(
        'operator_page', peer.node.get_namespace(), tmp_path, options=['--port', '0']
    ) as page:
        eventually(lambda: 'http://' in page.log, 'the page')
        found = used_in_the_end(peer, 'operator_page', expected)
    assert found == expected


def test_the_operator_may_ask_and_listen_but_set_nothing():
    explainer, operator = allowed('/mirror_explainer', '/a'), allowed('/operator', '/a')

    assert operator['client'] == {'/a/verbalize_plan', '/a/mirror_explainer/forget'}
    assert operator['client'] <= explainer['service']
    assert operator['subscriber'] <= explainer['publisher']


def test_where_security_is_enforced_the_node_does_not_start_without_its_keys(tmp_path):
    node = Path(get_package_prefix('mirror_explainer')) / 'lib/mirror_explainer/explainer_node'
    enforced = {
        'ROS_SECURITY_ENABLE': 'true',
        'ROS_SECURITY_STRATEGY': 'Enforce',
        'ROS_SECURITY_KEYSTORE': str(tmp_path),
    }
    ended = subprocess.run(
        [node, '--ros-args', '--enclave', '/mirror_explainer'],
        env=os.environ | enforced,
        capture_output=True,
        text=True,
        timeout=PATIENCE,
    )

    assert ended.returncode != 0
    assert 'SECURITY' in ended.stderr.upper()


def test_the_node_serves_where_it_can_write_nowhere_but_in_its_folder_of_temporary_files(
    peer, tmp_path
):
    unshare = ['unshare', '--mount', *([] if os.geteuid() == 0 else ['--map-root-user'])]
    read_only = 'mount --make-rprivate / && mount -o remount,bind,ro / && mount -t tmpfs none "$0"'
    check = '! touch "$0/../written" 2> /dev/null'
    folder = tmp_path / 'tmp'
    folder.mkdir()
    boxed = [*unshare, 'sh', '-ec', f'{read_only} && {check} && exec "$@"', folder]
    if subprocess.run([*boxed, 'true'], capture_output=True).returncode:
        pytest.skip('needs the right to make a read-only view of the file system (unshare)')
    node = Path(get_package_prefix('mirror_explainer')) / 'lib/mirror_explainer/explainer_node'
    namespace = ['-r', f'__ns:={peer.node.get_namespace()}']
    with (tmp_path / 'log').open('wb') as log:
        process = subprocess.Popen(
            [*boxed, node, '--ros-args', *namespace, '-p', f'user_model_file:={USER_MODEL}'],
            env=os.environ | {'TMPDIR': str(folder), 'ROS_LOG_DIR': str(folder)},
            stdout=log,
            stderr=log,
        )
    try:
        peer.publish_warehouse()
        answer = peer.answer()
    finally:
        process.terminate()
        process.wait(PATIENCE)
    assert answer == THREE_SENTENCES
