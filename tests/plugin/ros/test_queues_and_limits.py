"""Sizes of queues, limits of time and numbers of callbacks, at their boundaries."""

from __future__ import annotations

from typing import Any

import pytest

from pytest_tarl import faults
from pytest_tarl.errors import SettingsError
from pytest_tarl.ros import message_type
from pytest_tarl.ros.rclpy.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    InvalidQoSProfileException,
    QoSCompatibility,
    QoSProfile,
    ReliabilityPolicy,
    as_profile,
    qos_check_compatible,
)
from tests.plugin.ros.conftest import Start, heard

RELIABLE, BEST_EFFORT = ReliabilityPolicy.RELIABLE, ReliabilityPolicy.BEST_EFFORT
VOLATILE, LOCAL = DurabilityPolicy.VOLATILE, DurabilityPolicy.TRANSIENT_LOCAL
STRING = message_type("std_msgs/String")


@pytest.mark.parametrize(
    ("qos", "kept"),
    [
        ("1", 1),
        ("3", 3),
        ("QoSProfile(depth=4)", 4),
        ("QoSProfile(history=HistoryPolicy.KEEP_ALL)", 25),
        ("QoSProfile(history=HistoryPolicy.KEEP_ALL, depth=2)", 25),
        ("QoSProfile(history=HistoryPolicy.SYSTEM_DEFAULT, depth=6)", 6),
        ("qos_profile_sensor_data", 5),
        ("qos_profile_system_default", 10),
    ],
)
def test_a_subscription_keeps_the_newest_messages_of_its_depth(start: Start, qos: str, kept: int) -> None:
    ros = start(f"""
        import rclpy
        from rclpy.qos import HistoryPolicy, QoSProfile, qos_profile_sensor_data, qos_profile_system_default
        from std_msgs.msg import Int32
        rclpy.init()
        node = rclpy.create_node("n")
        found = []
        node.create_subscription(Int32, "x", lambda message: found.append(message.data), {qos})
        node.get_clock().sleep_for(rclpy.duration.Duration(seconds=1))
        rclpy.spin(node)
    """)
    number = message_type("std_msgs/msg/Int32")
    for value in range(25):
        ros.bus.publish("x", number(data=value))
    ros.step(1)
    assert ros.namespace["found"] == list(range(25 - kept, 25))  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    ("size", "kept"), [("queue_size=1", 1), ("queue_size=3", 3), ("queue_size=None", 24)]
)
def test_rospy_subscriber_keeps_the_newest_messages(start: Start, size: str, kept: int) -> None:
    ros = start(f"""
        import rospy
        from std_msgs.msg import Int32
        found = []
        def heard(message):
            found.append(message.data)
            rospy.sleep(1)
        rospy.init_node("n")
        rospy.Subscriber("x", Int32, heard, {size})
        rospy.spin()
    """)
    for value in range(25):
        ros.bus.publish("x", message_type("std_msgs/Int32")(value))
    ros.step(60)
    assert ros.namespace["found"] == [0, *range(25 - kept, 25)]  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    ("offered", "wanted", "connects"),
    [
        ((RELIABLE, VOLATILE), (RELIABLE, VOLATILE), True),
        ((RELIABLE, VOLATILE), (BEST_EFFORT, VOLATILE), True),
        ((BEST_EFFORT, VOLATILE), (RELIABLE, VOLATILE), False),
        ((BEST_EFFORT, VOLATILE), (BEST_EFFORT, VOLATILE), True),
        ((RELIABLE, VOLATILE), (RELIABLE, LOCAL), False),
        ((RELIABLE, LOCAL), (RELIABLE, VOLATILE), True),
        ((RELIABLE, LOCAL), (RELIABLE, LOCAL), True),
        ((BEST_EFFORT, LOCAL), (RELIABLE, LOCAL), False),
        ((BEST_EFFORT, VOLATILE), (RELIABLE, LOCAL), False),
    ],
)
def test_qos_profiles_connect_as_in_ros2(offered: Any, wanted: Any, connects: bool) -> None:
    def profile(pair: Any) -> QoSProfile:
        return QoSProfile(depth=1, reliability=pair[0], durability=pair[1])

    found, reason = qos_check_compatible(profile(offered), profile(wanted))
    assert found == (QoSCompatibility.OK if connects else QoSCompatibility.ERROR)
    assert bool(reason) is not connects


def test_a_profile_has_the_defaults_of_rclpy() -> None:
    profile = QoSProfile(depth=7)
    assert (profile.history, profile.depth) == (HistoryPolicy.KEEP_LAST, 7)
    assert (profile.reliability, profile.durability) == (RELIABLE, VOLATILE)
    assert profile.liveliness == 0
    assert profile.avoid_ros_namespace_conventions is False
    assert {profile.lifespan.nanoseconds, profile.deadline.nanoseconds} == {0}
    assert as_profile(0).capacity == 1
    assert as_profile(profile) is profile
    for wrong, error in ((-1, ValueError), (True, TypeError), (1.0, TypeError), ("x", TypeError)):
        with pytest.raises(error):
            as_profile(wrong)
    with pytest.raises(InvalidQoSProfileException, match="KEEP_LAST without a depth"):
        QoSProfile(history=HistoryPolicy.KEEP_LAST)
    with pytest.raises(InvalidQoSProfileException, match="History and/or depth"):
        QoSProfile(reliability=RELIABLE)
    with pytest.raises(AssertionError, match="nonsense"):
        QoSProfile(depth=1, nonsense=1)
    assert QoSProfile(history=HistoryPolicy.KEEP_ALL).depth == 0


@pytest.mark.parametrize(("threads", "beside"), [("1", 1), ("2", 2), ("3", 3), ("", 4)])
def test_executor_runs_one_callback_per_thread(start: Start, threads: str, beside: int) -> None:
    ros = start(f"""
        import rclpy
        from rclpy.callback_groups import ReentrantCallbackGroup
        from rclpy.executors import MultiThreadedExecutor
        rclpy.init()
        node = rclpy.create_node("n")
        running, most = [0], [0]
        def work():
            running[0] += 1
            most[0] = max(most[0], running[0])
            node.get_clock().sleep_for(rclpy.duration.Duration(seconds=0.5))
            running[0] -= 1
        group = ReentrantCallbackGroup()
        for _ in range(4):
            node.create_timer(1.0, work, callback_group=group)
        executor = MultiThreadedExecutor({threads})
        executor.add_node(node)
        executor.spin()
    """)
    ros.step(1.4)
    assert ros.namespace["most"] == [beside]  # type: ignore[attr-defined]


def test_a_node_belongs_to_one_executor(start: Start) -> None:
    ros = start("""
        import rclpy
        from rclpy.executors import SingleThreadedExecutor
        rclpy.init()
        node, first, second = rclpy.create_node("n"), SingleThreadedExecutor(), SingleThreadedExecutor()
        found = [first.add_node(node), first.add_node(node), first.get_nodes() == [node]]
        found += [second.add_node(node), first.get_nodes() == [], node.executor is second]
        first.remove_node(node)
        found += [node.executor is second]
        second.remove_node(node)
        found += [node.executor is None, second.shutdown()]
        first.add_node(node)
        first.shutdown()
        found += [first.get_nodes() == [], node.executor is None]
    """)
    assert ros.namespace["found"] == [True, False, True, *[True] * 8]  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    ("limit", "took"), [("timeout_sec=0.5", 0.5), ("timeout_sec=0", 0.0), ("0.25", 0.25)]
)
def test_waiting_for_a_future_ends_at_the_limit(start: Start, limit: str, took: float) -> None:
    ros = start(
        f"""
        import rclpy
        rclpy.init()
        node = rclpy.create_node("n")
        future, clock = rclpy.task.Future(), node.get_clock()
        began = clock.now()
        rclpy.spin_until_future_complete(node, future, None, {limit})
        first = (clock.now() - began).nanoseconds
        node.executor.spin_once({limit})
        second = (clock.now() - began).nanoseconds - first
        done = future.done()
    """.replace("node.executor.spin_once", "rclpy.get_global_executor().spin_once")
    )
    ros.step(2)
    found = ros.namespace  # type: ignore[attr-defined]
    assert (found["first"], found["second"], found["done"]) == (took * 1e9, took * 1e9, False)


def test_a_negative_limit_waits_for_the_result(start: Start) -> None:
    ros = start("""
        import rclpy
        rclpy.init()
        node = rclpy.create_node("n")
        future = rclpy.task.Future()
        node.create_timer(3.0, lambda: future.set_result("late"))
        rclpy.spin_until_future_complete(node, future, timeout_sec=-1)
        found = future.result(), node.get_clock().now().nanoseconds
    """)
    ros.step(5)
    assert ros.namespace["found"] == ("late", 3_000_000_000)  # type: ignore[attr-defined]


def test_ready_entities_run_in_rclpy_order(start: Start) -> None:
    """Timers, subscriptions, guard conditions, clients, services: `_wait_for_ready_callbacks` of rclpy."""
    ros = start("""
        import rclpy
        from std_msgs.msg import String
        from std_srvs.srv import Trigger
        rclpy.init()
        node, found = rclpy.create_node("n"), []
        def serve(request, response):
            found.append("service")
            return response
        node.create_service(Trigger, "s", serve)
        client = node.create_client(Trigger, "s")
        guard = node.create_guard_condition(lambda: found.append("guard"))
        node.create_subscription(String, "x", lambda _: found.append("subscription"), 1)
        node.create_timer(1.0, lambda: found.append("timer"))
        guard.trigger()
        client.call_async(Trigger.Request())
        node.get_clock().sleep_for(rclpy.duration.Duration(seconds=1))
        rclpy.spin(node)
    """)
    ros.bus.publish("x", message_type("std_msgs/msg/String")(data="x"))
    ros.step(1.5)
    assert ros.namespace["found"] == ["timer", "subscription", "guard", "service"]  # type: ignore[attr-defined]


@pytest.mark.parametrize(("timeout", "waits"), [(0.1, 0.3), (0.3, 0.3), (0.31, 0.6), (1.0, 1.2)])
def test_rospy_polls_services_every_three_tenths(start: Start, timeout: float, waits: float) -> None:
    ros = start(f"""
        import rospy
        rospy.init_node("n")
        began = rospy.get_time()
        try:
            rospy.wait_for_service("dock", {timeout})
        except rospy.ROSException as error:
            found = str(error), rospy.get_time() - began
    """)
    ros.step(3)
    said, took = ros.namespace["found"]  # type: ignore[attr-defined]
    assert said == "timeout exceeded while waiting for service /dock"
    assert took == pytest.approx(waits)


def test_world_latches_one_message_per_topic(start: Start) -> None:
    ros = start("pass")
    for text in ("old", "new"):
        ros.bus.publish("x", STRING(text), latch=True)
    ros.bus.publish("x", STRING("passing"))
    start(
        """
        import rospy
        from std_msgs.msg import String
        found = []
        rospy.init_node("n")
        rospy.Subscriber("x", String, lambda message: found.append(message.data))
        rospy.Publisher("y", String, queue_size=1).publish("own")
        rospy.spin()
        """,
        ros=ros,
    )
    assert ros.namespace["found"] == ["new"]  # type: ignore[attr-defined]
    assert dict(ros.published) == {"/y": 1}
    assert ros.subscribed == {"/x"}
    assert ros.bus.latest("x") is None
    assert ros.bus.latest("y").data == "own"


def test_muted_messages_reach_no_node(start: Start) -> None:
    ros = start("""
        import rospy
        from std_msgs.msg import String
        found = []
        rospy.init_node("n")
        rospy.Subscriber("x", String, lambda message: found.append(message.data))
        rospy.spin()
    """)
    ros.bus.muted = True
    ros.bus.publish("x", STRING("lost"), latch=True)
    ros.bus.muted = False
    ros.bus.publish("x", STRING("seen"))
    assert ros.namespace["found"] == ["seen"]  # type: ignore[attr-defined]
    assert not ros.bus.topic("x").kept


def test_queued_message_is_a_copy(start: Start) -> None:
    ros = start("""
        import rospy
        from std_msgs.msg import String
        rospy.init_node("n")
        publisher, message = rospy.Publisher("x", String, queue_size=9), String("first")
        publisher.publish(message)
        message.data = "second"
        publisher.publish(message)
        publisher.unregister()
        try:
            publisher.publish("third")
        except rospy.ROSException as error:
            said = str(error)
    """)
    messages = heard(ros, "x")
    assert messages == []
    assert ros.bus.latest("x").data == "second"
    assert ros.published["/x"] == 2
    assert "unregistered" in ros.namespace["said"]  # type: ignore[attr-defined]


def test_alarms_and_tasks_of_an_instant_run_in_order(
    start: Start,
) -> None:
    ros = start("""
        import rospy
        rospy.init_node("n")
        found = []
        rospy.sleep(1)
        found.append("node")
        rospy.sleep(1)
        found.append("node")
        rospy.spin()
    """)
    found, second = ros.namespace["found"], 1_000_000_000  # type: ignore[attr-defined]
    ros.scheduler.at(second, lambda: found.append("first"))
    ros.scheduler.at(second, lambda: found.append("second"))
    ros.scheduler.at(2 * second + 1, lambda: found.append("late"))
    ros.step(0.999999999)
    assert (found, ros.now) == ([], 0.999999999)
    ros.step(1e-9)
    assert found == ["first", "second", "node"]
    ros.step(1)
    assert (found[3:], ros.scheduler.time) == (["node"], 2 * second)
    ros.step(1e-9)
    assert found[4:] == ["late"]


def test_fault_on_a_silent_topic_is_refused(start: Start) -> None:
    ros = start("""
        import rospy
        from std_msgs.msg import String
        rospy.init_node("n")
        rospy.Subscriber("silent", String, print)
        rospy.Publisher("said", String, queue_size=1).publish("x")
    """)
    ros.bus.publish("told", STRING("x"))
    for topic in ("said", "told"):
        faults.dropout(topic, 0.5).check(ros, "loss")
    with pytest.raises(SettingsError, match=r"no message was published on silent.* are /said, /told\."):
        faults.dropout("silent", 0.5).check(ros, "loss")


@pytest.mark.parametrize("callback", ["lambda message: found.append(message.data) or 7", "answer"])
def test_returned_value_does_not_block_the_group(start: Start, callback: str) -> None:
    ros = start(f"""
        import rclpy
        from std_msgs.msg import String
        rclpy.init()
        node, found = rclpy.create_node("n"), []
        async def answer(message):
            found.append(message.data)
            return 7
        node.create_subscription(String, "x", {callback}, 10)
        rclpy.spin(node)
    """)
    for text in ("first", "second", "third"):
        ros.bus.publish("x", message_type("std_msgs/msg/String")(data=text))
    ros.step(0.1)
    assert ros.namespace["found"] == ["first", "second", "third"]  # type: ignore[attr-defined]
