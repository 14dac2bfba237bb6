"""`rclpy.service_introspection`: which calls of a service are published as events; here none are."""

from __future__ import annotations

from enum import IntEnum
from typing import Any


class ServiceIntrospectionState(IntEnum):
    """What the events of a service contain."""

    OFF = 0
    METADATA = 1
    CONTENTS = 2


class Introspected:
    """Common part of services and clients, whose calls can be published as events."""

    def configure_introspection(
        self, clock: Any, service_event_qos_profile: Any, introspection_state: ServiceIntrospectionState
    ) -> None:
        """Do nothing: the topic of service events is not published. Raise TypeError for another state."""
        del clock, service_event_qos_profile
        if not isinstance(introspection_state, ServiceIntrospectionState):
            raise TypeError(f"{introspection_state!r} is not a ServiceIntrospectionState")
