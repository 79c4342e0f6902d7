"""Before ROS is there: the command line, and whether its log can be written."""

import argparse
import os
import tempfile
from collections.abc import Sequence
from typing import NoReturn

from rclpy._rclpy_pybind11 import RCLError
from rclpy.exceptions import InvalidParameterTypeException, ParameterException
from rclpy.utilities import remove_ros_args


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
