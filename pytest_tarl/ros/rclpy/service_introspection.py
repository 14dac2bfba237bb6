"""`rclpy.service_introspection`: which service calls are published as events; none are here."""

from __future__ import annotations

from enum import IntEnum
from typing import Any


class ServiceIntrospectionState(IntEnum):
    """What a service's events contain."""

    OFF = 0
    METADATA = 1
    CONTENTS = 2


class Introspected:
    """Base of services and clients, whose calls can be published as events."""

    def configure_introspection(
        self, clock: Any, service_event_qos_profile: Any, introspection_state: ServiceIntrospectionState
    ) -> None:
        """Do nothing: service events are not published. Raise TypeError if the state is not one of rclpy's."""
        del clock, service_event_qos_profile
        if not isinstance(introspection_state, ServiceIntrospectionState):
            raise TypeError(f"{introspection_state!r} is not a ServiceIntrospectionState")
