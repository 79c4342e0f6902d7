"""A diagnosis as the message that ROS tools show."""

from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue

from mirror_explainer.node.answers import printable
from mirror_explainer.node.diagnostics import Diagnosis


def diagnostic_array(found: Diagnosis, name: str, stamp: Time) -> DiagnosticArray:
    """Return the message for /diagnostics, with one status of this name."""
    status = DiagnosticStatus(
        level=bytes([found.level]),
        name=name,
        hardware_id='none',
        message=printable(found.message),
        values=[KeyValue(key=key, value=printable(text)) for key, text in found.values.items()],
    )
    array = DiagnosticArray(status=[status])
    array.header.stamp = stamp
    return array
