"""Rarely used libraries: cameras, transformations, message classes by name, lazy transports, loggers."""

from __future__ import annotations

import math
import sys
from pathlib import Path
from textwrap import dedent
from types import ModuleType

import numpy as np
import pytest

from pytest_tarl.errors import NodeError, UnsupportedApiError
from pytest_tarl.ros import message_type
from pytest_tarl.ros import transformations as tf
from pytest_tarl.ros.image_geometry import PinholeCameraModel, StereoCameraModel
from tests.plugin.ros.conftest import Start, heard


def camera(kind: str = "sensor_msgs/CameraInfo", tx: float = 0.0) -> object:
    made = message_type(kind)()
    values = {"K": [100.0, 0, 32, 0, 120, 24, 0, 0, 1], "R": [1.0, 0, 0, 0, 1, 0, 0, 0, 1], "D": [],
              "P": [100.0, 0, 32, tx, 0, 120, 24, 0, 0, 0, 1, 0]}  # fmt: skip
    for name, numbers in values.items():
        setattr(made, name if hasattr(made, name) else name.lower(), [float(number) for number in numbers])
    made.width, made.height, made.header.frame_id = 64, 48, "lens"
    return made


@pytest.mark.parametrize("kind", ["sensor_msgs/CameraInfo", "sensor_msgs/msg/CameraInfo"])
def test_a_camera_model_projects_points_to_pixels_and_back(kind: str) -> None:
    model = PinholeCameraModel()
    model.fromCameraInfo(camera(kind))
    assert model.project3dToPixel((0.5, -0.25, 2.0)) == pytest.approx((57.0, 9.0))
    ray = np.array(model.projectPixelTo3dRay((57.0, 9.0)))
    assert np.linalg.norm(ray) == pytest.approx(1)
    assert ray / ray[2] * 2 == pytest.approx([0.5, -0.25, 2.0])
    assert all(map(math.isnan, model.project3dToPixel((1, 1, 0))))
    assert (model.fovX(), model.getDeltaX(10, 2.0), model.tfFrame()) == (2 * math.atan(0.32), 0.2, "lens")
    assert isinstance(model.intrinsicMatrix(), np.matrix)
    assert model.distortionCoeffs() is None


def test_camera_model_respects_binning_and_region() -> None:
    info = camera()
    info.binning_x = info.binning_y = 2  # type: ignore[attr-defined]
    info.roi.x_offset, info.roi.width, info.roi.height = 8, 32, 48  # type: ignore[attr-defined]
    model = PinholeCameraModel()
    model.fromCameraInfo(info)
    assert (model.fx(), model.cx(), model.cy()) == (50.0, 12.0, 12.0)
    assert model.fullIntrinsicMatrix()[0, 0] == 100.0


def test_a_stereo_camera_computes_depth() -> None:
    model = StereoCameraModel()
    model.fromCameraInfo(camera(), camera(tx=-20.0))
    (u, v), (u_right, _) = model.project3dToPixel((0.5, -0.25, 2.0))
    assert model.getZ(u - u_right) == pytest.approx(2.0)
    assert model.getDisparity(2.0) == pytest.approx(u - u_right)
    x, _, z = model.projectPixelTo3d((u, v), u - u_right)
    assert (x, z) == pytest.approx((0.5, 2.0))


def test_decomposed_matrices_can_be_composed_again() -> None:
    parts = ([1.5, 0.5, 2.0], [0.1, -0.2, 0.3], [0.4, -0.5, 0.6], [1, 2, 3])
    matrix = tf.compose_matrix(*parts)
    scale, shear, angles, translation, perspective = tf.decompose_matrix(matrix)
    for found, given in zip((scale, shear, angles, translation), parts, strict=True):
        assert list(found) == pytest.approx(given)
    assert list(perspective) == [0, 0, 0, 1]
    mirror = tf.reflection_matrix([1, 2, 3], [0, 1, 1])
    assert tf.is_same_transform(mirror @ mirror, tf.identity_matrix())
    assert tf.is_same_transform(tf.reflection_matrix(*tf.reflection_from_matrix(mirror)), mirror)
    turn = tf.rotation_matrix(1.2, [1, 2, 3], [4, 5, 6])
    assert tf.is_same_transform(tf.rotation_matrix(*tf.rotation_from_matrix(turn)), turn)
    flat = tf.projection_matrix([0, 0, 1], [0, 0, 1])
    assert list(flat @ [5, 6, 7, 1]) == [5, 6, 1, 1]
    points = np.random.default_rng(1).normal(size=(3, 6))
    moved = turn @ np.vstack([points, np.ones(6)])
    assert tf.is_same_transform(tf.superimposition_matrix(points, moved), turn)
    assert "compose_matrix" in tf.__all__
    with pytest.raises(ValueError, match="not orthogonal"):
        tf.shear_matrix(1, [1, 0, 0], [0, 0, 0], [1, 1, 0])


def test_classes_are_found_by_type_name(start: Start) -> None:
    ros = start("""
        import rospy
        import roslib.message
        from genpy.dynamic import generate_dynamic
        from genpy.message import fill_message_args, get_printable_message_args, strify_message, struct_I
        from roslib import message
        TEXT = "own_msgs/Inner one\\n" + "=" * 80 + "\\nMSG: own_msgs/Inner\\nint32 x\\n"
        pose = roslib.message.get_message_class("geometry_msgs/PoseStamped")()
        fill_message_args(pose, [{"header": {"stamp": "now"}, "pose": {"position": [1.0, 2.0, 3.0]}}],
                          keys={"now": rospy.Time(4)})
        names = get_printable_message_args(pose.pose.position)
        nobody = message.get_message_class("no_msgs/Such"), message.get_service_class("std_srvs/Empty").__name__
        made = generate_dynamic("own_msgs/Outer", TEXT)
        x = made["own_msgs/Outer"]().one.x
        size = struct_I.size
        try:
            fill_message_args(pose, [{"heading": 1}])
        except message.MessageException as error:
            said = str(error)
    """)
    found = ros.namespace
    assert (found["pose"].pose.position.y, found["pose"].header.stamp.secs, found["names"]) == (
        2.0,
        4,
        "x y z",
    )
    assert (found["nobody"], found["x"], found["size"]) == ((None, "Empty"), 0, 4)
    assert found["said"] == "No field name [heading]"


def test_tf2_ros_exposes_its_ros1_messages(start: Start) -> None:
    source = (
        "import {0}\nfrom tf2_ros import TransformStamped\nhas = hasattr(TransformStamped(), '_slot_types')"
    )
    assert start(source.format("rospy")).namespace["has"] is True


def test_tf2_ros_exposes_its_ros2_messages(start: Start) -> None:
    source = (
        "import rclpy\nfrom tf2_ros import TransformStamped\nhas = hasattr(TransformStamped(), '_slot_types')"
    )
    assert start(source).namespace["has"] is False


def test_parts_of_a_message_package_need_no_explicit_import(start: Start) -> None:
    ros = start("""
        import rospy
        import std_msgs
        found = std_msgs.msg.String("a").data
        missing = hasattr(std_msgs, "action")
    """)
    assert (ros.namespace["found"], ros.namespace["missing"]) == ("a", False)


def test_lazy_transport_subscribes_for_the_world(start: Start) -> None:
    ros = start("""
        import rospy
        from std_msgs.msg import Float64
        from topic_tools import LazyTransport

        class Doubler(LazyTransport):
            def __init__(self):
                super().__init__()
                self.pub = self.advertise("~output", Float64, queue_size=1)

            def subscribe(self):
                self.sub = rospy.Subscriber("~input", Float64, lambda m: self.pub.publish(2 * m.data))

            def unsubscribe(self):
                self.sub.unregister()

        rospy.init_node("doubler")
        Doubler()
        rospy.spin()
    """)
    got = heard(ros, "/doubler/output")
    ros.bus.publish("/doubler/input", message_type("std_msgs/Float64")(3.0))
    ros.step(0.1)
    assert [one.data for one in got] == [6.0]


def test_loggers_can_be_imported_from_rclpy_impl(start: Start) -> None:
    ros = start("""
        import rclpy
        from rclpy.impl.logging_severity import LoggingSeverity
        from rclpy.impl.rcutils_logger import RcutilsLogger
        rclpy.init()
        logger = rclpy.create_node("n").get_logger()
        found = isinstance(logger, RcutilsLogger), int(LoggingSeverity.WARN)
    """)
    assert ros.namespace["found"] == (True, 30)


def test_numpy_bools_fit_ros1_bool_fields(start: Start) -> None:
    ros = start("""
        import numpy as np
        import rospy
        from std_msgs.msg import Bool
        rospy.init_node("n")
        rospy.Publisher("on", Bool, queue_size=1).publish(np.float64(1) > 0)
    """)
    assert ros.bus.latest("/on").data is True


def test_modules_from_the_test_are_imported(start: Start, monkeypatch: pytest.MonkeyPatch) -> None:
    own = ModuleType("roslib.scriptutil")
    own.ask = lambda: "own"  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "roslib.scriptutil", own)
    ros = start("import rospy\nfrom roslib import scriptutil\nimport roslib.scriptutil as same\n")
    assert ros.namespace["scriptutil"] is ros.namespace["same"] is own
    with pytest.raises((NodeError, UnsupportedApiError), match=r"roslib\.names is not in the in-process ROS"):
        start("from roslib import names\n", ros=ros)


def test_test_package_replaces_the_built_in_package(start: Start, monkeypatch: pytest.MonkeyPatch) -> None:
    package, part = ModuleType("sound_play"), ModuleType("sound_play.libsoundplay")
    part.SoundClient = lambda: "own"  # type: ignore[attr-defined]
    package.libsoundplay = part  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "sound_play", package)
    monkeypatch.setitem(sys.modules, "sound_play.libsoundplay", part)
    ros = start("import rospy\nfrom sound_play.libsoundplay import SoundClient\nclient = SoundClient()\n")
    assert ros.namespace["client"] == "own"


def test_parts_of_a_stub_can_be_imported_from_it(start: Start) -> None:
    ros = start("from sensor_msgs_py import point_cloud2\nfrom tf import transformations\nimport rclpy\n")
    assert ros.namespace["point_cloud2"].__name__ == "sensor_msgs_py.point_cloud2"


@pytest.mark.parametrize(
    "name", ["pcl_msgs/PointIndices", "control_msgs/PointHeadActionGoal", "control_msgs/JointTrajectoryControllerState",
             "pcl_msgs/msg/PolygonMesh", "control_msgs/action/PointHead", "rcl_interfaces/srv/GetLoggerLevels",
             "laser_assembler/AssembleScans2", "audio_common_msgs/AudioData"],
)  # fmt: skip
def test_message_types_of_less_common_packages_are_known(name: str) -> None:
    found = message_type(name)
    assert found.__name__ == name.rpartition("/")[2]


def test_parameter_files_are_read_for_other_nodes(start: Start, tmp_path: Path) -> None:
    (tmp_path / "p.yaml").write_text(
        "/**:\n  ros__parameters: {debug: true}\n"
        "arm:\n  ros__parameters: {gain: 2.5, limits: {top: 3}}\n"
        "leg:\n  ros__parameters: {names: [a, b]}\n"
    )
    ros = start(f"""
        import rclpy
        from rclpy.parameter import Parameter, parameter_dict_from_yaml_file
        rclpy.init()
        path = {str(tmp_path / "p.yaml")!r}

        def read(*args, **kwds):
            found = parameter_dict_from_yaml_file(*args, **kwds)
            return {{name: Parameter.from_parameter_msg(one).value for name, one in found.items()}}

        found = read(path), read(path, True, ["/arm"]), read(path, target_nodes=["leg"])
        try:
            read(path, False, ["/hand"])
        except RuntimeError as error:
            said = str(error)
    """)
    arm, leg = {"gain": 2.5, "limits.top": 3}, {"names": ["a", "b"]}
    assert ros.namespace["found"] == ({**arm, **leg}, {"debug": True, **arm}, leg)
    assert ros.namespace["said"].startswith("Param file does not contain any parameters for ['/hand']")


def test_parameters_override_the_quality_of_service(start: Start) -> None:
    node = """
        import rclpy
        from rcl_interfaces.msg import SetParametersResult
        from rclpy.duration import Duration
        from rclpy.qos_overriding_options import QoSOverridingOptions, QoSPolicyKind
        from std_msgs.msg import Float64
        rclpy.init()
        node = rclpy.create_node("n")
        options = QoSOverridingOptions.with_default_policies(entity_id="left")
        pub = node.create_publisher(Float64, "out", 10, qos_overriding_options=options)
        own = QoSOverridingOptions((QoSPolicyKind.DEADLINE, QoSPolicyKind.DURABILITY), callback=check)
        sub = node.create_subscription(Float64, "in", print, 3, qos_overriding_options=own)
        found = (pub.qos_profile.reliability.name, pub.qos_profile.depth, sub.qos_profile.durability.name,
                 sub.qos_profile.deadline.nanoseconds, sub.qos_profile.depth,
                 node.get_parameter("qos_overrides./out.publisher_left.history").value)
    """
    check = "def check(profile): return SetParametersResult(successful={}, reason='no')\n"
    given = {
        "qos_overrides./out.publisher_left.reliability": "best_effort",
        "qos_overrides./out.publisher_left.depth": 2,
        "qos_overrides./in.subscription.deadline": 5,
    }
    ros = start(check.format(True) + dedent(node), parameters=given)
    assert ros.namespace["found"] == ("BEST_EFFORT", 2, "VOLATILE", 5, 3, "keep_last")
    with pytest.raises(NodeError, match="check refused the profile: no"):
        start(check.format(False) + dedent(node))
    with pytest.raises(
        NodeError, match="'sometimes' is not a valid reliability: use one of system_default, reliable,"
    ):
        start(check.format(True) + dedent(node),
              parameters={"qos_overrides./out.publisher_left.reliability": "sometimes"})  # fmt: skip


def test_multiplexers_are_called_by_their_services(start: Start) -> None:
    ros = start("""
        import rospy
        from topic_tools.srv import MuxSelect, MuxSelectResponse
        rospy.init_node("n")
        rospy.Service("mux/select", MuxSelect, lambda request: MuxSelectResponse(prev_topic="/" + request.topic))
        found = rospy.ServiceProxy("mux/select", MuxSelect)("odom").prev_topic
    """)
    assert ros.namespace["found"] == "/odom"


def test_node_may_choose_signal_handlers(start: Start) -> None:
    ros = start("""
        import signal
        import rclpy
        from rclpy.signals import SignalHandlerOptions, get_current_signal_handlers_options
        before = signal.getsignal(signal.SIGTERM)
        rclpy.init(signal_handler_options=SignalHandlerOptions.SIGTERM)
        rclpy.install_signal_handlers(rclpy.SignalHandlerOptions.ALL)
        found = get_current_signal_handlers_options(), signal.getsignal(signal.SIGTERM) is before
        rclpy.uninstall_signal_handlers()
    """)
    handlers, same = ros.namespace["found"]
    assert (handlers.name, same) == ("NO", True)


def test_a_context_knows_the_domain_of_the_environment(start: Start, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_DOMAIN_ID", "7")
    ros = start("""
        import rclpy
        rclpy.init()
        found = rclpy.get_default_context().get_domain_id()
    """)
    assert ros.namespace["found"] == 7
