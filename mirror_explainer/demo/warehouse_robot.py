"""A small robot stack for demo and tests: it carries out its plan in the warehouse.

After every step it republishes its problem, with the state as it now is, and
the plan that remains, as a robot's own stack should.
"""

import argparse
import warnings
from collections.abc import Sequence
from pathlib import Path

import rclpy
from ament_index_python.packages import get_package_share_directory
from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor
from rclpy.clock import Clock, ClockType
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.utilities import remove_ros_args
from std_msgs.msg import String
from unified_planning.engines import UPSequentialSimulator
from unified_planning.io import PDDLWriter
from unified_planning.plans import ActionInstance

from mirror_explainer.errors import InputError
from mirror_explainer.pddl import read_task
from mirror_explainer.pddl.plan_text import read_plan
from mirror_explainer.text_files import read_text

LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class WarehouseRobot(Node):
    """Publishes `domain`, `problem` and `plan`, latched, and acts a step every `step_period`.

    Raises InputError for files that cannot be read.
    """

    def __init__(self) -> None:
        super().__init__('warehouse_robot')
        folder = Path(get_package_share_directory('mirror_explainer')) / 'config' / 'warehouse'
        domain = self._text('domain_file', folder / 'domain.pddl')
        problem = self._text('problem_file', folder / 'problem.pddl')
        self._steps = list(read_plan(self._text('plan_file', folder / 'plan.txt')))
        period = self.declare_parameter(
            'step_period',
            0.0,
            ParameterDescriptor(
                description='s for one action of the plan; 0: stand still',
                floating_point_range=[FloatingPointRange(from_value=0.0, to_value=3600.0)],
                read_only=True,
            ),
        ).value
        self._model = read_task(domain, problem).model
        with warnings.catch_warnings():
            warnings.simplefilter('ignore')  # it is not sure of costs without a first value
            self._simulator = UPSequentialSimulator(self._model, error_on_failed_checks=False)
        self._state = self._simulator.get_initial_state()
        self._domain = self.create_publisher(String, 'domain', LATCHED)
        self._problem = self.create_publisher(String, 'problem', LATCHED)
        self._plan = self.create_publisher(String, 'plan', LATCHED)
        self._domain.publish(String(data=domain))
        self._publish()
        if period:
            # Not the node's clock, which stands still when the system's is set back.
            steady = Clock(clock_type=ClockType.STEADY_TIME)
            self._timer = self.create_timer(period, self._step, clock=steady)

    def _text(self, name: str, default: Path) -> str:
        """Return the content of the file that a parameter names."""
        descriptor = ParameterDescriptor(
            description=f'the file with the {name[:-5]}', read_only=True
        )
        path = self.declare_parameter(name, str(default), descriptor).value
        return read_text(path)

    def _step(self) -> None:
        """Carry out the first action of the plan that remains."""
        if not self._steps:
            self._timer.cancel()
            return
        step = self._steps.pop(0)
        name, *arguments = step.words
        objects = tuple(self._model.object(argument) for argument in arguments)
        action = ActionInstance(
            self._model.action(name),
            self._model.environment.expression_manager.auto_promote(objects),
        )
        state = self._simulator.apply(self._state, action)
        assert state is not None, f'{step.action} is not applicable'
        self._state = state
        self.get_logger().info(f'did {step.action}')
        self._publish()

    def _publish(self) -> None:
        """Publish the problem as it now is, and the plan that remains."""
        for fluent in self._model.initial_values:
            self._model.set_initial_value(fluent, self._state.get_value(fluent))
        self._problem.publish(String(data=PDDLWriter(self._model).get_problem()))
        self._plan.publish(String(data='\n'.join(step.action for step in self._steps)))


def main(args: Sequence[str] | None = None) -> None:
    """Run the robot until it is interrupted."""
    parser = argparse.ArgumentParser(
        'warehouse_robot',
        description='Publish a domain, a problem and a plan, and carry the plan out.',
        epilog='Parameters follow --ros-args: -p step_period:=5.0, and domain_file, problem_file '
        'and plan_file for another robot than the example.',
    )
    parser.parse_args(remove_ros_args(args)[1:])
    rclpy.init(args=args)
    node = None
    try:
        node = WarehouseRobot()
        while rclpy.ok():
            # Not `spin`: a signal that comes just before it waits would not wake it.
            rclpy.spin_once(node, timeout_sec=0.2)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    except InputError as error:
        parser.error(str(error))
    finally:
        if node is not None:
            node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
