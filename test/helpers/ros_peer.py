"""What the node's tests need: the built node as a real process, and a peer that talks to it."""

import contextlib
import itertools
import os
import signal
import subprocess
import threading
from collections.abc import Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path

import rclpy
from ament_index_python.packages import get_package_prefix
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from forked import Forked
from patience import PATIENCE, eventually
from rcl_interfaces.srv import ListParameters
from rclpy.duration import Duration
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.parameter_client import AsyncParameterClient
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String
from std_srvs.srv import Trigger

CONFIG = Path(__file__).parents[2] / 'config' / 'warehouse'
DOMAIN = (CONFIG / 'domain.pddl').read_text()
PROBLEM = (CONFIG / 'problem.pddl').read_text()
PLAN = (CONFIG / 'plan.txt').read_text()
USER_MODEL = str(CONFIG / 'user_model.yaml')
THREE_SENTENCES = 'I will grab a blue cube and a red circle.\nI will exit from the bottom door.'

LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
VOLATILE = QoSProfile(depth=1)

_numbers = itertools.count()


def new_namespace() -> str:
    """Return a namespace that no other test uses, so that no test hears another."""
    return f'/robot_{os.getpid()}_{next(_numbers)}'


class Peer:
    """A node in the test's own process: publishes, calls, sets parameters, listens."""

    def __init__(self, namespace: str) -> None:
        self.node = Node('peer', namespace=namespace)
        self.explainer = f'{namespace}/mirror_explainer'
        self.diagnostics: list[DiagnosticStatus] = []
        self.stamps: list[int] = []
        self._heard: dict[str, list[str]] = {}
        self._publishers: dict[tuple[str, bool], rclpy.publisher.Publisher] = {}
        self._clients: dict[str, rclpy.client.Client] = {}
        self._parameters: AsyncParameterClient | None = None
        self.node.create_subscription(DiagnosticArray, '/diagnostics', self._on_diagnostics, 10)
        self._executor = SingleThreadedExecutor()
        self._executor.add_node(self.node)
        self._thread = threading.Thread(target=self._executor.spin, daemon=True)
        self._thread.start()

    def close(self) -> None:
        self._executor.shutdown()
        self._thread.join()
        self.node.destroy_node()

    def _on_diagnostics(self, array: DiagnosticArray) -> None:
        name = f'{self.explainer.lstrip("/")}: explanation'
        found = [status for status in array.status if status.name == name]
        self.diagnostics += found
        self.stamps += [array.header.stamp.sec] * len(found)

    def publish(
        self, topic: str, text: str | bytes, *, latched: bool = True, heard: bool = True
    ) -> None:
        """Publish a text, or a message's bytes as they are.

        With `heard` wait for the subscriber first, as a volatile publisher must.
        """
        key = (topic, latched)
        if key not in self._publishers:
            qos = LATCHED if latched else VOLATILE
            self._publishers[key] = self.node.create_publisher(String, topic, qos)
        publisher = self._publishers[key]
        if heard:
            eventually(publisher.get_subscription_count, f'a subscriber of {topic}')
        publisher.publish(text if isinstance(text, bytes) else String(data=text))

    def wait_until_heard(self) -> None:
        """Wait until all that was published has reached its subscribers."""
        for publisher in self._publishers.values():
            assert publisher.wait_for_all_acked(Duration(seconds=PATIENCE))

    def publish_warehouse(self, unused: str = '', **how: bool) -> None:
        """Publish domain, problem and plan; with an unused fact all is planned for anew."""
        domain = DOMAIN.replace('(charged)', f'(charged) ({unused})', 1) if unused else DOMAIN
        self.publish('domain', domain, **how)
        self.publish('problem', PROBLEM, **how)
        self.publish('plan', PLAN, **how)

    def start_call(self, service: str = 'verbalize_plan') -> 'Call':
        if service not in self._clients:
            self._clients[service] = self.client(Trigger, service)
        client = self._clients[service]
        assert client.wait_for_service(PATIENCE), f'{service} is not served'
        return Call(client.call_async(Trigger.Request()))

    def client(self, kind: type, service: str, of: str = '') -> rclpy.client.Client:
        """Return a client for a service of a node, by default the explainer, which knows it."""
        client = self.node.create_client(kind, service)
        assert client.wait_for_service(PATIENCE), f'{service} is not served'
        self._wait_until_known(of or self.explainer)
        return client

    def _wait_until_known(self, node: str) -> None:
        """Wait until a node knows the clients made so far: to others it sends no reply.

        Clients become known in the order in which they were made, so one more is made here,
        which calls until it gets a reply.
        """
        client = self.node.create_client(ListParameters, f'{node}/list_parameters')
        assert client.wait_for_service(PATIENCE)
        eventually(
            lambda: Call(client.call_async(ListParameters.Request())).ends_within(1.0),
            'a reply to a new client',
        )

    def call(self, service: str = 'verbalize_plan') -> Trigger.Response:
        return self.start_call(service).result()

    def answer(self) -> str:
        """Call until the newest inputs were heard and there is an answer; return its text."""
        response = eventually(
            lambda: (found := self.call()).success and found, 'an answer that succeeds'
        )
        return response.message

    def failure(self, expected: str) -> str:
        """Call until the answer is a failure that has the expected words; return it."""
        response = eventually(
            lambda: not (found := self.call()).success and expected in found.message and found,
            f'a failure with "{expected}"',
        )
        return response.message

    def set_parameters(self, **values: object) -> list[tuple[bool, str]]:
        if self._parameters is None:
            self._parameters = AsyncParameterClient(self.node, self.explainer)
            assert self._parameters.wait_for_services(PATIENCE)
            self._wait_until_known(self.explainer)
        parameters = [Parameter(name, value=value) for name, value in values.items()]
        results = Call(self._parameters.set_parameters(parameters)).result().results
        return [(result.successful, result.reason) for result in results]

    def hear(self, topic: str) -> list[str]:
        """Return the list that the topic's messages go to, all in turn, latched ones included."""
        if topic not in self._heard:
            texts = self._heard.setdefault(topic, [])
            self.node.create_subscription(
                String,
                topic,
                lambda message: texts.append(message.data),
                QoSProfile(depth=100, durability=DurabilityPolicy.TRANSIENT_LOCAL),
            )
        return self._heard[topic]


class Call:
    """A call under way."""

    def __init__(self, future: rclpy.task.Future) -> None:
        self._future = future
        self._done = threading.Event()
        future.add_done_callback(lambda _: self._done.set())

    @property
    def done(self) -> bool:
        return self._done.is_set()

    def ends_within(self, seconds: float) -> bool:
        return self._done.wait(seconds)

    def result(self):
        assert self._done.wait(PATIENCE), 'no answer to the call'
        return self._future.result()


class Process:
    """An executable of the package, as `ros2 run` would start it.

    With an environment of its own, or within another program, by its script; else, for it is
    quicker, as a fork of a process that has imported what it needs.
    """

    def __init__(
        self,
        executable: str,
        namespace: str,
        log: Path,
        arguments: Sequence[str] = (),
        options: Sequence[str] = (),
        environment: Mapping[str, str] | None = None,
        within: Sequence[str] = (),
    ) -> None:
        words = [*options, '--ros-args', '-r', f'__ns:={namespace}', *arguments]
        self._log = log
        if environment is None and not within:
            self.popen: Forked | subprocess.Popen = Forked(executable, words, log)
            return
        prefix = Path(get_package_prefix('mirror_explainer'))
        with log.open('wb') as output:
            self.popen = subprocess.Popen(
                [*within, prefix / 'lib' / 'mirror_explainer' / executable, *words],
                stdout=output,
                stderr=subprocess.STDOUT,
                env=os.environ | (environment or {}),
                preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
            )

    @property
    def log(self) -> str:
        return self._log.read_text(errors='replace')

    def descendants(self) -> set[int]:
        """Return the process numbers of everything that this process started."""
        parents = {}
        for stat in Path('/proc').glob('[0-9]*/stat'):
            try:
                fields = stat.read_text().rsplit(')', 1)[1].split()
            except OSError:
                continue
            parents[int(stat.parent.name)] = int(fields[1])
        found = {self.popen.pid}
        while more := {pid for pid, parent in parents.items() if parent in found} - found:
            found |= more
        return found - {self.popen.pid}

    def session_leaders(self) -> set[int]:
        """Return those of them that lead a session: the planning processes."""
        leaders = set()
        for pid in self.descendants():
            with contextlib.suppress(ProcessLookupError):
                if os.getsid(pid) == pid:
                    leaders.add(pid)
        return leaders

    def stop(self, number: signal.Signals = signal.SIGTERM) -> int:
        """Send the signal, and return the exit status."""
        self.popen.send_signal(number)
        return self.popen.wait(PATIENCE)


def name_of(pid: int) -> str:
    """Return the program that a process runs, '' once it has ended."""
    try:
        return Path(f'/proc/{pid}/comm').read_text().strip()
    except OSError:
        return ''


def alive(pids: set[int]) -> set[int]:
    """Return those of the processes that still run (zombies do not)."""
    running = set()
    for pid in pids:
        try:
            state = Path(f'/proc/{pid}/stat').read_text().rsplit(')', 1)[1].split()[0]
        except OSError:
            continue
        if state != 'Z':
            running.add(pid)
    return running


@contextmanager
def running(
    executable: str,
    namespace: str,
    folder: Path,
    **how: object,
) -> Iterator[Process]:
    """Run an executable as `started` does, and show its log if a test fails."""
    with started(executable, namespace, folder, **how) as process:
        try:
            yield process
        finally:
            print(process.log)


@contextmanager
def started(
    executable: str,
    namespace: str,
    folder: Path,
    *,
    options: Sequence[str] = (),
    environment: Mapping[str, str] | None = None,
    within: Sequence[str] = (),
    **parameters: object,
) -> Iterator[Process]:
    """Run an executable of the package with these parameters, and end it afterwards.

    `options` are its own ones, not those of ROS; `environment` has what is added to
    the variables, `within` is a command that runs it. Without both it is a fork (see `Process`).
    """
    given = {name: value for name, value in parameters.items() if value != ''}
    arguments = [word for name, value in given.items() for word in ('-p', f'{name}:={value}')]
    log = folder / f'{executable}.log'
    process = Process(executable, namespace, log, arguments, options, environment, within)
    try:
        yield process
    finally:
        if process.popen.poll() is None:
            os.kill(process.popen.pid, signal.SIGTERM)
            try:
                process.popen.wait(PATIENCE)
            except subprocess.TimeoutExpired:
                process.popen.kill()
                process.popen.wait()


def explainer(peer: Peer, folder: Path, **parameters: object) -> AbstractContextManager[Process]:
    """Run the node in the peer's namespace, with the warehouse's user model, and patient."""
    parameters = {'user_model_file': USER_MODEL, 'answer_timeout': 30.0} | parameters
    return running('explainer_node', peer.node.get_namespace(), folder, **parameters)


def last_diagnostic(peer: Peer) -> dict[str, str]:
    """Return the newest diagnostics' values, with its level and message; wait for the first."""
    status = eventually(lambda: peer.diagnostics, 'diagnostics')[-1]
    return {value.key: value.value for value in status.values} | {
        'level': status.level,
        'message': status.message,
    }
