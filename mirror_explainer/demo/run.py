"""How each of these small robots runs: until it is interrupted, or its input is wrong."""

import argparse
from collections.abc import Callable, Sequence

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.utilities import remove_ros_args

from mirror_explainer.errors import InputError, told


def run(
    robot: Callable[[], Node], parser: argparse.ArgumentParser, args: Sequence[str] | None
) -> None:
    """Run a robot; what is wrong with its input ends it with one sentence of the parser's."""
    parser.parse_args(remove_ros_args(args)[1:])
    rclpy.init(args=args)
    node = None
    try:
        node = robot()
        while rclpy.ok():
            # Not `spin`: a signal that comes just before it waits would not wake it.
            rclpy.spin_once(node, timeout_sec=0.2)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    except InputError as error:
        parser.error(told(error))
    finally:
        if node is not None:
            node.destroy_node()
        rclpy.try_shutdown()
