"""Stand-in for rospy, with the same names, a virtual clock and no network."""

from __future__ import annotations

from typing import Any

from pytest_tarl.ros.messages.ros1 import Message
from pytest_tarl.ros.rospy import exceptions, timing
from pytest_tarl.ros.rospy import timing as rostime
from pytest_tarl.ros.rospy.exceptions import (
    ROSException,
    ROSInitException,
    ROSInternalException,
    ROSInterruptException,
    ROSSerializationException,
    ROSTimeMovedBackwardsException,
    ServiceException,
    TransportException,
    TransportInitError,
    TransportTerminated,
)
from pytest_tarl.ros.rospy.log import (
    logdebug,
    logdebug_once,
    logdebug_throttle,
    logdebug_throttle_identical,
    logerr,
    logerr_once,
    logerr_throttle,
    logerr_throttle_identical,
    logfatal,
    logfatal_once,
    logfatal_throttle,
    logfatal_throttle_identical,
    loginfo,
    loginfo_once,
    loginfo_throttle,
    loginfo_throttle_identical,
    logout,
    logwarn,
    logwarn_once,
    logwarn_throttle,
    logwarn_throttle_identical,
)
from pytest_tarl.ros.rospy.node import (
    DEBUG,
    ERROR,
    FATAL,
    INFO,
    WARN,
    get_caller_id,
    get_name,
    get_namespace,
    get_node_uri,
    get_ros_root,
    init_node,
    is_shutdown,
    myargv,
    on_shutdown,
    remap_name,
    resolve_name,
    signal_shutdown,
    spin,
)
from pytest_tarl.ros.rospy.parameters import (
    delete_param,
    get_param,
    get_param_cached,
    get_param_names,
    has_param,
    search_param,
    set_param,
)
from pytest_tarl.ros.rospy.services import Service, ServiceProxy, wait_for_service
from pytest_tarl.ros.rospy.timing import Duration, Rate, Time, Timer, TimerEvent, get_rostime, get_time, sleep
from pytest_tarl.ros.rospy.topics import (
    AnyMsg,
    Publisher,
    SubscribeListener,
    Subscriber,
    get_published_topics,
    wait_for_message,
)


def get_master() -> Any:
    """Return a proxy for the master, which answers with (code, status, value)."""
    from pytest_tarl.ros.tools.rosgraph import MasterProxy

    return MasterProxy()


__version__ = "1.16.0"


def __getattr__(name: str) -> Any:
    """Return `Header`, which rospy happens to export; raise for a name that the stand-in lacks."""
    if name == "Header":
        from pytest_tarl.ros.messages import message_type

        return message_type("std_msgs/Header")
    raise AttributeError(name)


__all__ = [
    "DEBUG",
    "ERROR",
    "FATAL",
    "INFO",
    "WARN",
    "AnyMsg",
    "Duration",
    "Message",
    "Publisher",
    "ROSException",
    "ROSInitException",
    "ROSInternalException",
    "ROSInterruptException",
    "ROSSerializationException",
    "ROSTimeMovedBackwardsException",
    "Rate",
    "Service",
    "ServiceException",
    "ServiceProxy",
    "SubscribeListener",
    "Subscriber",
    "Time",
    "Timer",
    "TimerEvent",
    "TransportException",
    "TransportInitError",
    "TransportTerminated",
    "delete_param",
    "exceptions",
    "get_caller_id",
    "get_master",
    "get_name",
    "get_namespace",
    "get_node_uri",
    "get_param",
    "get_param_cached",
    "get_param_names",
    "get_published_topics",
    "get_ros_root",
    "get_rostime",
    "get_time",
    "has_param",
    "init_node",
    "is_shutdown",
    "logdebug",
    "logdebug_once",
    "logdebug_throttle",
    "logdebug_throttle_identical",
    "logerr",
    "logerr_once",
    "logerr_throttle",
    "logerr_throttle_identical",
    "logfatal",
    "logfatal_once",
    "logfatal_throttle",
    "logfatal_throttle_identical",
    "loginfo",
    "loginfo_once",
    "loginfo_throttle",
    "loginfo_throttle_identical",
    "logout",
    "logwarn",
    "logwarn_once",
    "logwarn_throttle",
    "logwarn_throttle_identical",
    "myargv",
    "on_shutdown",
    "remap_name",
    "resolve_name",
    "rostime",
    "search_param",
    "set_param",
    "signal_shutdown",
    "sleep",
    "spin",
    "timing",
    "wait_for_message",
    "wait_for_service",
]  # fmt: skip
