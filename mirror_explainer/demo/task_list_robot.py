"""A node for robots without PDDL: hears their tasks as a text, and tells the explainer.

For whoever does not program in Python; who does may call `TaskList` from the robot's own node.
"""

from collections.abc import Sequence

from rcl_interfaces.msg import ParameterDescriptor
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import QoSProfile
from std_msgs.msg import String

from mirror_explainer.commands.command_line import command_parser
from mirror_explainer.errors import InputError, told
from mirror_explainer.node.robot_topics import LATCHED
from mirror_explainer.node.run import run
from mirror_explainer.node.start import parsed
from mirror_explainer.node.task_list import TaskList


class TaskListRobot(Node):
    """Publishes what `TaskList` does from what it hears on `tasks` (std_msgs/String).

    Each message is the whole list, one task a line, in order, with `done:`, `running:`,
    `skipped:` or `failed:` before those that are not ahead. An empty one: nothing to do. What is
    wrong with one is in the log, and in the explainer's answers until the next one comes. The
    parameters `known_tasks` and `user_model_file` name tasks that it may have at other times.
    """

    def __init__(self) -> None:
        super().__init__('task_list_robot')
        known = self.declare_parameter(
            'known_tasks',
            Parameter.Type.STRING_ARRAY,
            ParameterDescriptor(
                description='all tasks that the robot may ever have', read_only=True
            ),
        ).value
        user_model_file = self.declare_parameter(
            'user_model_file',
            '',
            ParameterDescriptor(
                description='the user model, whose goals name such tasks, too', read_only=True
            ),
        ).value
        self._tasks = TaskList(self, known or (), user_model_file)
        # A volatile publisher is heard by the first, a late start made good by the second.
        for qos in (heard_now := QoSProfile(depth=10), LATCHED):
            # Only what the volatile one can't hear is not heard: warn of that.
            warnings = SubscriptionEventCallbacks(use_default_callbacks=qos is heard_now)
            self.create_subscription(
                String, 'tasks', self._on_tasks, qos, event_callbacks=warnings
            )

    def _on_tasks(self, message: String) -> None:
        try:
            self._tasks.tell_text(message.data)
        except InputError as error:
            self.get_logger().error(told(error))


def main(args: Sequence[str] | None = None) -> None:
    """Run the node until it is interrupted."""
    command = 'ros2 run mirror_explainer task_list_robot'
    parser = command_parser(
        'task_list_robot',
        'Tell the explainer the tasks that are heard on the topic "tasks".',
        f'{command} --ros-args -p user_model_file:=/path/user_model.yaml',
        ends='Parameters follow --ros-args.',
    )
    parsed(parser, args)
    run(TaskListRobot, parser, args)


if __name__ == '__main__':
    main()
