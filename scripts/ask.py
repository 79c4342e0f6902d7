"""Call /verbalize_plan as a person would, and show the answer beside the whole plan."""

import json
import sys
import threading

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String
from std_srvs.srv import Trigger

TIMEOUT = 60.0  # s


def main() -> int:
    """Ask once everything is up; return 0 if there was an answer."""
    rclpy.init()
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
    finally:
        executor.shutdown()
        thread.join()
        node.destroy_node()
        rclpy.try_shutdown()


def ask(client, explanations: list[dict], explained: threading.Event) -> int:
    """Call until the node has heard the robot; print plan and answer."""
    if not client.wait_for_service(TIMEOUT):
        print('the explainer did not start', file=sys.stderr)
        return 1
    answer = None
    for _ in range(int(TIMEOUT)):
        done = threading.Event()
        future = client.call_async(Trigger.Request())
        future.add_done_callback(lambda _: done.set())
        if not done.wait(TIMEOUT):
            break
        answer = future.result()
        if answer.success:
            break
        threading.Event().wait(1.0)  # the robot may not have been heard yet
    if answer is None or not answer.success or not explained.wait(TIMEOUT):
        print(answer.message if answer else 'no answer', file=sys.stderr)
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


if __name__ == '__main__':
    sys.exit(main())
