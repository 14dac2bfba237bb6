"""`urdf_parser_py.urdf`: a robot as a tree of links and joints, with the elements of its description."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from xml.etree import ElementTree

from pytest_tarl.ros.urdf_parser.elements import (
    Box,
    Collision,
    Color,
    Cylinder,
    Inertia,
    Inertial,
    Joint,
    JointCalibration,
    JointDynamics,
    JointLimit,
    JointMimic,
    Link,
    Material,
    Mesh,
    ParseError,
    Pose,
    SafetyController,
    Sphere,
    Texture,
    Visual,
)
from pytest_tarl.ros.urdf_parser.reading import attribute, read_joint, read_link, read_material

__all__ = [
    "URDF",
    "Box",
    "Collision",
    "Color",
    "Cylinder",
    "Inertia",
    "Inertial",
    "Joint",
    "JointCalibration",
    "JointDynamics",
    "JointLimit",
    "JointMimic",
    "Link",
    "Material",
    "Mesh",
    "Pose",
    "Robot",
    "SafetyController",
    "Sphere",
    "Texture",
    "Visual",
]


@dataclass
class Robot:
    """A robot: links, connected by joints into a tree."""

    name: str | None = None
    version: str = "1.0"
    joints: list[Joint] = field(default_factory=list)
    links: list[Link] = field(default_factory=list)
    materials: list[Material] = field(default_factory=list)
    joint_map: dict[str, Joint] = field(default_factory=dict)
    link_map: dict[str, Link] = field(default_factory=dict)
    # link name → names of its joint and its parent link
    parent_map: dict[str, tuple[str, str]] = field(default_factory=dict)
    # link name → names of the joints and links below it
    child_map: dict[str, list[tuple[str, str]]] = field(default_factory=dict)

    def add_link(self, link: Link) -> None:
        """Add a link."""
        self.links.append(link)
        self.link_map[str(link.name)] = link

    def add_joint(self, joint: Joint) -> None:
        """Add a joint."""
        self.joints.append(joint)
        name, parent, child = str(joint.name), str(joint.parent), str(joint.child)
        self.joint_map[name] = joint
        self.parent_map[child] = (name, parent)
        self.child_map.setdefault(parent, []).append((name, child))

    def get_root(self) -> str:
        """Return the name of the link without a parent. Raise AssertionError unless there is exactly one."""
        roots = [str(link.name) for link in self.links if link.name not in self.parent_map]
        if len(roots) != 1:
            raise AssertionError(f"{'Multiple' if roots else 'No'} roots detected, invalid URDF.")
        return roots[0]

    def get_chain(
        self, root: str, tip: str, joints: bool = True, links: bool = True, fixed: bool = True
    ) -> list[str]:
        """Return the names of the links and joints from one link down to another. Raise KeyError if there are none."""
        chain = [tip] if links else []
        link = tip
        while link != root:
            joint, link = self.parent_map[link]
            if joints and (fixed or self.joint_map[joint].joint_type != "fixed"):
                chain.append(joint)
            if links:
                chain.append(link)
        return chain[::-1]

    @classmethod
    def from_xml_string(cls, xml_string: str | bytes) -> Robot:
        """Read a robot from XML. Raise ParseError for a malformed element, and ElementTree's error for broken XML."""
        root = ElementTree.fromstring(xml_string)  # noqa: S314 - expat limits the growth of entities
        if root.tag != "robot":
            raise ParseError(f"ParseError in /{root.tag}:\nThe root element is not a robot")
        robot = cls(name=attribute(root, "name"), version=root.get("version", "1.0"))
        robot.materials += [read_material(one) for one in root.findall("material")]
        for link in root.findall("link"):
            robot.add_link(read_link(link))
        for joint in root.findall("joint"):
            robot.add_joint(read_joint(joint))
        return robot

    @classmethod
    def from_xml_file(cls, file_path: str) -> Robot:
        """Read a robot from a file. Raise OSError, or what `from_xml_string` raises."""
        return cls.from_xml_string(Path(file_path).read_bytes())

    load_xml_string = from_xml_string
    load_xml_file = from_xml_file

    @classmethod
    def from_parameter_server(cls, key: str = "robot_description") -> Robot:
        """Read a robot from a parameter of rospy."""
        import rospy

        return cls.from_xml_string(rospy.get_param(key))

    load_from_parameter_server = from_parameter_server


URDF = Robot
