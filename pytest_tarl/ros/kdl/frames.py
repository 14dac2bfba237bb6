"""Frames of PyKDL, and sums and differences of its geometric values."""

from __future__ import annotations

import math
from typing import Any, overload

from pytest_tarl.ros.kdl.rotations import Rotation, _index
from pytest_tarl.ros.kdl.vectors import EPSILON, Twist, Vector, Wrench, equal


class Frame:
    """A pose with rotation `M` and position `p`."""

    __slots__ = ("_M", "_p")
    __hash__ = None  # type: ignore[assignment]

    def __init__(self, *given: Any) -> None:
        self._M, self._p = Rotation(), Vector()
        if len(given) == 2 and isinstance(given[0], Rotation) and isinstance(given[1], Vector):
            self.M, self.p = given
        elif len(given) == 1 and isinstance(given[0], Frame):
            self.M, self.p = given[0].M, given[0].p
        elif len(given) == 1 and isinstance(given[0], Rotation):
            self.M = given[0]
        elif len(given) == 1 and isinstance(given[0], Vector):
            self.p = given[0]
        elif given:
            raise TypeError(f"Frame takes a Rotation, a Vector, both, or a Frame, not {given}")

    @property
    def M(self) -> Rotation:  # noqa: N802 (these names are KDL's)
        """The rotation."""
        return self._M

    @M.setter
    def M(self, value: Rotation) -> None:  # noqa: N802
        self._M = Rotation(value)

    @property
    def p(self) -> Vector:
        """The position."""
        return self._p

    @p.setter
    def p(self, value: Vector) -> None:
        self._p = Vector(value)

    @staticmethod
    def Identity() -> Frame:  # noqa: N802
        """Return the frame at the origin without rotation."""
        return Frame()

    @staticmethod
    def DH(a: float, alpha: float, d: float, theta: float) -> Frame:  # noqa: N802
        """Return the frame of Denavit-Hartenberg parameters."""
        turn, shift = Rotation.RotZ(theta), Vector(a, 0, d)
        return Frame(turn * Rotation.RotX(alpha), turn * shift)

    @staticmethod
    def DH_Craig1989(a: float, alpha: float, d: float, theta: float) -> Frame:  # noqa: N802
        """Return the frame of Denavit-Hartenberg parameters in Craig's convention."""
        tilt = Rotation.RotX(alpha)
        return Frame(tilt * Rotation.RotZ(theta), Vector(a, 0, 0) + tilt * Vector(0, 0, d))

    def Inverse(self, other: Any = None) -> Any:  # noqa: N802
        """Return the inverse, or apply the inverse to a vector, twist or wrench."""
        turned = self.M.Inverse()
        inverse = Frame(turned, -(turned * self.p))
        return inverse if other is None else inverse * other

    def Integrate(self, twist: Twist, frequency: float) -> None:  # noqa: N802
        """Move by a twist in this frame, for a time of 1 / `frequency`."""
        change = Frame(Rotation.Rot(twist.rot, twist.rot.Norm() / frequency), twist.vel / frequency)
        moved = self * change
        self.M, self.p = moved.M, moved.p

    @overload
    def __mul__(self, other: Vector) -> Vector: ...
    @overload
    def __mul__(self, other: Frame) -> Frame: ...
    @overload
    def __mul__(self, other: Twist) -> Twist: ...
    @overload
    def __mul__(self, other: Wrench) -> Wrench: ...
    def __mul__(self, other: Any) -> Any:
        if type(other) is Vector:
            return self.M * other + self.p
        if isinstance(other, Frame):
            return Frame(self.M * other.M, self.M * other.p + self.p)
        if isinstance(other, Twist):
            turned = self.M * other.rot
            return Twist(self.M * other.vel + self.p * turned, turned)
        if isinstance(other, Wrench):
            force = self.M * other.force
            return Wrench(force, self.M * other.torque + self.p * force)
        return NotImplemented

    def __getitem__(self, place: tuple[int, int]) -> float:
        _index(place, 4, "Frame")
        return self.p[place[0]] if place[1] == 3 else self.M[place]

    def __setitem__(self, place: tuple[int, int], value: float) -> None:
        _index(place, 4, "Frame")
        if place[1] == 3:
            self.p[place[0]] = value
        else:
            self.M[place] = value

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Frame) and self.M == other.M and self.p == other.p

    def __repr__(self) -> str:
        return f"[{self.M!r}\n{self.p!r}]"

    def __copy__(self) -> Frame:
        return Frame(self)

    def __deepcopy__(self, memo: Any) -> Frame:
        return Frame(self)

    def __reduce__(self) -> tuple[Any, ...]:
        return Frame, (self.M, self.p)


def dot(one: Any, other: Any) -> float:
    """Return the scalar product of two vectors, or the power of a twist and a wrench."""
    return math.fsum(a * b for a, b in zip(one, other, strict=True))


def diff(one: Any, other: Any, dt: float = 1.0) -> Any:
    """Return the change per time between two values of the same kind, in their common frame."""
    if isinstance(one, Rotation):
        return one * (one.Inverse() * other).GetRot() / dt
    if isinstance(one, Frame):
        return Twist(diff(one.p, other.p, dt), diff(one.M, other.M, dt))
    return (other - one) / dt


def addDelta(value: Any, change: Any, dt: float = 1.0) -> Any:  # noqa: N802
    """Return a value after changing at the rate `change` for the time `dt`."""
    if isinstance(value, Rotation):
        return value * Rotation.Rot(value.Inverse(change), change.Norm() * dt)
    if isinstance(value, Frame):
        return Frame(addDelta(value.M, change.rot, dt), addDelta(value.p, change.vel, dt))
    return value + change * dt


def Equal(one: Any, other: Any, eps: float = EPSILON) -> bool:  # noqa: N802
    """Return whether two values of the same kind differ by less than `eps` in every number."""
    if isinstance(one, Frame):
        return Equal(one.p, other.p, eps) and Equal(one.M, other.M, eps)
    return equal(one, other, eps)


def SetToZero(value: Any) -> None:  # noqa: N802
    """Set all numbers of a vector, twist, wrench or array to zero."""
    for place in range(len(list(value))):
        value[place] = 0.0
