"""Parameters that override the quality of service: `qos_overrides./topic.publisher.reliability`."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from copy import copy
from enum import Enum, IntEnum
from typing import Any

from pytest_tarl.ros.messages import find_class
from pytest_tarl.ros.rclpy.descriptors import new_descriptor
from pytest_tarl.ros.rclpy.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    LivelinessPolicy,
    QoSProfile,
    ReliabilityPolicy,
)
from pytest_tarl.ros.rclpy.time import Duration

_ENUMS: dict[str, type[IntEnum]] = {
    "history": HistoryPolicy,
    "reliability": ReliabilityPolicy,
    "durability": DurabilityPolicy,
    "liveliness": LivelinessPolicy,
}
QosCallbackType = Callable[[QoSProfile], Any]  # rclpy's name, which nodes use in annotations
_DURATIONS = ("deadline", "lifespan", "liveliness_lease_duration")


def __getattr__(name: str) -> Any:
    """Return the class of a callback's result; raise for a name that the stand-in lacks."""
    if name == "QosCallbackResult":
        return find_class("ros2", "rcl_interfaces", "SetParametersResult")
    raise AttributeError(name)


class QoSPolicyKind(IntEnum):
    """The policies of a profile."""

    INVALID = 1 << 0
    DURABILITY = 1 << 1
    DEADLINE = 1 << 2
    LIVELINESS = 1 << 3
    RELIABILITY = 1 << 4
    HISTORY = 1 << 5
    LIFESPAN = 1 << 6
    DEPTH = 1 << 7
    LIVELINESS_LEASE_DURATION = 1 << 8
    AVOID_ROS_NAMESPACE_CONVENTIONS = 1 << 9


class InvalidQosOverridesError(Exception):
    """A parameter has no valid value for a policy, or the node's callback rejects the profile."""


class QoSOverridingOptions:
    """The policies that parameters may override; `callback` accepts or rejects the resulting profile."""

    def __init__(
        self,
        policy_kinds: Iterable[QoSPolicyKind],
        *,
        callback: Callable[[QoSProfile], Any] | None = None,
        entity_id: str | None = None,
    ) -> None:
        self.policy_kinds = tuple(policy_kinds)
        self.callback = callback
        self.entity_id = entity_id

    @classmethod
    def with_default_policies(
        cls, *, callback: Callable[[QoSProfile], Any] | None = None, entity_id: str | None = None
    ) -> QoSOverridingOptions:
        """Return options that let parameters override history, depth and reliability."""
        kinds = (QoSPolicyKind.HISTORY, QoSPolicyKind.DEPTH, QoSPolicyKind.RELIABILITY)
        return cls(kinds, callback=callback, entity_id=entity_id)


def overridden(node: Any, kind: str, topic: str, profile: QoSProfile, options: Any) -> QoSProfile:
    """Declare the parameters of a publisher or subscription (`kind`); return the profile with their values.

    Raise InvalidQosOverridesError for an invalid value, or if the options' callback rejects the profile.
    """
    if options is None:
        return profile
    made = copy(profile)
    entity = f"{kind}_{options.entity_id}" if options.entity_id else kind
    for policy in options.policy_kinds:
        field = policy.name.lower()
        name = f"qos_overrides.{topic}.{entity}.{field}"
        if not node.has_parameter(name):
            node.declare_parameter(name, _stated(getattr(made, field)), new_descriptor(read_only=True))
        setattr(made, field, _read(field, node.get_parameter(name).value))
    answer = options.callback(made) if options.callback is not None else None
    if answer is not None and not answer.successful:
        raise InvalidQosOverridesError(f"{options.callback.__name__} refused the profile: {answer.reason}")
    return made


def _stated(value: Any) -> Any:
    """Return the value of a policy as a parameter."""
    if isinstance(value, Enum):
        return value.name.lower()
    return value.nanoseconds if isinstance(value, Duration) else value


def _read(field: str, value: Any) -> Any:
    """Return the policy that a parameter specifies."""
    if field in _DURATIONS:
        return Duration(nanoseconds=value)
    if field not in _ENUMS:
        return value
    try:
        return _ENUMS[field][str(value).upper()]
    except KeyError:
        known = ", ".join(one.lower() for one in _ENUMS[field].__members__ if not one.startswith("RMW"))
        raise InvalidQosOverridesError(f"{value!r} is not a valid {field}: use one of {known}") from None
