"""Read the elements of a robot description from XML."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any
from xml.etree.ElementTree import Element

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

TYPES = ("unknown", "revolute", "continuous", "prismatic", "floating", "planar", "fixed")


def read_link(element: Element) -> Link:
    """Return a link. Raise ParseError if an element is malformed."""
    inertial = element.find("inertial")
    return Link(
        attribute(element, "name"),
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
        return Mesh(
            attribute(shape, "filename"), _numbers(shape, "scale") if "scale" in shape.attrib else None
        )
    raise _wrong(element, f"Unknown geometry: {shape.tag}")


def _material_of(element: Element) -> Material | None:
    found = element.find("material")
    return None if found is None else read_material(found)


def read_material(element: Element) -> Material:
    """Return a material. Raise ParseError if an element is malformed."""
    color, texture = element.find("color"), element.find("texture")
    return Material(
        element.get("name"),
        None if color is None else Color(_numbers(color, "rgba")),
        None if texture is None else Texture(attribute(texture, "filename")),
    )


def read_joint(element: Element) -> Joint:
    """Return a joint. Raise ParseError if an element is malformed."""
    kind = attribute(element, "type")
    if kind not in TYPES:
        raise _wrong(element, f"Invalid joint type: {kind}")
    axis = element.find("axis")

    def part(tag: str, make: Callable[[Element], Any]) -> Any:
        found = element.find(tag)
        return None if found is None else make(found)

    return Joint(
        attribute(element, "name"),
        attribute(_needed(element, "parent"), "link"),
        attribute(_needed(element, "child"), "link"),
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
            lambda one: JointMimic(attribute(one, "joint"), _given(one, "multiplier"), _given(one, "offset")),
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


def attribute(element: Element, name: str) -> str:
    """Return an attribute. Raise ParseError if it is missing."""
    value = element.get(name)
    if value is None:
        raise _wrong(element, f"Required attribute not set in XML: {name}")
    return value


def _number(element: Element, name: str, default: float | None = None) -> float:
    """Return an attribute as a number, or the default. Raise ParseError if it is missing without a default."""
    if default is not None and name not in element.attrib:
        return default
    return next(_floats(element, name, attribute(element, name)))


def _given(element: Element, name: str) -> float | None:
    return _number(element, name) if name in element.attrib else None


def _numbers(element: Element, name: str) -> list[float]:
    return list(_floats(element, name, attribute(element, name)))


def _floats(element: Element, name: str, given: str) -> Iterator[float]:
    try:
        yield from [float(one) for one in given.split() or [given]]
    except ValueError as error:
        raise _wrong(element, f"Attribute {name} is not a number: {given!r}") from error


def _wrong(element: Element, what: str) -> ParseError:
    name = element.get("name")
    return ParseError(f"ParseError in /{element.tag}" + (f"[@name='{name}']" if name else "") + f":\n{what}")
