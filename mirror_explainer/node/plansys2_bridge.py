"""The bridge from PlanSys2: what its services and topics tell, as the explainer hears it.

PlanSys2 has domain and problem as services, tells a plan once, as it begins, and how far it is as
the states of its actions; the explainer hears all four as texts. The two need not start in any
order, and either may be started anew.
"""

import time
from collections.abc import Callable, Sequence
from typing import Any

from action_msgs.msg import GoalStatus, GoalStatusArray
from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from rclpy.qos import QoSProfile, qos_profile_action_status_default
from std_msgs.msg import Empty

from mirror_explainer.commands.command_line import command_parser
from mirror_explainer.node.plansys2_execution import (
    AHEAD,
    DONE,
    FAILED,
    RUNNING,
    Execution,
    PlannedAction,
    goal_holds,
    goal_of,
)
from mirror_explainer.node.plansys2_messages import Messages, plansys2_messages
from mirror_explainer.node.robot_topics import LATCHED, RobotTopics
from mirror_explainer.node.run import run
from mirror_explainer.node.start import parsed

MANY = QoSProfile(depth=1000)  # one message an action and second, all at once
PERIOD = 0.1  # s between two looks at what is to be asked and told
PAUSE = 1.0  # s until a refused call is made again, or a new client has to know its service
GRACE = 0.3  # s from a plan's end until the last states of its actions have come as well
PATIENCE = 3.0  # s until a call that gets no reply is made again
UNDER_WAY = (GoalStatus.STATUS_ACCEPTED, GoalStatus.STATUS_EXECUTING, GoalStatus.STATUS_CANCELING)


class Plansys2Bridge(Node):
    """Tells the explainer what PlanSys2 knows. All names are relative: one bridge a robot.

    Calls      `domain_expert/get_domain`, `problem_expert/get_problem`
    Hears      `problem_expert/update_notify`, `executing_plan`, `action_execution_info`,
               `execute_plan/_action/status`
    Publishes  `domain`, `problem`, `plan`, `progress` (std_msgs/String, latched)

    A plan is told until it has ended; one that failed until the robot gets another goal, so
    that a person can hear where it got stuck.
    """

    def __init__(self, messages: Messages) -> None:
        super().__init__('plansys2_bridge')
        self._topics = RobotTopics(self)
        self._domain = _Service(
            self, messages.GetDomain, 'domain_expert/get_domain', 'domain', self._on_domain
        )
        self._problem = _Service(
            self, messages.GetProblem, 'problem_expert/get_problem', 'problem', self._on_problem
        )
        info = messages.ActionExecutionInfo
        # A cancelled action is not told: what became of it, only the state says.
        self._standing = {
            info.NOT_EXECUTED: AHEAD,
            info.EXECUTING: RUNNING,
            info.SUCCEEDED: DONE,
            info.FAILED: FAILED,
            info.CANCELLED: AHEAD,
        }
        self._execution = Execution.of(())
        self._heard_plan = 0.0  # when, on the steady clock
        self._executors: set[bytes] = set()  # who may have told it, as far as is known
        self._under_way: bool | None = None  # whether the executor has a goal; None: not heard
        self._ends: float | None = None  # when the plan that is over is no longer told
        self._over = False  # whether the plan is over, which is not told yet
        self._stuck = False  # whether the plan is over because it failed
        self._goal = ''  # the goal of the plan that is told
        self._plan_waits = False  # for the problem that belongs to it

        self.create_subscription(
            Empty, 'problem_expert/update_notify', lambda _: self._problem.ask(), MANY
        )
        self._plans = self.create_subscription(
            messages.Plan, 'executing_plan', self._on_plan, LATCHED
        )
        self.create_subscription(info, 'action_execution_info', self._on_action, MANY)
        self.create_subscription(
            GoalStatusArray,
            'execute_plan/_action/status',
            self._on_goals,
            qos_profile_action_status_default,
        )
        # Not the node's clock, which stands still when the system's is set back.
        steady = Clock(clock_type=ClockType.STEADY_TIME)
        self.create_timer(PERIOD, self._look, clock=steady)

    def _look(self) -> None:
        """Ask what is to be asked, and tell how far the robot is."""
        if self._execution.actions and self._executor_is_gone():
            self._execution = Execution.of(())
            self._under_way, self._ends, self._stuck = None, None, False
            self._expect_plan()
        if self._ends is not None and time.monotonic() > self._ends:
            self._end()
        self._domain.look()
        self._problem.look()
        if self._plan_waits and not self._problem.asked:
            self._tell_plan()
        elif not self._plan_waits:
            self._tell_progress()

    def _executor_is_gone(self) -> bool:
        """Say whether none is left of the publishers that there were when the plan was heard.

        Not whether there is one: PlanSys2 may have been started anew meanwhile.
        """
        now = self._executors_now()
        if not self._executors:
            self._executors = now
            return not now and time.monotonic() - self._heard_plan > PATIENCE
        return not self._executors & now

    def _executors_now(self) -> set[bytes]:
        """Return who may tell a plan."""
        topic = self._plans.topic_name
        return {bytes(info.endpoint_gid) for info in self.get_publishers_info_by_topic(topic)}

    def _on_domain(self, text: str) -> None:
        self._topics.tell(domain=text)

    def _on_problem(self, text: str) -> None:
        self._topics.tell(problem=text)
        if self._stuck and goal_of(text) != self._goal:
            self._execution, self._stuck = Execution.of(()), False
            self._plan_waits = True
        if self._plan_waits:
            self._tell_plan()

    def _on_plan(self, message: Any) -> None:
        actions = tuple(
            PlannedAction(item.time, item.action, item.duration) for item in message.items
        )
        if actions == self._execution.actions and not self._stuck:
            return  # some versions repeat it all the time
        self._execution, self._stuck, self._over = Execution.of(actions), False, False
        # Now, for whoever told it may be gone at the next look, and another be there.
        self._heard_plan, self._executors = time.monotonic(), self._executors_now()
        if self._under_way is not False:
            self._expect_plan()

    def _on_action(self, message: Any) -> None:
        standing = self._standing.get(message.status, AHEAD)
        self._execution = self._execution.after(message.action_full_name, standing)

    def _on_goals(self, message: GoalStatusArray) -> None:
        """Notice that a plan's execution begins or ends, which no other topic tells."""
        before = self._under_way
        self._under_way = any(goal.status in UNDER_WAY for goal in message.status_list)
        if self._under_way and before is False:
            if self._ends is not None:
                self._end()
            if time.monotonic() - self._heard_plan > PATIENCE:
                self._execution = Execution.of(())  # an old plan: the new one is yet to be heard
            self._expect_plan()
        elif not self._under_way and before is not False:
            self._ends = time.monotonic() + GRACE

    def _end(self) -> None:
        """Tell no plan any more, unless it failed."""
        self._ends = None
        self._stuck = self._execution.failed
        self._over = not self._stuck
        self._expect_plan()

    def _expect_plan(self) -> None:
        """Tell the plan as it now is once the problem has been asked for anew."""
        self._domain.ask()
        self._problem.ask()
        self._plan_waits = True

    def _tell_plan(self) -> None:
        """Tell the plan, and how far the robot is with it; first, since that was of another."""
        self._plan_waits = False
        problem = self._topics.told('problem')
        if self._over:
            if goal_holds(problem):  # PlanSys2 may not say so of the last actions
                self._execution = self._execution.finished()
                self._tell_progress()
            self._execution, self._over = Execution.of(()), False
        elif not self._stuck:
            self._goal = goal_of(problem)
        self._tell_progress(plan=self._execution.plan)

    def _tell_progress(self, **plan: str) -> None:
        """Tell how far the robot is, together with a plan if one is given."""
        execution = self._execution
        # What was done of a plan stays done when that is over.
        progress = {'progress': execution.progress} if execution.actions else {}
        self._topics.tell(**progress, **plan)


class _Service:
    """A text that a service of PlanSys2 gives: asked for when it may have changed.

    One call at a time, and all changes meanwhile make one more. Once the service
    is there, or there again, it is asked by itself.
    """

    def __init__(
        self, node: Node, kind: Any, name: str, field: str, on_text: Callable[[str], None]
    ) -> None:
        self._node, self._kind, self._name = node, kind, name
        self._client = node.create_client(kind, name)
        self._field = field
        self._on_text = on_text
        self._logger = node.get_logger()
        self._ready = False
        self._wanted = True
        self._call: Any = None
        self._deadline = 0.0
        self._not_before = 0.0
        self._trouble = ''

    @property
    def asked(self) -> bool:
        """Whether a text is on its way that has not been heard yet."""
        return self._ready and (self._wanted or self._call is not None)

    def ask(self) -> None:
        """Ask at the next look, and tell what comes."""
        self._wanted = True

    def look(self) -> None:
        """Make the call that is due."""
        ready = self._client.service_is_ready()
        if ready != self._ready:
            self._ready, self._wanted = ready, True
        now = time.monotonic()
        if not ready and now >= self._not_before:
            self._warn(f'{self._client.srv_name} is not there. Is PlanSys2 running?')
        if self._call is not None and (not ready or now > self._deadline):
            if ready:
                self._warn(f'{self._client.srv_name} gives no reply.')
            self._begin_anew(now)
            return
        if ready and self._wanted and self._call is None and now >= self._not_before:
            self._wanted = False
            self._deadline = now + PATIENCE
            self._call = self._client.call_async(self._kind.Request())
            self._call.add_done_callback(self._on_reply)

    def _begin_anew(self, now: float) -> None:
        """Give the call up, and make the next one as a new client.

        One that the service has not found, though it has found the service, never gets a reply.
        """
        self._call, self._ready, self._wanted = None, False, True
        self._node.destroy_client(self._client)
        self._client = self._node.create_client(self._kind, self._name)
        self._not_before = now + PAUSE  # until it is found

    def _on_reply(self, call: Any) -> None:
        if call is not self._call:
            return  # it was given up
        self._call = None
        reply = call.result()
        if reply.success:
            self._warn('')
            self._on_text(getattr(reply, self._field))
        else:  # as long as PlanSys2 is not active
            self._wanted = True
            self._not_before = time.monotonic() + PAUSE
            self._warn(f'{self._client.srv_name} gives no {self._field}: {reply.error_info}')

    def _warn(self, trouble: str) -> None:
        """Log what is wrong once, and that it is well again."""
        if trouble == self._trouble:
            return
        self._trouble = trouble
        if trouble:
            self._logger.warning(trouble)
        else:
            self._logger.info(f'{self._client.srv_name} gives the {self._field}')


def main(args: Sequence[str] | None = None) -> None:
    """Run the bridge until it is interrupted."""
    parser = command_parser(
        'plansys2_bridge',
        "Tell the explainer PlanSys2's domain, problem, plan and progress.",
        'ros2 run mirror_explainer plansys2_bridge --ros-args -r __ns:=/robot',
        ends='The example is for the robot whose PlanSys2 runs in the namespace /robot.',
    )
    parsed(parser, args)
    run(lambda: Plansys2Bridge(plansys2_messages()), parser, args)


if __name__ == '__main__':
    main()
