"""Call /verbalize_plan as a person would, and show the answer beside the whole plan."""

import argparse
import json
import sys
import threading
import time
from collections.abc import Iterator

try:
    import rclpy
    from rclpy.executors import SingleThreadedExecutor
    from rclpy.node import Node
    from rclpy.qos import DurabilityPolicy, QoSProfile
    from rclpy.signals import SignalHandlerOptions
    from rclpy.utilities import remove_ros_args
    from std_msgs.msg import String
    from std_srvs.srv import Trigger
except ModuleNotFoundError as missing:
    sys.exit(
        f'there is no {missing.name} here: source ROS 2 (. /opt/ros/jazzy/setup.bash), '
        'or activate the environment (. .venv/bin/activate)'
    )

PAUSE = 1.0  # s between two calls; what is over by then is not told


def options() -> argparse.Namespace:
    """Return what the command line asks for."""
    parser = argparse.ArgumentParser(
        description='Ask the robot "What are you up to?", and show the answer beside its plan.',
        epilog='Exit status: 0 with an answer, 1 without (no plan, or a fault), 130 on Ctrl-C. '
        'What is for ROS follows --ros-args, such as -r __ns:=/robot1.',
    )
    parser.add_argument(
        '--once',
        action='store_true',
        help='ask once, and print nothing but what the robot says: for scripts',
    )
    parser.add_argument(
        '--timeout',
        type=float,
        default=60.0,
        metavar='S',
        help='s, to wait for the explainer, and again for an answer (default: %(default)g)',
    )
    return parser.parse_args(remove_ros_args(sys.argv)[1:])


def main() -> int:
    """Ask once everything is up; return 0 if there was an answer, 130 on Ctrl-C."""
    wanted = options()
    # ROS would end under a call that waits.
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    node = Node('operator')
    explanations: list[dict] = []
    explained = threading.Event()

    def on_explanation(message: String) -> None:
        explanations.append(json.loads(message.data))
        explained.set()

    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    node.create_subscription(String, 'mirror_explainer/explanation', on_explanation, latched)
    client = node.create_client(Trigger, 'verbalize_plan')
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    thread = threading.Thread(target=executor.spin, daemon=True)
    thread.start()
    try:
        if not is_there(node, client, wanted.timeout):
            return 1
        if wanted.once:
            return ask_once(client, wanted.timeout)
        return ask(client, wanted.timeout, explanations, explained)
    except KeyboardInterrupt:
        return 130
    finally:
        executor.shutdown()
        thread.join()
        node.destroy_node()
        rclpy.try_shutdown()


def is_there(node: Node, client, timeout: float) -> bool:
    """Wait for the explainer; return whether it is there.

    After a while tell that it is not, and of those in other namespaces as they become known, which
    takes its time: of each once.
    """
    name = node.resolve_service_name('verbalize_plan')
    begin = time.monotonic()
    told: set[str] | None = None
    while not client.wait_for_service(min(timeout, PAUSE)):
        waited = time.monotonic() - begin
        if waited >= min(timeout, 5 * PAUSE):
            others = namespaces_of_others(node, name)
            if told is None or others - told:
                tell(f'nothing offers {name} yet: {hint(sorted(others - (told or set())))}')
                told = others | (told or set())
        if waited >= timeout:
            tell('the explainer did not start')
            return False
    return True


def namespaces_of_others(node: Node, name: str) -> set[str]:
    """Return the namespaces of the explainers that are called by other names than this."""
    return {
        other.removesuffix('/verbalize_plan') or '/'
        for other, _ in node.get_service_names_and_types()
        if other.endswith('/verbalize_plan') and other != name and node.count_services(other)
    }


def hint(namespaces: list[str]) -> str:
    """Say what may be wrong where explainers are in these namespaces alone."""
    if not namespaces:
        return 'is the explainer running? Waiting for it.'
    there = ', '.join(namespaces)
    return f'explainers are in {there} (--ros-args -r __ns:={namespaces[0]}). Waiting for it.'


def ask_once(client, timeout: float) -> int:
    """Print what the robot says, also where it has no plan; return the exit status."""
    answer = next(answers(client, timeout), None)
    if answer is None:
        tell(f'there was no answer for {timeout:g} s')
        return 1
    print(answer.message)
    return 0 if answer.success else 1


def ask(client, timeout: float, explanations: list[dict], explained: threading.Event) -> int:
    """Call until the node has heard the robot; print plan and answer."""
    answer = succeeding(client, timeout)
    if answer is None or not explained.wait(timeout):
        tell(f'there was no answer for {timeout:g} s')
        return 1
    explanation = explanations[-1]
    print("The robot's plan, with the actions that it tells marked:\n")
    for step in explanation['plan']:
        mark = '>' if step['position'] in explanation['positions'] else ' '
        print(f'  {mark} {step["position"]}  {step["action"]:32} {step["sentence"]}')
    print(
        '\nYou ask: "What are you up to?"  (ros2 service call /verbalize_plan '
        'std_srvs/srv/Trigger)\n'
    )
    print('\n'.join(f'  Robot: "{sentence}"' for sentence in answer.message.splitlines()))
    before, after = explanation['understanding_before'], explanation['understanding']
    print(f"\nHow likely you find the robot's true goal: {before:.0%} before, {after:.0%} now.")
    return 0


def succeeding(client, timeout: float) -> Trigger.Response | None:
    """Return the first answer that succeeds, None if there is none in time; tell what does not.

    The robot may not have been heard yet, and whoever sees why may mend it meanwhile.
    """
    before = told = None
    for answer in answers(client, timeout):
        if answer.success:
            return answer
        if answer.message == before != told:
            tell(
                f'{answer.message}\n(asking again until there is a plan to tell; the log of the '
                'explainer says what it waits for; Ctrl-C ends)'
            )
            told = answer.message
        before = answer.message
        time.sleep(PAUSE)
    return None


def answers(client, timeout: float) -> Iterator[Trigger.Response]:
    """Yield the answers to one call after the other, for so many seconds."""
    end = time.monotonic() + timeout
    while time.monotonic() < end:
        done = threading.Event()
        future = client.call_async(Trigger.Request())
        future.add_done_callback(lambda _, done=done: done.set())
        if done.wait(timeout / 4):  # else it was lost: the explainer did not know this client yet
            yield future.result()


def tell(text: str) -> None:
    """Tell what keeps the answer waiting."""
    print(text, file=sys.stderr, flush=True)


if __name__ == '__main__':
    sys.exit(main())
