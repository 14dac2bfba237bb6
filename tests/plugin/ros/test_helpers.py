"""Libraries besides rospy and rclpy: images, point clouds, filters, packages, dynamic parameters."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import numpy as np
import pytest

from pytest_tarl.errors import NodeError, UnsupportedApiError
from pytest_tarl.ros import Ros, message_type
from pytest_tarl.ros.cv_bridge import CvBridge, CvBridgeError
from pytest_tarl.ros.messages import node_workspaces
from tests.plugin.ros.conftest import Start, heard


def picture(encoding: str, data: np.ndarray) -> object:
    made = message_type("sensor_msgs/msg/Image")()
    made.height, made.width, made.encoding = data.shape[0], data.shape[1], encoding
    made.step, made.data = data.nbytes // data.shape[0], data.tobytes()
    return made


def test_cv_bridge_converts_images_to_arrays_and_between_encodings() -> None:
    rgb = np.arange(24, dtype=np.uint8).reshape(2, 4, 3)
    bridge = CvBridge()
    assert np.array_equal(bridge.imgmsg_to_cv2(picture("rgb8", rgb)), rgb)
    assert np.array_equal(bridge.imgmsg_to_cv2(picture("rgb8", rgb), "bgr8"), rgb[..., ::-1])
    assert bridge.imgmsg_to_cv2(picture("rgb8", rgb), "mono8")[0, 1] == round(
        3 * 0.299 + 4 * 0.587 + 5 * 0.114
    )
    assert bridge.imgmsg_to_cv2(picture("mono8", rgb[..., 0].copy()), "bgra8").shape == (2, 4, 4)
    depth = np.array([[0.5, 2.0]], dtype=np.float32)
    assert np.array_equal(bridge.imgmsg_to_cv2(picture("32FC1", depth)), depth)
    with pytest.raises(CvBridgeError, match="not a color format"):
        bridge.imgmsg_to_cv2(picture("32FC1", depth), "bgr8")


def test_a_node_publishes_arrays_as_images(start: Start) -> None:
    ros = start("""
        import numpy as np
        import rclpy
        from cv_bridge import CvBridge, CvBridgeError
        from sensor_msgs.msg import Image
        rclpy.init()
        node = rclpy.create_node("camera")
        made = CvBridge().cv2_to_imgmsg(np.full((2, 3, 3), 7, dtype=np.uint8), encoding="bgr8")
        node.create_publisher(Image, "image", 1).publish(made)
        try:
            CvBridge().cv2_to_imgmsg(np.zeros((2, 2)), encoding="bgr8")
        except CvBridgeError as error:
            said = str(error)
    """)
    image = ros.bus.latest("/image")
    assert (image.height, image.width, image.step, image.encoding, bytes(image.data)) == (
        2,
        3,
        9,
        "bgr8",
        b"\7" * 18,
    )
    assert "incompatible type 64FC1" in ros.namespace["said"]


@pytest.mark.parametrize(
    ("library", "module"), [("rospy", "sensor_msgs.point_cloud2"), ("rclpy", "sensor_msgs_py.point_cloud2")]
)
def test_point_clouds_are_created_and_read(start: Start, library: str, module: str) -> None:
    ros = start(f"""
        import math
        import {library}
        from std_msgs.msg import Header
        from {module} import create_cloud_xyz32, read_points
        cloud = create_cloud_xyz32(Header(frame_id="lidar"), [(1.0, 2.0, 3.0), (4.0, math.nan, 6.0)])
        whole = [tuple(float(v) for v in point) for point in read_points(cloud)]
        kept = [tuple(float(v) for v in point) for point in read_points(cloud, field_names=("z", "x"), skip_nans=True)]
    """)
    assert ros.namespace["whole"][0] == (1.0, 2.0, 3.0)
    assert len(ros.namespace["whole"]) == 2
    assert ros.namespace["kept"] == [(3.0, 1.0), (6.0, 4.0)]


def test_numpy_msg_delivers_numpy_arrays(start: Start) -> None:
    ros = start("""
        import numpy as np
        import rospy
        from rospy.numpy_msg import numpy_msg
        from rospy_tutorials.msg import Floats
        from sensor_msgs.msg import LaserScan
        rospy.init_node("n")
        pub = rospy.Publisher("out", numpy_msg(Floats), queue_size=1)
        def scanned(scan):
            near = scan.ranges[scan.ranges < 2.0]
            pub.publish(np.sqrt(near))
        rospy.Subscriber("scan", numpy_msg(LaserScan), scanned)
        rospy.spin()
    """)
    ros.bus.publish("scan", message_type("sensor_msgs/LaserScan")(ranges=[1.0, 4.0, 0.25]))
    assert tuple(ros.bus.latest("/out").data) == (1.0, 0.5)


def test_the_cache_keeps_the_last_messages_ordered_by_stamp(start: Start) -> None:
    ros = start("""
        import message_filters, rospy
        from geometry_msgs.msg import PointStamped
        rospy.init_node("n")
        cache = message_filters.Cache(message_filters.Subscriber("p", PointStamped), 2)
        count = []
        cache.registerCallback(lambda message: count.append(1))
        rospy.sleep(3.5)
        before = cache.getElemBeforeTime(rospy.Time(2.5)).point.x
        after = cache.getElemAfterTime(rospy.Time(2.5)).point.x
        inside = len(cache.getInterval(rospy.Time(1.0), rospy.Time(3.0)))
    """)
    for x in (1.0, 2.0, 3.0):
        ros.step(1.0)
        message = message_type("geometry_msgs/PointStamped")()
        message.point.x = x
        ros.bus.publish("p", message)
    ros.step(1.0)
    known = ros.namespace
    assert (len(known["count"]), known["before"], known["after"], known["inside"]) == (3, 2.0, 3.0, 2)


def test_dynamic_parameters_are_clipped_and_passed_with_their_level(start: Start) -> None:
    ros = start(
        """
        import types
        import rospy
        from dynamic_reconfigure.client import Client
        from dynamic_reconfigure.server import Server
        parameters = [
            {"name": "speed", "type": "double", "default": 0.5, "min": 0.0, "max": 1.0, "level": 1},
            {"name": "mode", "type": "str", "default": "slow", "level": 2},
        ]
        DriveConfig = types.SimpleNamespace(config_description={"parameters": parameters, "groups": []})
        rospy.init_node("drive")
        seen = []
        def changed(config, level):
            seen.append((config.speed, config["mode"], level))
            return config
        Server(DriveConfig, changed)
        client = Client("drive")
        answered = client.update_configuration({"speed": 7})
        rospy.sleep(0.1)
        known = client.get_configuration()
        import dynamic_reconfigure
        servers = dynamic_reconfigure.find_reconfigure_services()
        names = sorted(dynamic_reconfigure.get_parameter_names({"speed": 1, "mode": ""}))
        told = []
        client.set_config_callback(lambda config: told.append(config["speed"]))
        client.close()
        client.update_configuration({"speed": 0.25})
        rospy.sleep(0.1)
    """,
        parameters={"~mode": "fast"},
    )
    ros.step(1.0)
    assert ros.namespace["seen"] == [(0.5, "fast", 0xFFFFFFFF), (1.0, "fast", 1), (0.25, "fast", 1)]
    assert (ros.namespace["servers"], ros.namespace["names"]) == (["/drive"], ["mode", "speed"])
    assert ros.namespace["told"] == [1.0]  # a closed client gets no further configuration
    assert ros.namespace["answered"].speed == ros.namespace["known"]["speed"] == 1.0


def test_types_and_folders_of_workspace_packages_are_found(
    tmp_path: Path, start: Start, monkeypatch: pytest.MonkeyPatch
) -> None:
    package = tmp_path / "src" / "rover_things"
    for part, name, text in (
        ("msg", "Wheel", "float32 speed 0.5  # m/s\nstring side"),
        ("srv", "Turn", "float64 angle\n---\nbool done"),
        ("action", "Dig", "int32 depth\n---\nbool found\n---\nint32 depth"),
    ):
        (package / part).mkdir(parents=True, exist_ok=True)
        (package / part / f"{name}.{part}").write_text(text)
    (package / "package.xml").write_text("<package><name>rover_msgs</name></package>")
    (tmp_path / ".git").mkdir()
    monkeypatch.setattr(node_workspaces, "_SEARCHED", [])
    Ros().use_definitions_around(package, tmp_path)
    ros = start("""
        import rclpy
        from ament_index_python.packages import PackageNotFoundError, get_package_share_directory
        from rover_msgs.action import Dig
        from rover_msgs.msg import Wheel
        from rover_msgs.srv import Turn
        made = (Wheel().speed, Turn.Request(angle=1.0).angle, Dig.Goal(depth=2).depth, Dig.Feedback().depth)
        folder = get_package_share_directory("rover_msgs")
        try:
            get_package_share_directory("nowhere")
        except PackageNotFoundError as error:
            said = str(error)
    """)
    assert ros.namespace["made"] == (0.5, 1.0, 2, 0)
    assert ros.namespace["folder"] == str(package)
    assert "package 'nowhere' not found" in ros.namespace["said"]
    node_workspaces.forget()


def test_a_subscribe_listener_is_called_for_new_subscribers(start: Start) -> None:
    ros = start("""
        import rospy
        from std_msgs.msg import String
        class Greeter(rospy.SubscribeListener):
            def peer_subscribe(self, topic_name, topic_publish, peer_publish):
                peer_publish(String("welcome to " + topic_name))
        rospy.init_node("host")
        pub = rospy.Publisher("news", String, subscriber_listener=Greeter(), queue_size=1)
        rospy.spin()
    """)
    start(
        """
        import rospy
        from std_msgs.msg import String
        rospy.init_node("guest")
        got = []
        rospy.Subscriber("news", String, lambda message: got.append(message.data))
        rospy.spin()
    """,
        ros=ros,
    )
    assert ros.namespace["got"] == ["welcome to /news"]


@pytest.mark.skipif(sys.platform == "win32", reason="select works on sockets only")
def test_keyboard_polling_waits_in_virtual_time(start: Start) -> None:
    reading, writing = os.pipe()
    ros = start(f"""
        import os, select
        import rospy
        rospy.init_node("keys")
        got = []
        while not rospy.is_shutdown():
            ready, _, _ = select.select([{reading}], [], [], 0.5)
            got.append((rospy.get_time(), os.read({reading}, 1).decode() if ready else ""))
    """)
    ros.step(0.6)
    os.write(writing, b"w")
    ros.step(0.3)
    assert ros.namespace["got"] == [(0.5, ""), (0.61, "w")]
    for end in (reading, writing):
        os.close(end)


def test_errors_name_missing_libraries_and_functions(start: Start) -> None:
    for said, line in {
        r"rosgraph\.Master\.registerPublisher is not in": "import rosgraph; rosgraph.Master('/me').registerPublisher",
        r"roslaunch is not in .*call it in the test": "import roslaunch",
        r"tf2_ros\.Spaceship is not in": "from tf2_ros import Spaceship",
        r"actionlib\.Spaceship is not in": "import actionlib; actionlib.Spaceship",
        r"tf2_ros\.spaceship is not in": "import tf2_ros.spaceship",
        r"OpenCV": "import sys; sys.modules['cv2'] = None; from cv_bridge import CvBridge;"
                   " CvBridge().cv2_to_compressed_imgmsg(None)",
    }.items():  # fmt: skip
        with pytest.raises((UnsupportedApiError, NodeError), match=said):
            start(f"import rospy; {line}")
    sys.modules.pop("cv2", None)


def test_incompatible_qos_profiles_do_not_connect(start: Start) -> None:
    ros = start("""
        import rclpy
        from rclpy.qos import QoSProfile, ReliabilityPolicy, qos_check_compatible, qos_profile_sensor_data
        from std_msgs.msg import String
        rclpy.init()
        node = rclpy.create_node("n")
        got = []
        node.create_subscription(String, "x", lambda m: got.append("reliable"), QoSProfile(depth=1))
        node.create_subscription(String, "x", lambda m: got.append("best effort"), qos_profile_sensor_data)
        pub = node.create_publisher(String, "x", qos_profile_sensor_data)
        node.create_timer(0.1, lambda: pub.publish(String()))
        verdict = int(qos_check_compatible(qos_profile_sensor_data, QoSProfile(depth=1))[0])
        rclpy.spin(node)
    """)
    ros.step(0.2)
    assert ros.namespace["got"] == ["best effort"] * 2
    assert ros.namespace["verdict"] == 2
    ros.bus.publish("x", message_type("std_msgs/msg/String")())
    assert ros.namespace["got"].count("reliable") == 1  # the world's messages reach every subscriber
    assert heard(ros, "/x") == []
