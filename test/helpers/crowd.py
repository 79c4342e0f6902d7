"""Many clients at once, in a few processes: each calls, waits for the answer, and calls again."""

import os
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing import get_context
from multiprocessing.connection import Connection

import rclpy
from patience import eventually
from rcl_interfaces.srv import ListParameters
from rclpy.client import Client
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.task import Future
from std_srvs.srv import Trigger

# A reply goes to all clients of a service, each of which picks its own out of its queue: with the
# usual depth of 10, replies to others would push it out.
MANY_CALLS = QoSProfile(depth=1000)
# s: a call without an answer for so long is lost.
PATIENCE = 60.0


@dataclass(frozen=True)
class Answer:
    """What came of a call; `began` and `ended` are time.monotonic(), the same in all processes."""

    began: float
    ended: float
    success: bool
    message: str

    @property
    def seconds(self) -> float:
        """How long the call took."""
        return self.ended - self.began


@dataclass(frozen=True)
class Calls:
    """The calls of a round: those that were answered, and how many were not."""

    answers: Sequence[Answer]
    lost: int = 0


@dataclass(frozen=True)
class _Order:
    """What each client shall do: call at most so often, and not after a time."""

    service: str
    clients: int
    calls: int
    until: float


class Crowd:
    """Up to as many clients as there are processes times `clients_each`."""

    def __init__(self, pipes: Sequence[Connection], clients_each: int) -> None:
        self._pipes = pipes
        self.clients = len(pipes) * clients_each

    def start(
        self, service: str, clients: int, calls: int = 1 << 60, until: float = float('inf')
    ) -> None:
        """Let so many clients call, each `calls` times one after the other, until a time."""
        each, more = divmod(clients, len(self._pipes))
        for index, pipe in enumerate(self._pipes):
            pipe.send(_Order(service, each + (index < more), calls, until))

    def finish(self) -> Calls:
        """Wait for all calls to be answered, or lost."""
        rounds = [pipe.recv() for pipe in self._pipes]
        answers = sorted((a for each in rounds for a in each.answers), key=lambda a: a.began)
        return Calls(answers, sum(each.lost for each in rounds))

    def call(self, service: str, clients: int, calls: int) -> Calls:
        """Let so many clients call, each `calls` times, and wait."""
        self.start(service, clients, calls)
        return self.finish()


@contextmanager
def crowd(namespace: str, clients: int, processes: int) -> Iterator[Crowd]:
    """Start the processes, and end them afterwards."""
    spawn = get_context('spawn')
    each = -(-clients // processes)
    pairs = [spawn.Pipe() for _ in range(processes)]
    children = [
        spawn.Process(target=_serve, args=(theirs, namespace, each)) for _, theirs in pairs
    ]
    for child in children:
        child.start()
    try:
        yield Crowd([ours for ours, _ in pairs], each)
    finally:
        for ours, _ in pairs:
            ours.send(None)
        for child in children:
            child.join(PATIENCE)


def _serve(orders: Connection, namespace: str, clients: int) -> None:
    rclpy.init()
    node = Node(
        f'crowd_{os.getpid()}',
        namespace=namespace,
        enable_rosout=False,
        start_parameter_services=False,
    )
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    known: dict[str, list[Client]] = {}
    while (order := orders.recv()) is not None:
        if order.service not in known:
            known[order.service] = [
                node.create_client(Trigger, order.service, qos_profile=MANY_CALLS)
                for _ in range(clients)
            ]
            _wait_until_known(node, executor)
        chosen = known[order.service][: order.clients]
        for client in chosen:
            assert client.wait_for_service(PATIENCE), f'{order.service} is not served'
        orders.send(_Round(order).run(chosen, executor))
    node.destroy_node()
    rclpy.try_shutdown()


def _wait_until_known(node: Node, executor: SingleThreadedExecutor) -> None:
    """Wait until the explainer knows all clients made so far, as `ros_peer.Peer.client` does."""
    client = node.create_client(ListParameters, 'mirror_explainer/list_parameters')
    assert client.wait_for_service(PATIENCE)

    def is_answered() -> bool:
        future = client.call_async(ListParameters.Request())
        executor.spin_until_future_complete(future, timeout_sec=1.0)
        return future.done()

    eventually(is_answered, 'a reply to a new client')


class _Round:
    """One order, carried out by the clients of one process."""

    def __init__(self, order: _Order) -> None:
        self._order = order
        self._answers: list[Answer] = []
        self._waiting = 0

    def run(self, clients: Sequence[Client], executor: SingleThreadedExecutor) -> Calls:
        for client in clients:
            self._call(client, self._order.calls)
        heard, last = -1, time.monotonic()
        while self._waiting and time.monotonic() - last < PATIENCE:
            executor.spin_once(timeout_sec=0.1)
            if heard != len(self._answers):
                heard, last = len(self._answers), time.monotonic()
        return Calls(self._answers, self._waiting)

    def _call(self, client: Client, left: int) -> None:
        began = time.monotonic()
        if not left or began >= self._order.until:
            return
        self._waiting += 1

        def answered(future: Future) -> None:
            ended, response = time.monotonic(), future.result()
            self._waiting -= 1
            self._answers.append(Answer(began, ended, response.success, response.message))
            self._call(client, left - 1)

        client.call_async(Trigger.Request()).add_done_callback(answered)
