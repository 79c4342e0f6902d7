"""Before ROS is there: the command line, and whether its log can be written."""

import argparse
import os
import tempfile
from collections.abc import Sequence
from typing import NoReturn

from rclpy._rclpy_pybind11 import RCLError
from rclpy.exceptions import InvalidParameterTypeException, ParameterException
from rclpy.utilities import remove_ros_args

from mirror_explainer.node.surroundings import package_version

LOG_LEVELS = ('debug', 'info', 'warn', 'error', 'fatal')


def argument_parser() -> argparse.ArgumentParser:
    """Return the parser of what is not for ROS."""
    parser = argparse.ArgumentParser(
        prog='explainer_node',
        description='Say on request what the robot is up to, in the few most telling steps.',
        epilog='example: ros2 run mirror_explainer explainer_node --log-level debug --ros-args '
        '-p user_model_file:=user_model.yaml. Parameters, remappings and the like follow '
        '--ros-args.',
    )
    parser.add_argument(
        '--log-level',
        type=str.lower,
        choices=LOG_LEVELS,
        help="log this node's own lines from this level up (default info)",
    )
    parser.add_argument('--version', action='version', version=f'%(prog)s {package_version()}')
    return parser


def parsed(parser: argparse.ArgumentParser, args: Sequence[str] | None) -> argparse.Namespace:
    """Return what of a command line is not for ROS; what ROS cannot read ends the program."""
    try:
        return parser.parse_args(remove_ros_args(args)[1:])
    except RCLError as error:
        parser.error(str(error).split(', at /')[0].strip())


def refuse(parser: argparse.ArgumentParser, error: ParameterException) -> NoReturn:
    """End the program for a parameter that its node cannot take."""
    decimal = isinstance(error, InvalidParameterTypeException) and "'DOUBLE'" in str(error)
    parser.error(f'{error}{" (write a decimal with its point, as in 4.0)" if decimal else ""}')


def write_fault(folder: str) -> OSError | None:
    """Return why no log file can be written here, None if one can: ROS would not start without."""
    try:
        os.makedirs(folder, exist_ok=True)
        with tempfile.NamedTemporaryFile(dir=folder):
            return None
    except OSError as error:
        return error
