"""Virtual time passes in a loop that polls the clock or the state of ROS without a pause."""

from __future__ import annotations

from itertools import pairwise

import pytest

from pytest_tarl.errors import StuckNodeError
from pytest_tarl.ros import message_type
from pytest_tarl.ros.polling import AGAIN, PAUSE
from pytest_tarl.ros.scheduler import PATIENCE
from tests.plugin.ros.conftest import Start, heard

ROSPY = """
import queue, rospy, select, threading, time
from std_msgs.msg import Float64
rospy.init_node("node")
out = rospy.Publisher("/out", Float64, queue_size=1)
seen = []
rospy.Subscriber("/in", Float64, lambda message: seen.append(message.data))
ended = None
"""
RCLPY = """
import rclpy
from std_msgs.msg import Float64
rclpy.init()
node = rclpy.create_node("node")
out = node.create_publisher(Float64, "/out", 10)
seen = []
node.create_subscription(Float64, "/in", lambda message: seen.append(message.data), 10)
ended = None
"""
THREAD = """
done = []
thread = threading.Thread(target=lambda: (rospy.sleep(2), done.append(1), rospy.set_param('/done', True)))
thread.start()
"""
SPIN_ONCE = """
    rclpy.spin_once(node, timeout_sec=0)
    if seen: out.publish(Float64(data=seen.pop()))
"""
WAITS = {  # a loop that ends after two seconds
    "rospy.Time.now": "end = rospy.Time.now() + rospy.Duration(2)\nwhile rospy.Time.now() < end: pass",
    "rospy.get_time": "end = rospy.get_time() + 2\nwhile rospy.get_time() < end: pass",
    "time.time": "end = time.time() + 2\nwhile time.time() < end: pass",
    "time.monotonic_ns": "end = time.monotonic_ns() + 2 * 10**9\nwhile time.monotonic_ns() < end: pass",
    "time.perf_counter": "end = time.perf_counter() + 2\nwhile time.perf_counter() < end: out.publish(1.0)",
    "rospy.sleep(0)": f"{THREAD}while not done: rospy.sleep(0)",
    "time.sleep(0)": f"{THREAD}while not done: time.sleep(0)",
    "has_param": f"{THREAD}while not rospy.has_param('/done'): pass",
    "get_param": f"{THREAD}while not rospy.get_param('/done', False): pass",
    "is_alive": f"{THREAD}while thread.is_alive(): pass",
    "select": f"{THREAD}while not done: select.select([], [], [], 0)",
}


@pytest.mark.parametrize("way", WAITS)
def test_clock_polling_loop_ends_in_time(way: str, start: Start) -> None:
    ros = start(f"{ROSPY}{WAITS[way]}\nended = rospy.get_time()\nrospy.spin()")
    ros.step(1.9)
    assert ros.namespace["ended"] is None  # type: ignore[attr-defined]
    ros.step(0.2)
    assert ros.namespace["ended"] - ros.now <= 0  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    ("head", "loop"),
    [
        (ROSPY, "while not rospy.is_shutdown():\n    if seen: out.publish(seen.pop())"),
        (RCLPY, f"while rclpy.ok():{SPIN_ONCE}"),
        (RCLPY, f"while True:{SPIN_ONCE}"),
    ],
    ids=["is_shutdown", "ok", "spin_once"],
)
def test_loop_without_a_pause_receives_messages(head: str, loop: str, start: Start) -> None:
    ros = start(head + loop)
    keys = heard(ros, "/out")
    for value in (1.0, 2.0):
        ros.step(0.1)
        ros.bus.publish("/in", message_type("std_msgs/Float64")(value))
    ros.step(0.1)
    ros.close()
    assert [one.data for one in keys] == [1.0, 2.0]
    assert not ros.shutdown_errors


def test_a_callback_that_stamps_many_messages_does_not_wait(start: Start) -> None:
    ros = start(f"{ROSPY}times = {{rospy.get_time() for _ in range({PATIENCE - 1})}}\nrospy.spin()")
    assert len(ros.namespace["times"]) == 1  # type: ignore[attr-defined]


def test_polling_loop_runs_at_a_steady_rate(start: Start) -> None:
    ros = start(f"""{ROSPY}
times = [rospy.get_time() for _ in range({PATIENCE + 5 * AGAIN})]
rospy.sleep(1.0)
fresh = {{rospy.get_time() for _ in range({PATIENCE - 1})}}
rospy.spin()
""")
    ros.step(2.0)
    instants = sorted(set(ros.namespace["times"]))  # type: ignore[attr-defined]
    gaps = [later - sooner for sooner, later in pairwise(instants)]
    assert gaps == pytest.approx([PAUSE / 1e9] * len(gaps))
    assert [ros.namespace["times"].count(one) for one in instants[1:-1]] == [AGAIN] * (len(instants) - 2)  # type: ignore[attr-defined]
    assert len(ros.namespace["fresh"]) == 1  # type: ignore[attr-defined]


def test_loop_without_ros_calls_is_reported(start: Start) -> None:
    with pytest.raises(StuckNodeError, match="never waits"):
        start(f"{ROSPY}while not seen: pass", watchdog_limit=0.2)
