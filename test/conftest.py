"""The example warehouse, and user models as files, for many tests."""

import logging
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from browser import chromium  # noqa: F401  (a fixture for all tests)

from mirror_explainer.listener.user_model import UserModel, read_user_model
from mirror_explainer.pddl import Task, read_task

WAREHOUSE = Path(__file__).parent.parent / 'config' / 'warehouse'


@pytest.fixture(autouse=True)
def no_log_of_commands() -> Iterator[None]:
    """Take away what a command writes its log to: the test's standard error, which is closed."""
    yield
    root = logging.getLogger()
    for handler in [*root.handlers]:
        if type(handler) is logging.StreamHandler:  # and none of pytest's own
            root.removeHandler(handler)


@pytest.fixture(scope='session')
def warehouse() -> Path:
    """Return the folder of the example."""
    return WAREHOUSE


@pytest.fixture(scope='session')
def task() -> Task:
    """Return the example's task as read."""
    domain, problem = WAREHOUSE / 'domain.pddl', WAREHOUSE / 'problem.pddl'
    return read_task(domain.read_text(), problem.read_text())


@pytest.fixture
def model_file(tmp_path: Path) -> Callable[[str], Path]:
    """Return a function that writes a user model's YAML to a file."""

    def write(text: str) -> Path:
        path = tmp_path / 'user.yaml'
        path.write_text(text, encoding='utf-8')
        return path

    return write


@pytest.fixture
def read_model(model_file: Callable[[str], Path], task: Task) -> Callable[[str], UserModel]:
    """Return a function that reads a user model's YAML text against the example's task."""
    return lambda text: read_user_model(model_file(text), task)


@pytest.fixture(scope='module')
def ros() -> Iterator[None]:
    """Let the tests of a module talk ROS 2."""
    rclpy = pytest.importorskip('rclpy', reason='needs ROS 2')
    rclpy.init()
    yield
    rclpy.try_shutdown()


@pytest.fixture
def peer(ros: None) -> Iterator[object]:
    """A peer of a robot's nodes in a namespace of its own, so that no test hears another."""
    from ros_peer import Peer, new_namespace

    peer = Peer(new_namespace())
    yield peer
    peer.close()


# The files that take longest, for half a minute and more, or wait for most of their time.
LONGEST = (
    'test_operator_page.py',
    'test_study_browser.py',
    'test_explainer_node.py',
    'test_plansys2_explained.py',
    'test_planning_processes.py',
    'test_faults_robot.py',
    'test_study_people.py',
    'test_explainer_node_seen.py',
    'test_faults_files.py',
    'test_faults_planner.py',
    'test_study_load.py',
    'test_faults_disk.py',
    'test_drafted_robots.py',
    'test_experiments_planning.py',
    'test_experiments_pucrs.py',
    'test_experiments_user_study.py',
    'test_updates.py',
    'test_plansys2_bridge.py',
)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Begin with the longest files, so that no process is left with one at the end."""
    place = {name: number for number, name in enumerate(LONGEST)}
    items.sort(key=lambda item: place.get(item.path.name, len(LONGEST)))


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the option that reports the faults of the node's tests."""
    parser.addoption('--fault-table', type=Path, help='write a Markdown table of the faults here')


@pytest.fixture(scope='session')
def fault_table(request: pytest.FixtureRequest) -> Iterator[object]:
    """Collect the faults that the tests inject, and write the table where it is asked for."""
    from faults import FaultTable

    table = FaultTable()
    yield table
    path = request.config.getoption('--fault-table')
    if path:
        table.write(path)
