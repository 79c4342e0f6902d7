"""The operator's page as a node: it hears an explainer, asks it, and serves a web page.

The page's threads reach ROS by calls with a time limit only; what they show is a value
that the node's callbacks replace.
"""

import sys
import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from rcl_interfaces.msg import ParameterDescriptor
from rcl_interfaces.srv import GetParameters, SetParametersAtomically
from rclpy.client import Client
from rclpy.exceptions import ParameterException
from rclpy.executors import SingleThreadedExecutor
from rclpy.expand_topic_name import expand_topic_name
from rclpy.node import Node
from rclpy.parameter import Parameter, parameter_value_to_python
from rclpy.signals import SignalHandlerOptions
from rclpy.task import Future
from std_msgs.msg import String
from std_srvs.srv import Trigger

from mirror_explainer.commands.command_line import command_parser
from mirror_explainer.commands.extras import MissingExtras, require_extras
from mirror_explainer.commands.terminal import tell_error
from mirror_explainer.errors import InputError
from mirror_explainer.node.robot_topics import LATCHED
from mirror_explainer.node.run import spin
from mirror_explainer.node.start import parsed, refuse
from mirror_explainer.web.address import add_address_arguments, address
from mirror_explainer.web.operator.heard import (
    SETTINGS,
    Heard,
    Settings,
    Status,
    read_answer,
)

DEMO_RESTART = 'warehouse_robot/restart'  # of the demo robot: no other one is to be moved
PORT = 8350
# Seconds.
SILENCE = 5.0  # the explainer tells its state each second
DISCOVERY = 2.0  # for a service that was not seen yet
REPLY = 5.0  # for a reply, beside what the explainer itself waits for an update
LONGEST_REPLY = 60.0  # however long it waits


class OperatorPage(Node):
    """Hears an explainer's answers, state and settings, and asks for what the page's users want.

    `ask`, `adjust`, `forget`, `restart` and `heard` are for other threads than the executor's:
    they return in limited time, and what went wrong is heard as a failure.
    """

    def __init__(self) -> None:
        super().__init__('operator_page')
        about = ParameterDescriptor(description="the explainer's node name", read_only=True)
        explainer = self.declare_parameter('explainer', 'mirror_explainer', about).value
        self._name = expand_topic_name(explainer, self.get_name(), self.get_namespace())
        self._heard = Heard(self._name)
        self._changed = threading.Condition()
        self._explanations = 0
        self._last_status = 0.0  # of time.monotonic()
        self._asked_settings: Future | None = None

        self._explanation = self.create_subscription(
            String, f'{explainer}/explanation', self._on_explanation, LATCHED
        )
        self.create_subscription(DiagnosticArray, '/diagnostics', self._on_diagnostics, 10)
        namespace = self._name.rpartition('/')[0]
        self._verbalize = self.create_client(Trigger, f'{namespace}/verbalize_plan')
        self._forget = self.create_client(Trigger, f'{explainer}/forget')
        self._restart = self.create_client(Trigger, DEMO_RESTART)
        self._get = self.create_client(GetParameters, f'{explainer}/get_parameters')
        self._set = self.create_client(
            SetParametersAtomically, f'{explainer}/set_parameters_atomically'
        )

    def heard(self) -> Heard:
        """Return what was heard, up to now."""
        with self._changed:
            silent = time.monotonic() > self._last_status + SILENCE
            heard = replace(self._heard, silent=silent)
        return replace(heard, restarts=self._restart.service_is_ready())

    def ask(self) -> None:
        """Ask what the robot is up to, and wait until the answer is heard."""
        with self._changed:
            before = self._explanations
        try:
            response = self._call(self._verbalize, Trigger.Request())
            if not response.success:
                raise _NoAnswer(response.message)
            with self._changed:
                if not self._changed.wait_for(lambda: self._explanations > before, REPLY):
                    raise _NoAnswer(f'nothing came on {self._explanation.topic_name}')
        except _NoAnswer as error:
            self._on_failure(str(error))

    def adjust(self, **parameters: Any) -> bool:
        """Set these parameters of the explainer; return whether it took them."""
        values = [Parameter(name, value=value) for name, value in parameters.items()]
        request = SetParametersAtomically.Request()
        request.parameters = [value.to_parameter_msg() for value in values]
        try:
            result = self._call(self._set, request).result
            if not result.successful:
                raise _NoAnswer(f'the settings were refused: {result.reason}')
        except _NoAnswer as error:
            self._on_failure(str(error))
            return False
        with self._changed:
            if self._heard.settings:
                settings = replace(self._heard.settings, **parameters)
                self._heard = replace(self._heard, settings=settings)
        return True

    def forget(self) -> None:
        """Let the explainer forget what it said."""
        try:
            self._call(self._forget, Trigger.Request())
        except _NoAnswer as error:
            self._on_failure(str(error))

    def restart(self) -> None:
        """Let the demo robot begin again."""
        try:
            self._call(self._restart, Trigger.Request())
        except _NoAnswer as error:
            self._on_failure(str(error))

    def _call(self, client: Client, request: Any) -> Any:
        """Return the service's response; raise _NoAnswer if there is none, or no sign of life."""
        if not client.wait_for_service(DISCOVERY):
            raise _NoAnswer(f'nobody serves {client.service_name}. Is the explainer running?')
        with self._changed:
            settings = self._heard.settings
        waits = settings.answer_timeout if settings else 0.0
        limit = min(REPLY + waits, LONGEST_REPLY)
        started = time.monotonic()
        done = threading.Event()
        future = client.call_async(request)
        future.add_done_callback(lambda _: done.set())
        while not done.wait(0.2):
            now = time.monotonic()
            if now > min(started + limit, max(started, self._last_status) + SILENCE):
                client.remove_pending_request(future)
                raise _NoAnswer(f'{client.service_name} gave no reply in {now - started:.0f} s')
        return future.result()

    def _update(self, change: Callable[[Heard], Heard]) -> None:
        with self._changed:
            self._heard = change(self._heard)

    def _on_failure(self, reason: str) -> None:
        self.get_logger().warning(reason)
        silent = time.monotonic() > self._last_status + SILENCE
        self._update(lambda heard: replace(heard, silent=silent).with_failure(reason, _clock()))

    def _on_explanation(self, message: String, info: Any) -> None:
        try:
            answer = read_answer(message.data, self._explanation.topic_name)
            at = _clock(info['source_timestamp'] / 1e9)
            self._update(lambda heard: heard.with_answer(answer, at))
        except InputError as error:
            self._on_failure(str(error))
        with self._changed:
            self._explanations += 1
            self._changed.notify_all()

    def _on_diagnostics(self, array: DiagnosticArray) -> None:
        name = f'{self._name.lstrip("/")}: explanation'
        for item in array.status:
            if item.name == name:
                values = {pair.key: pair.value for pair in item.values}
                status = Status.of(item.level[0], item.message, values)
                self._last_status = time.monotonic()
                self._update(
                    lambda heard: replace(heard, status=status, status_at=_clock())  # noqa: B023
                )
                self._ask_settings()

    def _ask_settings(self) -> None:
        """Ask for the parameters, whenever there is news: anyone may have set them."""
        if self._asked_settings is not None:
            self._get.remove_pending_request(self._asked_settings)
        if self._get.service_is_ready():
            self._asked_settings = self._get.call_async(GetParameters.Request(names=SETTINGS))
            self._asked_settings.add_done_callback(self._on_settings)

    def _on_settings(self, future: Future) -> None:
        values = [parameter_value_to_python(value) for value in future.result().values]
        self._update(lambda heard: replace(heard, settings=Settings.of(values)))


class _NoAnswer(Exception):
    """A call failed; the message says why."""


def _clock(seconds: float | None = None) -> str:
    return time.strftime('%H:%M:%S', time.localtime(seconds))


def main(args: Sequence[str] | None = None) -> int:
    """Serve the page until it is interrupted; return the exit status."""
    argv = sys.argv if args is None else ['operator_page', *args]
    command = 'ros2 run mirror_explainer operator_page'
    parser = command_parser(
        'operator_page',
        'Serve a web page on which people ask the explainer what the robot is up to.',
        command,
        f'{command} --host 0.0.0.0 --port 8080 --ros-args -r __ns:=/robot1',
        ends='Remappings and the like follow --ros-args.',
    )
    add_address_arguments(parser, PORT)
    options = parsed(parser, argv)
    try:
        require_extras('web')
    except MissingExtras as error:
        tell_error('operator_page', error)
        return 1
    from mirror_explainer.web.operator.site import operator_site
    from mirror_explainer.web.serving import serve
    from mirror_explainer.web.site import configure

    # The server takes the signals, and everything ends when it does.
    rclpy.init(args=argv, signal_handler_options=SignalHandlerOptions.NO)
    executor = SingleThreadedExecutor()
    try:
        node = OperatorPage()
    except ParameterException as error:
        rclpy.try_shutdown()
        refuse(parser, error)
    executor.add_node(node)
    thread = threading.Thread(target=spin, args=[executor, node.get_logger()], name='ros')
    thread.start()
    try:
        where = address(options)
        configure(operator_site(node, node.get_namespace()), where)
        serve(where)
    except (InputError, OSError) as error:
        tell_error('operator_page', error)
        return 1
    finally:
        rclpy.try_shutdown()
        thread.join()
        executor.shutdown()
        node.destroy_node()
    return 0


if __name__ == '__main__':
    sys.exit(main())
