"""Vectors, twists and wrenches of PyKDL."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any, Final, TypeVar

EPSILON: Final = 1e-6  # default tolerance of KDL
WIDTH: Final = 12  # characters per number in printed text
Six = TypeVar("Six", bound="_Six")


def shown(values: Any) -> str:
    """Return numbers as KDL prints them."""
    return ",".join(f"{value:{WIDTH}.6g}" for value in values)


class Vector:
    """Three coordinates; `*` between vectors is the cross product."""

    __slots__ = ("_data",)
    __hash__ = None  # type: ignore[assignment]

    def __init__(self, *given: Any, **named: Any) -> None:
        values = [*given, *(named[one] for one in "xyz"[len(given) :] if one in named)]
        if len(values) == 1 and isinstance(values[0], Vector):
            self._data: list[float] = [*values[0]]
        elif len(values) in (0, 3) and len(values) == len(given) + len(named):
            self._data = [float(one) for one in values] or [0.0, 0.0, 0.0]
        else:
            raise TypeError(f"Vector takes nothing, three numbers or a Vector, not {values}")

    @staticmethod
    def Zero() -> Vector:  # noqa: N802 (these names are KDL's)
        """Return the zero vector."""
        return Vector()

    def x(self, value: float | None = None) -> Any:
        """Return the first coordinate; set it if a value is given."""
        return self._entry(0, value)

    def y(self, value: float | None = None) -> Any:
        """Return the second coordinate; set it if a value is given."""
        return self._entry(1, value)

    def z(self, value: float | None = None) -> Any:
        """Return the third coordinate; set it if a value is given."""
        return self._entry(2, value)

    def _entry(self, place: int, value: float | None) -> float | None:
        if value is None:
            return self._data[place]
        self._data[place] = float(value)
        return None

    def Norm(self, eps: float = EPSILON) -> float:  # noqa: N802
        """Return the length; 0 if all coordinates are below `eps`."""
        return math.hypot(*self._data) if max(map(abs, self._data)) >= eps else 0.0

    def Normalize(self, eps: float = EPSILON) -> float:  # noqa: N802
        """Scale to length 1 and return the old length; a vector shorter than `eps` becomes the x axis."""
        length = self.Norm()
        self._data = [1.0, 0.0, 0.0] if length < eps else [one / length for one in self._data]
        return length

    def ReverseSign(self) -> None:  # noqa: N802
        """Negate all coordinates."""
        self._data = [-one for one in self._data]

    def __getitem__(self, place: int) -> float:
        if not 0 <= place < 3:
            raise IndexError("Vector index out of range")
        return self._data[place]

    def __setitem__(self, place: int, value: float) -> None:
        if not 0 <= place < 3:
            raise IndexError("Vector index out of range")
        self._data[place] = float(value)

    def __iter__(self) -> Iterator[float]:
        return iter(tuple(self._data))

    def __add__(self, other: Vector) -> Vector:
        return Vector(*map(sum, zip(self, other, strict=True))) if type(other) is Vector else NotImplemented

    def __sub__(self, other: Vector) -> Vector:
        return self + -other if type(other) is Vector else NotImplemented

    def __iadd__(self, other: Vector) -> Vector:
        self._data = [*(self + other)]
        return self

    def __isub__(self, other: Vector) -> Vector:
        self._data = [*(self - other)]
        return self

    def __neg__(self) -> Vector:
        return Vector(*(-one for one in self))

    def __mul__(self, other: Any) -> Vector:
        if type(other) is Vector:
            (a, b, c), (d, e, f) = self, other
            return Vector(b * f - c * e, c * d - a * f, a * e - b * d)
        return Vector(*(one * other for one in self)) if isinstance(other, float | int) else NotImplemented

    __rmul__ = __mul__

    def __truediv__(self, other: float) -> Vector:
        return Vector(*(one / other for one in self)) if isinstance(other, float | int) else NotImplemented

    def __eq__(self, other: object) -> bool:
        return type(other) is Vector and equal(self, other)

    def __repr__(self) -> str:
        return f"[{shown(self)}]"

    def __copy__(self) -> Vector:
        return Vector(self)

    def __deepcopy__(self, memo: Any) -> Vector:
        return Vector(self)

    def __reduce__(self) -> tuple[Any, ...]:
        return Vector, tuple(self)


class _Six:
    """A linear and an angular vector, which subclasses name."""

    __slots__ = ("_one", "_two")
    __hash__ = None  # type: ignore[assignment]

    def __init__(self, *given: Any) -> None:
        if len(given) == 1 and type(given[0]) is type(self):
            given = (given[0]._one, given[0]._two)
        if len(given) not in (0, 2) or not all(isinstance(one, Vector) for one in given):
            raise TypeError(f"{type(self).__name__} takes nothing, two Vectors or a copy, not {given}")
        self._one: Vector = Vector(*given[:1])
        self._two: Vector = Vector(*given[1:])

    @classmethod
    def Zero(cls: type[Six]) -> Six:  # noqa: N802
        """Return two zero vectors."""
        return cls()

    def ReverseSign(self) -> None:  # noqa: N802
        """Negate both vectors."""
        self._one, self._two = -self._one, -self._two

    def __getitem__(self, place: int) -> float:
        if not 0 <= place < 6:
            raise IndexError(f"{type(self).__name__} index out of range")
        return (self._one, self._two)[place // 3][place % 3]

    def __setitem__(self, place: int, value: float) -> None:
        if not 0 <= place < 6:
            raise IndexError(f"{type(self).__name__} index out of range")
        (self._one, self._two)[place // 3][place % 3] = value

    def __iter__(self) -> Iterator[float]:
        return iter((*self._one, *self._two))

    def __add__(self: Six, other: Six) -> Six:
        same = type(other) is type(self)
        return type(self)(self._one + other._one, self._two + other._two) if same else NotImplemented

    def __sub__(self: Six, other: Six) -> Six:
        return self + -other if type(other) is type(self) else NotImplemented

    def __iadd__(self: Six, other: Six) -> Six:
        self._one, self._two = self._one + other._one, self._two + other._two
        return self

    def __isub__(self: Six, other: Six) -> Six:
        self._one, self._two = self._one - other._one, self._two - other._two
        return self

    def __neg__(self: Six) -> Six:
        return type(self)(-self._one, -self._two)

    def __rmul__(self: Six, other: float) -> Six:
        return self._scaled(other) if isinstance(other, float | int) else NotImplemented

    def __truediv__(self: Six, other: float) -> Six:
        if not isinstance(other, float | int):
            return NotImplemented
        return type(self)(self._one / other, self._two / other)

    def __eq__(self, other: object) -> bool:
        return type(other) is type(self) and equal(self, other)

    def __repr__(self) -> str:
        return f"[{shown(self)}]"

    def __copy__(self: Six) -> Six:
        return type(self)(self)

    def __deepcopy__(self: Six, memo: Any) -> Six:
        return type(self)(self)

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self._one, self._two)

    def _scaled(self: Six, factor: float) -> Six:
        return type(self)(self._one * factor, self._two * factor)


class Twist(_Six):
    """A velocity `vel` and an angular velocity `rot`."""

    __slots__ = ()

    @property
    def vel(self) -> Vector:
        """The velocity of the reference point."""
        return self._one

    @vel.setter
    def vel(self, value: Vector) -> None:
        self._one = Vector(value)

    @property
    def rot(self) -> Vector:
        """The angular velocity."""
        return self._two

    @rot.setter
    def rot(self, value: Vector) -> None:
        self._two = Vector(value)

    def RefPoint(self, moved: Vector) -> Twist:  # noqa: N802
        """Return the twist with the reference point moved by a vector."""
        return Twist(self.vel + self.rot * moved, self.rot)

    def __mul__(self, other: float) -> Twist:
        return self._scaled(other) if isinstance(other, float | int) else NotImplemented


class Wrench(_Six):
    """A force and a torque."""

    __slots__ = ()

    @property
    def force(self) -> Vector:
        """The force."""
        return self._one

    @force.setter
    def force(self, value: Vector) -> None:
        self._one = Vector(value)

    @property
    def torque(self) -> Vector:
        """The torque about the reference point."""
        return self._two

    @torque.setter
    def torque(self, value: Vector) -> None:
        self._two = Vector(value)

    def RefPoint(self, moved: Vector) -> Wrench:  # noqa: N802
        """Return the wrench with the reference point moved by a vector."""
        return Wrench(self.force, self.torque + self.force * moved)

    def __mul__(self, other: float) -> Wrench:
        return self._scaled(other) if isinstance(other, float | int) else NotImplemented


def equal(one: Any, other: Any, eps: float = EPSILON) -> bool:
    """Return whether all numbers differ by less than `eps`."""
    return all(abs(a - b) < eps for a, b in zip(one, other, strict=True))
