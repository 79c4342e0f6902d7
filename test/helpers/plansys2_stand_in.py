"""A stand-in for PlanSys2, with its services and topics, for the tests of the bridge.

It behaves as PlanSys2 for Jazzy does: effects at start are applied when an action starts and those
at end when it ends, each change is notified at once and without its content, actions' states come
once in a while, all of the plan's and one that stands for its beginning, and a plan's end is
told by the executor's goals alone.

    python plansys2_stand_in.py TASK.json --ros-args -r __ns:=/robot

TASK.json is a Task. Lines on stdin say what happens next (see `Plansys2.obey`); each is
acknowledged on stdout once it has happened.
"""

import json
import sys
import threading
import time

import rclpy
from action_msgs.msg import GoalStatus, GoalStatusArray
from plansys2_msgs.msg import ActionExecutionInfo, Plan, PlanItem
from plansys2_msgs.srv import GetDomain, GetProblem
from plansys2_task import Step, Task
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_action_status_default
from std_msgs.msg import Empty

LATCHED = QoSProfile(depth=100, durability=DurabilityPolicy.TRANSIENT_LOCAL)
STATES = {
    'ahead': ActionExecutionInfo.NOT_EXECUTED,
    'running': ActionExecutionInfo.EXECUTING,
    'done': ActionExecutionInfo.SUCCEEDED,
    'failed': ActionExecutionInfo.FAILED,
}


class Plansys2(Node):
    """Domain expert, problem expert and executor in one node."""

    def __init__(self, task: Task) -> None:
        super().__init__('plansys2')
        self._task = task
        self._facts = list(task.facts)
        self._goal_known = False
        self._standing = ['ahead'] * len(task.plan)
        self._active = task.active
        self.create_service(GetDomain, 'domain_expert/get_domain', self._get_domain)
        self.create_service(GetProblem, 'problem_expert/get_problem', self._get_problem)
        self._notify = self.create_publisher(Empty, 'problem_expert/update_notify', 100)
        self._plan = self.create_publisher(Plan, 'executing_plan', LATCHED)
        self._info = self.create_publisher(ActionExecutionInfo, 'action_execution_info', 100)
        self._goals = self.create_publisher(
            GoalStatusArray, 'execute_plan/_action/status', qos_profile_action_status_default
        )
        self._timer = self.create_timer(task.status_period, self.tell_states)
        self._timer.cancel()

    def obey(self, line: str) -> None:
        """Let happen what a line says.

        `activate`; `execute`; `start K` and `end K` an action; `fail K` it, which ends the
        plan; `cancel`; `finish`; `repeat` the plan's message; `states`; `add FACT`; `plan JSON`,
        other steps; `goal TEXT`; `hang S` seconds after a change.
        """
        command, _, rest = line.strip().partition(' ')
        match command:
            case 'activate':
                self._active = True
            case 'execute':
                self._standing = ['ahead'] * len(self._task.plan)
                self._tell_goals(GoalStatus.STATUS_EXECUTING)
                self._repeat()
                self._timer.reset()
            case 'start':
                self._change(self._task.plan[int(rest)].start)
                self._standing[int(rest)] = 'running'
            case 'end':
                self._change(self._task.plan[int(rest)].end)
                self._standing[int(rest)] = 'done'
            case 'fail':
                self._standing[int(rest)] = 'failed'
                self.tell_states()
                self._end(GoalStatus.STATUS_ABORTED)
            case 'cancel':
                self._end(GoalStatus.STATUS_CANCELED)
            case 'finish':
                self._end(GoalStatus.STATUS_SUCCEEDED)
            case 'repeat':
                self._repeat()
            case 'states':
                self.tell_states()
            case 'add':
                self._change({'add': [rest]})
            case 'plan':
                self._task.plan = [Step(**step) for step in json.loads(rest)]
            case 'goal':
                self._task.goal = rest
                self._change({})
            case 'hang':
                self._change({})
                time.sleep(float(rest))
            case _:
                raise ValueError(line)

    def tell_states(self) -> None:
        """Tell where each action stands, in the order of their names, as PlanSys2 does."""
        begun = ActionExecutionInfo(status=ActionExecutionInfo.SUCCEEDED, action_full_name=':0')
        infos = [begun]
        for step, standing in zip(self._task.plan, self._standing, strict=True):
            words = step.action.strip('()').split()
            infos.append(
                ActionExecutionInfo(
                    status=STATES[standing],
                    action_full_name=f'{step.action}:{int(step.time * 1000)}',
                    action=words[0],
                    arguments=words[1:] or words,
                )
            )
        for info in sorted(infos, key=lambda info: info.action_full_name):
            self._info.publish(info)

    def _end(self, status: int) -> None:
        self._timer.cancel()
        self._tell_goals(status)

    def _repeat(self) -> None:
        items = [
            PlanItem(time=step.time, action=step.action, duration=step.duration)
            for step in self._task.plan
        ]
        self._plan.publish(Plan(items=items))

    def _tell_goals(self, status: int) -> None:
        self._goals.publish(GoalStatusArray(status_list=[GoalStatus(status=status)]))

    def _change(self, effect: dict[str, list[str]]) -> None:
        """Apply an effect as PlanSys2 does: each fact is notified by itself."""
        for fact in effect.get('delete', []):
            self._facts.remove(fact)
            self._notify.publish(Empty())
        for fact in effect.get('add', []):
            self._facts.append(fact)
            self._notify.publish(Empty())
        if not effect:
            self._notify.publish(Empty())

    def _get_domain(
        self, request: GetDomain.Request, response: GetDomain.Response
    ) -> GetDomain.Response:
        return self._reply(response, 'domain', self._task.domain)

    def _get_problem(
        self, request: GetProblem.Request, response: GetProblem.Response
    ) -> GetProblem.Response:
        return self._reply(response, 'problem', self._task.problem(self._facts))

    def _reply(self, response, name: str, text: str):
        response.success = self._active
        if self._active:
            setattr(response, name, text)
        else:
            response.error_info = 'Requesting service in non-active state'
        return response


def main() -> None:
    """Obey the lines on stdin until it ends."""
    with open(sys.argv[1]) as file:
        task = Task.read(file.read())
    rclpy.init(args=sys.argv)
    node = Plansys2(task)
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    lines = threading.Thread(target=obey_stdin, args=(node, executor), daemon=True)
    lines.start()
    try:
        while rclpy.ok() and lines.is_alive():
            executor.spin_once(timeout_sec=0.1)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        executor.shutdown()
        node.destroy_node()
        rclpy.try_shutdown()


def obey_stdin(node: Plansys2, executor: SingleThreadedExecutor) -> None:
    """Let the executor's thread do what each line says, and acknowledge it."""
    for line in sys.stdin:
        executor.create_task(node.obey, line).add_done_callback(acknowledge)


def acknowledge(task: rclpy.task.Future) -> None:
    """Write a line on stdout, which the error of what did not work is raised before."""
    task.result()
    print('done', flush=True)


if __name__ == '__main__':
    main()
