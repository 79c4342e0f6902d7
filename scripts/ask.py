"""Call /verbalize_plan as a person would, and show the answer beside the whole plan."""

import json
import sys
import threading
import time

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.signals import SignalHandlerOptions
from std_msgs.msg import String
from std_srvs.srv import Trigger

TIMEOUT = 60.0  # s, for the explainer to start, and then for an answer
PAUSE = 1.0  # s between two calls; what is over by then is not told


def main() -> int:
    """Ask once everything is up; return 0 if there was an answer, 130 on Ctrl-C."""
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
        return ask(client, explanations, explained)
    except KeyboardInterrupt:
        return 130
    finally:
        executor.shutdown()
        thread.join()
        node.destroy_node()
        rclpy.try_shutdown()


def ask(client, explanations: list[dict], explained: threading.Event) -> int:
    """Call until the node has heard the robot; print plan and answer."""
    if not client.wait_for_service(5 * PAUSE):
        tell(f'nothing offers {client.srv_name} yet: is the explainer running? Waiting for it.')
        if not client.wait_for_service(TIMEOUT):
            tell('the explainer did not start')
            return 1
    answer = succeeding(client)
    if answer is None or not explained.wait(TIMEOUT):
        tell(f'there was no answer for {TIMEOUT:.0f} s')
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


def succeeding(client) -> Trigger.Response | None:
    """Return the first answer that succeeds, None if there is none in time; tell what does not.

    The robot may not have been heard yet, and whoever sees why may mend it meanwhile.
    """
    end = time.monotonic() + TIMEOUT
    before = told = None
    while time.monotonic() < end:
        done = threading.Event()
        future = client.call_async(Trigger.Request())
        future.add_done_callback(lambda _, done=done: done.set())
        if not done.wait(TIMEOUT / 4):
            continue  # it was lost: the explainer did not know this client yet
        answer = future.result()
        if answer.success:
            return answer
        if answer.message == before != told:
            tell(f'{answer.message}\n(asking again until there is a plan to tell; Ctrl-C ends)')
            told = answer.message
        before = answer.message
        time.sleep(PAUSE)
    return None


def tell(text: str) -> None:
    """Tell what keeps the answer waiting."""
    print(text, file=sys.stderr, flush=True)


if __name__ == '__main__':
    sys.exit(main())
