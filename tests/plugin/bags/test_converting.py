"""Messages from bags in the class of a node: each kind of field, in both generations of ROS."""

from __future__ import annotations

from array import array
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from pytest_tarl.bags.converting import _value, class_named, converted
from pytest_tarl.ros.messages import find_class, times
from pytest_tarl.ros.messages.field_values import FieldError
from pytest_tarl.ros.messages.type_definitions import Kind

KINDS: tuple[Kind, ...] = ("ros1", "ros2")


def one(name: str, kind: Kind) -> Any:
    package, _, short = name.partition("/")
    found = find_class(kind, package, short)
    assert found is not None
    return found


def told(kind: str, **fields: Any) -> Any:
    return SimpleNamespace(__msgtype__=kind, **fields)


def stamp(seconds: int, rest: int) -> Any:
    return told("builtin_interfaces/msg/Time", sec=seconds, nanosec=rest)


@pytest.mark.parametrize("kind", KINDS)
def test_types_are_named_as_in_ros_2(kind: Kind) -> None:
    assert class_named("std_msgs/msg/Bool", kind) is one("std_msgs/Bool", kind)
    assert class_named("std_msgs/Bool", kind) is one("std_msgs/Bool", kind)
    assert class_named("my_msgs/msg/Odd", kind) is None


@pytest.mark.parametrize("kind", KINDS)
def test_plain_fields_keep_their_values(kind: Kind) -> None:
    made = converted(told("std_msgs/msg/String", data="text"), one("std_msgs/String", kind))
    assert (type(made), made.data) == (one("std_msgs/String", kind), "text")


@pytest.mark.parametrize("kind", KINDS)
def test_a_header_of_the_other_ros_version_is_converted(kind: Kind) -> None:
    header = told("std_msgs/msg/Header", stamp=stamp(3, 4), frame_id="map")
    made = converted(header, one("std_msgs/Header", kind))
    assert made.frame_id == "map"
    if kind == "ros1":
        assert (made.seq, made.stamp.secs, made.stamp.nsecs) == (0, 3, 4)
        assert type(made.stamp) is type(one("std_msgs/Header", kind)().stamp)
    else:
        assert (made.stamp.sec, made.stamp.nanosec) == (3, 4)


@pytest.mark.parametrize("kind", KINDS)
def test_a_missing_field_is_an_error(kind: Kind) -> None:
    with pytest.raises(FieldError, match="the recorded my/msg/A has no field 'data'"):
        converted(told("my/msg/A"), one("std_msgs/Bool", kind))


@pytest.mark.parametrize("kind", KINDS)
def test_messages_inside_messages_are_converted(kind: Kind) -> None:
    point = told("geometry_msgs/msg/Point", x=1.0, y=2.0, z=3.0)
    turn = told("geometry_msgs/msg/Quaternion", x=0.0, y=0.0, z=0.0, w=1.0)
    made = converted(
        told("geometry_msgs/msg/Pose", position=point, orientation=turn), one("geometry_msgs/Pose", kind)
    )
    assert (made.position.y, made.orientation.w) == (2.0, 1.0)
    assert type(made.position) is one("geometry_msgs/Point", kind)


def ranges(kind: Kind) -> Any:
    scan = told("sensor_msgs/msg/LaserScan", header=told("h", stamp=stamp(0, 0), frame_id=""))
    for name in (
        "angle_min",
        "angle_max",
        "angle_increment",
        "time_increment",
        "scan_time",
        "range_min",
        "range_max",
    ):
        setattr(scan, name, 0.5)
    scan.ranges = scan.intensities = np.array([1.5, 2.5], np.float32)
    return converted(scan, one("sensor_msgs/LaserScan", kind)).ranges


def test_number_sequences_are_converted_for_each_ros_version() -> None:
    assert ranges("ros1") == [1.5, 2.5]
    assert type(ranges("ros1")) is list
    assert ranges("ros2") == array("f", [1.5, 2.5])


@pytest.mark.parametrize("kind", KINDS)
def test_fixed_arrays_have_the_form_of_the_field(kind: Kind) -> None:
    values = np.arange(36.0)
    pose = told(
        "geometry_msgs/msg/Pose",
        position=told("p", x=0.0, y=0.0, z=0.0),
        orientation=told("q", x=0.0, y=0.0, z=0.0, w=1.0),
    )
    made = converted(told("c", pose=pose, covariance=values), one("geometry_msgs/PoseWithCovariance", kind))
    assert list(made.covariance) == values.tolist()
    template = one("geometry_msgs/PoseWithCovariance", kind)().covariance
    assert isinstance(made.covariance, np.ndarray) == isinstance(template, np.ndarray)
    if kind == "ros2":
        assert made.covariance.dtype == template.dtype


def test_bytes_are_converted_for_each_ros_version() -> None:
    image = {"header": told("h", stamp=stamp(0, 0), frame_id=""), "format": "png"}
    data = np.array([1, 2, 255], np.uint8)
    first, second = (
        converted(told("i", **image, data=data), one("sensor_msgs/CompressedImage", kind)).data
        for kind in KINDS
    )
    assert first == b"\x01\x02\xff"
    assert second == array("B", [1, 2, 255])


def test_single_byte_is_bytes_in_ros2_and_a_number_in_ros1() -> None:
    found = [converted(told("b", data=7), one("std_msgs/Byte", kind)).data for kind in KINDS]
    assert found == [7, b"\x07"]


@pytest.mark.parametrize("kind", KINDS)
def test_sequences_of_messages_and_texts_are_converted(kind: Kind) -> None:
    points = [told("geometry_msgs/msg/Point32", x=float(x), y=0.0, z=0.0) for x in (1, 2)]
    made = converted(told("p", points=points), one("geometry_msgs/Polygon", kind))
    assert [point.x for point in made.points] == [1.0, 2.0]
    assert type(made.points[0]) is one("geometry_msgs/Point32", kind)
    assert list(converted(told("p", points=[]), one("geometry_msgs/Polygon", kind)).points) == []
    odd = [told("my/msg/Odd", x=1.0)]
    with pytest.raises(FieldError, match="the type my/msg/Odd is unknown"):
        converted(told("p", points=odd), one("geometry_msgs/Polygon", kind))


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", ["Time", "Duration"])
def test_sequences_of_times_are_converted_for_each_ros_version(kind: Kind, name: str) -> None:
    recorded = [told(f"builtin_interfaces/msg/{name}", sec=sec, nanosec=5) for sec in (1, 2)]
    found = _value(recorded, [], kind)
    if kind == "ros1":
        assert found == [getattr(times, name)(1, 5), getattr(times, name)(2, 5)]
        assert {type(one) for one in found} == {getattr(times, name)}
    else:
        assert [(one.sec, one.nanosec) for one in found] == [(1, 5), (2, 5)]
        assert {type(one) for one in found} == {one_of("ros2", name)}


def one_of(kind: Kind, name: str) -> Any:
    return class_named(f"builtin_interfaces/msg/{name}", kind)
