"""Geometry, accounts of errors, groups, lazy nodes, services and queries, with stand-ins around them."""

from __future__ import annotations

import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from pytest_tarl.errors import NodeError
from pytest_tarl.ros import message_type, tf2_geometry_msgs, topic_tools
from pytest_tarl.ros.exception_texts import account, of_node
from pytest_tarl.ros.kdl.vectors import Vector
from pytest_tarl.ros.rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from tests.plugin.ros.conftest import Start

# geometry

TURN = Rotation.from_euler("xyz", [0.3, -0.2, 1.1])
MOVE = np.array([1.0, -2.0, 0.5])


@pytest.fixture(params=["ros1", "ros2"])
def transform(request: pytest.FixtureRequest) -> Any:
    """Return a function that makes messages, and the transform to the frame `map`."""
    infix = "/" if request.param == "ros1" else "/msg/"

    def make(name: str) -> Any:
        return message_type(f"geometry_msgs{infix}{name}")()

    made = make("TransformStamped")
    made.header.frame_id = "map"
    made.transform.translation.x, made.transform.translation.y, made.transform.translation.z = MOVE.tolist()
    turn = made.transform.rotation
    turn.x, turn.y, turn.z, turn.w = TURN.as_quat().tolist()
    return make, made


def numbers(vector: Any) -> list[float]:
    return [vector.x, vector.y, vector.z]


def test_points_are_rotated_and_moved_and_vectors_only_rotated(transform: Any) -> None:
    make, to_map = transform
    for name, part, expected in (
        ("PointStamped", "point", TURN.apply([1, 2, 3]) + MOVE),
        ("Vector3Stamped", "vector", TURN.apply([1, 2, 3])),
    ):
        given = make(name)
        inner = getattr(given, part)
        inner.x, inner.y, inner.z = 1.0, 2.0, 3.0
        moved = tf2_geometry_msgs.TRANSFORMERS[name](given, to_map)
        assert numbers(getattr(moved, part)) == pytest.approx(expected.tolist())
        assert (moved.header.frame_id, given.header.frame_id) == ("map", "")
        assert numbers(inner) == [1.0, 2.0, 3.0]


def test_both_parts_of_a_wrench_are_rotated(transform: Any) -> None:
    make, to_map = transform
    given = make("WrenchStamped")
    given.wrench.force.x, given.wrench.torque.y = 1.0, 2.0
    moved = tf2_geometry_msgs.do_transform_wrench(given, to_map)
    assert numbers(moved.wrench.force) == pytest.approx(TURN.apply([1, 0, 0]).tolist())
    assert numbers(moved.wrench.torque) == pytest.approx(TURN.apply([0, 2, 0]).tolist())


def test_all_corners_of_a_polygon_are_moved(transform: Any) -> None:
    make, to_map = transform
    given = make("PolygonStamped")
    given.polygon.points = [make("Point32"), make("Point32")]
    given.polygon.points[1].x = 2.0
    moved = tf2_geometry_msgs.do_transform_polygon_stamped(given, to_map)
    frame = tf2_geometry_msgs.transform_to_kdl(to_map)
    for corner, x in zip(moved.polygon.points, (0.0, 2.0), strict=True):
        assert numbers(corner) == pytest.approx(list(frame * Vector(x, 0, 0)), abs=1e-6)
    assert (moved.header.frame_id, given.polygon.points[1].y) == ("map", 0.0)


def test_a_pose_is_moved_with_and_without_a_header(transform: Any) -> None:
    make, to_map = transform
    stamped = make("PoseStamped")
    own = Rotation.from_euler("z", 0.4)
    stamped.pose.position.x = 2.0
    turn = stamped.pose.orientation
    turn.x, turn.y, turn.z, turn.w = own.as_quat().tolist()
    for moved in (
        tf2_geometry_msgs.do_transform_pose(stamped, to_map).pose,
        tf2_geometry_msgs.do_transform_pose(stamped.pose, to_map),
    ):
        assert numbers(moved.position) == pytest.approx((TURN.apply([2, 0, 0]) + MOVE).tolist())
        found = Rotation.from_quat(
            [moved.orientation.x, moved.orientation.y, moved.orientation.z, moved.orientation.w]
        )
        assert found.as_matrix() == pytest.approx((TURN * own).as_matrix())
    assert stamped.pose.position.x == 2.0


def test_a_covariance_is_rotated_with_its_pose(transform: Any) -> None:
    make, to_map = transform
    given = make("PoseWithCovarianceStamped")
    given.pose.pose.orientation.w = 1.0
    covariance = np.diag([1.0, 2.0, 3.0, 4.0, 5.0, 6.0])
    given.pose.covariance = covariance.ravel().tolist()
    moved = tf2_geometry_msgs.do_transform_pose_with_covariance_stamped(given, to_map)
    both = np.kron(np.eye(2), TURN.as_matrix())
    assert np.allclose(np.reshape(moved.pose.covariance, (6, 6)), both @ covariance @ both.T)
    assert numbers(moved.pose.pose.position) == pytest.approx(MOVE.tolist())


# accounts of errors


def raised(cause: BaseException | None) -> NodeError:
    try:
        if cause is not None:
            try:
                exec(compile("raise cause", "/robot/node.py", "exec"), {"cause": cause})
            except type(cause) as error:
                raise NodeError("Node failed.") from error
        raise NodeError("Node failed.")
    except NodeError as error:
        return error


def test_error_report_has_both_tracebacks() -> None:
    text = account(raised(ValueError("boom")), Path(__file__))
    sentence, trace, line = text.split("\n\n")
    assert sentence == "Node failed."
    assert trace.endswith('File "/robot/node.py", line 1, in <module>\nValueError: boom')
    assert line.startswith("The test was at test_small_parts_by_hand.py, line ")
    assert line.endswith('raise NodeError("Node failed.") from error')


def test_error_without_a_cause_is_reported_by_its_message() -> None:
    assert account(raised(None), Path(__file__)) == "Node failed."
    assert account(ValueError("mine"), Path(__file__)) == "mine"
    other = account(raised(ValueError("boom")), Path("/elsewhere/test_x.py"))
    assert "The test was at" not in other


def test_traceback_omits_first_package_frames() -> None:
    def of(*files: str) -> Any:
        frame: Any = None
        for file in reversed(files):
            frame = SimpleNamespace(
                tb_frame=SimpleNamespace(f_code=SimpleNamespace(co_filename=file)), tb_next=frame
            )
        return frame

    own = str(Path(sys.modules["pytest_tarl"].__file__ or "").parent / "ros" / "x.py")
    trace = of(own, own, "/robot/node.py", own)
    assert of_node(trace) is trace.tb_next.tb_next
    only = of(own, own)
    assert of_node(only) is only


# groups


def test_exclusive_group_runs_one_callback_at_a_time() -> None:
    exclusive, free = MutuallyExclusiveCallbackGroup(), ReentrantCallbackGroup()
    assert (exclusive.can_execute("a"), exclusive.beginning_execution("a")) == (True, True)
    assert (exclusive.can_execute("b"), exclusive.beginning_execution("b")) == (False, False)
    exclusive.ending_execution("a")
    assert exclusive.beginning_execution("b")
    assert [free.beginning_execution(one) and free.can_execute(one) for one in "ab"] == [True, True]
    exclusive.add_entity("a")
    assert [exclusive.has_entity(one) for one in "ab"] == [True, False]


# lazy transports


class Lazy(topic_tools.LazyTransport):
    """A node that notes when it subscribes."""

    def __init__(self, *peers: int) -> None:
        super().__init__()
        self.trail: list[str] = []
        self._publishers = [SimpleNamespace(get_num_connections=lambda peer=peer: peer) for peer in peers]  # type: ignore[misc]

    def subscribe(self) -> None:
        self.trail.append("subscribe")

    def unsubscribe(self) -> None:
        self.trail.append("unsubscribe")


def test_lazy_node_unsubscribes_with_its_last_peer(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(topic_tools, "get_param", lambda name, default: default)
    idle, busy = Lazy(0, 0), Lazy(0, 1)
    for one in (idle, busy):
        one.peer_subscribe()
        one.peer_unsubscribe()
    assert idle.trail == ["subscribe", "unsubscribe"]
    assert busy.trail == ["subscribe"]
    idle.peer_unsubscribe()
    idle.peer_subscribe()
    assert idle.trail[2:] == ["subscribe"]
    assert Lazy().trail == []


def test_a_node_that_is_not_lazy_always_subscribes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(topic_tools, "get_param", lambda name, default: False)
    node = Lazy()
    node.peer_unsubscribe()
    assert node.trail == ["subscribe"]


# services and the graph of ROS 2

PAIR = """
    import rclpy
    from example_interfaces.srv import AddTwoInts
    from std_msgs.msg import String
    rclpy.init()
    node = rclpy.create_node("one", namespace="ns")
    found = []
"""


def found(ros: Any) -> list[Any]:
    return ros.namespace["found"]  # type: ignore[no-any-return]


def test_client_calls_a_service_with_a_limit(start: Start) -> None:
    ros = start(
        PAIR
        + """
    client = node.create_client(AddTwoInts, "add")
    found += [client.service_is_ready(), client.wait_for_service(0.5), node.get_clock().now().nanoseconds]
    found.append(client.call(AddTwoInts.Request(a=1, b=2), timeout_sec=0.25))
    found.append(node.get_clock().now().nanoseconds)
    pending = client.call_async(AddTwoInts.Request())
    client.remove_pending_request(pending)
    kept = client.call_async(AddTwoInts.Request())
    client.destroy()
    found += [pending.cancelled(), kept.cancelled()]
    try:
        client.call_async("text")
    except TypeError as error:
        found.append(str(error).startswith("Expected"))
    """
    )
    ros.step(2.0)
    assert found(ros) == [False, False, 500_000_000, None, 750_000_000, False, True, True]


def test_service_may_answer_from_a_coroutine(start: Start) -> None:
    ros = start(
        PAIR
        + """
    async def add(request, response):
        response.sum = request.a + request.b
        return response
    service = node.create_service(AddTwoInts, "add", add)
    client = node.create_client(AddTwoInts, "add")
    future = client.call_async(AddTwoInts.Request(a=1, b=2))
    rclpy.spin_until_future_complete(node, future)
    found += [future.result().sum, client.service_is_ready(), node.count_services("add"), node.count_clients("add")]
    node.destroy_service(service)
    found += [client.service_is_ready(), node.count_services("add")]
    """
    )
    ros.step(1.0)
    assert found(ros) == [3, True, 1, 1, False, 0]


def test_a_node_describes_the_ends_of_topics_and_services(start: Start) -> None:
    ros = start(
        PAIR
        + """
    node.create_publisher(String, "text", 3)
    node.create_subscription(String, "heard", lambda _: None, 4)
    node.create_service(AddTwoInts, "add", lambda request, response: response)
    node.create_client(AddTwoInts, "other")
    of = "one", "/ns"
    found += [node.get_service_names_and_types_by_node(*of)[-1], node.get_client_names_and_types_by_node(*of)]
    found += [("/ns/text", ["std_msgs/msg/String"]) in node.get_publisher_names_and_types_by_node(*of)]
    found += [("/ns/heard", ["std_msgs/msg/String"]) in node.get_subscriber_names_and_types_by_node(*of)]
    (end,) = node.get_publishers_info_by_topic("text")
    found += [(end.node_name, end.node_namespace, end.topic_type, int(end.endpoint_type), end.qos_profile.depth)]
    (end,) = node.get_subscriptions_info_by_topic("heard")
    found += [(int(end.endpoint_type), end.qos_profile.depth), node.get_subscriptions_info_by_topic("text")]
    found += [node.count_publishers("text"), node.count_publishers("heard"), node.count_subscribers("heard")]
    found += [node.wait_for_node("ns/one", 1.0), node.wait_for_node("ns/two", 0.25)]
    found += [node.get_clock().now().nanoseconds, node.get_node_names_and_namespaces()]
    try:
        node.get_publisher_names_and_types_by_node("two", "/ns")
    except RuntimeError as error:
        found.append("does not exist" in str(error))
    """
    )
    ros.step(1.0)
    assert found(ros) == [
        ("/ns/add", ["example_interfaces/srv/AddTwoInts"]),
        [("/ns/other", ["example_interfaces/srv/AddTwoInts"])],
        True,
        True,
        ("one", "/ns", "std_msgs/msg/String", 1, 3),
        (2, 4),
        [],
        2,
        1,
        2,
        True,
        False,
        250_000_000,
        [("one", "/ns")],
        True,
    ]
