"""The topics on which a robot tells the explainer what it is doing, as far as it is new."""

from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String

from mirror_explainer.errors import InputError

LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class RobotTopics:
    """Publishes `domain`, `problem`, `plan` and `progress` in the namespace of a robot's node."""

    def __init__(self, node: Node) -> None:
        self._told: dict[str, str] = {}
        self._outputs = {
            topic: node.create_publisher(String, topic, LATCHED)
            for topic in ('domain', 'problem', 'progress', 'plan')
        }

    def told(self, topic: str) -> str:
        """Return what was published last on a topic, '' before that."""
        return self._told.get(topic, '')

    def tell(self, **texts: str) -> None:
        """Publish texts, each on the topic of its name, in this order, if they are new there.

        Progress that comes with a new plan is published even if it is as before: the explainer
        takes what it heard long before a plan for progress in the plan before.
        """
        if 'plan' in texts and texts['plan'] != self._told.get('plan'):
            self._told.pop('progress', None)
        for topic, text in texts.items():
            if self._told.get(topic) != text:
                self._told[topic] = text
                self._outputs[topic].publish(String(data=text))

    def tell_fault(self, error: InputError) -> None:
        """Publish why there is no plan to tell, in its place: the one before is over."""
        self.tell(plan=f'fault: {error}')
