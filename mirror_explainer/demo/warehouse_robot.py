"""A small robot stack for demo and tests: it carries out its plan in the warehouse.

After every step it republishes its problem, with the state as it now is, and the plan
that remains, as a robot's own stack may; or the plan once, and then only its state. It tells
its progress, too, if it is to.
"""

from collections import deque
from collections.abc import Sequence
from pathlib import Path

from ament_index_python.packages import get_package_share_directory
from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor
from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from std_msgs.msg import String
from std_srvs.srv import Trigger

from mirror_explainer.commands.command_line import command_parser
from mirror_explainer.node.robot_topics import LATCHED
from mirror_explainer.node.run import run
from mirror_explainer.node.start import parsed
from mirror_explainer.pddl import read_task
from mirror_explainer.pddl.plan_check import check_plan
from mirror_explainer.pddl.plan_text import Step, read_plan
from mirror_explainer.pddl.problem_text import with_state
from mirror_explainer.text_files import read_text


class WarehouseRobot(Node):
    """Carries out its plan, which was checked, a step every `step_period`.

    Publishers (std_msgs/String, latched):
        * **domain**: once
        * **problem**: with the state as it is after each step
        * **plan**: what is left of it, or, once for all, all of it (`plan_once`)
        * **progress**: the steps that are done, and the one that goes on (`tell_progress`)

    Services:
        * **~/restart** (std_srvs/Trigger): begin again, wherever it is

    Parameters, all read-only:
        * **domain_file**, **problem_file**, **plan_file**: another robot than the example
        * **step_period** (s): 0, the default, is to stand still
        * **plan_once**: publish the plan at the beginning only, and then nothing but the state
        * **tell_progress**: tell which steps are done, and which one goes on; and the plan once

    Raises InputError for files that cannot be read, or a plan that cannot be carried out.
    """

    def __init__(self) -> None:
        super().__init__('warehouse_robot')
        folder = Path(get_package_share_directory('mirror_explainer')) / 'config' / 'warehouse'
        domain_file = self._file('domain_file', folder / 'domain.pddl')
        problem_file = self._file('problem_file', folder / 'problem.pddl')
        plan_file = self._file('plan_file', folder / 'plan.txt')
        period = self.declare_parameter(
            'step_period',
            0.0,
            ParameterDescriptor(
                description='s for one action of the plan; 0: stand still',
                floating_point_range=[FloatingPointRange(from_value=0.0, to_value=3600.0)],
                read_only=True,
            ),
        ).value
        once = self._flag('plan_once', 'publish the plan once, and then only the state')
        tells = self._flag('tell_progress', 'tell which steps are done, and which one goes on')
        self._plan_once = once or tells  # progress is about the whole plan
        domain, problem = read_text(domain_file), read_text(problem_file)
        task = read_task(domain, problem, domain_file, problem_file)
        self._steps = read_plan(read_text(plan_file), plan_file)
        run = check_plan(task, self._steps, plan_file)
        # The steps, by position, in the order in which they end, and the problem after each.
        problems = (with_state(problem, state) for state in run.states[1:])
        self._run = list(zip(run.positions, problems, strict=True))
        self._initial = problem
        self._domain = self.create_publisher(String, 'domain', LATCHED)
        self._problem = self.create_publisher(String, 'problem', LATCHED)
        self._progress = self.create_publisher(String, 'progress', LATCHED) if tells else None
        self._plan = self.create_publisher(String, 'plan', LATCHED)
        self._domain.publish(String(data=domain))
        # Not the node's clock, which stands still when the system's is set back.
        steady = Clock(clock_type=ClockType.STEADY_TIME)
        self._timer = self.create_timer(period, self._step, clock=steady) if period else None
        self._begin()
        self.create_service(Trigger, '~/restart', self._on_restart)

    def _file(self, name: str, default: Path) -> str:
        """Return the path that a parameter gives."""
        descriptor = ParameterDescriptor(
            description=f'the file with the {name[:-5]}', read_only=True
        )
        path: str = self.declare_parameter(name, str(default), descriptor).value
        return path

    def _flag(self, name: str, description: str) -> bool:
        """Return what a parameter says that is false by default."""
        descriptor = ParameterDescriptor(description=description, read_only=True)
        value: bool = self.declare_parameter(name, False, descriptor).value
        return value

    def _begin(self) -> None:
        """Publish the initial state and the whole plan; the first step takes its time."""
        self._ahead = deque(self._run)
        self._problem.publish(String(data=self._initial))
        self._publish_progress()
        self._publish_plan()
        if self._timer is not None:
            self._timer.reset()

    def _on_restart(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        self._begin()
        self.get_logger().info('began again')
        response.success = True
        return response

    def _step(self) -> None:
        """Carry out the first action of the plan that remains, if one does."""
        if not self._ahead:
            return
        position, problem = self._ahead.popleft()
        self.get_logger().info(f'did {self._steps[position].action}')
        self._problem.publish(String(data=problem))
        self._publish_progress()
        if not self._plan_once:
            self._publish_plan()

    def _publish_plan(self) -> None:
        """Publish the plan that remains."""
        left = sorted(position for position, _ in self._ahead)
        self._plan.publish(String(data='\n'.join(_line(self._steps[p]) for p in left)))

    def _publish_progress(self) -> None:
        """Publish the steps that are done and, if it does not stand still, the one after them."""
        if self._progress is None:
            return
        done = {*range(len(self._steps))}.difference(position for position, _ in self._ahead)
        lines = [f'done: {self._steps[position].action}' for position in sorted(done)]
        if self._timer and self._ahead:
            lines.append(f'running: {self._steps[self._ahead[0][0]].action}')
        self._progress.publish(String(data='\n'.join(lines)))


def _line(step: Step) -> str:
    """Return a step as a line of a plan, with its times if it has them."""
    if step.start is None or step.end is None:
        return step.action
    return f'{step.start}: {step.action} [{round(step.end - step.start, 6)}]'


def main(args: Sequence[str] | None = None) -> None:
    """Run the robot until it is interrupted."""
    command = 'ros2 run mirror_explainer warehouse_robot'
    parser = command_parser(
        'warehouse_robot',
        'Publish a domain, a problem and a plan, and carry the plan out.',
        f'{command} --ros-args -p step_period:=5.0',
        f'{command} --ros-args -p step_period:=5.0 -p tell_progress:=true',
        'ros2 service call /warehouse_robot/restart std_srvs/srv/Trigger',
        ends='Parameters follow --ros-args: step_period, plan_once, tell_progress, and '
        'domain_file, problem_file and plan_file for another robot than the example.',
    )
    parsed(parser, args)
    run(WarehouseRobot, parser, args)


if __name__ == '__main__':
    main()
