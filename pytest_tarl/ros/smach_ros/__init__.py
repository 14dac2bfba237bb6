"""smach_ros for ROS 1: states that use actions, services and topics, and containers as action servers."""

from __future__ import annotations

from pytest_tarl.ros.smach_ros.actions import SimpleActionState
from pytest_tarl.ros.smach_ros.introspection import IntrospectionServer
from pytest_tarl.ros.smach_ros.monitoring import ConditionState, MonitorState, set_preempt_handler
from pytest_tarl.ros.smach_ros.services import ServiceState
from pytest_tarl.ros.smach_ros.serving import ActionServerWrapper

__all__ = [
    "ActionServerWrapper", "ConditionState", "IntrospectionServer", "MonitorState", "ServiceState", "SimpleActionState",
    "set_preempt_handler",
]  # fmt: skip
