"""The ROS 2 node: hears the robot's problem and plan, and says what it is up to when asked."""

import functools
import logging
import os
import sys
import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import fields, replace
from typing import Any

# Our matrices are small: numpy's own threads only take the processors from the robot.
# numpy reads this when it is imported.
os.environ.setdefault('OPENBLAS_NUM_THREADS', '1')

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from rcl_interfaces.msg import SetParametersResult
from rcl_interfaces.srv import ListParameters
from rclpy._rclpy_pybind11 import RCLError
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.clock import Clock, ClockType
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.exceptions import ParameterException
from rclpy.executors import Executor, ExternalShutdownException, MultiThreadedExecutor
from rclpy.logging import LoggingSeverity, get_logging_directory
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.utilities import remove_ros_args
from std_msgs.msg import String
from std_srvs.srv import Trigger

from mirror_explainer.errors import with_cure
from mirror_explainer.input_limits import InputLimits
from mirror_explainer.node.answers import Answers, printable
from mirror_explainer.node.diagnostic_message import diagnostic_array
from mirror_explainer.node.diagnostics import diagnose, rivalry
from mirror_explainer.node.history import History, news
from mirror_explainer.node.maker import Maker
from mirror_explainer.node.parameters import CHOICES, PARAMETERS, unknown_parameters
from mirror_explainer.node.ros_log import RosLog
from mirror_explainer.node.start import argument_parser, write_fault
from mirror_explainer.node.state import Inputs, Phase, State, Text
from mirror_explainer.node.surroundings import look_around
from mirror_explainer.node.updates import Updates
from mirror_explainer.planning import Planner

LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
VOLATILE = QoSProfile(depth=1)
# With the usual depth of 10, calls of more clients at once than that would get lost.
MANY_CALLS = QoSProfile(depth=1000)
INPUTS = ('domain', 'problem', 'plan')
# A call that waits for an explanation holds one of the executor's threads.
THREADS = 64
MOST_WAITING_CALLS = THREADS - 8

_NOT_READY = 'the explanation is not ready yet'

# The package's own log, which the node hands on to ROS.
_log = logging.getLogger('mirror_explainer')


def _guarded(callback: Callable[..., None]) -> Callable[..., None]:
    """Return a method that logs what goes wrong: what leaves a callback would end the node."""

    @functools.wraps(callback)
    def guarded(self: 'ExplainerNode', *arguments: Any, **named: Any) -> None:
        try:
            callback(self, *arguments, **named)
        except Exception:
            if self.context.ok():  # otherwise the node is ending
                _log.exception('%s failed', callback.__name__.strip('_'))

    return guarded


class ExplainerNode(Node):
    """Serves `verbalize_plan` from what the topics and the user model say.

    The work goes on in an `Updates` thread and the planner's processes; the
    callbacks here only hand inputs on and wait for results. `options` are those
    of `Node`, such as `context` or `parameter_overrides`.
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
        self._inputs = Inputs()
        self._inputs_lock = threading.Lock()
        self._answers = Answers(self._publish_answer)
        self._waiting = threading.Semaphore(MOST_WAITING_CALLS)
        self._history = History()
        self._history_lock = threading.Lock()
        self._service = self.resolve_service_name('verbalize_plan')
        self._topics = {name: self.resolve_topic_name(name) for name in INPUTS}
        self._rivals = 0

        self._verbalization = self.create_publisher(String, '~/verbalization', LATCHED)
        self._explanation = self.create_publisher(String, '~/explanation', LATCHED)
        self._diagnostics = self.create_publisher(DiagnosticArray, '/diagnostics', 10)
        self._updates = Updates(Maker(self._make_planner), self._on_state)

        in_order = MutuallyExclusiveCallbackGroup()
        at_once = ReentrantCallbackGroup()
        for name in INPUTS:
            # A volatile publisher is heard by the first, a late start made good by the second.
            for qos in (VOLATILE, LATCHED):
                self.create_subscription(
                    String,
                    name,
                    self._input_callback(name),
                    qos,
                    callback_group=in_order,
                    # Only what the volatile one can't hear is not heard: warn of that.
                    event_callbacks=SubscriptionEventCallbacks(
                        use_default_callbacks=qos is VOLATILE
                    ),
                )
        self.create_service(
            Trigger,
            'verbalize_plan',
            self._verbalize,
            qos_profile=MANY_CALLS,
            callback_group=at_once,
        )
        self.create_service(Trigger, '~/forget', self._forget, callback_group=at_once)
        # Not the node's clock, which stands still when the system's is set back.
        steady = Clock(clock_type=ClockType.STEADY_TIME)
        # A group of its own: where a file system hangs, one thread hangs with it.
        self.create_timer(1.0, self._each_second, MutuallyExclusiveCallbackGroup(), steady)
        self.add_post_set_parameters_callback(self._on_parameters)
        self._submit()

    def close(self) -> None:
        """Stop all work, and free the calls that wait; no planner process is left."""
        self._answers.close()
        self._updates.close()
        _log.removeHandler(self._ros_log)

    def destroy_node(self) -> None:
        """Stop all work, if `close` has not, and destroy the node."""
        self.close()
        super().destroy_node()

    def _make_planner(self) -> Planner:
        return Planner(
            self._value('planner'),
            workers=self._value('workers'),
            planning_timeout=self._value('planning_timeout'),
            memory_limit=self._value('planner_memory_limit'),
            downward_binary=self._value('downward_binary'),
        )

    def _value(self, name: str) -> Any:
        return self.get_parameter(name).value

    def _input_callback(self, name: str) -> Callable[[String], None]:
        def callback(message: String) -> None:
            # The other subscription may have heard it already: that submits nothing new.
            self._submit(**{name: Text(message.data, self._topics[name])})

        return callback

    @_guarded
    def _submit(self, **changes: Any) -> None:
        """Hand the newest inputs on, with what the parameters say now."""
        parameters = ('domain_file', 'user_model_file', 'max_beliefs', 'plans_per_belief')
        with self._inputs_lock:
            self._inputs = replace(
                self._inputs,
                **changes,
                **{name: self._value(name) for name in (*parameters, 'deadline')},
                limits=InputLimits(**{f.name: self._value(f.name) for f in fields(InputLimits)}),
            )
            self._updates.submit(self._inputs, self._value('answer_timeout'))

    def _check_parameters(self, parameters: Sequence[Parameter]) -> SetParametersResult:
        for parameter in parameters:
            choices = CHOICES.get(parameter.name)
            if choices and parameter.value not in choices:
                reason = f'{parameter.name} must be one of {", ".join(filter(None, choices))}'
                return SetParametersResult(successful=False, reason=reason)
        return SetParametersResult(successful=True)

    def _on_parameters(self, parameters: Sequence[Parameter]) -> None:
        self._submit()

    @_guarded
    def _each_second(self) -> None:
        """Tell how things are, and that a caller may hear another node; notice edited files."""
        rivals = max(0, self.count_services(self._service) - 1)
        if rivals and not self._rivals:
            _log.warning('%s', with_cure(*rivalry(rivals)))
        self._rivals = rivals
        self._publish_diagnostics(self._updates.state)
        self._ros_log.log_repetitions()
        self._updates.look_at_files()

    @_guarded
    def _on_state(self, state: State) -> None:
        """Tell how an update ended, and make the answer that a call will want."""
        with self._history_lock:
            before, self._history = self._history.outcome, self._history.after_update(state)
        for level, line in news(before, state):
            _log.log(level, '%s', line)
        if state.preparation is not None:
            self._answers.make(state.preparation, state.number, self._question())
        elif state.phase is Phase.WAITING:  # what was said was about a plan that is over
            self._answers.forget()
        self._publish_diagnostics(state)

    def _question(self) -> dict[str, Any]:
        """Return the arguments of `explain` that the parameters decide."""
        names = ('strategy', 'n', 'threshold', 'selection_budget')
        return {name: self._value(name) for name in names}

    def _verbalize(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        started = time.perf_counter()
        try:
            response.success, response.message = self._answer(self._state_for_a_call())
        except Exception as error:  # an exception that leaves a callback ends the node
            if self.context.ok():  # otherwise the node is ending
                _log.exception('verbalize_plan failed')
            response.success = False
            response.message = printable(f'internal error, please report it: {error!r}')
        seconds = time.perf_counter() - started
        with self._history_lock:
            self._history = self._history.after_call(response.success, seconds)
        _log.debug('call: %s', 'answered' if response.success else response.message)
        return response

    def _publish_answer(self, text: str, report: str) -> None:
        self._verbalization.publish(String(data=text))
        self._explanation.publish(String(data=report))

    def _state_for_a_call(self) -> State:
        """Return the state to answer from, once the work under way is done."""
        if self._waiting.acquire(blocking=False):
            try:
                state = self._updates.wait(self._value('answer_timeout'))
            finally:
                self._waiting.release()
            waits = ''
        else:
            state = self._updates.state
            waits = f' (and {MOST_WAITING_CALLS} calls wait for it, as many as may)'
        if state.phase is Phase.WORKING:
            message = f'{_NOT_READY}: {state.message}{waits}'
            return State(Phase.WORKING, message)
        return state

    def _answer(self, state: State) -> tuple[bool, str]:
        """Return whether there is an answer, and the answer, or why there is none."""
        if state.preparation is None:
            return False, printable(state.message)
        text = self._answers.give(
            state.preparation, state.number, self._question(), self._value('remember')
        )
        if text is None:
            return False, f'{_NOT_READY}: other calls are answered first'
        return True, text

    def _forget(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        count = self._answers.forget()
        response.success = True
        response.message = f'{count} sentences forgotten'
        return response

    def _publish_diagnostics(self, state: State) -> None:
        files = (self._inputs.domain_file, self._inputs.user_model_file)
        publishers = {n: self.count_publishers(self._topics[n]) for n in ('problem', 'plan')}
        found = diagnose(
            state,
            self._history,
            self._inputs,
            look_around(files, publishers, self._rivals),
            self._answers.last,
        )
        name = f'{self.get_fully_qualified_name().lstrip("/")}: explanation'
        stamp = self.get_clock().now().to_msg()
        self._diagnostics.publish(diagnostic_array(found, name, stamp))


def _spin_once(executor: Executor) -> None:
    """Do what is due, or wait half a second for it; log what goes wrong in a callback.

    Not `spin`: a signal that comes just before it waits would not wake it. And callbacks
    of rclpy's own raise for messages such as a parameter of a type that there is not.
    """
    try:
        executor.spin_once(timeout_sec=0.5)
    except (ExternalShutdownException, RCLError):
        raise
    except Exception:
        _log.exception('a callback of ROS failed')


def main(args: Sequence[str] | None = None) -> None:
    """Run the node until it is interrupted."""
    parser = argument_parser()
    try:
        options = parser.parse_args(remove_ros_args(args)[1:])
    except RCLError as error:
        parser.error(str(error).split(', at /')[0].strip())
    log_fault = write_fault(get_logging_directory())
    if log_fault:  # a full disk must not keep the node from starting
        args = [*(sys.argv if args is None else args), '--ros-args', '--disable-external-lib-logs']
    rclpy.init(args=args)
    node = None
    executor = MultiThreadedExecutor(THREADS)
    try:
        node = ExplainerNode()
        if log_fault:
            _log.warning('there is no log file: %s', log_fault)
        if options.log_level:
            node.get_logger().set_level(LoggingSeverity[options.log_level.upper()])
        executor.add_node(node)
        while rclpy.ok():
            _spin_once(executor)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    except ParameterException as error:
        parser.error(str(error))
    except RCLError:
        if rclpy.ok():  # otherwise a signal came just before the executor waited
            raise
    finally:
        if node is not None:
            node.close()
        executor.shutdown(timeout_sec=1.0)
        if node is not None:
            node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
