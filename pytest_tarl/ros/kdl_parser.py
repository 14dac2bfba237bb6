"""Stand-in for `kdl_parser_py.urdf`: trees of PyKDL from robot descriptions, without inertias."""

from __future__ import annotations

from typing import Any

from pytest_tarl.ros.kdl.chains import Joint, Segment, Tree
from pytest_tarl.ros.kdl.frames import Frame
from pytest_tarl.ros.kdl.rotations import Rotation
from pytest_tarl.ros.kdl.vectors import Vector
from pytest_tarl.ros.urdf_parser.urdf import Robot

__all__ = ["treeFromFile", "treeFromParam", "treeFromString", "treeFromUrdfModel"]

_TURNING = ("revolute", "continuous")


def treeFromFile(filename: str) -> tuple[bool, Tree]:  # noqa: N802 (these names are kdl_parser_py's)
    """Return True and the tree of a description in a file."""
    return treeFromUrdfModel(Robot.from_xml_file(filename))


def treeFromString(xml: str) -> tuple[bool, Tree]:  # noqa: N802
    """Return True and the tree of a description in XML."""
    return treeFromUrdfModel(Robot.from_xml_string(xml))


def treeFromParam(param: str) -> tuple[bool, Tree]:  # noqa: N802
    """Return True and the tree of a description in a parameter of rospy."""
    return treeFromUrdfModel(Robot.from_parameter_server(param))


def treeFromUrdfModel(robot_model: Any, quiet: bool = False) -> tuple[bool, Tree]:  # noqa: N802, ARG001
    """Return True and the tree of a description; segments are named after links."""
    root = robot_model.get_root()
    tree = Tree(root)
    below = [root]
    while below:
        parent = below.pop(0)
        for name, child in robot_model.child_map.get(parent, []):
            joint = robot_model.joint_map[name]
            pose = _pose(joint.origin)
            tree.addSegment(Segment(child, _joint(joint, pose), pose), parent)
            below.append(child)
    return True, tree


def _pose(origin: Any) -> Frame:
    if origin is None:
        return Frame()
    return Frame(Rotation.RPY(*(origin.rpy or (0, 0, 0))), Vector(*(origin.xyz or (0, 0, 0))))


def _joint(joint: Any, pose: Frame) -> Joint:
    """Return a joint whose axis and origin are in the parent link's frame."""
    axis = pose.M * Vector(*(joint.axis or (1, 0, 0)))
    if joint.joint_type in _TURNING:
        return Joint(joint.name, pose.p, axis, Joint.RotAxis)
    if joint.joint_type == "prismatic":
        return Joint(joint.name, pose.p, axis, Joint.TransAxis)
    return Joint(joint.name, Joint.Fixed)
