"""ROS 1 times and durations (`genpy.Time`, `genpy.Duration`): whole seconds and nanoseconds.

Arithmetic returns the class of the left operand, so that a `rospy.Duration` remains one.
"""

from __future__ import annotations

from numbers import Integral, Real
from typing import Any, ClassVar, TypeVar

NANOSECONDS = 1_000_000_000
Self = TypeVar("Self", bound="TVal")


def _split(seconds: float) -> tuple[int, int]:
    whole = int(seconds)
    return whole, int((seconds - whole) * NANOSECONDS)  # genpy also truncates nanoseconds


class TVal:
    """Seconds and nanoseconds, normalised so that 0 <= nsecs < 1e9."""

    __slots__ = ["nsecs", "secs"]
    _slot_types: ClassVar[list[str]] = ["int32", "int32"]
    secs: int
    nsecs: int

    def __init__(self, secs: Any = 0, nsecs: int = 0) -> None:
        if not isinstance(secs, Integral):
            if nsecs:
                raise ValueError("if secs is a float, nsecs cannot be set")
            secs, nsecs = _split(secs)
        secs, nsecs = int(secs), int(nsecs)
        carry, self.nsecs = divmod(nsecs, NANOSECONDS)
        self.secs = secs + carry

    @classmethod
    def from_sec(cls: type[Self], float_secs: float) -> Self:
        """Create a value from float seconds."""
        return cls(*_split(float_secs))

    def is_zero(self) -> bool:
        """Return whether this is zero."""
        return self.secs == 0 and self.nsecs == 0

    def set(self, secs: int, nsecs: int) -> None:
        """Set both parts without normalising."""
        self.secs, self.nsecs = secs, nsecs

    def canon(self) -> None:
        """Normalise the parts."""
        carry, self.nsecs = divmod(self.nsecs, NANOSECONDS)
        self.secs += carry

    def to_sec(self) -> float:
        """Return float seconds."""
        return float(self.secs) + float(self.nsecs) / 1e9

    def to_nsec(self) -> int:
        """Return nanoseconds."""
        return self.secs * NANOSECONDS + self.nsecs

    def __getstate__(self) -> list[int]:
        return [self.secs, self.nsecs]

    def __setstate__(self, state: list[int]) -> None:
        self.secs, self.nsecs = state

    def __hash__(self) -> int:
        return hash((self.secs, self.nsecs))

    def __str__(self) -> str:
        return str(self.to_nsec())

    def __repr__(self) -> str:
        return f"genpy.{type(self).__name__}[{self.to_nsec()}]"

    def __bool__(self) -> bool:
        return not self.is_zero()

    def _order(self, other: Any) -> int | None:
        return self.to_nsec() - other.to_nsec() if isinstance(other, self._family()) else None

    def _family(self) -> type[TVal]:
        return TVal

    def __eq__(self, other: object) -> bool:
        return self._order(other) == 0

    def __lt__(self, other: Any) -> bool:
        order = self._order(other)
        return NotImplemented if order is None else order < 0

    def __le__(self, other: Any) -> bool:
        order = self._order(other)
        return NotImplemented if order is None else order <= 0

    def __gt__(self, other: Any) -> bool:
        order = self._order(other)
        return NotImplemented if order is None else order > 0

    def __ge__(self, other: Any) -> bool:
        order = self._order(other)
        return NotImplemented if order is None else order >= 0


class Time(TVal):
    """A time, never negative."""

    __slots__ = ["nsecs", "secs"]

    def __init__(self, secs: float = 0, nsecs: int = 0) -> None:
        super().__init__(secs, nsecs)
        if self.secs < 0:
            raise TypeError("time values must be positive")

    def _family(self) -> type[TVal]:
        return Time

    def to_time(self) -> float:
        """Return float seconds."""
        return self.to_sec()

    def __add__(self, other: Any) -> Any:
        if not isinstance(other, Duration):
            return NotImplemented
        return type(self)(self.secs + other.secs, self.nsecs + other.nsecs)

    __radd__ = __add__

    def __sub__(self, other: Any) -> Any:
        if isinstance(other, Time):
            return Duration(self.secs - other.secs, self.nsecs - other.nsecs)
        if isinstance(other, Duration):
            return type(self)(self.secs - other.secs, self.nsecs - other.nsecs)
        return NotImplemented


class Duration(TVal):
    """A span of time, positive or negative."""

    __slots__ = ["nsecs", "secs"]

    def _family(self) -> type[TVal]:
        return Duration

    def __neg__(self) -> Any:
        return type(self)(-self.secs, -self.nsecs)

    def __abs__(self) -> Any:
        return self if self.secs >= 0 else -self

    def __add__(self, other: Any) -> Any:
        if not isinstance(other, Duration):
            return NotImplemented
        return type(self)(self.secs + other.secs, self.nsecs + other.nsecs)

    __radd__ = __add__

    def __sub__(self, other: Any) -> Any:
        if not isinstance(other, Duration):
            return NotImplemented
        return type(self)(self.secs - other.secs, self.nsecs - other.nsecs)

    def __mul__(self, factor: Any) -> Any:
        if isinstance(factor, Integral):
            return type(self)(self.secs * int(factor), self.nsecs * int(factor))
        return self.from_sec(self.to_sec() * float(factor)) if isinstance(factor, Real) else NotImplemented

    __rmul__ = __mul__

    def __floordiv__(self, divisor: Any) -> Any:
        if isinstance(divisor, Duration):
            return int(self.to_sec() // divisor.to_sec())
        return self.from_sec(self.to_sec() // float(divisor)) if isinstance(divisor, Real) else NotImplemented

    def __truediv__(self, divisor: Any) -> Any:
        if isinstance(divisor, Duration):
            return self.to_sec() / divisor.to_sec()
        return self.from_sec(self.to_sec() / float(divisor)) if isinstance(divisor, Real) else NotImplemented

    def __mod__(self, divisor: Any) -> Any:
        if not isinstance(divisor, Duration):
            return NotImplemented
        return self.from_sec(self.to_sec() % divisor.to_sec())

    def __divmod__(self, divisor: Any) -> Any:
        return (self // divisor, self % divisor) if isinstance(divisor, Duration) else NotImplemented
