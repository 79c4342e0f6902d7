"""PlanSys2's messages, which are there where PlanSys2 is: this package does not depend on them."""

from types import ModuleType
from typing import Any, NamedTuple

from mirror_explainer.errors import InputError

PACKAGE = 'plansys2_msgs'
# What the bridge reads of each, named as in PlanSys2 for Jazzy.
FIELDS = {
    'ActionExecutionInfo': ('status', 'action_full_name'),
    'Plan': ('items',),
    'PlanItem': ('time', 'action', 'duration'),
    'GetDomain': ('success', 'domain', 'error_info'),
    'GetProblem': ('success', 'problem', 'error_info'),
}


class Messages(NamedTuple):
    """The types of PlanSys2's topics and services."""

    ActionExecutionInfo: Any
    Plan: Any
    GetDomain: Any
    GetProblem: Any


def plansys2_messages() -> Messages:
    """Return PlanSys2's types; raises InputError where they are missing, or other ones."""
    try:
        from plansys2_msgs import msg, srv
    except ModuleNotFoundError as error:
        if error.name != PACKAGE:
            raise _unusable(error) from error
        raise InputError(
            PACKAGE,
            "PlanSys2's messages are not installed here",
            cure='Install them (sudo apt install ros-jazzy-plansys2-msgs), or source the '
            'workspace that has PlanSys2, and start again.',
        ) from error
    except ImportError as error:
        raise _unusable(error) from error
    return checked(msg, srv)


def checked(msg: ModuleType, srv: ModuleType) -> Messages:
    """Return the types of these modules; raises InputError if one lacks what the bridge reads."""
    missing = [
        f'{name}.{field}'
        for name, fields in FIELDS.items()
        for field in fields
        if field not in _fields(msg, srv, name)
    ]
    if missing:
        raise InputError(
            PACKAGE,
            f'these are not the messages of PlanSys2 for Jazzy, which have {", ".join(missing)}',
            cure='Use a version of PlanSys2 for ROS 2 Jazzy.',
        )
    return Messages(msg.ActionExecutionInfo, msg.Plan, srv.GetDomain, srv.GetProblem)


def _fields(msg: ModuleType, srv: ModuleType, name: str) -> dict[str, str]:
    """Return the fields of a message, or of a service's response; none where it is missing."""
    found = getattr(msg, name, None) or getattr(getattr(srv, name, None), 'Response', None)
    return {} if found is None else dict(found.get_fields_and_field_types())


def _unusable(error: ImportError) -> InputError:
    return InputError(
        PACKAGE,
        f"PlanSys2's messages cannot be loaded: {error}",
        cure='Source the setup file of the workspace that has them, and start again.',
    )
