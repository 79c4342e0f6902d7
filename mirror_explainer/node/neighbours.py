"""What a node sees of others in ROS: who publishes what it hears, and who serves the same."""

from collections import Counter

from rclpy.node import Node
from rclpy.qos import ReliabilityPolicy

from mirror_explainer.node.inputs import TOPICS
from mirror_explainer.node.surroundings import Others

# What ROS calls a node whose publisher it knows already, and not yet its name.
_UNKNOWN = '_NODE_NAME_UNKNOWN_'


def others_of(node: Node, service: str) -> Others:
    """Return what there is of nodes beside this one, an explainer that serves `service`.

    One node may publish a topic twice, such as latched and not.
    """
    there = Counter(
        _full_name(place, name) for name, place in node.get_node_names_and_namespaces()
    )
    publishers, unreliable = {}, {}
    for topic in TOPICS:
        infos = node.get_publishers_info_by_topic(node.resolve_topic_name(topic))
        publish = Counter(_full_name(info.node_namespace, info.node_name) for info in infos)
        nodes = {name: min(count, max(1, there[name])) for name, count in publish.items()}
        publishers[topic] = tuple(Counter(nodes).elements())
        heard = {
            _full_name(info.node_namespace, info.node_name)
            for info in infos
            if info.qos_profile.reliability is not ReliabilityPolicy.BEST_EFFORT
        }
        unreliable[topic] = tuple(sorted(publish.keys() - heard))
    is_alone = not publishers['problem'] and not publishers['plan']
    elsewhere = _plans_elsewhere(node) if is_alone else ()
    rivals = max(0, node.count_services(node.resolve_service_name(service)) - 1)
    return Others(publishers, unreliable, elsewhere, rivals)


def _plans_elsewhere(node: Node) -> tuple[str, ...]:
    """Return the namespaces in which somebody publishes a problem and a plan."""
    names = {
        name
        for name, types in node.get_topic_names_and_types()
        if 'std_msgs/msg/String' in types and node.count_publishers(name)
    }
    plans = (name.removesuffix('plan') for name in names if name.endswith('/plan'))
    return tuple(sorted(place for place in plans if f'{place}problem' in names))


def _full_name(namespace: str, name: str) -> str:
    """Return a node's name with its namespace, '' where ROS does not know it yet."""
    return '' if name == _UNKNOWN else f'{namespace.rstrip("/")}/{name}'
