"""The ROS 2 node: hears the robot's problem and plan, and says what it is up to when asked."""

import functools
import gc
import logging
import time
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import mirror_explainer.selection.one_thread  # noqa: F401  # isort: skip

from diagnostic_msgs.msg import DiagnosticArray
from rcl_interfaces.msg import SetParametersResult
from rcl_interfaces.srv import ListParameters
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.clock import Clock, ClockType
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.executors import MultiThreadedExecutor
from rclpy.logging import LoggingSeverity
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import QoSProfile
from rclpy.subscription import Subscription
from std_msgs.msg import String
from std_srvs.srv import Trigger

from mirror_explainer.commands.command_line import command_parser
from mirror_explainer.errors import with_cure
from mirror_explainer.node.deliveries import Deliveries
from mirror_explainer.node.diagnostic_message import diagnostic_array
from mirror_explainer.node.diagnostics import crowded, rivalry
from mirror_explainer.node.inputs import TOPICS, Configuration, Text
from mirror_explainer.node.live_explainer import MOST_WAITING_CALLS, LiveExplainer
from mirror_explainer.node.neighbours import others_of
from mirror_explainer.node.parameters import (
    CHOICES,
    PARAMETERS,
    configuration,
    unknown_parameters,
)
from mirror_explainer.node.robot_topics import LATCHED
from mirror_explainer.node.ros_log import RosLog
from mirror_explainer.node.run import run
from mirror_explainer.node.start import parsed
from mirror_explainer.node.surroundings import Others

VOLATILE = QoSProfile(depth=1)
SERVICE = 'verbalize_plan'
# With the usual depth of 10, calls of more clients at once than that would get lost.
MANY_CALLS = QoSProfile(depth=1000)
# A call that waits holds one of the executor's threads; some are left for all else.
THREADS = MOST_WAITING_CALLS + 8

# The package's own log, which the node hands on to ROS.
_log = logging.getLogger('mirror_explainer')


def _guarded(callback: Callable[..., None]) -> Callable[..., None]:
    """Return a method that logs what goes wrong: what leaves a callback would end the node."""

    @functools.wraps(callback)
    def guarded(self: 'ExplainerNode', *arguments: Any) -> None:
        try:
            callback(self, *arguments)
        except Exception:
            if self.context.ok():  # otherwise the node is ending
                _log.exception('%s failed', callback.__name__.strip('_'))

    return guarded


class ExplainerNode(Node):
    """Translates between ROS and a `LiveExplainer`, which does all the work.

    Subscribers (std_msgs/String, from volatile and transient-local publishers):
        * **domain**, **problem**, **plan**: the robot's task and plan, in PDDL
        * **progress**: how far the plan is, from robots that tell it: "done: (move a b)",
          "skipped: (…)", "running: (…)" or "failed: (…) because …", one step a line

    Services (std_srvs/Trigger):
        * **verbalize_plan**: say what the robot is up to, or why that cannot be said
        * **~/forget**: forget what was said, see `remember`

    Publishers:
        * **~/verbalization** (std_msgs/String, latched): each answer, ready to be spoken
        * **~/explanation** (std_msgs/String, latched): the same answer as JSON
        * **/diagnostics** (diagnostic_msgs/DiagnosticArray): level, message and values, each
          second and after each update

    Parameters: the fields of `NodeSettings`, `Question`, `PlanningSettings` and `InputLimits`,
    with their meanings, ranges and defaults; those called fixed there are read-only here, and
    the others act at once.

    `options` are those of `rclpy.node.Node`, such as `context` or `parameter_overrides`.
    """

    def __init__(self, **options: Any) -> None:
        super().__init__('mirror_explainer', enable_logger_service=True, **options)
        self._ros_log = RosLog(self.get_logger())
        _log.addHandler(self._ros_log)
        _log.setLevel(logging.DEBUG)  # what is logged is for the ROS logger to decide
        self.add_on_set_parameters_callback(self._check_parameters)
        self.declare_parameters('', PARAMETERS)
        declared = self.list_parameters([], ListParameters.Request.DEPTH_RECURSIVE).names
        # There is no public way to those that were given, but not declared.
        for sentence in unknown_parameters(self._parameter_overrides, declared):
            _log.warning('%s', sentence)
        self._others = Others()  # as they were at the last look

        self._verbalization = self.create_publisher(String, '~/verbalization', LATCHED)
        self._explanation = self.create_publisher(String, '~/explanation', LATCHED)
        self._diagnostics = self.create_publisher(DiagnosticArray, '/diagnostics', 10)
        self._explainer = LiveExplainer(
            self._configuration(), self._publish_answer, self._publish_diagnostics
        )

        self._deliveries = Deliveries()
        self._in_order = MutuallyExclusiveCallbackGroup()
        at_once = ReentrantCallbackGroup()
        # A volatile publisher is heard by the first, a late start made good by the second.
        self._subscribed = [
            (name, self._subscribe(name, qos)) for name in TOPICS for qos in (VOLATILE, LATCHED)
        ]
        self.create_service(
            Trigger, SERVICE, self._verbalize, qos_profile=MANY_CALLS, callback_group=at_once
        )
        self.create_service(Trigger, '~/forget', self._forget, callback_group=at_once)
        # Not the node's clock, which stands still when the system's is set back.
        steady = Clock(clock_type=ClockType.STEADY_TIME)
        # A group of its own: where a file system hangs, one thread hangs with it.
        self.create_timer(1.0, self._each_second, MutuallyExclusiveCallbackGroup(), steady)
        self.add_post_set_parameters_callback(self._on_parameters)

    def close(self) -> None:
        """Stop all work, and free the calls that wait; no planner process is left."""
        self._explainer.close()
        _log.removeHandler(self._ros_log)

    def destroy_node(self) -> None:
        """Stop all work, if `close` has not, and destroy the node."""
        self.close()
        super().destroy_node()

    def _subscribe(self, name: str, qos: QoSProfile) -> Subscription:
        return self.create_subscription(
            String,
            name,
            functools.partial(self._hear, name),
            qos,
            callback_group=self._in_order,
            # Only what the volatile one can't hear is not heard: warn of that.
            event_callbacks=SubscriptionEventCallbacks(use_default_callbacks=qos is VOLATILE),
        )

    def _configuration(self) -> Configuration:
        return configuration(lambda name: self.get_parameter(name).value)

    def _check_parameters(self, parameters: Sequence[Parameter]) -> SetParametersResult:
        for parameter in parameters:
            choices = CHOICES.get(parameter.name)
            if choices and parameter.value not in choices:
                reason = f'{parameter.name} must be one of {", ".join(filter(None, choices))}'
                return SetParametersResult(successful=False, reason=reason)
        return SetParametersResult(successful=True)

    @_guarded
    def _on_parameters(self, parameters: Sequence[Parameter]) -> None:
        self._explainer.configure(self._configuration())

    @_guarded
    def _hear(self, name: str, message: String, info: Mapping[str, int]) -> None:
        if self._deliveries.take(name, info['source_timestamp']):
            self._explainer.hear(name, Text(message.data, self.resolve_topic_name(name)))

    @_guarded
    def _hear_what_waits(self) -> None:
        """Hear what reached this node before a call that the executor came to first.

        It is done in the executor's place, by its rule for callbacks that exclude each other.
        """
        for name, subscription in self._subscribed:
            while not self._in_order.beginning_execution(subscription):
                time.sleep(0.001)  # a text is being heard
            try:
                with subscription.handle:
                    taken = subscription.handle.take_message(String, False)
                if taken is not None:
                    self._hear(name, *taken)
            finally:
                self._in_order.ending_execution(subscription)
        if self.executor is not None:  # so that it looks at what was held up here
            self.executor.wake()

    def _verbalize(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        self._hear_what_waits()
        reply = self._explainer.ask()
        response.success, response.message = reply.success, reply.message
        return response

    def _forget(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        response.success = True
        response.message = f'{self._explainer.forget()} sentences forgotten'
        return response

    @_guarded
    def _each_second(self) -> None:
        """Tell how things are, and what others mix up here; notice edited files."""
        before, self._others = self._others, others_of(self, SERVICE)
        rivals, crowd = self._others.rivals, crowded(self._others.publishers)
        if rivals and not before.rivals:
            _log.warning('%s', with_cure(*rivalry(rivals)))
        if crowd and crowd != crowded(before.publishers):
            _log.warning('%s', with_cure(*crowd))
        self._publish_diagnostics(self._others)
        self._ros_log.tell_counts()
        self._explainer.look_at_files()

    @_guarded
    def _publish_answer(self, text: str, report: str) -> None:
        self._verbalization.publish(String(data=text))
        self._explanation.publish(String(data=report))

    @_guarded
    def _publish_diagnostics(self, others: Others | None = None) -> None:
        found = self._explainer.diagnose(others or others_of(self, SERVICE))
        name = f'{self.get_fully_qualified_name().lstrip("/")}: explanation'
        stamp = self.get_clock().now().to_msg()
        self._diagnostics.publish(diagnostic_array(found, name, stamp))


def main(args: Sequence[str] | None = None) -> None:
    """Run the node until it is interrupted."""
    command = 'ros2 run mirror_explainer explainer_node'
    parser = command_parser(
        'explainer_node',
        'Say on request what the robot is up to, in the few most telling steps.',
        f'{command} --log-level debug --ros-args -p user_model_file:=user_model.yaml',
        ends='Parameters, remappings and the like follow --ros-args.',
    )
    parser.add_argument(
        '--log-level',
        type=str.lower,
        choices=('debug', 'info', 'warn', 'error', 'fatal'),
        help="log this node's own lines from this level up (default info)",
    )
    options = parsed(parser, args)

    def make_node() -> ExplainerNode:
        node = ExplainerNode()
        if options.log_level:
            node.get_logger().set_level(LoggingSeverity[options.log_level.upper()])
        # Else each full collection looks through all that was imported, while the robot waits.
        gc.freeze()
        return node

    run(make_node, parser, args, lambda: MultiThreadedExecutor(THREADS), _log)


if __name__ == '__main__':
    main()
