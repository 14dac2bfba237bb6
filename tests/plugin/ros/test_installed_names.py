"""Names, types and environment variables of a ROS installation other than those of the client libraries."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

from pytest_tarl.ros import cv_bridge_boost, message_type, packages
from pytest_tarl.ros.messages import find_class, snapshot
from pytest_tarl.ros.messages.known import known_types
from pytest_tarl.ros.messages.node_workspaces import search
from tests.plugin.ros.conftest import Start, heard


@pytest.mark.parametrize("part", ["msg", "srv", "action"])
@pytest.mark.parametrize("kind", ["ros1", "ros2"])
def test_every_known_type_can_be_built(kind: str, part: str) -> None:
    for name in known_types(kind, part):  # type: ignore[arg-type]
        package, short = name.split("/")
        if part == "action" and kind == "ros1":
            made = find_class("ros1", package, f"{short}Action")
        else:
            made = find_class(kind, package, short, part)  # type: ignore[arg-type]
        assert made is not None, name
        if part == "msg" or (part, kind) == ("action", "ros1"):
            snapshot.snapshot(made())
        elif part == "srv":
            halves = (
                (made._request_class, made._response_class)
                if kind == "ros1"
                else (made.Request, made.Response)
            )
            assert all(half() is not None for half in halves)
        else:
            assert all(half() is not None for half in (made.Goal, made.Result, made.Feedback))


def test_moveit_types_have_their_constants() -> None:
    codes, scene = (
        message_type("moveit_msgs/MoveItErrorCodes"),
        message_type("moveit_msgs/msg/CollisionObject"),
    )
    assert (codes.SUCCESS, codes.NO_IK_SOLUTION) == (1, -31)
    assert "message" not in codes.__slots__
    assert message_type("moveit_msgs/msg/MoveItErrorCodes")().message == ""
    assert scene().operation == scene.ADD == b"\x00"


def test_a_sound_client_publishes_requests(start: Start) -> None:
    ros = start("""
        import rospy
        from sound_play.libsoundplay import SoundClient
        from sound_play.msg import SoundRequest
        rospy.init_node("speaker")
        client = SoundClient()
        rospy.sleep(0.1)
        client.say("hello", volume=7)
        client.startWaveFromPkg("a_package", "bell.wav", 0.5)
        client.builtinSound(SoundRequest.BACKINGUP).stop()
        client.stopAll()
        rospy.spin()
    """)
    requests = heard(ros, "/robotsound")
    ros.step(0.2)
    assert [(one.sound, one.command, one.arg, one.arg2, one.volume) for one in requests] == [
        (-3, 1, "hello", "", 1.0), (-2, 2, "bell.wav", "a_package", 0.5), (1, 0, "", "", 1.0), (-1, 0, "", "", 1.0)
    ]  # fmt: skip


def test_a_blocking_sound_client_waits_for_its_server(start: Start) -> None:
    ros = start("""
        import actionlib, rospy
        from sound_play.msg import SoundRequestAction, SoundRequestResult
        rospy.init_node("server")
        def play(goal):
            rospy.sleep(0.5)
            server.set_succeeded(SoundRequestResult(playing=False))
        server = actionlib.SimpleActionServer("sound_play", SoundRequestAction, play, auto_start=False)
        server.start()
        rospy.spin()
    """)
    start(
        """
        import rospy
        from sound_play.libsoundplay import SoundClient
        rospy.init_node("speaker")
        begun = rospy.get_time()
        SoundClient(blocking=True).playWave("bell.wav")
        took = rospy.get_time() - begun
    """,
        ros=ros,
    )
    ros.step(2)
    assert 0.5 <= ros.namespace["took"] < 1


def test_transformers_return_matrices(start: Start) -> None:
    ros = start("""
        import rospy, tf
        from geometry_msgs.msg import PointStamped, TransformStamped
        rospy.init_node("n")
        tree = tf.Transformer(True, rospy.Duration(10))
        sent = TransformStamped()
        sent.header.frame_id, sent.child_frame_id = "map", "base"
        sent.transform.translation.x, sent.transform.rotation.w = 2.0, 1.0
        tree.setTransform(sent)
        header = PointStamped().header
        header.frame_id = "base"
        matrix = tree.asMatrix("map", header).tolist()
    """)
    assert ros.namespace["matrix"] == [[1, 0, 0, 2], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]


def test_numbers_of_encodings_equal_the_numbers_of_opencv() -> None:
    number = cv_bridge_boost.getCvType("bgr8")
    assert (number, cv_bridge_boost.CV_MAT_CNWrap(number), cv_bridge_boost.CV_MAT_DEPTHWrap(number)) == (
        16,
        3,
        0,
    )
    assert cv_bridge_boost.CV_MAT_DEPTHWrap(cv_bridge_boost.getCvType("32FC1")) == 5
    image = np.array([[[1, 2, 3]]], dtype=np.uint8)
    assert cv_bridge_boost.cvtColor2(image, "bgr8", "rgb8").tolist() == [[[3, 2, 1]]]


def test_names_of_small_libraries_can_be_imported(start: Start) -> None:
    ros = start("""
        import actionlib, rospy
        from actionlib_msgs.msg import GoalStatus
        from cv_bridge.boost.cv_bridge_boost import getCvType
        from roslib.rostime import Time
        from rospkg.common import ResourceNotFound
        from tf2_geometry_msgs import PoseStamped
        import rospkg
        state = actionlib.get_name_of_constant(GoalStatus, 3)
        unknown = actionlib.get_name_of_constant(GoalStatus, 77)
        same = PoseStamped._type, Time is rospy.Time.__base__, rospkg.ResourceNotFound is ResourceNotFound
    """)
    assert (ros.namespace["state"], ros.namespace["unknown"]) == ("SUCCEEDED", "No such constant")
    assert ros.namespace["same"] == ("geometry_msgs/PoseStamped", True, True)


def test_rospkg_and_roslib_find_files_of_packages(tmp_path: Path) -> None:
    folder = tmp_path / "driver"
    (folder / "scripts" / "inner").mkdir(parents=True)
    (tmp_path / ".git").mkdir()
    (folder / "package.xml").write_text("<package><name>driver</name></package>")
    node, data = folder / "scripts" / "run.py", folder / "scripts" / "inner" / "run.yaml"
    for file in (node, data):
        file.write_text("")
    node.chmod(0o755)
    search(folder)
    assert packages.get_package_name(str(data)) == "driver"
    assert packages.get_package_name(str(tmp_path)) is None
    assert packages.find_node("driver", "run.py") == [str(node)]
    assert packages.find_node("driver", "run.yaml") == []
    assert packages.find_resource("driver", "run.yaml") == [str(data)]
    with pytest.raises(packages.InvalidROSPkgException):
        packages.find_node("drivers", "run.py")
    assert packages.get_ros_home({"ROS_HOME": "/var/ros"}) == "/var/ros"
    assert packages.get_dir_pkg(str(node)) == (str(folder), "driver")
    assert packages.get_dir_pkg(str(tmp_path)) == (None, None)
    assert packages.get_log_dir({"ROS_HOME": "/var/ros"}) == str(Path("/var/ros/log"))
    assert packages.get_ros_home({}) == str(Path.home() / ".ros")


@pytest.mark.parametrize(
    ("library", "version", "distribution"), [("rospy", "1", "noetic"), ("rclpy", "2", "humble")]
)
def test_nodes_read_the_variables_of_a_sourced_ros(
    library: str, version: str, distribution: str, start: Start, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("ROS_DISTRO", raising=False)
    monkeypatch.setenv("ROS_VERSION", "")
    ros = start(f"import os, {library}; read = os.environ['ROS_DISTRO'], os.environ['ROS_VERSION']")
    assert ros.namespace["read"] == (distribution, "")  # even an empty variable is not changed
    monkeypatch.delenv("ROS_VERSION")
    assert start(f"import os, {library}; read = os.environ.get('ROS_VERSION')").namespace["read"] == version


def test_variables_of_ros_are_gone_after_the_episode(monkeypatch: pytest.MonkeyPatch) -> None:
    from pytest_tarl.ros import Ros

    monkeypatch.delenv("ROS_DISTRO", raising=False)
    ros = Ros()
    with ros.installed():
        ros.start(lambda: exec("import rospy"), name="node.py")
        assert os.environ["ROS_DISTRO"] == "noetic"
    ros.close()
    assert "ROS_DISTRO" not in os.environ


def test_names_are_joined_and_resolved_as_rosgraph_does(
    start: Start, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROS_NAMESPACE", "robot")
    ros = start("""
        import rosgraph, rospy
        from rosgraph import names
        from rosgraph.names import load_mappings
        same = rosgraph.names is names
        mappings = load_mappings(["scan:=laser", "__name:=x", "_rate:=3", "file.yaml"])
        joined = [names.ns_join(*pair) for pair in (("/a", "b"), ("/a/", "/b"), ("", "b"), ("~", "b"), ("a", "~b"))]
        resolved = [names.resolve_name(name, "/ns/node", {"/ns/scan": "/laser"}) for name in ("scan", "/x/", "~y", "")]
        spaces = [names.namespace("/a/b"), names.make_global_ns("a"), names.make_caller_id("me")]
        script = [names.script_resolve_name("rostopic", name) for name in ("scan", "/scan", "")]
        legal = [names.is_legal_name(name) for name in ("a/b", "1a", "a//b", "~a", "", None)]
        base = [names.is_legal_base_name(name) for name in ("a_1", "a/b", "")]
        two = {names.anonymous_name("cam"), names.anonymous_name("cam2")}
        plain = names.canonicalize_name("/a//b/"), names.get_ros_namespace({}, ["__ns:=left"])
        refused = []
        for function, argument in ((names.make_global_ns, "~a"), (names.namespace, None)):
            try:
                function(argument)
            except ValueError:
                refused.append(function.__name__)
    """)
    found = ros.namespace
    assert found["same"]
    assert found["mappings"] == {"scan": "laser"}
    assert found["joined"] == ["/a/b", "/b", "b", "~b", "~b"]
    assert found["resolved"] == ["/laser", "/x", "/ns/node/y", "/ns/"]
    assert found["spaces"] == ["/a/", "/a/", "/robot/me"]
    assert found["script"] == ["/robot/scan", "/scan", "/robot/"]
    assert found["legal"] == [True, False, False, True, True, False]
    assert found["base"] == [True, False, False]
    assert len(found["two"]) == 2
    assert found["plain"] == ("/a/b", "/left/")
    assert found["refused"] == ["make_global_ns", "namespace"]


def test_rates_of_topics_are_measured_in_virtual_time(start: Start) -> None:
    ros = start("""
        import rospy, rostopic
        from std_msgs.msg import String
        rospy.init_node("meter")
        meter = rostopic.ROSTopicHz(-1)
        odd = rostopic.ROSTopicHz(2, filter_expr=lambda message: message.data == "odd")
        rospy.Subscriber("word", String, meter.callback_hz)
        rospy.Subscriber("word", String, odd.callback_hz, callback_args="word")
        empty = meter.get_hz()
        rospy.spin()
    """)
    for number in range(6):
        ros.bus.publish("word", message_type("std_msgs/String")("odd" if number % 2 else "even"))
        ros.step(0.1 if number < 4 else 0.2)
    rate, shortest, longest, deviation, count = ros.namespace["meter"].get_hz()
    assert ros.namespace["empty"] is None
    assert (1 / rate, shortest, longest, count) == pytest.approx((0.12, 0.1, 0.2, 6))
    assert deviation == pytest.approx(0.04)
    assert ros.namespace["odd"].get_hz("word")[1:3] == pytest.approx((0.2, 0.3))
    ros.namespace["meter"].print_hz([None, "silent"])
