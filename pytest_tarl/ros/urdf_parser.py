"""urdf_parser_py: read robot descriptions (URDF). An installed urdf_parser_py takes precedence.

Lengths are in metres, angles in radians, masses in kilograms. An element that the description lacks is None.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

from pytest_tarl.ros.missing import refusing

__all__ = [
    "URDF", "Box", "Collision", "Color", "Cylinder", "Inertia", "Inertial", "Joint", "JointCalibration",
    "JointDynamics", "JointLimit", "JointMimic", "Link", "Material", "Mesh", "ParseError", "Pose", "Robot",
    "SafetyController", "Sphere", "Texture", "Visual",
]  # fmt: skip

__getattr__ = refusing("urdf_parser_py.urdf")

TYPES = ("unknown", "revolute", "continuous", "prismatic", "floating", "planar", "fixed")


class ParseError(Exception):
    """Raised if an element lacks an attribute or has one of a wrong form."""


@dataclass
class Pose:
    """A position and an orientation as roll, pitch and yaw."""

    xyz: list[float] | None = None
    rpy: list[float] | None = None

    @property
    def position(self) -> list[float] | None:
        """Return the position."""
        return self.xyz

    @property
    def rotation(self) -> list[float] | None:
        """Return roll, pitch and yaw."""
        return self.rpy


@dataclass
class Color:
    """A colour; red, green, blue and alpha are between 0 and 1."""

    rgba: list[float] | None = None


@dataclass
class Texture:
    """An image on a surface."""

    filename: str | None = None


@dataclass
class Material:
    """A material of a visual, or a reference to one by its name."""

    name: str | None = None
    color: Color | None = None
    texture: Texture | None = None


@dataclass
class Box:
    """A box with the lengths of its edges."""

    size: list[float] | None = None


@dataclass
class Cylinder:
    """A cylinder along z."""

    radius: float = 0.0
    length: float = 0.0


@dataclass
class Sphere:
    """A sphere."""

    radius: float = 0.0


@dataclass
class Mesh:
    """A mesh in a file, which is not read."""

    filename: str | None = None
    scale: list[float] | None = None


@dataclass
class Visual:
    """A shape to display."""

    geometry: Any = None
    material: Material | None = None
    origin: Pose | None = None
    name: str | None = None


@dataclass
class Collision:
    """A shape for collisions."""

    geometry: Any = None
    origin: Pose | None = None
    name: str | None = None


@dataclass
class Inertia:
    """The six numbers of an inertia matrix, in kg m²."""

    ixx: float = 0.0
    ixy: float = 0.0
    ixz: float = 0.0
    iyy: float = 0.0
    iyz: float = 0.0
    izz: float = 0.0

    def to_matrix(self) -> list[list[float]]:
        """Return the matrix as three rows."""
        return [
            [self.ixx, self.ixy, self.ixz],
            [self.ixy, self.iyy, self.iyz],
            [self.ixz, self.iyz, self.izz],
        ]


@dataclass
class Inertial:
    """Mass, inertia and centre of mass of a link."""

    mass: float = 0.0
    inertia: Inertia | None = None
    origin: Pose | None = None


@dataclass
class JointLimit:
    """Largest effort and velocity of a joint, and the bounds of its position."""

    effort: float | None = None
    velocity: float | None = None
    lower: float = 0
    upper: float = 0


@dataclass
class JointDynamics:
    """Damping and friction of a joint."""

    damping: float | None = None
    friction: float | None = None


@dataclass
class JointMimic:
    """The joint that a joint follows: multiplier * position + offset."""

    joint: str | None = None
    multiplier: float | None = None
    offset: float | None = None


@dataclass
class JointCalibration:
    """Positions of the edges of a reference switch."""

    rising: float = 0
    falling: float = 0


@dataclass
class SafetyController:
    """Soft limits of a joint."""

    k_velocity: float | None = None
    k_position: float = 0
    soft_lower_limit: float = 0
    soft_upper_limit: float = 0


@dataclass
class Joint:
    """A joint between two links, which it names."""

    name: str | None = None
    parent: str | None = None
    child: str | None = None
    joint_type: str | None = None
    axis: list[float] | None = None
    origin: Pose | None = None
    limit: JointLimit | None = None
    dynamics: JointDynamics | None = None
    safety_controller: SafetyController | None = None
    calibration: JointCalibration | None = None
    mimic: JointMimic | None = None

    @property
    def type(self) -> str | None:
        """Return the type of the joint, such as `revolute`."""
        return self.joint_type


@dataclass
class Link:
    """A rigid body."""

    name: str | None = None
    inertial: Inertial | None = None
    visuals: list[Visual] = field(default_factory=list)
    collisions: list[Collision] = field(default_factory=list)
    origin: Pose | None = None

    @property
    def visual(self) -> Visual | None:
        """Return the first visual."""
        return self.visuals[0] if self.visuals else None

    @property
    def collision(self) -> Collision | None:
        """Return the first collision shape."""
        return self.collisions[0] if self.collisions else None


@dataclass
class Robot:
    """A robot: links, and the joints that connect them to a tree."""

    name: str | None = None
    version: str = "1.0"
    joints: list[Joint] = field(default_factory=list)
    links: list[Link] = field(default_factory=list)
    materials: list[Material] = field(default_factory=list)
    joint_map: dict[str, Joint] = field(default_factory=dict)
    link_map: dict[str, Link] = field(default_factory=dict)
    # name of a link → names of the joint and the link above it
    parent_map: dict[str, tuple[str, str]] = field(default_factory=dict)
    # name of a link → names of the joints and links below it
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
        """Return the names of the links and joints from one link down to another. Raise KeyError without a chain."""
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
        """Read a robot from XML. Raise ParseError for an element of a wrong form, and ElementTree's for broken XML."""
        return _robot(cls, ElementTree.fromstring(xml_string))  # noqa: S314 - expat limits the growth of entities

    @classmethod
    def from_xml_file(cls, file_path: str) -> Robot:
        """Read a robot from a file. Raise what `from_xml_string` raises, and OSError."""
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


def _robot(cls: type[Robot], root: Element) -> Robot:
    if root.tag != "robot":
        raise ParseError(f"ParseError in /{root.tag}:\nThe root element is not a robot")
    robot = cls(name=_text(root, "name"), version=root.get("version", "1.0"))
    robot.materials += [_material(one) for one in root.findall("material")]
    for link in root.findall("link"):
        robot.add_link(_link(link))
    for joint in root.findall("joint"):
        robot.add_joint(_joint(joint))
    return robot


def _link(element: Element) -> Link:
    inertial = element.find("inertial")
    return Link(
        _text(element, "name"),
        None if inertial is None else _inertial(inertial),
        [
            Visual(_geometry(one), _material_of(one), _pose(one), one.get("name"))
            for one in element.findall("visual")
        ],
        [Collision(_geometry(one), _pose(one), one.get("name")) for one in element.findall("collision")],
        _pose(element),
    )


def _inertial(element: Element) -> Inertial:
    mass, inertia = element.find("mass"), element.find("inertia")
    made = None
    if inertia is not None:
        made = Inertia(**{name: _number(inertia, name, 0.0) for name in Inertia.__dataclass_fields__})
    return Inertial(0.0 if mass is None else _number(mass, "value"), made, _pose(element))


def _geometry(element: Element) -> Any:
    geometry = element.find("geometry")
    shape = next(iter(geometry), None) if geometry is not None else None
    if shape is None:
        return None
    if shape.tag == "box":
        return Box(_numbers(shape, "size"))
    if shape.tag == "cylinder":
        return Cylinder(_number(shape, "radius"), _number(shape, "length"))
    if shape.tag == "sphere":
        return Sphere(_number(shape, "radius"))
    if shape.tag == "mesh":
        return Mesh(_text(shape, "filename"), _numbers(shape, "scale") if "scale" in shape.attrib else None)
    raise _wrong(element, f"Unknown geometry: {shape.tag}")


def _material_of(element: Element) -> Material | None:
    found = element.find("material")
    return None if found is None else _material(found)


def _material(element: Element) -> Material:
    color, texture = element.find("color"), element.find("texture")
    return Material(
        element.get("name"),
        None if color is None else Color(_numbers(color, "rgba")),
        None if texture is None else Texture(_text(texture, "filename")),
    )


def _joint(element: Element) -> Joint:
    kind = _text(element, "type")
    if kind not in TYPES:
        raise _wrong(element, f"Invalid joint type: {kind}")
    axis = element.find("axis")

    def part(tag: str, make: Callable[[Element], Any]) -> Any:
        found = element.find(tag)
        return None if found is None else make(found)

    return Joint(
        _text(element, "name"),
        _text(_needed(element, "parent"), "link"),
        _text(_needed(element, "child"), "link"),
        kind,
        None if axis is None else _numbers(axis, "xyz"),
        _pose(element),
        part("limit", _limit),
        part("dynamics", lambda one: JointDynamics(_given(one, "damping"), _given(one, "friction"))),
        part("safety_controller", _safety),
        part(
            "calibration", lambda one: JointCalibration(_number(one, "rising", 0), _number(one, "falling", 0))
        ),
        part(
            "mimic",
            lambda one: JointMimic(_text(one, "joint"), _given(one, "multiplier"), _given(one, "offset")),
        ),
    )


def _limit(element: Element) -> JointLimit:
    return JointLimit(
        _number(element, "effort"),
        _number(element, "velocity"),
        _number(element, "lower", 0),
        _number(element, "upper", 0),
    )


def _safety(element: Element) -> SafetyController:
    return SafetyController(
        _number(element, "k_velocity"),
        _number(element, "k_position", 0),
        _number(element, "soft_lower_limit", 0),
        _number(element, "soft_upper_limit", 0),
    )


def _pose(element: Element) -> Pose | None:
    origin = element.find("origin")
    if origin is None:
        return None
    return Pose(*(_numbers(origin, name) if name in origin.attrib else None for name in ("xyz", "rpy")))


def _needed(element: Element, tag: str) -> Element:
    found = element.find(tag)
    if found is None:
        raise _wrong(element, f"Required element not defined in XML: {tag}")
    return found


def _text(element: Element, name: str) -> str:
    value = element.get(name)
    if value is None:
        raise _wrong(element, f"Required attribute not set in XML: {name}")
    return value


def _number(element: Element, name: str, default: float | None = None) -> float:
    """Return an attribute as a number; the default if it is missing. Raise ParseError if it is missing without one."""
    if default is not None and name not in element.attrib:
        return default
    return next(_floats(element, name, _text(element, name)))


def _given(element: Element, name: str) -> float | None:
    return _number(element, name) if name in element.attrib else None


def _numbers(element: Element, name: str) -> list[float]:
    return list(_floats(element, name, _text(element, name)))


def _floats(element: Element, name: str, text: str) -> Iterator[float]:
    try:
        yield from [float(one) for one in text.split() or [text]]
    except ValueError as error:
        raise _wrong(element, f"Attribute {name} is not a number: {text!r}") from error


def _wrong(element: Element, what: str) -> ParseError:
    name = element.get("name")
    return ParseError(f"ParseError in /{element.tag}" + (f"[@name='{name}']" if name else "") + f":\n{what}")
