"""rclpy's lifecycle nodes: a state machine driven by a test, a manager or the node itself."""

from __future__ import annotations

from pytest_tarl.ros.rclpy.lifecycle.entities import (
    LifecyclePublisher,
    ManagedEntity,
    SimpleManagedEntity,
)
from pytest_tarl.ros.rclpy.lifecycle.node import LifecycleNode, LifecycleNodeMixin
from pytest_tarl.ros.rclpy.lifecycle.states import LifecycleState, TransitionCallbackReturn

Node, NodeMixin = LifecycleNode, LifecycleNodeMixin
State, Publisher = LifecycleState, LifecyclePublisher

__all__ = [
    "LifecycleNode", "LifecycleNodeMixin", "LifecyclePublisher", "LifecycleState", "ManagedEntity", "Node", "NodeMixin",
    "Publisher", "SimpleManagedEntity", "State", "TransitionCallbackReturn",
]  # fmt: skip
