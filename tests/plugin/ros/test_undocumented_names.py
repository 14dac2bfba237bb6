"""Names of rospy and rclpy that nodes import although the documentation hardly mentions them."""

from __future__ import annotations

import pytest

from pytest_tarl.errors import UnsupportedApiError
from pytest_tarl.ros import message_type
from pytest_tarl.ros.rclpy import validating
from pytest_tarl.ros.rclpy.exceptions import (
    InvalidParameterException,
    InvalidServiceNameException,
    NameValidationException,
    NoTypeSupportImportedException,
)
from tests.plugin.ros.conftest import Start


def test_undocumented_names_of_rospy_exist(start: Start) -> None:
    ros = start("""
        import rospy
        from rospy import Header
        from rospy.rostime import is_rostime_initialized, is_wallclock, set_rostime_initialized, switch_to_wallclock
        from rospy.rostime import wallsleep
        before = rospy.core.is_initialized(), is_rostime_initialized()
        rospy.init_node("n")
        after = rospy.core.is_initialized(), is_rostime_initialized(), is_wallclock()
        switch_to_wallclock(), set_rostime_initialized(True), rospy.core.configure_logging("n")
        begun = rospy.get_time()
        wallsleep(0.5)
        took = rospy.get_time() - begun
        same = rospy.core.Publisher is rospy.Publisher, Header._type
        reasons = []
        rospy.core.add_preshutdown_hook(reasons.append)
        rospy.core.logerror("seen")
        rospy.signal_shutdown("done")
    """)
    ros.step(1)
    found = ros.namespace
    assert (found["before"], found["after"]) == ((False, False), (True, True, False))
    assert found["took"] == pytest.approx(0.5)
    assert found["same"] == (True, "std_msgs/Header")
    assert found["reasons"] == ["shutdown"]


def test_a_node_tries_names_that_only_some_versions_have(start: Start) -> None:
    ros = start("""
        import rospy
        found = []
        try:
            from rospy import a_name_of_next_year
        except ImportError:
            found.append("import")
        try:
            rospy.another_name
        except AttributeError:
            found.append("attribute")
    """)
    assert ros.namespace["found"] == ["import", "attribute"]
    for line in ("from rospy import a_name_of_next_year", "import rospy; rospy.another_name"):
        with pytest.raises(UnsupportedApiError, match=r"rospy\.an?\w+ is not in the in-process ROS"):
            start(line)
    with pytest.raises(
        UnsupportedApiError, match=r"^rclpy\.qos\.a_name_of_next_year is .* ROS has no such name"
    ):
        start("from rclpy.qos import a_name_of_next_year")


def test_names_of_rclpy_for_annotations_and_events_exist(start: Start) -> None:
    ros = start("""
        from rclpy.client import SrvTypeRequest
        from rclpy.event_handler import QoSOfferedIncompatibleQoSInfo, QoSRequestedDeadlineMissedInfo
        from rclpy.logging import get_logger_level, get_logging_severity_from_string
        from rclpy.parameter import get_parameter_value
        from rclpy.publisher import MsgType
        from rclpy.qos import QoSPresetProfiles, qos_profile_rosout_default, qos_profile_sensor_data
        from rclpy.service import SrvType
        levels = get_logging_severity_from_string("warn"), get_logger_level("x")
        try:
            get_logging_severity_from_string("loud")
        except RuntimeError as error:
            refused = str(error)
        values = [(one.type, one.integer_value, one.string_value) for one in map(get_parameter_value, ("3", "fast"))]
        profile = QoSPresetProfiles.get_from_short_key("Sensor_Data") == qos_profile_sensor_data
        short = QoSPresetProfiles.short_keys()[0]
    """)
    found = ros.namespace
    assert found["levels"] == (30, 0)
    assert "loud" in found["refused"]
    assert found["values"] == [(2, 3, ""), (4, 0, "fast")]
    assert (found["profile"], found["short"]) == (True, "default")


VALID = {
    "validate_topic_name": ("a/b", "~/a", "/a", "~", "{node}/a", "a__b", "a//b"),
    "validate_full_topic_name": ("/a/b_1", "/a__b"),
    "validate_namespace": ("/", "/a/b"),
    "validate_node_name": ("a_1", "_a"),
    "validate_parameter_name": ("a.b",),
}
INVALID = {
    "validate_topic_name": ("", "a b", "1a", "a/", "a~", "é", "{a", "{1}"),
    "validate_full_topic_name": ("a", "/", "/~/a", "/a-b", "/a//b"),
    "validate_namespace": ("", "a", "/a/"),
    "validate_node_name": ("", "1a", "a/b"),
    "validate_parameter_name": ("",),
}


@pytest.mark.parametrize("function", VALID)
def test_names_are_validated_as_rclpy_does(function: str) -> None:
    validate = getattr(validating, function)
    assert all(validate(name) is True for name in VALID[function])
    for name in INVALID[function]:
        with pytest.raises((NameValidationException, InvalidParameterException)):
            validate(name)


def test_topic_names_are_expanded_and_types_checked() -> None:
    assert validating.expand_topic_name("~/a", "n", "/ns") == "/ns/n/a"
    assert validating.expand_topic_name("{node}/a", "n", "/ns") == "/ns/n/a"
    assert [validating.topic_or_service_is_hidden(name) for name in ("/a/_b", "/a/b_")] == [True, False]
    message, service = message_type("std_msgs/msg/String"), message_type("std_srvs/srv/Empty")
    for one in (message, service):
        validating.check_for_type_support(one)
    validating.check_is_valid_msg_type(message)
    validating.check_is_valid_srv_type(service)
    with pytest.raises(RuntimeError, match="message type is invalid"):
        validating.check_is_valid_msg_type(service)
    with pytest.raises(NoTypeSupportImportedException):
        validating.check_for_type_support(str)
    with pytest.raises(InvalidServiceNameException, match="service name"):
        validating.validate_topic_name("a b", is_service=True)
