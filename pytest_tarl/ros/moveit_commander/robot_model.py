"""The robot of moveit_commander: kinematics from `robot_description`, groups from `robot_description_semantic`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Final
from xml.etree import ElementTree

from pytest_tarl.ros.kdl.chains import Chain, JntArray, JointKind
from pytest_tarl.ros.kdl.frames import Frame
from pytest_tarl.ros.kdl.solvers import ChainFkSolverPos_recursive, ChainIkSolverPos_LMA
from pytest_tarl.ros.kdl_parser import treeFromUrdfModel
from pytest_tarl.ros.urdf_parser.urdf import Robot

_FASTEST: Final = 1.0  # speed limit (rad/s or m/s) of joints that have none


@dataclass(frozen=True)
class Group:
    """A planning group: moving joints, links, named states, and the link at its end."""

    name: str
    joints: tuple[str, ...]
    links: tuple[str, ...]
    tip: str = ""
    states: Mapping[str, Mapping[str, float]] = field(default_factory=dict)


class RobotModel:
    """A robot description with its semantic description."""

    def __init__(self, urdf: str, srdf: str) -> None:
        self.robot = Robot.from_xml_string(urdf.encode())
        self.root = self.robot.get_root()
        self._tree = treeFromUrdfModel(self.robot)[1]
        self._srdf = ElementTree.fromstring(srdf.encode())  # noqa: S314 - expat limits the growth of entities
        self.groups = {name: self._group(name) for name in self._names()}

    @property
    def joints(self) -> tuple[str, ...]:
        """Return the moving joints."""
        return tuple(str(one.name) for one in self.robot.joints if self._moves(str(one.name)))

    @property
    def planning_frame(self) -> str:
        """Return the parent frame of a moving virtual joint, or the root link."""
        for one in self._srdf.findall("virtual_joint"):
            if one.get("type") != "fixed":
                return one.get("parent_frame", self.root)
        return self.root

    def speed(self, joint: str) -> float:
        """Return a joint's speed limit in rad/s or m/s."""
        limit = self.robot.joint_map[joint].limit
        return limit.velocity if limit is not None and limit.velocity else _FASTEST

    def bounds(self, joint: str) -> tuple[float, float] | None:
        """Return the limits of a joint's position; None if it has none."""
        found = self.robot.joint_map[joint]
        limited = found.limit is not None and found.joint_type != "continuous"
        return (found.limit.lower, found.limit.upper) if limited and found.limit is not None else None

    def pose(self, link: str, state: Mapping[str, float]) -> Frame:
        """Return a link's pose in the root link's frame. Raise KeyError for an unknown link."""
        chain = self._tree.getChain(self.root, link) if link in self.robot.link_map else None
        if chain is None:
            raise KeyError(link)
        pose = Frame()
        ChainFkSolverPos_recursive(chain).JntToCart(_values(chain, state), pose)
        return pose

    def reached(
        self, group: Group, link: str, pose: Frame, state: Mapping[str, float]
    ) -> dict[str, float] | None:
        """Return joint values near `state` that bring a link to a pose, or None if none are found.

        The search starts from the current state. If it fails, it restarts from the middle and from a quarter of the
        joints' ranges.
        """
        chain = self._tree.getChain(self.root, link)
        names = _moving(chain)
        for share in (None, 0.5, 0.25, 0.75):
            start = {**state, **({} if share is None else self._between(names, share))}
            found = JntArray(len(names))
            if ChainIkSolverPos_LMA(chain).CartToJnt(_values(chain, start), pose, found) == 0:
                values = dict(zip(names, map(float, found.data), strict=True))
                inside = {name: value for name, value in values.items() if name in group.joints}
                others = [
                    name
                    for name in names
                    if name not in group.joints and abs(values[name] - state[name]) > 1e-3
                ]
                if self.allowed(inside) and not others:
                    return inside
        return None

    def allowed(self, values: Mapping[str, float]) -> bool:
        """Return whether all values are within the limits of their joints."""
        limits = [(value, self.bounds(name)) for name, value in values.items()]
        return all(one is None or one[0] - 1e-6 <= value <= one[1] + 1e-6 for value, one in limits)

    def _between(self, names: Sequence[str], share: float) -> dict[str, float]:
        limits = {name: self.bounds(name) or (-3.0, 3.0) for name in names}
        return {name: low + share * (high - low) for name, (low, high) in limits.items()}

    def _moves(self, joint: str) -> bool:
        found = self.robot.joint_map.get(joint)
        return (
            found is not None
            and found.joint_type in ("revolute", "continuous", "prismatic")
            and not found.mimic
        )

    def _names(self) -> list[str]:
        return [one.get("name", "") for one in self._srdf.findall("group")]

    def _group(self, name: str) -> Group:
        joints, links = self._parts(name, ())
        moving = tuple(one for one in dict.fromkeys(joints) if self._moves(one))
        states = {
            one.get("name", ""): {
                joint.get("name", ""): float(joint.get("value", "0").split()[0])
                for joint in one.findall("joint")
            }
            for one in self._srdf.findall("group_state")
            if one.get("group") == name
        }
        effector = next(
            (one.get("parent_link", "") for one in self._srdf.findall("end_effector")
             if one.get("parent_group", name) == name and one.get("parent_link") in links), "")  # fmt: skip
        return Group(
            name, moving, tuple(dict.fromkeys(links)), effector or (links[-1] if links else ""), states
        )

    def _parts(self, name: str, seen: tuple[str, ...]) -> tuple[list[str], list[str]]:
        """Return the joints and links of a group, including those of its subgroups."""
        joints: list[str] = []
        links: list[str] = []
        group = next(
            (one for one in self._srdf.findall("group") if one.get("name") == name), ElementTree.Element("")
        )
        for one in group:
            if one.tag == "chain":
                chain = self.robot.get_chain(one.get("base_link", ""), one.get("tip_link", ""))
                joints += chain[1::2]
                links += chain[2::2]
            elif one.tag == "joint":
                joints.append(one.get("name", ""))
                links += (
                    [str(self.robot.joint_map[joints[-1]].child)]
                    if joints[-1] in self.robot.joint_map
                    else []
                )
            elif one.tag == "link":
                links.append(one.get("name", ""))
                joints += [self.robot.parent_map[links[-1]][0]] if links[-1] in self.robot.parent_map else []
            elif one.tag == "group" and one.get("name") not in seen:
                inner = self._parts(one.get("name", ""), (*seen, name))
                joints, links = joints + inner[0], links + inner[1]
        return joints, links


def _moving(chain: Chain) -> list[str]:
    joints = [one.getJoint() for one in chain.segments]
    return [one.getName() for one in joints if one.getType() is not JointKind.Fixed]


def _values(chain: Chain, state: Mapping[str, float]) -> JntArray:
    names = _moving(chain)
    values = JntArray(len(names))
    for place, name in enumerate(names):
        values[place] = state.get(name, 0.0)
    return values


def described(parameters: Mapping[str, Any], name: str) -> RobotModel | None:
    """Return the robot in the parameter `name` and its semantic description; None if one of them is not set."""
    urdf, srdf = parameters.get(name), parameters.get(f"{name}_semantic")
    return RobotModel(str(urdf), str(srdf)) if urdf and srdf else None
