"""Threads of nodes run in virtual time, so that runs are reproducible."""

from __future__ import annotations

from typing import Any

from pytest_tarl.ros import Ros, message_type

NODE = """
import queue, random, threading, time
import rospy
from std_msgs.msg import Float64

rospy.init_node("mixer")
out = rospy.Publisher("out", Float64, queue_size=10)
lock, work, state = threading.Lock(), queue.Queue(), {"sum": 0.0, "turns": 0}

def worker(name, gain):
    while not rospy.is_shutdown():
        value = work.get()
        with lock:
            state["sum"] = state["sum"] * gain + value
            time.sleep(0.013 * gain)
            state["turns"] += 1
            trail.append((name, value, rospy.get_time()))

def beat():
    while not rospy.is_shutdown():
        time.sleep(0.07)
        with lock:
            out.publish(state["sum"] + state["turns"] / 7.0)

trail = []
for name, gain in (("a", 0.9), ("b", 0.7), ("c", 1.1)):
    threading.Thread(target=worker, args=(name, gain), daemon=True).start()
threading.Thread(target=beat, daemon=True).start()
rospy.Subscriber("in", Float64, lambda message: [work.put(message.data * part) for part in (1.0, 0.5, 0.25)])
rospy.spin()
"""


def trajectory() -> tuple[list[tuple[float, str]], list[tuple[str, float, float]]]:
    """Run the node for 40 steps; return its messages with times, and the work of each thread."""
    published: list[tuple[float, str]] = []
    names: dict[str, Any] = {"__name__": "__main__", "__file__": "node.py"}
    ros, number = Ros(), message_type("std_msgs/Float64")
    with ros.installed():
        ros.start(lambda: exec(compile(NODE, "node.py", "exec"), names), name="mixer")
        ros.bus.subscribe("/out", lambda message: published.append((ros.now, message.data.hex())))
        for step in range(40):
            ros.bus.publish("/in", number(data=1.0 + 0.1 * step))
            ros.step(0.05)
        trail = list(names["trail"])
        ros.close()
    return published, trail


def test_threaded_runs_are_bitwise_equal() -> None:
    first, second = trajectory(), trajectory()
    assert len(first[0]) > 15
    assert {name for name, _, _ in first[1]} == {"a", "b", "c"}
    assert first == second
