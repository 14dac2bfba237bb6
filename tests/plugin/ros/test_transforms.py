from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pytest_tarl.ros import message_type, transformations
from pytest_tarl.ros.transforms import Rigid, slerp
from tests.plugin.ros.conftest import Start

angles = st.floats(-3.1, 3.1)
ORDERS = [
    frame + order
    for frame in "sr"
    for order in ("xyz", "xzy", "yxz", "yzx", "zxy", "zyx", "zyz", "zxz", "xyx")
]


@pytest.mark.parametrize("axes", ORDERS)
@given(angles, angles, angles)
def test_angles_of_a_rotation_give_the_same_rotation(
    axes: str, first: float, second: float, third: float
) -> None:
    matrix = transformations.euler_matrix(first, second, third, axes)
    again = transformations.euler_matrix(*transformations.euler_from_matrix(matrix, axes), axes)
    assert np.allclose(matrix, again, atol=1e-7)


@given(angles, angles, angles)
def test_a_quaternion_survives_conversion_to_a_matrix(roll: float, pitch: float, yaw: float) -> None:
    quaternion = transformations.quaternion_from_euler(roll, pitch, yaw)
    found = transformations.quaternion_from_matrix(transformations.quaternion_matrix(quaternion))
    assert np.allclose(found, quaternion, atol=1e-9) or np.allclose(found, -quaternion, atol=1e-9)


@pytest.mark.parametrize("pitch", [math.pi / 2, -math.pi / 2])
@pytest.mark.parametrize("axes", ["sxyz", "rzyx", "rxyz", "szyx"])
def test_gimbal_lock_preserves_the_rotation(pitch: float, axes: str) -> None:
    matrix = transformations.euler_matrix(0.3, pitch, 0.4, axes)
    again = transformations.euler_matrix(*transformations.euler_from_matrix(matrix, axes), axes)
    assert np.allclose(matrix, again, atol=1e-7)


def test_moving_axes_equal_fixed_axes_in_the_opposite_order() -> None:
    assert np.allclose(transformations.quaternion_from_euler(0.1, 0.2, 0.3, "rzyx"),
                       transformations.quaternion_from_euler(0.3, 0.2, 0.1, "sxyz"))  # fmt: skip


@given(angles, angles)
def test_slerp_at_one_half_halves_the_angle(start: float, end: float) -> None:
    turns = [tuple(transformations.quaternion_about_axis(a, (0, 0, 1)).tolist()) for a in (start, end)]
    half = slerp(turns[0], turns[1], 0.5)
    assert math.isclose(sum(a * b for a, b in zip(half, turns[0], strict=True)),
                        abs(sum(a * b for a, b in zip(half, turns[1], strict=True))), abs_tol=1e-6)  # fmt: skip


@given(angles, st.floats(-5, 5), st.floats(-5, 5))
def test_a_transform_times_its_inverse_is_the_identity(yaw: float, x: float, y: float) -> None:
    pose = Rigid((x, y, 1.0), (0.0, 0.0, math.sin(yaw / 2), math.cos(yaw / 2)))
    assert np.allclose((pose @ pose.inverse()).apply((1.0, 2.0, 3.0)), (1.0, 2.0, 3.0))


def transform(parent: str, child: str, time: float, x: float, yaw: float = 0.0) -> object:
    made = message_type("geometry_msgs/msg/TransformStamped")()
    made.header.frame_id, made.child_frame_id = parent, child
    made.header.stamp.sec, made.header.stamp.nanosec = divmod(round(time * 1e9), 10**9)
    made.transform.translation.x = x
    made.transform.rotation.z, made.transform.rotation.w = math.sin(yaw / 2), math.cos(yaw / 2)
    return made


TF2_NODE = """
    import rclpy, tf2_ros
    import tf2_geometry_msgs
    from geometry_msgs.msg import PointStamped
    from rclpy.duration import Duration
    from rclpy.time import Time
    from tf2_ros.buffer import Buffer
    from tf2_ros.transform_listener import TransformListener

    rclpy.init()
    node = rclpy.create_node("n")
    buffer = Buffer(cache_time=Duration(seconds=5))
    TransformListener(buffer, node)
    log = []

    def ask():
        now = Time(nanoseconds=1_500_000_000)
        try:
            found = buffer.lookup_transform("odom", "laser", now)
        except tf2_ros.TransformException as error:
            log.append(type(error).__name__)
            return
        move = found.transform.translation
        log.append((round(move.x, 6), round(move.y, 6), found.header.frame_id, found.child_frame_id))
        point = PointStamped()
        point.header.frame_id = "laser"
        point.point.x = 1.0
        log.append(round(buffer.transform(point, "odom").point.x, 6))

    node.create_timer(1.0, ask)
    rclpy.spin(node)
"""


def test_buffer_interpolates_and_names_missing_frames(start: Start) -> None:
    ros = start(TF2_NODE)
    message = message_type("tf2_msgs/msg/TFMessage")
    ros.step(1.0)
    ros.bus.publish("/tf_static", message(transforms=[transform("base_link", "laser", 0.0, 0.5)]), latch=True)
    ros.bus.publish("/tf", message(transforms=[transform("odom", "base_link", 1.0, 1.0)]))
    ros.step(1.0)
    ros.bus.publish("/tf", message(transforms=[transform("odom", "base_link", 2.0, 3.0, math.pi)]))
    ros.step(1.0)
    assert ros.namespace["log"] == [
        "LookupException", "ExtrapolationException", (2.0, 0.5, "odom", "laser"), 1.5,
    ]  # fmt: skip


def test_transforms_reach_the_listener_of_another_node(start: Start) -> None:
    ros = start("""
        import rospy, tf, tf2_ros
        from geometry_msgs.msg import TransformStamped
        rospy.init_node("a")
        fixed = TransformStamped()
        fixed.header.frame_id, fixed.child_frame_id = "map", "odom"
        fixed.transform.translation.x, fixed.transform.rotation.w = 10.0, 1.0
        tf2_ros.StaticTransformBroadcaster().sendTransform(fixed)
        broadcaster = tf.TransformBroadcaster()
        rate = rospy.Rate(10)
        while not rospy.is_shutdown():
            turn = tf.transformations.quaternion_from_euler(0, 0, 1.0)
            broadcaster.sendTransform((1, 2, 0), turn, rospy.Time.now(), "base", "odom")
            rate.sleep()
    """)
    start(
        """
        import rospy, tf
        from geometry_msgs.msg import PoseStamped
        rospy.init_node("b")
        listener = tf.TransformListener()
        try:
            listener.lookupTransform("/map", "/base", rospy.Time(0))
        except (tf.LookupException, tf.ConnectivityException, tf.ExtrapolationException):
            early = True
        listener.waitForTransform("map", "base", rospy.Time(0), rospy.Duration(2))
        (trans, rot) = listener.lookupTransform("/map", "/base", rospy.Time(0))
        yaw = tf.transformations.euler_from_quaternion(rot)[2]
        pose = PoseStamped()
        pose.header.frame_id, pose.pose.orientation.w = "base", 1.0
        moved = listener.transformPose("map", pose).pose.position
        try:
            listener.waitForTransform("map", "nowhere", rospy.Time(0), rospy.Duration(0.5))
        except tf.Exception as error:
            said = str(error)
    """,
        ros=ros,
    )
    ros.step(2.0)
    known = ros.namespace
    assert known["early"]
    assert (known["trans"], round(known["yaw"], 9)) == ([11.0, 2.0, 0.0], 1.0)
    assert (known["moved"].x, known["moved"].y) == (11.0, 2.0)
    assert '"nowhere" passed to lookupTransform argument does not exist' in known["said"]


def test_a_lookup_waits_until_the_transform_arrives(start: Start) -> None:
    ros = start("""
        import rclpy, tf2_ros
        from rclpy.callback_groups import ReentrantCallbackGroup
        from rclpy.time import Time
        rclpy.init()
        node = rclpy.create_node("n")
        buffer = tf2_ros.Buffer()
        tf2_ros.TransformListener(buffer, node)
        log = []
        async def ask():
            timer.cancel()
            found = await buffer.lookup_transform_async("odom", "base", Time())
            log.append((found.transform.translation.x, node.get_clock().now().nanoseconds))
        timer = node.create_timer(0.1, ask, callback_group=ReentrantCallbackGroup())
        rclpy.spin(node)
    """)
    ros.step(0.5)
    ros.bus.publish(
        "/tf", message_type("tf2_msgs/msg/TFMessage")(transforms=[transform("odom", "base", 0.5, 4.0)])
    )
    ros.step(0.5)
    assert ros.namespace["log"] == [(4.0, 500_000_000)]


MOVING = """
    import rospy, tf, tf2_ros
    from geometry_msgs.msg import Point32, PointStamped, TransformStamped
    from sensor_msgs.msg import PointCloud

    def add(parent, child, x, seconds):
        message = TransformStamped(child_frame_id=child)
        message.header.frame_id, message.header.stamp = parent, rospy.Time(seconds)
        message.transform.translation.x, message.transform.rotation.w = x, 1.0
        transformer.setTransform(message)

    rospy.init_node("n")
    transformer = tf.Transformer(True, rospy.Duration(10.0))
    for seconds in (1, 9):
        add("map", "odom", 1.0, seconds)
        add("odom", "base", seconds - 1.0, seconds)
        add("base", "cam", 0.5, seconds)
        add("map", "mark", 2.0, seconds)
    times = rospy.Time(2), rospy.Time(5)
"""


def test_look_ups_between_two_times_use_a_fixed_frame(start: Start) -> None:
    ros = start(
        MOVING
        + """
    there = transformer.lookupTransformFull("base", times[0], "base", times[1], "odom")
    found = transformer.canTransformFull("base", times[0], "base", times[1], "odom")
    chain = transformer.chain("cam", times[0], "mark", times[0], "map")
    back = transformer.chain("base", times[0], "base", times[1], "odom")
    began = rospy.get_time()
    try:
        transformer.waitForTransformFull("base", times[0], "nothing", times[1], "odom", rospy.Duration(0.5))
    except tf.Exception as error:
        problem, waited = str(error), rospy.get_time() - began
    transformer.clear()
    frames = transformer.getFrameStrings()
    """
    )
    ros.step(1.0)
    names = ros.namespace  # type: ignore[attr-defined]
    assert names["there"] == (
        [3.0, 0.0, 0.0],
        [0.0, 0.0, 0.0, 1.0],
    )  # as Debian's tf 1.13 answers, like the chains
    assert names["found"] is True
    assert names["chain"] == ["mark", "map", "odom", "base", "cam"]
    assert names["back"] == ["base", "odom", "base"]
    assert "nothing" in names["problem"]
    assert names["waited"] == pytest.approx(0.5)
    assert names["frames"] == []


def test_messages_are_transformed_via_a_fixed_frame(
    start: Start,
) -> None:
    ros = start(
        MOVING
        + """
    point = PointStamped()
    point.header.frame_id, point.header.stamp, point.point.x = "base", times[1], 0.25
    moved = transformer._buffer.transform_full(point, "base", times[0], "odom")
    cloud = PointCloud(points=[Point32(1.0, 2.0, 3.0)])
    cloud.header.frame_id, cloud.header.stamp = "cam", times[0]
    turned = transformer.transformPointCloud("odom", cloud)
    """
    )
    ros.step(0.1)
    names = ros.namespace  # type: ignore[attr-defined]
    assert (names["moved"].point.x, names["moved"].header.frame_id) == (3.25, "base")
    assert [(one.x, one.y, one.z) for one in names["turned"].points] == [(2.5, 2.0, 3.0)]
    assert names["turned"].header.frame_id == "odom"
