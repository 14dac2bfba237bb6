"""Rotations of PyKDL."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any, Final, overload

from pytest_tarl.ros.kdl.vectors import Twist, Vector, Wrench, equal, shown

_TINY: Final = 1e-12  # rad; KDL treats rotations by smaller angles as singular
_IDENTITY: Final = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)


class Rotation:
    """A rotation matrix, constructed from nine numbers (row by row) or three columns."""

    __slots__ = ("_data",)
    __hash__ = None  # type: ignore[assignment]

    def __init__(self, *given: Any) -> None:
        if not given:
            self._data = [*_IDENTITY]
        elif len(given) == 1 and isinstance(given[0], Rotation):
            self._data = [*given[0]._data]
        elif len(given) == 3 and all(isinstance(one, Vector) for one in given):
            self._data = [column[row] for row in range(3) for column in given]
        elif len(given) == 9:
            self._data = [float(one) for one in given]
        else:
            raise TypeError(f"Rotation takes nothing, nine numbers, three Vectors or a Rotation, not {given}")

    @staticmethod
    def Identity() -> Rotation:  # noqa: N802 (these names are KDL's)
        """Return the identity."""
        return Rotation()

    @staticmethod
    def RotX(angle: float) -> Rotation:  # noqa: N802
        """Return the rotation about the x axis."""
        return Rotation.Rot2(Vector(1, 0, 0), angle)

    @staticmethod
    def RotY(angle: float) -> Rotation:  # noqa: N802
        """Return the rotation about the y axis."""
        return Rotation.Rot2(Vector(0, 1, 0), angle)

    @staticmethod
    def RotZ(angle: float) -> Rotation:  # noqa: N802
        """Return the rotation about the z axis."""
        return Rotation.Rot2(Vector(0, 0, 1), angle)

    @staticmethod
    def Rot(axis: Vector, angle: float) -> Rotation:  # noqa: N802
        """Return the rotation about an axis of any length."""
        unit = Vector(axis)
        unit.Normalize()
        return Rotation.Rot2(unit, angle)

    @staticmethod
    def Rot2(unit: Vector, angle: float) -> Rotation:  # noqa: N802
        """Return the rotation about a unit vector (Rodrigues' formula)."""
        sine, cosine = math.sin(angle), math.cos(angle)
        x, y, z = unit
        rest = 1.0 - cosine
        return Rotation(
            cosine + rest * x * x, rest * x * y - sine * z, rest * x * z + sine * y,
            rest * x * y + sine * z, cosine + rest * y * y, rest * y * z - sine * x,
            rest * x * z - sine * y, rest * y * z + sine * x, cosine + rest * z * z,
        )  # fmt: skip

    @staticmethod
    def RPY(roll: float, pitch: float, yaw: float) -> Rotation:  # noqa: N802
        """Return the rotation by roll, then pitch, then yaw, about fixed axes."""
        return Rotation.RotZ(yaw) * Rotation.RotY(pitch) * Rotation.RotX(roll)

    @staticmethod
    def EulerZYX(alpha: float, beta: float, gamma: float) -> Rotation:  # noqa: N802
        """Return the rotation about z, then the new y, then the new x."""
        return Rotation.RPY(gamma, beta, alpha)

    @staticmethod
    def EulerZYZ(alpha: float, beta: float, gamma: float) -> Rotation:  # noqa: N802
        """Return the rotation about z, then the new y, then the new z."""
        return Rotation.RotZ(alpha) * Rotation.RotY(beta) * Rotation.RotZ(gamma)

    @staticmethod
    def Quaternion(x: float, y: float, z: float, w: float) -> Rotation:  # noqa: N802
        """Return the rotation of a unit quaternion; KDL does not scale it to length 1."""
        return Rotation(
            w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y),
            2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x),
            2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z,
        )  # fmt: skip

    def UnitX(self, column: Vector | None = None) -> Vector | None:  # noqa: N802
        """Return the first column; set it if a vector is given."""
        return self._column(0, column)

    def UnitY(self, column: Vector | None = None) -> Vector | None:  # noqa: N802
        """Return the second column; set it if a vector is given."""
        return self._column(1, column)

    def UnitZ(self, column: Vector | None = None) -> Vector | None:  # noqa: N802
        """Return the third column; set it if a vector is given."""
        return self._column(2, column)

    def _column(self, place: int, column: Vector | None) -> Vector | None:
        if column is None:
            return Vector(*self._data[place::3])
        self._data[place::3] = column
        return None

    def DoRotX(self, angle: float) -> None:  # noqa: N802
        """Rotate about the rotated x axis."""
        self._data = (self * Rotation.RotX(angle))._data

    def DoRotY(self, angle: float) -> None:  # noqa: N802
        """Rotate about the rotated y axis."""
        self._data = (self * Rotation.RotY(angle))._data

    def DoRotZ(self, angle: float) -> None:  # noqa: N802
        """Rotate about the rotated z axis."""
        self._data = (self * Rotation.RotZ(angle))._data

    def GetRPY(self) -> tuple[float, float, float]:  # noqa: N802
        """Return roll, pitch and yaw; roll is 0 if pitch is ±90°."""
        m = self._data
        pitch = math.atan2(-m[6], math.hypot(m[0], m[3]))
        if abs(pitch) > math.pi / 2 - _TINY:
            return 0.0, pitch, math.atan2(-m[1], m[4])
        return math.atan2(m[7], m[8]), pitch, math.atan2(m[3], m[0])

    def GetEulerZYX(self) -> tuple[float, float, float]:  # noqa: N802
        """Return the angles of `EulerZYX`."""
        return self.GetRPY()[::-1]

    def GetEulerZYZ(self) -> tuple[float, float, float]:  # noqa: N802
        """Return the angles of `EulerZYZ`; the last is 0 if both rotations about z have the same axis."""
        m = self._data
        if abs(m[8]) > 1 - _TINY:
            return (
                (math.atan2(m[3], m[0]), 0.0, 0.0) if m[8] > 0 else (math.atan2(-m[3], -m[0]), math.pi, 0.0)
            )
        return math.atan2(m[5], m[2]), math.atan2(math.hypot(m[6], m[7]), m[8]), math.atan2(m[7], -m[6])

    def GetQuaternion(self) -> tuple[float, float, float, float]:  # noqa: N802
        """Return x, y, z and w, computed from the largest of them."""
        m = self._data
        trace = m[0] + m[4] + m[8]
        if trace > _TINY:
            scale = 0.5 / math.sqrt(trace + 1.0)
            return (m[7] - m[5]) * scale, (m[2] - m[6]) * scale, (m[3] - m[1]) * scale, 0.25 / scale
        first = 0 if m[0] > m[4] and m[0] > m[8] else 1 if m[4] > m[8] else 2
        second, third = (first + 1) % 3, (first + 2) % 3
        scale = 2.0 * math.sqrt(1.0 + m[4 * first] - m[4 * second] - m[4 * third])
        found = [0.0, 0.0, 0.0]
        found[first] = 0.25 * scale
        found[second] = (m[3 * second + first] + m[3 * first + second]) / scale
        found[third] = (m[3 * third + first] + m[3 * first + third]) / scale
        w = (m[3 * third + second] - m[3 * second + third]) / scale
        return found[0], found[1], found[2], w

    def GetRotAngle(self, eps: float = 1e-6) -> tuple[float, Vector]:  # noqa: N802
        """Return the angle in [0, π] and the unit axis, which is z for a zero rotation."""
        m = self._data
        axis = Vector(m[7] - m[5], m[2] - m[6], m[3] - m[1])
        sine, cosine = axis.Norm(eps) / 2, (m[0] + m[4] + m[8] - 1) / 2
        if sine:
            return math.atan2(sine, cosine), axis / (2 * sine)
        if cosine > 0:
            return 0.0, Vector(0, 0, 1)
        return math.pi, _half_turn_axis(m)

    def GetRot(self) -> Vector:  # noqa: N802
        """Return the axis, scaled to the angle."""
        angle, axis = self.GetRotAngle()
        return axis * angle

    def Inverse(self, other: Any = None) -> Any:  # noqa: N802
        """Return the inverse, or apply the inverse to a vector, twist or wrench."""
        m = self._data
        inverse = Rotation(*(m[3 * column + row] for row in range(3) for column in range(3)))
        return inverse if other is None else inverse * other

    def SetInverse(self) -> None:  # noqa: N802
        """Invert the rotation in place."""
        self._data = self.Inverse()._data

    def __getitem__(self, place: tuple[int, int]) -> float:
        return self._data[_index(place, 3, "Rotation")]

    def __setitem__(self, place: tuple[int, int], value: float) -> None:
        self._data[_index(place, 3, "Rotation")] = float(value)

    @overload
    def __mul__(self, other: Vector) -> Vector: ...
    @overload
    def __mul__(self, other: Rotation) -> Rotation: ...
    @overload
    def __mul__(self, other: Twist) -> Twist: ...
    @overload
    def __mul__(self, other: Wrench) -> Wrench: ...
    def __mul__(self, other: Any) -> Any:
        m = self._data
        if type(other) is Vector:
            return Vector(
                *(sum(a * b for a, b in zip(m[row : row + 3], other, strict=True)) for row in (0, 3, 6))
            )
        if isinstance(other, Rotation):
            return Rotation(*(self * Vector(*other._data[column::3]) for column in range(3)))
        if isinstance(other, Twist):
            return Twist(self * other.vel, self * other.rot)
        if isinstance(other, Wrench):
            return Wrench(self * other.force, self * other.torque)
        return NotImplemented

    def __iter__(self) -> Iterator[float]:
        return iter(tuple(self._data))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Rotation) and equal(self, other)

    def __repr__(self) -> str:
        return "[" + ";\n ".join(shown(self._data[row : row + 3]) for row in (0, 3, 6)) + "]"

    def __copy__(self) -> Rotation:
        return Rotation(self)

    def __deepcopy__(self, memo: Any) -> Rotation:
        return Rotation(self)

    def __reduce__(self) -> tuple[Any, ...]:
        return Rotation, tuple(self._data)


def _half_turn_axis(m: Sequence[float]) -> Vector:
    """Return the unit axis of a 180° rotation, from the largest diagonal entry of (R + I) / 2."""
    first = 0 if m[0] > m[4] and m[0] > m[8] else 1 if m[4] > m[8] else 2
    length = math.sqrt(max(0.0, (m[4 * first] + 1) / 2))
    return Vector(*(length if one == first else m[3 * first + one] / (2 * length) for one in range(3)))


def _index(place: Any, columns: int, what: str) -> int:
    if not isinstance(place, tuple) or len(place) != 2:
        raise TypeError(f"{what} takes two indices, not {place!r}")
    row, column = place
    if not (0 <= row < 3 and 0 <= column < columns):
        raise IndexError(f"{what} index out of range")
    return int(row) * 3 + int(column)
