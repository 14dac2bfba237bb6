"""tf2_ros for both ROS generations: buffer, listener, broadcasters."""

from __future__ import annotations

from typing import Any

from pytest_tarl.ros.tf2_ros.broadcasting import (
    StaticTransformBroadcaster,
    TransformBroadcaster,
    TransformListener,
)
from pytest_tarl.ros.tf2_ros.buffer import Buffer, BufferInterface, TransformRegistration, TypeException
from pytest_tarl.ros.tf2_ros.serving import BufferClient, BufferServer
from pytest_tarl.ros.transforms import (
    ConnectivityException,
    ExtrapolationException,
    InvalidArgumentException,
    LookupException,
    TimeoutException,
    TransformException,
)

__all__ = [
    "Buffer", "BufferClient", "BufferInterface", "BufferServer", "ConnectivityException", "ExtrapolationException",
    "InvalidArgumentException", "LookupException", "StaticTransformBroadcaster", "TimeoutException",
    "TransformBroadcaster", "TransformException", "TransformListener", "TransformRegistration", "TypeException",
]  # fmt: skip


def __getattr__(name: str) -> Any:
    """Return a message class that tf2_ros exposes; raise for a name that the stand-in lacks."""
    package = {"TransformStamped": "geometry_msgs", "TFMessage": "tf2_msgs"}.get(name)
    if package is not None:
        from pytest_tarl.ros.install import kind_of_caller
        from pytest_tarl.ros.messages import class_of

        return class_of(kind_of_caller(), f"{package}/{name}")
    raise AttributeError(name)
