"""The ROS 2 node: hears the robot's problem and plan, and says what it is up to when asked."""

import json
import os
import threading
import time
from collections import deque
from collections.abc import Callable, Sequence
from typing import Any

import rclpy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rcl_interfaces.msg import (
    FloatingPointRange,
    IntegerRange,
    ParameterDescriptor,
    SetParametersResult,
)
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String
from std_srvs.srv import Trigger

from mirror_explainer.explainer import STRATEGIES, Explanation, Preparation, explain
from mirror_explainer.planning import Planner
from mirror_explainer.updates import Inputs, Phase, State, Text, Updates

LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
VOLATILE = QoSProfile(depth=1)
INPUTS = ('domain', 'problem', 'plan')
# A call that waits for an explanation holds one of the executor's threads.
THREADS = 64
MOST_WAITING_CALLS = THREADS - 8


class ExplainerNode(Node):
    """Serves `verbalize_plan` from what the topics and the user model say.

    The work goes on in an `Updates` thread and the planner's processes; the
    callbacks here only hand inputs on and wait for results.
    """

    def __init__(self) -> None:
        super().__init__('mirror_explainer')
        self._declare_parameters()
        self._inputs = Inputs()
        self._inputs_lock = threading.Lock()
        self._seen: deque[tuple[str, int]] = deque(maxlen=64)
        self._answers = _Answers()
        self._waiting = threading.Semaphore(MOST_WAITING_CALLS)
        self._last_error = ''

        self._verbalization = self.create_publisher(String, '~/verbalization', LATCHED)
        self._explanation = self.create_publisher(String, '~/explanation', LATCHED)
        self._diagnostics = self.create_publisher(DiagnosticArray, '/diagnostics', 10)
        self._updates = Updates(self._make_planner, self._on_state)

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
                    event_callbacks=SubscriptionEventCallbacks(use_default_callbacks=False),
                )
        self.create_service(Trigger, 'verbalize_plan', self._verbalize, callback_group=at_once)
        self.create_service(Trigger, '~/forget', self._forget, callback_group=at_once)
        self.create_timer(1.0, self._each_second, callback_group=in_order)
        self.add_on_set_parameters_callback(self._check_parameters)
        self.add_post_set_parameters_callback(self._on_parameters)
        self._submit()

    def close(self) -> None:
        """Stop all work; no planner process is left."""
        self._updates.close()

    def _make_planner(self) -> Planner:
        return Planner(
            self._value('planner'),
            workers=self._value('workers'),
            planning_timeout=self._value('planning_timeout'),
            memory_limit=self._value('planner_memory_limit'),
            downward_binary=self._value('downward_binary'),
        )

    def _declare_parameters(self) -> None:
        text, number, count = _described, _in_range, _counted
        self.declare_parameters(
            '',
            [
                ('domain_file', '', text('PDDL domain; a message on "domain" replaces it', True)),
                ('user_model_file', '', text('YAML: what the listener may believe')),
                ('n', 3, count('how many sentences an answer has at most', 0, 1000)),
                (
                    'threshold',
                    0.0,
                    number(
                        'say only as many as bring the cross-entropy below this (nats)', 0, 1e3
                    ),
                ),
                ('strategy', 'informative', text(f'one of {", ".join(STRATEGIES)}')),
                ('remember', False, text('whether each answer conditions the next')),
                ('planner', 'fast-downward-opt', text("a unified-planning engine's name", True)),
                ('plans_per_belief', 300, count('optimal plans of a belief, at most', 1, 10_000)),
                ('max_beliefs', 1024, count('most probable beliefs to plan for', 1, 1_000_000)),
                ('planning_timeout', 10.0, number('s, for each belief', 1e-3, 1e6, True)),
                ('deadline', 60.0, number('s, for the planning of a whole update', 1e-3, 1e6)),
                ('selection_budget', 0.5, number('s, to find the best sentences', 1e-3, 1e3)),
                ('answer_timeout', 5.0, number('s, that a call waits for an update', 0, 1e6)),
                ('workers', 2, count('planning processes at a time', 1, 256, True)),
                ('planner_memory_limit', 1024, count('MiB, for each search', 80, 1 << 24, True)),
                ('downward_binary', '', text("Fast Downward's search, if self-built", True)),
            ],
        )

    def _value(self, name: str) -> Any:
        return self.get_parameter(name).value

    def _input_callback(self, name: str) -> Callable[[String, Any], None]:
        topic = self.resolve_topic_name(name)

        def callback(message: String, info: Any) -> None:
            identity = (name, info['source_timestamp'])
            if identity in self._seen:
                return  # heard by the other subscription already
            self._seen.append(identity)
            self._submit(**{name: Text(message.data, topic)})

        return callback

    def _submit(self, **changes: Text) -> None:
        """Hand the newest inputs on, with what the parameters say now."""
        path = self._value('user_model_file')
        with self._inputs_lock:
            self._inputs = Inputs(
                **{name: getattr(self._inputs, name) for name in INPUTS} | changes,
                domain_file=self._value('domain_file'),
                user_model_file=path,
                user_model_revision=_revision(path),
                max_beliefs=self._value('max_beliefs'),
                plans_per_belief=self._value('plans_per_belief'),
                deadline=self._value('deadline'),
            )
            self._updates.submit(self._inputs)

    def _check_parameters(self, parameters: Sequence[Parameter]) -> SetParametersResult:
        for parameter in parameters:
            if parameter.name == 'strategy' and parameter.value not in STRATEGIES:
                reason = f'strategy must be one of {", ".join(STRATEGIES)}'
                return SetParametersResult(successful=False, reason=reason)
        return SetParametersResult(successful=True)

    def _on_parameters(self, parameters: Sequence[Parameter]) -> None:
        self._submit()

    def _each_second(self) -> None:
        """Tell how things are, and notice a user-model file that was edited."""
        if self._inputs.user_model_revision != _revision(self._inputs.user_model_file):
            self._submit()
        self._publish_diagnostics(self._updates.state)

    def _on_state(self, state: State) -> None:
        if state.phase is Phase.ERROR:
            self._last_error = state.message
            self.get_logger().error(state.message)
        elif state.preparation is None:
            self.get_logger().info(state.message)
        else:
            self._report_ready(state.preparation)
        self._publish_diagnostics(state)

    def _report_ready(self, preparation: Preparation) -> None:
        model = preparation.model
        for warning in model.warnings:
            self.get_logger().warning(warning)
        self.get_logger().info(
            f'ready: a plan of {len(model.sentences)} actions, '
            f'{len(model.hypotheses)} hypotheses, '
            f'{preparation.planner_calls} planner calls in {preparation.seconds.planning:.2f} s'
        )
        try:
            self._answers.get(preparation, self._question())  # the first call finds it made
        except Exception as error:  # nor may one end the update thread; the call will tell it
            self.get_logger().error(f'the answer could not be made: {error!r}')

    def _question(self) -> dict[str, Any]:
        """Return the arguments of `explain` that the parameters decide."""
        names = ('strategy', 'n', 'threshold', 'selection_budget')
        return {name: self._value(name) for name in names}

    def _verbalize(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        state = self._state_for_a_call()
        if state.preparation is None:
            response.message = _printable(state.message)
            return response
        try:
            remember = self._value('remember')
            text, report = self._answers.get(state.preparation, self._question(), remember)
        except Exception as error:  # an exception that leaves a callback ends the node
            self.get_logger().error(f'verbalize_plan: {error!r}')
            response.message = _printable(f'the answer failed: {error}')
            return response
        self._verbalization.publish(String(data=text))
        self._explanation.publish(String(data=report))
        response.success, response.message = True, text
        return response

    def _state_for_a_call(self) -> State:
        """Return the state to answer from, once the work under way is done."""
        if self._waiting.acquire(blocking=False):
            try:
                state = self._updates.wait(self._value('answer_timeout'))
            finally:
                self._waiting.release()
        else:
            state = self._updates.state
        if state.phase is Phase.WORKING:
            return State(Phase.WORKING, f'the explanation is not ready yet: {state.message}')
        return state

    def _forget(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        count = self._answers.forget()
        response.success = True
        response.message = f'{count} sentences forgotten'
        return response

    def _publish_diagnostics(self, state: State) -> None:
        levels = {Phase.WAITING: DiagnosticStatus.WARN, Phase.ERROR: DiagnosticStatus.ERROR}
        values = {
            'state': state.phase.value,
            'seconds in this state': f'{time.monotonic() - state.since:.0f}',
            'last error': self._last_error or 'none',
        }
        if state.preparation is not None:
            model, seconds = state.preparation.model, state.preparation.seconds
            values |= {
                'seconds reading': f'{seconds.read:.3f}',
                'seconds planning': f'{seconds.planning:.3f}',
                'planner calls': str(state.preparation.planner_calls),
                'hypotheses': str(len(model.hypotheses)),
                'covered mass': f'{model.covered_mass:.6f}',
                'unsolvable mass': f'{model.unsolvable_mass:.6f}',
                'unknown mass': f'{model.unknown_mass:.6f}',
                'stand-in plans': str(model.stand_in_plans),
                'warnings': '; '.join(model.warnings) or 'none',
            }
        incomplete = state.preparation is not None and not state.preparation.model.complete
        status = DiagnosticStatus(
            level=DiagnosticStatus.WARN
            if incomplete
            else levels.get(state.phase, DiagnosticStatus.OK),
            name=f'{self.get_fully_qualified_name().lstrip("/")}: explanation',
            message=_printable(state.message),
            values=[KeyValue(key=key, value=_printable(value)) for key, value in values.items()],
        )
        array = DiagnosticArray(status=[status])
        array.header.stamp = self.get_clock().now().to_msg()
        self._diagnostics.publish(array)


class _Answers:
    """Makes each answer once, and remembers what was said."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._said: list[str] = []
        self._made_for: Preparation | None = None
        self._made: dict[object, tuple[Explanation, str, str]] = {}

    def get(
        self, preparation: Preparation, question: dict[str, Any], remember: bool | None = None
    ) -> tuple[str, str]:
        """Return the answer's text and its JSON.

        With `remember` it is conditioned on what was said, and counts as said.
        Sentences that are not in the present plan are no part of it.
        """
        with self._lock:
            if self._made_for is not preparation:
                self._made_for, self._made = preparation, {}
            said = [s for s in self._said if remember and s in preparation.model.sentences]
            key = (*question.items(), *said)
            if key not in self._made:
                explanation = explain(preparation, said=said, **question)
                report = json.dumps(explanation.as_dict(hypotheses=False), ensure_ascii=False)
                self._made[key] = explanation, _printable(explanation.text), _printable(report)
            explanation, text, report = self._made[key]
            if remember:
                self._said += explanation.sentences
            return text, report

    def forget(self) -> int:
        """Forget what was said; return how many sentences that was."""
        with self._lock:
            count = len(self._said)
            self._said.clear()
            return count


def _described(description: str, read_only: bool = False) -> ParameterDescriptor:
    return ParameterDescriptor(description=description, read_only=read_only)


def _counted(
    description: str, least: int, most: int, read_only: bool = False
) -> ParameterDescriptor:
    between = [IntegerRange(from_value=least, to_value=most)]
    return ParameterDescriptor(description=description, integer_range=between, read_only=read_only)


def _in_range(
    description: str, least: float, most: float, read_only: bool = False
) -> ParameterDescriptor:
    between = [FloatingPointRange(from_value=float(least), to_value=float(most))]
    return ParameterDescriptor(
        description=description, floating_point_range=between, read_only=read_only
    )


def _revision(path: str) -> object:
    """Return something that changes whenever the file does."""
    try:
        found = os.stat(path)
    except (OSError, ValueError):
        return None
    return found.st_mtime_ns, found.st_size, found.st_ino


def _printable(text: str) -> str:
    """Return the text without what a ROS string can't carry: NUL and lone surrogates."""
    return text.replace('\0', '').encode('utf-8', 'replace').decode('utf-8')


def main(args: Sequence[str] | None = None) -> None:
    """Run the node until it is interrupted."""
    rclpy.init(args=args)
    node = ExplainerNode()
    executor = MultiThreadedExecutor(THREADS)
    executor.add_node(node)
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.close()
        executor.shutdown(timeout_sec=1.0)
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
