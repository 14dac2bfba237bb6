"""rclpy's times, durations and clocks, all on the virtual clock."""

# ruff: noqa: ARG002 (signatures are rclpy's)

from __future__ import annotations

from enum import Enum, IntEnum
from typing import Any

from pytest_tarl.ros.clock import NANOSECONDS
from pytest_tarl.ros.messages import find_class
from pytest_tarl.ros.polling import asked
from pytest_tarl.ros.process import current_process
from pytest_tarl.ros.scheduler import Scheduler

CONVERSION_CONSTANT = S_TO_NS = NANOSECONDS


class ClockType(Enum):
    """The clock of a time. It prints as `ClockType.ROS_TIME`; it is not an int, but `int` converts it."""

    UNINITIALIZED = 0
    ROS_TIME = 1
    SYSTEM_TIME = 2
    STEADY_TIME = 3

    def __int__(self) -> int:
        return int(self.value)


class Duration:
    """A duration in nanoseconds."""

    def __init__(self, *, seconds: float = 0, nanoseconds: float = 0) -> None:
        self._nanoseconds = int(seconds * NANOSECONDS) + int(nanoseconds)

    @property
    def nanoseconds(self) -> int:
        """Return the duration in nanoseconds."""
        return self._nanoseconds

    def __add__(self, other: Any) -> Duration:
        if not isinstance(other, Duration):
            return NotImplemented
        return Duration(nanoseconds=self._nanoseconds + other.nanoseconds)

    def __sub__(self, other: Any) -> Duration:
        if not isinstance(other, Duration):
            return NotImplemented
        return Duration(nanoseconds=self._nanoseconds - other.nanoseconds)

    def __mul__(self, factor: Any) -> Duration:
        if not isinstance(factor, int | float):
            return NotImplemented
        return Duration(nanoseconds=self._nanoseconds * factor)

    __rmul__ = __mul__

    def to_msg(self) -> Any:
        """Convert to builtin_interfaces/Duration."""
        made: Any = find_class("ros2", "builtin_interfaces", "Duration")
        sec, nanosec = divmod(self._nanoseconds, NANOSECONDS)
        return made(sec=sec, nanosec=nanosec)

    @classmethod
    def from_msg(cls, msg: Any) -> Duration:
        """Create a duration from builtin_interfaces/Duration."""
        return cls(seconds=msg.sec, nanoseconds=msg.nanosec)

    def __repr__(self) -> str:
        return f"Duration(nanoseconds={self._nanoseconds})"

    def __str__(self) -> str:
        return f"{self._nanoseconds} nanoseconds"

    def __hash__(self) -> int:
        return hash(self._nanoseconds)

    def __eq__(self, other: object) -> bool:
        return self._nanoseconds == other.nanoseconds if isinstance(other, Duration) else NotImplemented

    def __lt__(self, other: Any) -> bool:
        return self._nanoseconds < other.nanoseconds if isinstance(other, Duration) else NotImplemented

    def __le__(self, other: Any) -> bool:
        return self._nanoseconds <= other.nanoseconds if isinstance(other, Duration) else NotImplemented

    def __gt__(self, other: Any) -> bool:
        return self._nanoseconds > other.nanoseconds if isinstance(other, Duration) else NotImplemented

    def __ge__(self, other: Any) -> bool:
        return self._nanoseconds >= other.nanoseconds if isinstance(other, Duration) else NotImplemented


class Time:
    """A time in nanoseconds of one clock type; times of different clock types cannot be compared."""

    def __init__(
        self, *, seconds: float = 0, nanoseconds: int = 0, clock_type: ClockType = ClockType.SYSTEM_TIME
    ) -> None:
        if seconds < 0 or nanoseconds < 0:
            raise ValueError("Seconds value must not be negative" if seconds < 0
                             else "Nanoseconds value must not be negative")  # fmt: skip
        self._nanoseconds = int(seconds * NANOSECONDS) + int(nanoseconds)
        self._clock_type = clock_type

    @property
    def nanoseconds(self) -> int:
        """Return nanoseconds since the clock's epoch."""
        return self._nanoseconds

    @property
    def clock_type(self) -> ClockType:
        """Return the clock type."""
        return self._clock_type

    def seconds_nanoseconds(self) -> tuple[int, int]:
        """Return whole seconds and remaining nanoseconds."""
        return divmod(self._nanoseconds, NANOSECONDS)

    def to_msg(self) -> Any:
        """Convert to builtin_interfaces/Time."""
        made: Any = find_class("ros2", "builtin_interfaces", "Time")
        sec, nanosec = self.seconds_nanoseconds()
        return made(sec=sec, nanosec=nanosec)

    @classmethod
    def from_msg(cls, msg: Any, clock_type: ClockType = ClockType.ROS_TIME) -> Time:
        """Create a time from builtin_interfaces/Time."""
        return cls(seconds=msg.sec, nanoseconds=msg.nanosec, clock_type=clock_type)

    def __repr__(self) -> str:
        return f"Time(nanoseconds={self._nanoseconds}, clock_type={self._clock_type.name})"

    def __hash__(self) -> int:
        return hash((self._nanoseconds, self._clock_type))

    def __add__(self, other: Any) -> Time:
        if not isinstance(other, Duration):
            return NotImplemented
        return Time(nanoseconds=self._nanoseconds + other.nanoseconds, clock_type=self._clock_type)

    __radd__ = __add__

    def __sub__(self, other: Any) -> Any:
        if isinstance(other, Time):
            self._require_same_clock(other, "Can't subtract times with different clock types")
            return Duration(nanoseconds=self._nanoseconds - other.nanoseconds)
        if isinstance(other, Duration):
            return Time(nanoseconds=self._nanoseconds - other.nanoseconds, clock_type=self._clock_type)
        return NotImplemented

    def _require_same_clock(
        self, other: Time, message: str = "Can't compare times with different clock types"
    ) -> None:
        if self._clock_type != other.clock_type:
            raise TypeError(message)

    def _behind(self, other: Any) -> int | None:
        if not isinstance(other, Time):
            return None
        self._require_same_clock(other)
        return self._nanoseconds - other.nanoseconds

    def __eq__(self, other: object) -> bool:
        return self._behind(other) == 0

    def __lt__(self, other: Any) -> bool:
        behind = self._behind(other)
        return NotImplemented if behind is None else behind < 0

    def __le__(self, other: Any) -> bool:
        behind = self._behind(other)
        return NotImplemented if behind is None else behind <= 0

    def __gt__(self, other: Any) -> bool:
        behind = self._behind(other)
        return NotImplemented if behind is None else behind > 0

    def __ge__(self, other: Any) -> bool:
        behind = self._behind(other)
        return NotImplemented if behind is None else behind >= 0


class ClockChange(IntEnum):
    """How a clock jumped."""

    ROS_TIME_NO_CHANGE = 1
    ROS_TIME_ACTIVATED = 2
    ROS_TIME_DEACTIVATED = 3
    SYSTEM_TIME_NO_CHANGE = 4


class JumpThreshold:
    """The smallest clock jump to report."""

    def __init__(
        self, *, min_forward: Duration | None, min_backward: Duration | None, on_clock_change: bool = True
    ) -> None:
        self.min_forward, self.min_backward = min_forward, min_backward
        self.on_clock_change = on_clock_change


class JumpHandle:
    """Keeps the callbacks for clock jumps."""

    def unregister(self) -> None:
        """Drop the callbacks."""

    def __enter__(self) -> JumpHandle:
        return self

    def __exit__(self, *_: object) -> None:
        self.unregister()


class Clock:
    """Reads the virtual clock, whatever the clock type."""

    def __init__(self, *, clock_type: ClockType = ClockType.SYSTEM_TIME) -> None:
        self._process = current_process("rclpy.clock.Clock")
        self.clock_type = clock_type

    @property
    def _scheduler(self) -> Scheduler:
        return self._process.scheduler

    def now(self) -> Time:
        """Return the current time."""
        asked()
        return Time(nanoseconds=self._scheduler.time, clock_type=self.clock_type)

    def create_jump_callback(
        self, threshold: Any, *, pre_callback: Any = None, post_callback: Any = None
    ) -> JumpHandle:
        """Accept callbacks for clock jumps, which never happen here. Raise ValueError if there is none."""
        if pre_callback is None and post_callback is None:
            raise ValueError("One of pre_callback or post_callback must be callable")
        return JumpHandle()

    def __repr__(self) -> str:
        return f"Clock(clock_type={self.clock_type.name})"

    def sleep_until(self, until: Time, context: Any = None) -> bool:
        """Wait until a time; return whether it came before the shutdown."""
        while self._scheduler.time < until.nanoseconds and not self._process.ending:
            self._scheduler.wait(until.nanoseconds)
        return not self._process.ending

    def sleep_for(self, rel_time: Duration, context: Any = None) -> bool:
        """Wait for a duration; return whether it passed before the shutdown."""
        return self.sleep_until(self.now() + rel_time)


class ROSClock(Clock):
    """A node's clock."""

    def __init__(self) -> None:
        super().__init__(clock_type=ClockType.ROS_TIME)

    @property
    def ros_time_is_active(self) -> bool:
        """Return True: the time comes from the simulation."""
        return True


class Infinite:
    """An infinite duration."""

    nanoseconds = 2**63 - 1
