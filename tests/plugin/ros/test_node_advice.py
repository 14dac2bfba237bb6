"""Errors of nodes end in one sentence that says what is missing and what to do."""

from __future__ import annotations

import re
import sys
from pathlib import Path

import pytest

from pytest_tarl.errors import MOST_TEXT, NodeError
from pytest_tarl.ros import Ros
from pytest_tarl.ros.launch_sources import Given
from pytest_tarl.ros.launched import given
from pytest_tarl.ros.messages import node_workspaces
from tests.plugin.ros.conftest import Start

CASES = {
    "import cv2000": r"No package of the workspace .* installs cv2000, .*: run pip install cv2000, or put",
    "import sklearn_not, sklearn": "run pip install sklearn_not",
    "import skimage": "run pip install scikit-image, or put a replacement into sys.modules in the test",
    "import RPi.GPIO as GPIO": "it drives a device, so put a replacement into sys.modules",
    "import trac_ik_python": "it is a compiled library of a ROS installation, so put a replacement",
    "from servo_board.msg import Servo": (
        r"No package of the workspace .* defines servo_board\.msg: put a copy of the package servo_board, or only its "
        r"\.msg files in a folder servo_board/msg, into the workspace\.$"
    ),
    "import servo_board.srv": r"only its \.srv files in a folder servo_board/srv",
    "[1, 2, 3][: 3 / 2]": r"/ of two integers gives a float: write // where Python 2 rounded down\.$",
    "range(10 / 2)": "write // where Python 2 rounded down",
    "[0] * (4 / 2)": "write // where Python 2 rounded down",
    "import urllib2": "This is Python 2, which no supported ROS uses: port the node to Python 3",
    "raw_input('go?')": "This is Python 2",
    "{}.iteritems()": "This is Python 2",
    "from sys import maxint": "This is Python 2",
    "exec(compile('print 1', 'x.py', 'exec'))": "This is Python 2",
    "os.environ['ROBOT_MODEL_OF_TEST']": r"ROBOT_MODEL_OF_TEST is not set: call monkeypatch\.setenv\(\"ROBOT_MODEL_OF",
    "rospy.get_param('~frame_id')": r"sets this parameter: pass parameters=\{\"frame_id\": …\} to tarl\.start",
    "rospy.get_param('/robot/mass')": r"pass parameters=\{\"/robot/mass\": …\} to tarl\.start",
    "import rospkg; rospkg.RosPack().get_path('gripper')": r"package 'gripper' not found in .*: put a checkout of it",
    "import ament_index_python as a; a.get_package_share_directory('gripper')": "'gripper' not found in .*package.xml",
    "from roslib.packages import get_pkg_dir; get_pkg_dir('gripper')": "'gripper' not found in .*: put a checkout",
    "int(rospy.get_param('~count', None))": (
        r"Parameters that it asked for have no value: count\. If it needs one, pass parameters=\{\"count\": …\}"
    ),
    "rospy.get_param('/a', None), rospy.has_param('b'), rospy.get_param('~c', 1), None.x": (
        r"have no value: /a, b\. If it needs one, pass parameters=\{\"/a\": …\} to tarl\.start\.$"
    ),
    "[rospy.has_param(name) for name in 'abcde']; 2 * None": "no value: a, b, c and 2 more",
    "speed = [rospy.get_param(one, None) for one in ('a', '~top_speed', 'top_speed')][0]; 2.0 * speed": (
        r"have no value: top_speed, a\. If it needs one, pass parameters=\{\"top_speed\": …\}"
    ),
    "yaml.load('a: 1')": r"PyYAML 6 has no default for it: call yaml\.safe_load",
    "from collections import Mapping": r"Python 3\.\d+ has no such name in collections: use its replacement in the",
    "import time; time.clock()": r"Python 3\.\d+ has no such name in time: use its replacement in the node\.$",
    "from numpy import nothing_here": r"The installed numpy [\d.]+ has no such name: install a version that has it",
    "import numpy; numpy.nothing_here": r"The installed numpy [\d.]+ has no such name: install a version that has it",
    "from std_srvs.srv import Empty; rospy.ServiceProxy('reset', Empty)()": (
        r"No node offers it: offer it in the test with tarl\.bus\.serve\(\"/reset\", type, handler\)\.$"
    ),
    "import tf; tf.TransformListener().lookupTransform('odom', 'base', rospy.Time(0))": (
        r"No node sends a transform with the frame odom: publish one on /tf_static or /tf in the test \(tf2_msgs/TFMess"
    ),
    "sys.exit(1) if rospy.get_param('~inputs', None) is None else 0": (
        r"Parameters that it asked for have no value: inputs\. If it needs one, pass parameters=\{\"inputs\": …\}"
    ),
    "sys.argv[1]": r"The node reads its command line: pass argv=\[…\] to tarl\.start",
    "sys.exit('usage: node FILE') if len(sys.argv) < 2 else None": r"pass argv=\[…\]",
    "sys.exit('\\n Drive.\\n\\nUsage: node FILE') if not sys.argv[1:] else 0": r"status 1: Drive\. \(.*pass argv=\[…\]",
    "argparse.ArgumentParser().parse_args(['--what'])": r"incomplete \(unrecognized arguments: --what\): pass argv=",
}
BLOCKS = {
    "import sys\ndef usage():\n    sys.exit(1)\nif len(sys.argv) == 1:\n    usage()": "reads its command line",
    "import sys\ndef main(args):\n    return args[1]\nmain(sys.argv)": "reads its command line",
    "import sys\ndef main(args):\n    return [][0]\nmain(sys.argv)": r"in main\)\.$",
    "import sys\nif sys.maxsize:\n    sys.exit(1)": r"line 3\)\.$",
    "import sys\nfiles = [one for one in sys.argv[1:]]\nif not files:\n    sys.exit(1)": "reads its command line",
    "import sys\nfiles = [1]\nif files:\n    sys.exit(1)": r"line 4\)\.$",
}
GUARDED = """
try:
    {0}
except {1}:
    print("without it")
{2}
"""
CAUGHT = {
    ("from servo_board.msg import Servo", "ImportError as e", "Servo()"): (
        r"The import of Servo in line 3 failed, and the node continued without it\. No package .* defines serv"
    ),
    ("import cv2000 as cv", "(ValueError, ModuleNotFoundError)", "cv.show()"): (
        r"The import of cv in line 3 failed, and the node continued without it\. .* run pip install cv2000, or"
    ),
    (
        "import os.path\n    1 / 0\n    import cv2000.parts",
        "Exception",
        "cv2000.show()",
    ): "run pip install cv2000",
    ("import cv2000", "ImportError", "absent"): r"line 6\)\.$",
    ("from . import parts", "(ImportError, ImportWarning)", "parts"): r"line 6\)\.$",
    ("cv2 = 1\n    import os.path", "ValueError", "absent"): r"line 7\)\.$",
}
SILENT = [
    "range(2.0)",
    "{}['key']",
    "[][0]",
    "None.name",
    "1 / 0",
    "sys.exit(3)",
    "undefined_name",
    "'a' + 1",
]
IMPORTS = "import argparse, os, sys, yaml\nimport rospy\nrospy.init_node('it')\n"


@pytest.mark.parametrize("line", CASES)
def test_error_says_what_is_missing_and_what_to_do(line: str, start: Start) -> None:
    with pytest.raises(NodeError, match=CASES[line]) as error:
        start(IMPORTS + line)
    assert "line 4)" in str(error.value)
    assert str(error.value).count("\n") == 0


@pytest.mark.parametrize("block", BLOCKS)
def test_error_without_arguments_advises_passing_them(block: str, start: Start) -> None:
    with pytest.raises(NodeError) as error:
        start(block)
    assert re.search(BLOCKS[block], str(error.value))


@pytest.mark.parametrize("parts", CAUGHT)
def test_an_error_names_the_import_that_failed_before(parts: tuple[str, str, str], start: Start) -> None:
    with pytest.raises(NodeError, match=CAUGHT[parts]):
        start(GUARDED.format(*parts))


@pytest.mark.parametrize("line", SILENT)
def test_other_errors_get_no_advice(line: str, start: Start) -> None:
    with pytest.raises(NodeError) as error:
        start(IMPORTS + line)
    assert str(error.value).endswith("line 4).")


@pytest.mark.parametrize("asks", ["node.get_parameter_or('mass').value", "node.get_parameter('mass').value"])
def test_an_error_names_parameters_of_rclpy_without_a_value(asks: str, start: Start) -> None:
    with pytest.raises(
        NodeError, match=r"have no value: mass\. If it needs one, pass parameters=\{\"mass\": …\}"
    ):
        start(f"""
            import rclpy
            rclpy.init()
            node = rclpy.create_node("it", allow_undeclared_parameters=True)
            print(2.0 * {asks})
        """)


# values of local variables whose comparison calls code or has no single truth value
LOCALS = ["numpy.zeros(5)", "[numpy.zeros(5)]", "Unequal()", "[Unequal()]"]


@pytest.mark.parametrize("value", LOCALS)
def test_variables_are_not_compared_by_their_own_code(value: str, start: Start) -> None:
    code = (
        "import numpy\n\n\nclass Unequal:\n    def __eq__(self, other):\n        raise KeyError(other)\n\n\n"
        f"def on_scan():\n    ranges = {value}\n    return [][3]\n\n\non_scan()\n"
    )
    with pytest.raises(NodeError, match=r"raised IndexError: list index out of range \(\S+node.py, line 11"):
        start(code)


def test_argument_advice_covers_equal_variables(start: Start) -> None:
    with pytest.raises(NodeError, match="The node reads its command line"):
        start("import sys\n\n\ndef run(given):\n    return given[7]\n\n\nrun(list(sys.argv))\n")


MESSAGES = {
    "raise Silent()": "raised Silent: (its __str__ raised ZeroDivisionError) (",
    "raise KeyError(Silent())": "raised KeyError: (its __str__ raised ZeroDivisionError) (",
    "raise SystemExit(Silent())": "exited with status 1: (its __str__ raised ZeroDivisionError) (",
    "raise ValueError('x' * 5000)": f"raised ValueError: {'x' * MOST_TEXT}… (5000 characters) (",
}


@pytest.mark.parametrize("line", MESSAGES)
def test_long_messages_still_give_one_sentence(line: str, start: Start) -> None:
    code = "class Silent(BaseException):\n    def __str__(self):\n        return 1 / 0\n\n    __repr__ = __str__\n\n\n"
    with pytest.raises(NodeError) as error:
        start(f"{code}{line}\n")
    assert f"Node 'node.py' {MESSAGES[line]}" in str(error.value)
    assert str(error.value).endswith("node.py, line 8).")


def test_node_may_continue_without_a_module(start: Start) -> None:
    ros = start("""
        import rospy
        found = []
        for name in ("image_transport", "roslaunch.parent", "rospy.impl"):
            try:
                __import__(name)
            except ImportError as error:
                found.append(error.name)
    """)
    assert ros.namespace["found"] == ["image_transport", "roslaunch", "rospy.impl"]


@pytest.mark.parametrize(
    "inner", ["srv", "__init__.py"], ids=["folder of definitions", "package with Python modules"]
)
def test_advice_names_a_folder_with_the_package_name(
    inner: str, start: Start, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(node_workspaces, "_SEARCHED", [])
    node_workspaces.forget()
    package = tmp_path / "boat_base"
    package.mkdir()
    (package / inner).touch() if inner.endswith(".py") else (package / inner).mkdir()
    monkeypatch.syspath_prepend(tmp_path)
    told = r"around the node defines boat_base\.srv: .* or only its \.srv files in a folder boat_base/srv"
    with pytest.raises(NodeError, match=told):
        start("import rospy\nfrom boat_base.srv import Shoot\n")
    for name in [name for name in sys.modules if name.partition(".")[0] == "boat_base"]:
        del sys.modules[name]
    node_workspaces.forget()


def test_advice_names_the_file_that_hides_a_package(start: Start, tmp_path: Path) -> None:
    (tmp_path / ".git").mkdir()
    for package in ("seen", "tools/unseen"):
        (tmp_path / package).mkdir(parents=True)
        name = Path(package).name
        (tmp_path / package / "package.xml").write_text(f"<package><name>{name}</name></package>")
    marker = tmp_path / "tools" / "CATKIN_IGNORE"
    marker.touch()
    node_workspaces.search(tmp_path / "seen")
    node_workspaces.forget()
    with pytest.raises(
        NodeError, match=r"unseen is in the workspace, but .*CATKIN_IGNORE hides it from the build"
    ):
        start("import rospy, unseen")
    with pytest.raises(
        NodeError, match=r"'unseen' not found: .*CATKIN_IGNORE hides it from the build; delete"
    ):
        start("import rospkg, rospy; rospkg.RosPack().get_path('unseen')")


@pytest.mark.parametrize(
    ("argument", "advice"),
    [
        ('name="target" default=""', "no value that is known before the launch: pass parameters="),
        (
            'name="target"',
            r"save\.launch starts this node with ~target from its launch arguments: use tarl\.launch",
        ),
    ],
    ids=["null in YAML", "no default"],
)
def test_a_parameter_without_a_value_is_not_set(
    argument: str, advice: str, start: Start, tmp_path: Path
) -> None:
    (tmp_path / ".git").mkdir()
    (tmp_path / "package.xml").write_text("<package><name>saver</name></package>")
    (tmp_path / "save.launch").write_text(
        f'<launch><arg {argument}/><node pkg="saver" type="node.py" name="saver">'
        '<rosparam subst_value="true">\ntarget: $(arg target)\nrate: 5\n</rosparam></node></launch>'
    )
    (tmp_path / "node.py").write_text("")
    node_workspaces.search(tmp_path)
    node_workspaces.forget()
    found = given(tmp_path / "node.py")
    assert (found.private, found.valueless) == ({"rate": 5}, ("target",))
    ros = Ros()
    source = "import rospy\nrospy.init_node('saver')\nrospy.get_param('~target')"
    with ros.installed():
        ros.launch(found)
        with pytest.raises(NodeError, match=advice):
            start(source, ros=ros)
    ros.close()


def in_package(folder: Path, **files: str) -> Given:
    """Write a package `saver` with a node and these launch files; return the settings that the files give the node."""
    (folder / ".git").mkdir()
    (folder / "package.xml").write_text("<package><name>saver</name></package>")
    for name, text in files.items():
        (folder / f"{name}.launch").write_text(f"<launch>{text}</launch>")
    (folder / "node.py").write_text("")
    node_workspaces.search(folder)
    node_workspaces.forget()
    return given(folder / "node.py")


def failure(start: Start, found: Given, source: str) -> str:
    """Return the message of a node that fails when it is started with what launch files give it."""
    ros = Ros()
    with ros.installed():
        ros.launch(found)
        with pytest.raises(NodeError) as error:
            start(source, ros=ros, argv=found.argv)
    ros.close()
    return str(error.value)


def test_missing_parameter_names_its_launch_files(start: Start, tmp_path: Path) -> None:
    node = '<node pkg="saver" type="node.py" name="{0}"><param name="port" value="{1}"/></node>'
    found = in_package(
        tmp_path, left=node.format("left_arm", "/dev/a"), right=node.format("right_arm", "/dev/b")
    )
    message = failure(start, found, "import rospy\nrospy.init_node('saver')\nrospy.get_param('~port')")
    assert message.endswith(
        "left.launch starts this node with ~port:=/dev/a, and right.launch with ~port:=/dev/b: use "
        'tarl.launch("saver/left.launch", only=["left_arm"]) or tarl.launch("saver/right.launch", only=["right_arm"]), '
        'or pass parameters={"port": …} to tarl.start.'
    )


def test_missing_parameter_names_its_launch_arguments(start: Start, tmp_path: Path) -> None:
    node = '<node pkg="saver" type="node.py" name="{0}"><param name="port" value="$(arg port)"/></node>'
    text = f'<arg name="port"/><arg name="rate" default="5"/>{node.format("arm")}{node.format("other_arm")}'
    found = in_package(tmp_path, bringup=text)
    message = failure(start, found, "import rospy\nrospy.init_node('saver')\nrospy.get_param('~port')")
    assert message.endswith(
        "bringup.launch starts this node with ~port from its launch arguments: use "
        'tarl.launch("saver/bringup.launch", arguments={"port": …}, only=["arm"]), or pass parameters={"port": …} to '
        "tarl.start."
    )


def test_rclpy_parameter_without_a_value_gets_advice(start: Start) -> None:
    source = """
        import rclpy
        rclpy.init()
        node = rclpy.create_node("arm")
        node.declare_parameter("port", rclpy.Parameter.Type.STRING)
        node.get_parameter("port")
    """
    with pytest.raises(
        NodeError, match=r'sets this parameter: pass parameters=\{"port": …\} to tarl\.start\.$'
    ):
        start(source)


READS = """
import argparse
parser = argparse.ArgumentParser()
parser.add_argument("--pip")
parser.add_argument("file")
"""


def test_error_names_the_launch_file_with_the_missing_arguments(start: Start, tmp_path: Path) -> None:
    text = '<arg name="ip"/><node pkg="saver" type="node.py" name="walker" args="--pip=$(arg ip) f.txt _a:=1 in:=out"/>'
    found = in_package(tmp_path, nao=text)
    assert found.argv == ()
    message = failure(start, found, READS + "parser.parse_args()")
    assert message.endswith(
        "the following arguments are required: file): nao.launch starts this node with the arguments "
        '`--pip=$(arg ip) f.txt`: use tarl.launch("saver/nao.launch", arguments={"ip": …}, only=["walker"]), or '
        "pass argv=[…] to tarl.start."
    )


def test_the_command_line_comes_from_the_launch_file(start: Start, tmp_path: Path) -> None:
    text = (
        '<node pkg="saver" type="node.py" name="walker" args="--pip 1.2.3.4 \'a b.txt\' _rate:=1 in:=out"/>'
    )
    found = in_package(tmp_path, nao=text)
    assert found.argv == ("--pip", "1.2.3.4", "a b.txt")
    assert found.note == "parameters and arguments of walker come from nao.launch."
    ros = start(READS + "found = vars(parser.parse_args())", argv=found.argv)
    assert ros.namespace["found"] == {"pip": "1.2.3.4", "file": "a b.txt"}  # type: ignore[attr-defined]


def test_including_file_supplies_launch_arguments(tmp_path: Path) -> None:
    driver = """<arg name="port"/><node pkg="saver" type="node.py" name="arm" args="$(arg port)">
        <param name="port" value="$(arg port)"/></node>"""
    robot = '<include file="$(find saver)/driver.launch"><arg name="port" value="/dev/arm"/></include>'
    found = in_package(tmp_path, driver=driver, robot=robot)
    assert (found.private, found.argv) == ({"port": "/dev/arm"}, ("/dev/arm",))
    assert found.note == "parameters and arguments of arm come from robot.launch (driver.launch)."


def test_launch_file_named_after_the_script_gives_the_parameters(
    tmp_path: Path,
) -> None:
    node = '<node pkg="saver" type="node.py" name="saver"><param name="rate" value="{0}"/></node>'
    found = in_package(tmp_path, slow=node.format(1), fast=node.format(2), sample_node=node.format(3))
    assert found.private == {"rate": 3}
    assert found.note.endswith("come from sample_node.launch. Other launch files give it other values.")
