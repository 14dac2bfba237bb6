"""rosidl_runtime_py: types by name, messages as dictionaries and back."""

from __future__ import annotations

from collections import OrderedDict
from typing import Any

import pytest

from pytest_tarl.ros import message_type
from pytest_tarl.ros.rosidl_runtime import (
    message_to_csv,
    message_to_ordereddict,
    message_to_yaml,
    set_message_fields,
)
from pytest_tarl.ros.rosidl_runtime.convert import get_message_slot_types
from pytest_tarl.ros.rosidl_runtime.utilities import get_action, get_interface, get_message, get_service
from tests.plugin.ros.conftest import Start, heard

Odometry: Any = message_type("nav_msgs/msg/Odometry")
Path: Any = message_type("nav_msgs/msg/Path")
String: Any = message_type("std_msgs/msg/String")
Polygon: Any = message_type("geometry_msgs/msg/Polygon")
Floats: Any = message_type("std_msgs/msg/Float64MultiArray")


def test_node_subscribes_to_a_type_by_name(start: Start) -> None:
    ros = start(
        """
        import rclpy
        from rosidl_runtime_py import message_to_ordereddict, set_message_fields
        from rosidl_runtime_py.utilities import get_message
        rclpy.init()
        node = rclpy.create_node("mirror")
        kind = get_message("geometry_msgs/msg/Twist")
        pub = node.create_publisher(kind, "out", 1)
        def mirror(message):
            fields = message_to_ordereddict(message)
            fields["linear"]["x"] *= -1.0
            back = kind()
            set_message_fields(back, fields)
            pub.publish(back)
        node.create_subscription(kind, "in", mirror, 1)
        rclpy.spin(node)
        """
    )
    messages = heard(ros, "/out")
    twist: Any = message_type("geometry_msgs/msg/Twist")()
    twist.linear.x, twist.angular.z = 0.5, 0.25
    ros.bus.publish("/in", twist)
    ros.step(0.1)
    (message,) = messages
    assert (message.linear.x, message.angular.z) == (-0.5, 0.25)


def test_interface_classes_are_found_by_name() -> None:
    assert get_message("std_msgs/msg/String") is String
    assert get_interface("std_msgs/String") is String
    assert get_service("std_srvs/srv/SetBool") is message_type("std_srvs/srv/SetBool")
    assert get_action("nav2_msgs/action/NavigateToPose") is message_type("nav2_msgs/action/NavigateToPose")


@pytest.mark.parametrize(
    "name", ["String", "/msg/String", "std_msgs/msg/", "std_msgs/text/String", "a/msg/b/C"]
)
def test_malformed_type_name_is_a_value_error(name: str) -> None:
    with pytest.raises(ValueError, match="Invalid name"):
        get_message(name)


def test_wrong_or_unknown_type_is_an_error() -> None:
    with pytest.raises(ValueError, match="full name of a message, got 'std_srvs/srv/SetBool'"):
        get_message("std_srvs/srv/SetBool")
    with pytest.raises(ValueError, match="full name of a service"):
        get_service("std_msgs/msg/String")
    with pytest.raises(AttributeError, match=r"std_msgs\.msg.*NoSuchType"):
        get_message("std_msgs/msg/NoSuchType")


def test_message_becomes_an_ordered_dictionary_of_plain_values() -> None:
    odometry = Odometry(child_frame_id="base")
    odometry.header.stamp.sec = 7
    odometry.pose.covariance[3] = 0.5
    fields = message_to_ordereddict(odometry)
    assert list(fields) == ["header", "child_frame_id", "pose", "twist"]
    assert fields["header"] == OrderedDict(stamp=OrderedDict(sec=7, nanosec=0), frame_id="")
    assert fields["pose"]["covariance"] == [0.0, 0.0, 0.0, 0.5, *[0.0] * 32]
    assert {type(value) for value in fields["pose"]["covariance"]} == {float}


def test_long_arrays_and_strings_are_cut_or_described() -> None:
    floats = Floats(data=[1.0, 2.0, 3.0])
    assert message_to_ordereddict(floats)["data"] == [1.0, 2.0, 3.0]
    assert message_to_ordereddict(floats, truncate_length=2)["data"] == [1.0, 2.0, "..."]
    assert message_to_ordereddict(floats, truncate_length=3)["data"] == [1.0, 2.0, 3.0]
    assert message_to_ordereddict(floats, no_arr=True)["data"] == "<sequence type: double, length: 3>"
    covariance = message_to_ordereddict(Odometry(), no_arr=True)["pose"]["covariance"]
    assert covariance == "<array type: double[36]>"
    text = String(data="forward")
    assert message_to_ordereddict(text, truncate_length=3)["data"] == "for..."
    assert message_to_ordereddict(text, truncate_length=7)["data"] == "forward"
    assert message_to_ordereddict(text, no_str=True)["data"] == "<string length: <7>>"


def test_csv_contains_the_values_of_nested_messages() -> None:
    odometry = Odometry(child_frame_id="base")
    odometry.header.stamp.sec = 7
    assert message_to_csv(odometry).startswith("7,0,,base,0.0,0.0,0.0,0.0,0.0,0.0,1.0,")
    assert message_to_csv(Floats(data=[1.5, 2.5])).endswith("0,1.5,2.5")


def test_yaml_is_printed_in_blocks_or_on_one_line() -> None:
    pytest.importorskip("yaml")
    stamp = message_type("builtin_interfaces/msg/Time")(sec=3)
    assert message_to_yaml(stamp) == "sec: 3\nnanosec: 0\n"
    assert message_to_yaml(stamp, flow_style=True) == "{sec: 3, nanosec: 0}\n"


def test_the_types_of_fields_come_from_the_message_class() -> None:
    assert get_message_slot_types(String()) == OrderedDict(data="string")


def test_a_message_is_filled_from_dictionaries_lists_and_messages() -> None:
    path = Path()
    pose: Any = message_type("geometry_msgs/msg/PoseStamped")()
    pose.pose.position.y = 2.0
    values = {
        "header": {"frame_id": "map"},
        "poses": [{"pose": {"position": {"x": 1}}}, pose],
    }
    assert set_message_fields(path, values) == []
    assert path.header.frame_id == "map"
    assert [(one.pose.position.x, one.pose.position.y) for one in path.poses] == [(1.0, 0.0), (0.0, 2.0)]
    odometry = Odometry()
    set_message_fields(odometry, {"pose": {"covariance": list(range(36))}, "child_frame_id": "base"})
    assert list(odometry.pose.covariance[:3]) == [0.0, 1.0, 2.0]
    floats = Floats()
    set_message_fields(floats, {"data": [1, 2]})
    assert list(floats.data) == [1.0, 2.0]


def test_message_survives_conversion_to_a_dictionary() -> None:
    polygon = Polygon()
    set_message_fields(polygon, {"points": [{"x": 1.0, "y": 2.0, "z": 0.5}, {"z": -1.0}]})
    twin = Polygon()
    set_message_fields(twin, message_to_ordereddict(polygon))
    assert twin == polygon
    assert len(twin.points) == 2


def test_time_fields_to_stamp_later_are_returned_if_requested() -> None:
    odometry = Odometry()
    stamps = set_message_fields(odometry, {"header": "auto"}, expand_header_auto=True)
    now = message_type("builtin_interfaces/msg/Time")(sec=5)
    for stamp in stamps:
        stamp(now)
    assert (len(stamps), odometry.header.stamp.sec) == (1, 5)
    header: Any = message_type("std_msgs/msg/Header")()
    (stamp,) = set_message_fields(header, {"stamp": "now"}, expand_time_now=True)
    stamp(now)
    assert header.stamp.sec == 5


@pytest.mark.parametrize(
    ("values", "error"),
    [
        ({"header": "auto"}, TypeError),
        ({"header": {"stamp": "now"}}, TypeError),
        ({"no_such_field": 1}, AttributeError),
        ({"pose": 3}, TypeError),
        ("text", TypeError),
    ],
)
def test_values_that_do_not_fit_are_errors(values: Any, error: type[Exception]) -> None:
    with pytest.raises(error):
        set_message_fields(Odometry(), values)
