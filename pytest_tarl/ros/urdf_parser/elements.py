"""The elements of a robot description, and the error for a malformed element.

Lengths are in metres, angles in radians, masses in kilograms. Elements missing from the description are None.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any


class ParseError(Exception):
    """An element lacks an attribute or has a malformed one."""


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
    """The material of a visual, or a reference to one by name."""

    name: str | None = None
    color: Color | None = None
    texture: Texture | None = None


@dataclass
class Box:
    """A box, given by the lengths of its edges."""

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
    """A mesh file, which is not read."""

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
    """A joint's maximum effort and velocity, and its range of positions."""

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
    """The joint that this one follows: multiplier * position + offset."""

    joint: str | None = None
    multiplier: float | None = None
    offset: float | None = None


@dataclass
class JointCalibration:
    """The positions at which a reference switch changes."""

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
    """A joint between two links, given by name."""

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
