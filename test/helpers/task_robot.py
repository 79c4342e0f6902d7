"""A robot without PDDL: its tasks go straight to an explainer, with no ROS between."""

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

from std_msgs.msg import String
from test_live_explainer import Operator

from mirror_explainer.node.task_list import TaskList


def robot_of(operator: Callable[..., Operator], user_model_file: str, **settings: Any) -> Any:
    """Return an operator whose `tasks` tell its explainer a list of tasks, with its log."""
    robot: Any = operator(user_model_file=user_model_file, **settings)

    def create_publisher(_: type, topic: str, __: object) -> SimpleNamespace:
        def publish(message: String) -> None:
            robot.publish(**{topic: message.data})

        return SimpleNamespace(publish=publish)

    robot.warnings = []
    log = SimpleNamespace(warning=robot.warnings.append)
    node: Any = SimpleNamespace(create_publisher=create_publisher, get_logger=lambda: log)
    robot.tasks = TaskList(node, user_model_file=user_model_file)
    return robot
