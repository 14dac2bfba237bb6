"""tf2_ros for both ROS generations: buffer, listener, broadcasters."""

from __future__ import annotations

from typing import Any

from pytest_tarl.ros.missing import refuse
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
    """Name what is missing."""
    raise refuse("tf2_ros", name)
