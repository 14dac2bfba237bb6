"""TARL307 for parameters whose names a program composes, and TARL308 for strings that resemble a remapped name."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.lint.system.test_parameters_of_launches import messages

ROSPY = """#!/usr/bin/env python3
import rospy
from std_msgs.msg import Float64
rospy.init_node("edge")
out = rospy.Publisher("out", Float64, queue_size=1)
"""
RCLPY = """#!/usr/bin/env python3
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64
rclpy.init()
out = rclpy.create_node("out").create_publisher(Float64, "out", 1)
out.publish(Float64())
"""
# Programs, each below its title, the parameters that are set, and those that the node lacks after `|`.
PROGRAMS = """\
### a helper composes the name: gains/left gains/right limits/left | limits/left
def section(name, *keys):
    return {key: rospy.get_param("~%s/%s" % (name, key), 0.0) for key in keys}
section("gains", "left", "right")
section("limits", "low")
### the keys are keywords: gains/left gains/low | gains/low
def section(name, **defaults):
    values = dict(defaults)
    for key in defaults:
        values[key] = rospy.get_param("~%s/%s" % (name, key), defaults[key])
    return values
section("gains", left=1.0)
section("limits", low=0.0)
### a helper of a helper: a/b/c b/a/c | b/a/c
def one(path):
    return rospy.get_param("~" + path)
def two(first, second):
    return one(first + "/" + second + "/c")
two("a", "b")
### format and f-strings: a/left b/left b/right | b/left
def get(kind, side):
    return rospy.get_param("~{}/{}".format(kind, side)), rospy.get_param(f"~{kind}/{side}")
get("a", "left")
get("b", "right")
### a loop over a range: tray0 tray2 tray3 | tray3
for number in range(3):
    rospy.get_param("~tray%d" % number, 0)
### a loop over literals: wheel_front wheel_back wheel_left | wheel_left
print("left")
for side in ("front", "back"):
    rospy.get_param(f"~wheel_{side}", 0)
### a loop whose range is not known: tray0 tray7 |
for number in range(rospy.get_param("~count")):
    rospy.get_param("~tray%d" % number, 0)
### a part comes from a parameter: arm_left arm_right left right |
side = rospy.get_param("~side")
rospy.get_param("~arm_" + side, 0)
print("left", "right")
### a function that nothing calls composes others: arm/left arm/right |
def get(side):
    return rospy.get_param("~arm/" + side)
get("left")
def later():
    return get("right")
### a callback composes others: arm/left arm/right arm/up | arm/up
def get(side):
    return rospy.get_param("~arm/" + side)
get("left")
print("up")
rospy.Timer(rospy.Duration(1), lambda event: get("right"))
### a group is read as a whole: gains/left gains/right limits/low | limits/low
gains = rospy.get_param("~" + "gains")
print(gains["left"])
for name in ("a", "b"):
    rospy.get_param("~limits/" + name)
print("low")
### all parameters are read as a whole: left right |
for name in ("a", "b"):
    rospy.get_param("~" + name)
print(rospy.get_param("~")["left"])
### an absolute name: gain offset | offset
for name in ("gain",):
    rospy.get_param("/edge/" + name)
"""
IN_RCLPY = """\
### an f-string in a loop: tray0.tare tray1.tare tray4.tare | tray4.tare
class Shelf(Node):
    def __init__(self):
        super().__init__("edge")
        for number in range(4):
            self.declare_parameter(f"tray{number}.tare", 0.0)
Shelf()
### a base class that declares: arm.speed arm.limit leg.speed | leg.speed
class Base(Node):
    def __init__(self, name, *keys):
        super().__init__("edge")
        for key in keys:
            self.declare_parameter(f"{name}.{key}", 0.0)
class Arm(Base):
    def __init__(self):
        super().__init__("arm", "speed", "limit")
print("leg")
Arm()
### declare_parameters with a namespace: arm.speed leg.speed | leg.speed
class Arm(Node):
    def __init__(self, side):
        super().__init__("edge")
        self.declare_parameters(side, [("speed", 1.0), ("limit", 2.0)])
print("leg")
Arm("arm")
### undeclared parameters: arm.speed leg.speed |
class Arm(Node):
    def __init__(self):
        super().__init__("edge", allow_undeclared_parameters=True)
        for key in ("speed", "limit"):
            self.declare_parameter("arm." + key, 0.0)
Arm()
"""
LAUNCH = '<launch><node pkg="robot" type="edge.py" name="edge">{inside}</node></launch>'
LAUNCH_2 = '<launch><node pkg="robot" exec="edge.py" name="edge">{inside}</node></launch>'


def cases(programs: str) -> dict[str, tuple[str, list[str], list[str]]]:
    """Return the text of each program, the parameters that are set, and those that it lacks."""
    found = {}
    for part in programs.split("### ")[1:]:
        title, _, body = part.partition("\n")
        title, _, names = title.partition(": ")
        given, _, lacking = names.partition("|")
        found[title] = (body, given.split(), lacking.split())
    return found


ONE, TWO = cases(PROGRAMS), cases(IN_RCLPY)


@pytest.mark.parametrize("title", ONE)
def test_parameter_names_composed_in_a_ros1_program_are_known(tmp_path: Path, title: str) -> None:
    body, given, lacking = ONE[title]
    inside = "".join(f'<param name="{name}" value="1"/>' for name in given)
    found = messages(tmp_path, LAUNCH.format(inside=inside), edge=f"{ROSPY}{body}rospy.spin()\n")
    assert found == [f"TARL307 /edge has no parameter {name}" for name in lacking]


@pytest.mark.parametrize("title", TWO)
def test_parameter_names_composed_in_a_ros2_program_are_known(tmp_path: Path, title: str) -> None:
    body, given, lacking = TWO[title]
    inside = "".join(f'<param name="{name}" value="1.0"/>' for name in given)
    found = messages(tmp_path, LAUNCH_2.format(inside=inside), "launch/r.launch.xml", edge=RCLPY + body)
    assert found == [f"TARL307 /edge has no parameter {name}" for name in lacking]


@pytest.mark.parametrize(
    ("old", "code", "reported"),
    [
        ("path", "rospy.Publisher('path', Path, queue_size=1)", False),
        ("path", "rospy.Publisher('~path', Path, queue_size=1)", True),
        ("~path", "rospy.Publisher('~path', Path, queue_size=1)", False),
        ("/edge/path", "rospy.Publisher('~path', Path, queue_size=1)", False),
        ("path", "rospy.Publisher('~path', Path, queue_size=1); print('path')", False),
        ("path", "rospy.Publisher('way', Path, queue_size=1); print('front/path')", True),
        ("path", "rospy.Publisher('way', Path, queue_size=1); print('my path')", True),
        ("path", "rospy.Publisher('way', Path, queue_size=1); rospy.get_param('~path', '')", True),
        ("front/path", "rospy.Publisher('way', Path, queue_size=1); print('path')", False),
        ("/front/path", "rospy.Publisher('way', Path, queue_size=1); print('front/path')", False),
        ("front/path", "rospy.Publisher('way', Path, queue_size=1); print('back/path')", True),
    ],
)
def test_longer_names_do_not_use_the_remapped_name(
    tmp_path: Path, old: str, code: str, reported: bool
) -> None:
    program = f"{ROSPY}from nav_msgs.msg import Path\n{code}\nrospy.spin()\n"
    found = messages(tmp_path, LAUNCH.format(inside=f'<remap from="{old}" to="elsewhere"/>'), edge=program)
    assert any(one.startswith(f"TARL308 /edge uses no name {old}") for one in found) is reported
