"""Quality-of-service profiles. Only depth, history and durability matter here: delivery is always reliable."""

from __future__ import annotations

from enum import Enum, IntEnum
from typing import Any

from pytest_tarl.ros.rclpy.time import Duration


class InvalidQoSProfileException(Exception):  # noqa: N818 (named by rclpy)
    """A profile lacks a required setting."""

    def __init__(self, *args: Any) -> None:
        super().__init__("Invalid QoSProfile", *args)


class HistoryPolicy(IntEnum):
    """Which messages a queue keeps."""

    SYSTEM_DEFAULT = 0
    RMW_QOS_POLICY_HISTORY_SYSTEM_DEFAULT = 0
    KEEP_LAST = 1
    RMW_QOS_POLICY_HISTORY_KEEP_LAST = 1
    KEEP_ALL = 2
    RMW_QOS_POLICY_HISTORY_KEEP_ALL = 2
    UNKNOWN = 3


class ReliabilityPolicy(IntEnum):
    """Whether a message may be lost."""

    SYSTEM_DEFAULT = 0
    RMW_QOS_POLICY_RELIABILITY_SYSTEM_DEFAULT = 0
    RELIABLE = 1
    RMW_QOS_POLICY_RELIABILITY_RELIABLE = 1
    BEST_EFFORT = 2
    RMW_QOS_POLICY_RELIABILITY_BEST_EFFORT = 2
    UNKNOWN = 3
    BEST_AVAILABLE = 4


class DurabilityPolicy(IntEnum):
    """Whether later subscribers get earlier messages."""

    SYSTEM_DEFAULT = 0
    RMW_QOS_POLICY_DURABILITY_SYSTEM_DEFAULT = 0
    TRANSIENT_LOCAL = 1
    RMW_QOS_POLICY_DURABILITY_TRANSIENT_LOCAL = 1
    VOLATILE = 2
    RMW_QOS_POLICY_DURABILITY_VOLATILE = 2
    UNKNOWN = 3
    BEST_AVAILABLE = 4


class LivelinessPolicy(IntEnum):
    """How a publisher asserts that it is alive."""

    SYSTEM_DEFAULT = 0
    AUTOMATIC = 1
    MANUAL_BY_TOPIC = 3
    UNKNOWN = 4
    BEST_AVAILABLE = 5


QoSHistoryPolicy = HistoryPolicy
QoSReliabilityPolicy = ReliabilityPolicy
QoSDurabilityPolicy = DurabilityPolicy
QoSLivelinessPolicy = LivelinessPolicy


class QoSProfile:
    """A profile; it needs a `depth`, or a `history` without depth, such as KEEP_ALL."""

    def __init__(self, **given: Any) -> None:
        if "history" not in given and "depth" not in given:
            raise InvalidQoSProfileException("History and/or depth settings are required.")
        self.history = HistoryPolicy(given.pop("history", HistoryPolicy.KEEP_LAST))
        if self.history == HistoryPolicy.KEEP_LAST and "depth" not in given:
            raise InvalidQoSProfileException("History set to KEEP_LAST without a depth setting.")
        self.depth = int(given.pop("depth", 0))
        self.reliability = ReliabilityPolicy(given.pop("reliability", ReliabilityPolicy.RELIABLE))
        self.durability = DurabilityPolicy(given.pop("durability", DurabilityPolicy.VOLATILE))
        self.lifespan = given.pop("lifespan", Duration())
        self.deadline = given.pop("deadline", Duration())
        self.liveliness = LivelinessPolicy(given.pop("liveliness", LivelinessPolicy.SYSTEM_DEFAULT))
        self.liveliness_lease_duration = given.pop("liveliness_lease_duration", Duration())
        self.avoid_ros_namespace_conventions = bool(given.pop("avoid_ros_namespace_conventions", False))
        if given:
            raise AssertionError(f"Unexpected keyword arguments: {', '.join(given)}")

    @property
    def capacity(self) -> int | None:
        """Return the queue length of this profile; None if unlimited."""
        return None if self.history == HistoryPolicy.KEEP_ALL else max(self.depth, 1)

    def satisfies(self, wanted: QoSProfile) -> bool:
        """Return whether a publisher with this profile connects to a subscription with profile `wanted`."""
        lossy = (
            self.reliability == ReliabilityPolicy.BEST_EFFORT
            and wanted.reliability == ReliabilityPolicy.RELIABLE
        )
        forgetful = (
            wanted.durability == DurabilityPolicy.TRANSIENT_LOCAL
            and self.durability == DurabilityPolicy.VOLATILE
        )
        return not (lossy or forgetful)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, QoSProfile) and vars(self) == vars(other)

    __hash__ = None  # type: ignore[assignment]


def as_profile(given: Any) -> QoSProfile:
    """Return the profile for an argument that is a profile or a depth.

    Raise ValueError for a negative depth, and TypeError for other arguments.
    """
    if isinstance(given, QoSProfile):
        return given
    if isinstance(given, int) and not isinstance(given, bool):
        if given < 0:
            raise ValueError("Depth must be greater than or equal to zero")
        return QoSProfile(depth=given)
    raise TypeError("Expected QoSProfile or int, but received {!r}".format(type(given)))  # noqa: UP032


_BEST_EFFORT = ReliabilityPolicy.BEST_EFFORT
qos_profile_default = QoSProfile(depth=10)
qos_profile_unknown = qos_profile_default
qos_profile_system_default = QoSProfile(history=HistoryPolicy.SYSTEM_DEFAULT, depth=10)
qos_profile_sensor_data = QoSProfile(depth=5, reliability=_BEST_EFFORT)
qos_profile_best_available = QoSProfile(depth=10)
qos_profile_services_default = QoSProfile(depth=10)
qos_profile_parameters = QoSProfile(depth=1000)
qos_profile_parameter_events = QoSProfile(depth=1000)
qos_profile_rosout_default = QoSProfile(depth=1000, durability=DurabilityPolicy.TRANSIENT_LOCAL)
qos_profile_action_status_default = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class QoSCompatibility(IntEnum):
    """How compatible two profiles are."""

    OK = 0
    WARNING = 1
    ERROR = 2


def qos_check_compatible(
    publisher_qos: QoSProfile, subscription_qos: QoSProfile
) -> tuple[QoSCompatibility, str]:
    """Return the compatibility of a publisher and a subscription, and why they do not connect, if so."""
    if publisher_qos.satisfies(subscription_qos):
        return QoSCompatibility.OK, ""
    return QoSCompatibility.ERROR, "ERROR: the publisher offers less than the subscription asks for;"


class QoSPresetProfiles(Enum):
    """The profiles that ROS provides."""

    DEFAULT = qos_profile_default
    SYSTEM_DEFAULT = qos_profile_system_default
    SENSOR_DATA = qos_profile_sensor_data
    BEST_AVAILABLE = qos_profile_best_available
    SERVICES_DEFAULT = qos_profile_services_default
    PARAMETERS = qos_profile_parameters
    PARAMETER_EVENTS = qos_profile_parameter_events
    ACTION_STATUS_DEFAULT = qos_profile_action_status_default

    @classmethod
    def short_keys(cls) -> list[str]:
        """Return the names of the profiles in lower case."""
        return [one.lower() for one in cls.__members__]

    @classmethod
    def get_from_short_key(cls, name: str) -> Any:
        """Return the profile with this name (in any case). Raise KeyError."""
        return cls[name.upper()].value
