"""How each of these small robots runs: until it is interrupted, or its input is wrong."""

import argparse
from collections.abc import Callable, Sequence

import rclpy
from rclpy.exceptions import ParameterException
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node

from mirror_explainer.errors import InputError, told
from mirror_explainer.node.start import parsed, refuse


def run(
    robot: Callable[[], Node], parser: argparse.ArgumentParser, args: Sequence[str] | None
) -> None:
    """Run a robot; what is wrong with its input ends it with one sentence of the parser's."""
    parsed(parser, args)
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
    except ParameterException as error:
        refuse(parser, error)
    finally:
        if node is not None:
            node.destroy_node()
        rclpy.try_shutdown()
