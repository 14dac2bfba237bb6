"""Names that a module of rclpy, rospy, tf2_ros or actionlib imports from another module.

Editors suggest such names, so some nodes import them from there. The names are those of rclpy 9.1, rospy 1.15, tf2_ros
0.7 and actionlib 1.14.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from importlib import import_module
from typing import Any, Final

REEXPORTED: Final[
    Mapping[str, Mapping[str, str]]
] = {  # module → module of definition → names, or NAME=ORIGINAL
    "actionlib": {
        "actionlib_msgs.msg": "GoalStatusArray",
        "std_msgs.msg": "Header",
    },
    "actionlib.action_client": {
        "actionlib.exceptions": "ActionException",
        "actionlib_msgs.msg": "GoalID GoalStatus GoalStatusArray",
        "std_msgs.msg": "Header",
    },
    "actionlib.action_server": {
        "actionlib.exceptions": "ActionException",
        "actionlib.goal_id_generator": "GoalIDGenerator",
        "actionlib_msgs.msg": "GoalID GoalStatus GoalStatusArray",
    },
    "actionlib.simple_action_client": {
        "actionlib.action_client": "ActionClient CommState",
        "actionlib_msgs.msg": "GoalStatus",
    },
    "actionlib.simple_action_server": {
        "actionlib.action_server": "ActionServer",
        "actionlib.server_goal_handle": "ServerGoalHandle",
        "actionlib_msgs.msg": "GoalStatus",
    },
    "rclpy.action.client": {
        "action_msgs.msg": "GoalStatus GoalStatusArray",
        "action_msgs.srv": "CancelGoal",
        "builtin_interfaces.msg": "Time",
        "rclpy.clock": "Clock",
        "rclpy.qos": "QoSProfile qos_profile_action_status_default qos_profile_services_default",
        "rclpy.type_support": "check_for_type_support",
        "unique_identifier_msgs.msg": "UUID",
        "rclpy.service_introspection": "ServiceIntrospectionState",
    },
    "rclpy.action.server": {
        "action_msgs.msg": "GoalInfo GoalStatus",
        "action_msgs.srv": "CancelGoal",
        "rclpy.clock": "Clock",
        "rclpy.qos": "QoSProfile qos_profile_action_status_default qos_profile_services_default",
        "rclpy.task": "Task",
        "rclpy.type_support": "check_for_type_support",
        "unique_identifier_msgs.msg": "UUID",
        "rclpy.service_introspection": "ServiceIntrospectionState",
    },
    "rclpy.client": {
        "rclpy.callback_groups": "CallbackGroup",
        "rclpy.clock": "Clock",
        "rclpy.context": "Context",
        "rclpy.qos": "QoSProfile",
        "rclpy.service_introspection": "ServiceIntrospectionState",
    },
    "rclpy.clock": {
        "rclpy.context": "Context",
        "rclpy.exceptions": "NotInitializedException",
        "rclpy.utilities": "get_default_context",
    },
    "rclpy.event_handler": {
        "rclpy.callback_groups": "CallbackGroup",
        "rclpy.logging": "get_logger",
    },
    "rclpy.executors": {
        "rclpy.client": "Client",
        "rclpy.clock": "Clock",
        "rclpy.guard_condition": "GuardCondition",
        "rclpy.service": "Service",
        "rclpy.subscription": "MessageInfo Subscription",
        "rclpy.timer": "Timer TimerInfo",
        "rclpy.utilities": "get_default_context timeout_sec_to_nsec",
        "rclpy.exceptions": "InvalidHandle TimerCancelledError",
        "rclpy.clock_type": "ClockType",
    },
    "rclpy.guard_condition": {
        "rclpy.callback_groups": "CallbackGroup",
        "rclpy.context": "Context",
        "rclpy.utilities": "get_default_context",
    },
    "rclpy.lifecycle.node": {
        "rclpy.callback_groups": "CallbackGroup",
        "rclpy.impl.rcutils_logger": "RcutilsLogger",
        "rclpy.qos": "QoSProfile",
        "rclpy.service": "Service",
        "rclpy.type_support": "check_is_valid_srv_type",
    },
    "rclpy.lifecycle.publisher": {
        "rclpy.callback_groups": "CallbackGroup",
        "rclpy.event_handler": "PublisherEventCallbacks",
        "rclpy.qos": "QoSProfile",
    },
    "rclpy.node": {
        "rcl_interfaces.msg": (
            "FloatingPointRange IntegerRange ListParametersResult ParameterDescriptor ParameterEvent "
            "ParameterMsg=Parameter ParameterType ParameterValue SetParametersResult"
        ),
        "rcl_interfaces.srv": "ListParameters",
        "rclpy.callback_groups": "CallbackGroup ReentrantCallbackGroup",
        "rclpy.clock": "Clock",
        "rclpy.context": "Context",
        "rclpy.event_handler": "PublisherEventCallbacks SubscriptionEventCallbacks",
        "rclpy.exceptions": (
            "InvalidHandle InvalidParameterTypeException InvalidParameterValueException NotInitializedException "
            "ParameterAlreadyDeclaredException ParameterImmutableException ParameterNotDeclaredException "
            "ParameterUninitializedException"
        ),
        "rclpy.executors": "Executor",
        "rclpy.expand_topic_name": "expand_topic_name",
        "rclpy.logging": "get_logger",
        "rclpy.parameter": "Parameter",
        "rclpy.qos": "QoSProfile qos_profile_parameter_events qos_profile_rosout_default qos_profile_services_default",
        "rclpy.qos_overriding_options": "QoSOverridingOptions",
        "rclpy.subscription": "MessageInfo",
        "rclpy.timer": "TimerInfo",
        "rclpy.topic_endpoint_info": "TopicEndpointInfo",
        "rclpy.type_support": "check_is_valid_msg_type check_is_valid_srv_type",
        "rclpy.utilities": "get_default_context",
        "rclpy.validate_parameter_name": "validate_parameter_name",
    },
    "rclpy.parameter": {
        "rcl_interfaces.msg": "ParameterMsg=Parameter ParameterValue",
    },
    "rclpy.parameter_client": {
        "rcl_interfaces.msg": "ParameterEvent ParameterMsg=Parameter",
        "rcl_interfaces.srv": (
            "DescribeParameters GetParameterTypes GetParameters ListParameters SetParameters "
            "SetParametersAtomically"
        ),
        "rclpy.callback_groups": "CallbackGroup",
        "rclpy.event_handler": "SubscriptionEventCallbacks",
        "rclpy.node": "Node",
        "rclpy.parameter": "parameter_dict_from_yaml_file",
        "rclpy.qos": "QoSProfile qos_profile_parameter_events qos_profile_services_default",
        "rclpy.qos_overriding_options": "QoSOverridingOptions",
        "rclpy.subscription": "MessageInfo Subscription",
    },
    "rclpy.parameter_event_handler": {
        "rcl_interfaces.msg": "ParameterEvent ParameterMsg=Parameter",
        "rclpy.callback_groups": "CallbackGroup",
        "rclpy.event_handler": "SubscriptionEventCallbacks",
        "rclpy.node": "Node",
        "rclpy.qos": "QoSProfile",
        "rclpy.qos_overriding_options": "QoSOverridingOptions",
    },
    "rclpy.publisher": {
        "rclpy.callback_groups": "CallbackGroup",
        "rclpy.duration": "Duration",
        "rclpy.event_handler": "PublisherEventCallbacks",
    },
    "rclpy.qos_overriding_options": {
        "rcl_interfaces.msg": "ParameterDescriptor SetParametersResult",
        "rclpy.exceptions": "ParameterAlreadyDeclaredException",
        "rclpy.parameter": "Parameter",
        "rclpy.publisher": "Publisher",
        "rclpy.qos": "QoSDurabilityPolicy QoSHistoryPolicy QoSLivelinessPolicy QoSReliabilityPolicy",
        "rclpy.subscription": "Subscription",
    },
    "rclpy.service": {
        "rclpy.callback_groups": "CallbackGroup",
        "rclpy.clock": "Clock",
        "rclpy.qos": "QoSProfile",
        "rclpy.service_introspection": "ServiceIntrospectionState",
    },
    "rclpy.signals": {
        "rclpy.exceptions": "InvalidHandle",
    },
    "rclpy.subscription": {
        "rclpy.callback_groups": "CallbackGroup",
        "rclpy.event_handler": "SubscriptionEventCallbacks",
        "rclpy.exceptions": "RCLError",
    },
    "rclpy.timer": {
        "rclpy.callback_groups": "CallbackGroup",
        "rclpy.clock": "Clock",
        "rclpy.context": "Context",
        "rclpy.utilities": "get_default_context",
        "rclpy.clock_type": "ClockType",
        "rclpy.exceptions": "InvalidHandle",
    },
    "rospy.client": {
        "roscpp.msg": "Logger",
        "roscpp.srv": "GetLoggers GetLoggersResponse SetLoggerLevel SetLoggerLevelResponse",
        "rosgraph_msgs.msg": "Log",
    },
    "rospy.core": {
        "rosgraph.names": "get_ros_namespace is_global is_private load_mappings make_global_ns namespace ns_join",
        "rosgraph_msgs.msg": "Log",
    },
    "rospy.names": {
        "rosgraph.names": "get_ros_namespace is_global is_private load_mappings make_global_ns namespace ns_join",
    },
    "tf2_ros": {
        "actionlib_msgs.msg": "GoalStatus",
        "std_msgs.msg": "Header",
        "tf2_msgs.msg": "LookupTransformAction LookupTransformGoal",
        "tf2_msgs.srv": "FrameGraph FrameGraphResponse",
    },
    "tf2_ros.buffer": {
        "tf2_msgs.srv": "FrameGraph FrameGraphResponse",
    },
    "tf2_ros.buffer_client": {
        "actionlib_msgs.msg": "GoalStatus",
        "tf2_msgs.msg": "LookupTransformAction LookupTransformGoal",
    },
    "tf2_ros.buffer_interface": {
        "std_msgs.msg": "Header",
    },
    "tf2_ros.static_transform_broadcaster": {
        "geometry_msgs.msg": "TransformStamped",
        "tf2_msgs.msg": "TFMessage",
    },
    "tf2_ros.transform_broadcaster": {
        "geometry_msgs.msg": "TransformStamped",
        "tf2_msgs.msg": "TFMessage",
    },
    "tf2_ros.transform_listener": {
        "tf2_msgs.msg": "TFMessage",
    },
}


@cache
def _homes(module: str) -> Mapping[str, tuple[str, str]]:
    """Return, for each name that a module re-exports, its module of definition and its original name."""
    return {
        name: (home, original or name)
        for home, names in REEXPORTED.get(module, {}).items()
        for name, _, original in (one.partition("=") for one in names.split())
    }


def is_reexported(module: str, name: str) -> bool:
    """Return whether a module imports a name from another module."""
    return name in _homes(module)


def reexported(module: str, name: str) -> Any:
    """Return the object behind a re-exported name; the importing node must run in an episode."""
    home, original = _homes(module)[name]
    return getattr(import_module(home), original)
