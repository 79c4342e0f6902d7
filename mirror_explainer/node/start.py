"""Before ROS is there: the command line, and whether its log can be written."""

import argparse
import os
import tempfile

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


def write_fault(folder: str) -> OSError | None:
    """Return why no log file can be written here, None if one can: ROS would not start without."""
    try:
        os.makedirs(folder, exist_ok=True)
        with tempfile.NamedTemporaryFile(dir=folder):
            return None
    except OSError as error:
        return error
