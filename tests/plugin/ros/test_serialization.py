"""ROS 2 messages as bytes. The bytes are those of rclpy 9.1.2, which leaves chance values in the padding."""

from __future__ import annotations

from typing import Any

import pytest

from pytest_tarl.ros import message_type
from pytest_tarl.ros.messages.ros2_wire import deserialize, serialize
from tests.plugin.ros.conftest import Start, heard

JOINTS = (
    "00010000000000000000000001000000000000000000000001000000000000000000f03f00000000010000000000000000000040"
)
NAMES = [
    "std_msgs/msg/Empty", "sensor_msgs/msg/PointCloud2", "sensor_msgs/msg/CameraInfo", "nav_msgs/msg/OccupancyGrid",
    "diagnostic_msgs/msg/DiagnosticArray", "rcl_interfaces/msg/ParameterEvent", "std_msgs/msg/Bool",
]  # fmt: skip


def filled(name: str) -> Any:
    """Return a message in which arrays, strings and nested messages have values."""
    made: Any = message_type(name)()
    if hasattr(made, "header"):
        made.header.frame_id, made.header.stamp.sec = "é", 7
    if name.endswith("PointCloud2"):
        field: Any = message_type("sensor_msgs/msg/PointField")
        made.fields, made.data, made.is_dense = [field(name="x", count=1), field(name="yy")], [1, 2, 3], True
    elif name.endswith("CameraInfo"):
        made.d, made.k, made.distortion_model = [0.5, 1.5], [float(i) for i in range(9)], "plumb_bob"
    elif name.endswith("OccupancyGrid"):
        made.data, made.info.origin.orientation.w = [-1, 0, 100], 0.5
    elif name.endswith("DiagnosticArray"):
        status: Any = message_type("diagnostic_msgs/msg/DiagnosticStatus")
        made.status = [status(level=b"\x02", name="a", message="bcd"), status()]
    elif name.endswith("ParameterEvent"):
        parameter: Any = message_type("rcl_interfaces/msg/Parameter")
        made.new_parameters = [parameter(name="gain")]
        made.new_parameters[0].value.double_array_value = [1.0, 2.0]
    return made


@pytest.mark.parametrize("name", NAMES)
def test_a_message_survives_serialization(name: str) -> None:
    made = filled(name)
    assert deserialize(serialize(made), message_type(name)) == made


def test_messages_have_the_bytes_of_rclpy() -> None:
    joints: Any = message_type("sensor_msgs/msg/JointState")
    data = serialize(joints(position=[1.0], effort=[2.0]))
    assert data.hex() == JOINTS
    assert deserialize(bytes.fromhex(JOINTS + "0000000000000000"), joints).effort.tolist() == [2.0]
    text: Any = message_type("std_msgs/msg/String")
    assert serialize(text(data="hi")).hex() == "0001000003000000686900"


@pytest.mark.parametrize("data", ["", "00010000ffffffff", "000100000900000061", "00000000"])
def test_bytes_that_are_not_a_message_are_refused(data: str) -> None:
    with pytest.raises(ValueError, match="the bytes are not a"):
        deserialize(bytes.fromhex(data), message_type("std_msgs/msg/String"))


def test_nodes_receive_and_publish_raw_messages(start: Start) -> None:
    ros = start("")
    texts = heard(ros, "/copy")
    start("""
        import rclpy
        from rclpy.serialization import deserialize_message, serialize_message
        from rclpy.experimental.events_executor import EventsExecutor
        from std_msgs.msg import String
        rclpy.init()
        node = rclpy.create_node("relay")
        got = []
        publisher = node.create_publisher(String, "copy", 10)
        def relay(data):
            got.append(deserialize_message(data, String).data)
            publisher.publish(data)
        node.create_subscription(String, "text", relay, 10, raw=True)
        executor = EventsExecutor()
        executor.add_node(node)
        executor.spin()
    """, ros=ros)  # fmt: skip
    ros.bus.publish("/text", message_type("std_msgs/msg/String")(data="hello"))
    ros.step(0.1)
    assert [text.data for text in texts] == ["hello"]
    assert ros.namespace["got"] == ["hello"]  # type: ignore[attr-defined]


def test_a_parameter_event_handler_gets_changes_of_other_nodes(start: Start) -> None:
    ros = start("""
        import rclpy
        from rclpy.parameter_event_handler import ParameterEventHandler
        rclpy.init()
        node = rclpy.create_node("watcher")
        handler = ParameterEventHandler(node)
        values, events = [], []
        handle = handler.add_parameter_callback("gain", "/other", lambda one: values.append(one.value.double_value))
        handler.add_parameter_event_callback(lambda event: events.append(event.node))
        rclpy.spin(node)
    """)
    watcher: dict[str, Any] = ros.namespace  # type: ignore[attr-defined]
    start("""
        import rclpy
        rclpy.init()
        node = rclpy.create_node("other")
        node.declare_parameter("gain", 1.0)
        node.declare_parameter("name", "x")
        node.set_parameters([rclpy.Parameter("gain", value=2.0)])
    """, ros=ros)  # fmt: skip
    ros.step(0.1)
    assert watcher["values"] == [1.0, 2.0]
    assert "/other" in watcher["events"]
