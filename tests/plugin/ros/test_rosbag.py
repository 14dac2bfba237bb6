"""Serialised ROS 1 messages, and bags read and written by nodes."""

from __future__ import annotations

import math
from io import BytesIO
from pathlib import Path
from typing import Any

import pytest
from rosbags.typesys import Stores, get_typestore

from benchmarks.foreign_messages import filled
from pytest_tarl.ros import message_type
from pytest_tarl.ros.messages.ros1 import field_class
from pytest_tarl.ros.messages.ros1_wire import WireError, deserialize, full_text, serialize
from tests.plugin.ros.conftest import Start

KINDS = ["nav_msgs/Odometry", "sensor_msgs/LaserScan", "sensor_msgs/Image", "sensor_msgs/PointCloud2", "std_msgs/Empty",
         "trajectory_msgs/JointTrajectory", "diagnostic_msgs/DiagnosticArray", "sensor_msgs/CameraInfo",
         "std_msgs/Bool", "visualization_msgs/MarkerArray", "std_msgs/Duration",
         "std_msgs/Int64MultiArray"]  # fmt: skip


@pytest.fixture(scope="module")
def store() -> Any:
    return get_typestore(Stores.ROS1_NOETIC)


@pytest.mark.parametrize("name", KINDS)
def test_messages_have_the_bytes_of_ros(name: str, store: Any) -> None:
    message = filled(message_type(name), 3)
    data = serialize(message)
    other = name.replace("/", "/msg/")
    assert bytes(store.serialize_ros1(store.deserialize_ros1(data, other), other)) == data
    again = deserialize(type(message), data, field_class)
    assert serialize(again) == data
    assert again == type(message)._tarl_copy(message)  # type: ignore[attr-defined]


def test_invalid_bytes_are_refused() -> None:
    kind = message_type("sensor_msgs/JointState")
    data = serialize(filled(kind, 1))
    for wrong in (data[:-1], data + b"\0", data[:12] + b"\xff\xff\xff\xff" + data[16:], b""):
        with pytest.raises(WireError):
            deserialize(kind, wrong, field_class)


def test_messages_serialise_and_deserialise() -> None:
    kind, buffer = message_type("geometry_msgs/Twist"), BytesIO()
    filled(kind, 2).serialize(buffer)  # type: ignore[attr-defined]
    assert kind().deserialize(buffer.getvalue()).linear.x == pytest.approx(0.5 + 0.1 * math.sin(2))
    assert "MSG: geometry_msgs/Vector3\nfloat64 x\n" in full_text(kind)


def test_bag_of_one_node_is_read_by_another(start: Start, tmp_path: Path) -> None:
    path = str(tmp_path / "a.bag")
    start(f"""
        import rosbag
        import rospy
        from geometry_msgs.msg import PoseStamped
        from std_msgs.msg import Float64
        rospy.init_node("writer")
        with rosbag.Bag({path!r}, "w") as bag:
            for number in range(4):
                bag.write("/x", Float64(number), rospy.Time(10 + number, 500))
            bag.write("/pose", PoseStamped(), t=rospy.Time(12))
    """)
    ros = start(f"""
        import rosbag
        import rospy
        from genpy import Time
        bag = rosbag.Bag({path!r})
        everything = [(topic, t.to_sec()) for topic, _, t in bag]
        some = [m.data for _, m, t in bag.read_messages(topics=["/x"], start_time=Time(11), end_time=Time(12, 500))]
        info = bag.get_type_and_topic_info()
        counts = bag.get_message_count(), bag.get_message_count("/pose"), info.topics["/x"].msg_type
        times = bag.get_start_time(), bag.get_end_time()
        raw = [m[1] for _, m, _ in bag.read_messages("/x", raw=True)][1]
        bag.close()
        try:
            rosbag.Bag({path!r} + "x")
        except IOError as error:
            missing = error.errno
        with open({path!r} + "y", "w") as file:
            file.write("no bag")
        try:
            rosbag.Bag({path!r} + "y")
        except rosbag.ROSBagException as error:
            wrong = True
    """)
    found = ros.namespace
    assert [topic for topic, _ in found["everything"]] == ["/x", "/x", "/pose", "/x", "/x"]
    assert (found["some"], found["counts"]) == ([1.0, 2.0], (5, 1, "std_msgs/Float64"))
    assert found["times"] == pytest.approx((10.0000005, 13.0000005))
    assert (found["raw"], found["missing"], found["wrong"]) == (b"\0\0\0\0\0\0\xf0?", 2, True)


def test_types_known_only_to_the_bag_are_built(start: Start, tmp_path: Path) -> None:
    from rosbags.rosbag1 import Writer

    text = f"own_msgs/Part[] parts\nstring name\n{'=' * 80}\nMSG: own_msgs/Part\nint32[2] pair\n"
    with Writer(tmp_path / "b.bag") as bag:
        connection = bag.add_connection("/own", "own_msgs/msg/Whole", msgdef=text, md5sum="0" * 32)
        bag.write(connection, 1, b"\x01\0\0\0\x05\0\0\0\x06\0\0\0\x02\0\0\0ab")
    ros = start(f"""
        import rosbag
        import rospy
        with rosbag.Bag({str(tmp_path / "b.bag")!r}) as bag:
            (_, message, _), = bag
        found = message.name, list(message.parts[0].pair)
    """)
    assert ros.namespace["found"] == ("ab", [5, 6])
