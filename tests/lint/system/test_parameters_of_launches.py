"""TARL307 for parameters of `.cfg` files, for those set beside the nodes in ROS 1, and names under which nodes run."""

from __future__ import annotations

from pathlib import Path

import pytest

from tarl_lint.settings.config import Options, resolve
from tarl_lint.system.command import ALL, Request, systems
from tarl_lint.system.hazards import hazards

CFG = """
from dynamic_reconfigure.parameter_generator_catkin import *
gen = ParameterGenerator()
group = gen.add_group("edge")
group.add("offset", double_t, 0, "", 0.5)
gen.add("gain", double_t, 0, "", 0.5)
exit(gen.generate("robot", "edge", "Edge"))
"""
EDGE = """#!/usr/bin/env python3
import rospy
from dynamic_reconfigure.server import Server
from robot.cfg import EdgeConfig
rospy.init_node("edge")
server = Server(EdgeConfig, lambda config, level: config)
speed = rospy.get_param("~speed")
"""


def messages(root: Path, launch: str, where: str = "launch/r.launch", **programs: str) -> list[str]:
    """Return the hazards of a package `robot` with a launch file and programs."""
    files = {"package.xml": "<package><name>robot</name></package>", where: launch, **programs}
    for name, text in files.items():
        path = root / "robot" / (f"{name}.py" if name in programs and name != "cfg/Edge.cfg" else name)
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    config = resolve(Options((root,), select=("TARL3",)))
    found = [one for each in systems(Request(ALL, (), (root,)), config) for one in hazards(each, config)]
    return [f"{one.code} {one.message.partition(':')[0]}" for one in found]


@pytest.mark.parametrize(
    ("cfg", "found"),
    [
        (CFG, ["TARL307 /edge has no parameter ofset"]),
        (CFG.replace('"offset"', "name"), []),
        ("", []),
    ],
)
def test_cfg_files_name_program_parameters(tmp_path, cfg, found):
    names = ("offset", "ofset", "gain", "speed")
    settings = "".join(f'<param name="{name}" value="1"/>' for name in names)
    launch = f'<launch><node pkg="robot" type="edge.py" name="edge">{settings}</node></launch>'
    (tmp_path / "robot/cfg").mkdir(parents=True)
    (tmp_path / "robot/cfg/Edge.cfg").write_text(cfg)
    assert messages(tmp_path, launch, edge=EDGE) == found


@pytest.mark.parametrize(
    ("module", "found"), [("smach_ros", ["TARL307 /edge has no parameter sped"]), ("other", [])]
)
def test_modules_that_use_topics_may_read_no_parameters(tmp_path, module, found):
    launch = (
        '<launch><node pkg="robot" type="edge.py" name="edge"><param name="sped" value="1"/></node></launch>'
    )
    text = EDGE.replace("from robot.cfg import EdgeConfig", f"import {module}").replace(
        "Server(EdgeConfig", "print(1"
    )
    assert (
        messages(tmp_path, launch, edge=text.replace("from dynamic_reconfigure.server import Server\n", ""))
        == found
    )


KEEPER = """#!/usr/bin/env python3
import rospy
rospy.init_node("keeper")
gain, stiffness = rospy.get_param("~gain"), rospy.get_param("~stiffness", 1)
rate = rospy.get_param("/a/arm/rate")
"""
GROUP = """<launch><group ns="a"><rosparam>
arm: {}
other: {{x: 1}}
</rosparam><node pkg="robot" type="keeper.py" name="arm"/></group></launch>"""


@pytest.mark.parametrize(
    ("values", "found"),
    [
        ("{gain: 1, speed: 2}", ["TARL307 /a/arm has no parameter speed"]),
        ("{gain: 1, rate: 2}", []),
        ("{stifness: 1}", ["TARL307 /a/arm has no parameter stifness"]),
        ("{type: position_controllers/JointGroupPositionController}", []),
    ],
)
def test_parameters_beside_a_node_may_be_meant_for_it(tmp_path, values, found):
    assert messages(tmp_path, GROUP.format(values), keeper=KEEPER) == found


LIFT = """#!/usr/bin/env python3
import rospy
from std_msgs.msg import Int8
from std_srvs.srv import Trigger
rospy.init_node("lift")
pub = rospy.Publisher("~floor", Int8, queue_size=1)
rospy.Service("~call", Trigger, lambda request: pub.publish(1))
rospy.spin()
"""
GUEST = """#!/usr/bin/env python3
import rospy
from std_msgs.msg import Int8
from std_srvs.srv import Trigger
rospy.init_node("guest")
call = rospy.ServiceProxy("lift/call", Trigger)
rospy.Subscriber("lift/floor", Int8, lambda floor: call())
rospy.spin()
"""


@pytest.mark.parametrize(("name", "found"), [("lift", []), ("elevator", ["TARL301", "TARL304"])])
def test_private_names_follow_a_renamed_node(tmp_path, name, found):
    launch = f"""<launch><node pkg="robot" type="lift.py" name="{name}"/>
    <node pkg="robot" type="guest.py" name="guest"/><node pkg="other" type="driver" name="driver"/></launch>"""
    assert sorted(one[:7] for one in messages(tmp_path, launch, lift=LIFT, guest=GUEST)) == found
