"""Every module of the in-process ROS treats a missing name as Python does, and the error says whether ROS has it."""

from __future__ import annotations

import pytest

from pytest_tarl.errors import UnsupportedApiError, UnsupportedImportError
from pytest_tarl.ros.lacking_names import LACKING
from pytest_tarl.ros.standins import STANDALONE, STANDINS
from tests.plugin.ros.conftest import Start

PARTS = {
    "rospy": ("std_msgs", "std_msgs.msg", "std_srvs.srv", "actionlib_tutorials.msg"),
    "rclpy": ("std_msgs", "std_msgs.msg", "std_srvs.srv", "composition_interfaces.srv", "action_msgs.msg"),
}


@pytest.mark.parametrize("kind", PARTS)
def test_missing_name_is_an_attribute_error_and_an_import_error(start: Start, kind: str) -> None:
    ros = start(f"""
        import importlib
        import {kind}
        errors = {{}}
        for name in {(*STANDINS, *PARTS[kind])}:
            module = importlib.import_module(name)
            assert not hasattr(module, "zq_nothing")
            assert getattr(module, "zq_nothing", 7) == 7
            try:
                module.zq_nothing
            except AttributeError as error:
                read = error
            try:
                exec(f"from {{name}} import zq_nothing")
            except ImportError as error:
                errors[name] = str(read), error
    """)
    errors = ros.namespace["errors"]
    assert errors.keys() == {*STANDINS, *PARTS[kind]}
    for name, (read, imported) in errors.items():
        # an installed package, as well as the module of a package's parts, is an ordinary module
        if name.partition(".")[0] not in STANDALONE and name != "std_msgs":
            assert isinstance(imported, UnsupportedImportError)
            assert str(imported) == read
            known = STANDINS.get(name)
            told = "is not in the in-process ROS" if known else "zq_nothing is unknown: neither"
            assert told in read, name


def test_no_name_that_is_listed_as_lacking_exists(start: Start) -> None:
    named = {
        name: names.split() for name, names in LACKING.items() if name.partition(".")[0] not in STANDALONE
    }
    ros = start(f"""
        import importlib, rospy
        found = [f"{{module}}.{{name}}" for module, names in {named!r}.items() for name in names
                 if hasattr(importlib.import_module(module), name)]
    """)
    assert ros.namespace["found"] == []
    assert LACKING.keys() <= STANDINS.keys()


@pytest.mark.parametrize(
    ("line", "said"),
    [
        (
            "import tf.transformations; tf.transformations.transform",
            r"^tf\.transformations\.transform is not in .*, and ROS has no such name either: check its spelling\.$",
        ),
        ("import rospy; rospy.Publsher", r"ROS has no such name either\. Did you mean rospy\.Publisher\?$"),
        ("import rospy; rospy.core.xmlrpcapi", r"^rospy\.core\.xmlrpcapi is not in the in-process ROS yet: give"),
        ("import smach; smach.Nope", r"^smach\.Nope is not in the in-process ROS: check its spelling\. If ROS has it"),
        ("import rospy; rospy.topics._Impl", r"rospy\.topics\._Impl is .*: check its spelling\. If ROS has it, give"),
    ],
)  # fmt: skip
def test_the_error_says_whether_ros_has_the_name(start: Start, line: str, said: str) -> None:
    with pytest.raises(UnsupportedApiError, match=said):
        start(line)


def test_an_object_that_refuses_names_has_no_such_attribute(start: Start) -> None:
    ros = start("""
        import moveit_commander, rosgraph
        scene = moveit_commander.PlanningSceneInterface()
        found = [hasattr(one, "nope") for one in (scene, rosgraph.Master("/n"))]
    """)
    assert ros.namespace["found"] == [False, False]
