"""How each node of this package runs: until it is interrupted, or its input is wrong."""

import argparse
import logging
import sys
import traceback
from collections.abc import Callable, Sequence
from typing import Any

import rclpy
from rclpy._rclpy_pybind11 import RCLError
from rclpy.exceptions import ParameterException
from rclpy.executors import Executor, ExternalShutdownException, SingleThreadedExecutor
from rclpy.logging import get_logging_directory
from rclpy.node import Node

from mirror_explainer.errors import InputError, told
from mirror_explainer.node.start import refuse, write_fault


def run(
    make_node: Callable[[], Node],
    parser: argparse.ArgumentParser,
    args: Sequence[str] | None,
    make_executor: Callable[[], Executor] = SingleThreadedExecutor,
    log: logging.Logger | None = None,
) -> None:
    """Run a node; what is wrong with its input ends it with one sentence of the parser's.

    Faults of callbacks go to `log`, by default the node's own.
    """
    log_fault = write_fault(get_logging_directory())
    if log_fault:  # a full disk must not keep the node from starting
        args = [*(sys.argv if args is None else args), '--ros-args', '--disable-external-lib-logs']
    rclpy.init(args=args)
    node = None
    executor = make_executor()
    try:
        node = make_node()
        if log_fault:
            node.get_logger().warning(f'there is no log file: {log_fault}')
        executor.add_node(node)
        spin(executor, log or node.get_logger())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    except InputError as error:
        parser.error(told(error))
    except ParameterException as error:
        refuse(parser, error)
    except RCLError:
        if rclpy.ok():  # otherwise a signal came before the node was there
            raise
    finally:
        executor.shutdown(timeout_sec=1.0)
        if node is not None:
            node.destroy_node()
        rclpy.try_shutdown()


def spin(executor: Executor, log: Any) -> None:
    """Do what is due until ROS ends, and log what goes wrong in a callback.

    Not `Executor.spin`: a signal that comes just before it waits would not wake it. And callbacks
    of rclpy's own raise for messages such as a parameter of a type that there is not.
    """
    while rclpy.ok():
        try:
            executor.spin_once(timeout_sec=0.5)
        except ExternalShutdownException:
            return
        except RCLError:
            if rclpy.ok():  # otherwise a signal came just before the executor waited
                raise
        except Exception:
            log.error(f'a callback of ROS failed: {traceback.format_exc()}')
