"""Calls that configure an object of a library, on which a published value depends through the object only."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.lint.analysing import analysed

NODE = """
    import logging
    import numpy as np
    import rospy
    from control_library import Filter, Pid
    from std_msgs.msg import Float64
    LIMIT = 0.5
    {top}
    class Driver:
        def __init__(self):
            self.log = logging.getLogger("driver")
            self.kp = rospy.get_param("~kp", 1.5)
            {setup}
            self.out = rospy.Publisher("out", Float64, queue_size=1)
            rospy.Subscriber("in", Float64, self.on)
        def on(self, msg):
            self.out.publish({use})
    rospy.init_node("driver")
    Driver()
    rospy.spin()
"""


@pytest.mark.parametrize(
    ("top", "setup", "use", "expected"),
    [
        ("", "self.pid = Pid(self.kp, ki=0.2)", "self.pid.update(msg.data)", ["self.kp", "0.2"]),
        ("", "self.pid = Pid(self.kp, ki=0.2)", "self.pid(msg.data)", ["self.kp", "0.2"]),
        ("pid = Pid(0.8)", "pid.set_limit(LIMIT)", "pid.step(msg.data)", ["0.8", "LIMIT"]),
        ("K = np.array([[1.0, 2.0]])", "", "K.dot(np.array([msg.data, 0.0]))", ["1.0", "2.0"]),
        ("", "self.two = [Filter(4), Filter(5)]", "sum(f.step(msg.data) for f in self.two)", ["4", "5"]),
        ("", "self.pid = Pid(1.0); self.other = Pid(2.0)", "self.pid.step(msg.data)", ["1.0"]),
        ("G = [0.5, 2.0]", "", "sum(g * x for g, x in zip(G, msg.data))", ["0.5", "2.0"]),
        ("", "self.bounds = [0.08] * 7", "any(abs(x) > b for x, b in zip(msg.data, self.bounds))", ["0.08"]),
        ("G = [0.5, 2.0]; H = [3.0]", "", "max(G) * msg.data", ["0.5", "2.0"]),
        (f"G = {list(range(17))}", "", "sum(g * msg.data for g in G)", []),
        ("", "self.log.setLevel(10)", "msg.data", []),
        ("", "self.gain = 2.0", "self.gain * msg.data", []),
    ],
)
def test_constants_that_configure_a_used_object_are_operands(
    top: str, setup: str, use: str, expected: list[str], tmp_path: Path
) -> None:
    analysis = analysed(tmp_path, node=NODE.format(top=top, setup=setup or "pass", use=use))
    sites = (*analysis.configuring, *(step.site for step in analysis.deciding))
    assert [one.code for site in sites for one in analysis.operands(site)] == expected
    users = {user for _, users in analysis.configuring.values() for user in users}
    assert users <= {step.site for step in (*analysis.sites, *analysis.deciding)}


TWO_WHEELS = """
    import rospy
    from std_msgs.msg import Float64
    LEFT, RIGHT = 0.16, 0.17
    class Wheel:
        def __init__(self, radius, name="wheel"):
            self.radius = radius
        def speed(self, turns):
            return turns * self.radius
    class Driver:
        def __init__(self):
            {setup}
            self.out = rospy.Publisher("out", Float64, queue_size=1)
            rospy.Subscriber("in", Float64, self.on)
        def on(self, msg):
            self.out.publish({use})
    rospy.init_node("driver")
    Driver()
    rospy.spin()
"""


@pytest.mark.parametrize(
    ("setup", "use", "expected"),
    [
        (
            "self.left = Wheel(LEFT); self.right = Wheel(RIGHT)",
            "self.left.speed(msg.data) + self.right.speed(msg.data)",
            {"self.left = Wheel(LEFT)": ["LEFT"], "self.right = Wheel(RIGHT)": ["RIGHT"]},
        ),
        (
            "self.left = Wheel(0.16); self.spare = Wheel(0.2)",
            "self.left.speed(msg.data)",
            {"self.left = Wheel(0.16)": ["0.16"]},
        ),
        ("self.left = Wheel(0.16); self.name = str(self.left)", "msg.data", {}),
    ],
)
def test_constructor_arguments_of_used_objects_are_operands(
    setup: str, use: str, expected: dict[str, list[str]], tmp_path: Path
) -> None:
    analysis = analysed(tmp_path, node=TWO_WHEELS.format(setup=setup, use=use))
    found = {
        step.code: [one.code for one in analysis.operands(site)]
        for site, (step, _) in analysis.making.items()
    }
    assert found == expected
    sites = {step.site for step in (*analysis.sites, *analysis.deciding)}
    assert all({*users} <= sites for _, users in analysis.making.values())
