"""Diagnostic tasks for topics: how often messages are published, and how old their stamps are."""

from __future__ import annotations

import math
import threading
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from pytest_tarl.ros.clock import NANOSECONDS
from pytest_tarl.ros.diagnostic_updater.tasks import CompositeDiagnosticTask, DiagnosticTask
from pytest_tarl.ros.process import current_process


class Heartbeat(DiagnosticTask):
    """A task that is always OK."""

    def __init__(self) -> None:
        super().__init__("Heartbeat")

    def run(self, stat: Any) -> Any:
        """Set "Alive"."""
        stat.set_level(0, "Alive")
        return stat


@dataclass(eq=False)
class FrequencyStatusParam:
    """Limits of a frequency (Hz): `freq_bound` has the keys "min" and, optionally, "max"; `tolerance` is relative."""

    freq_bound: Mapping[str, float]
    tolerance: float = 0.1
    window_size: int = 5  # number of updates


class FrequencyStatus(DiagnosticTask):
    """Check how often `tick` is called."""

    def __init__(self, params: FrequencyStatusParam, name: str = "FrequencyStatus") -> None:
        super().__init__(name)
        self.params = params
        self.lock = threading.Lock()
        self.clear()

    def clear(self) -> None:
        """Forget all events."""
        self.count = 0
        self._marks = [(_now(), 0)] * self.params.window_size  # (time (s), number of events) at each update

    def tick(self) -> None:
        """Count an event."""
        self.count += 1

    def run(self, stat: Any) -> Any:
        """Compare the frequency with the limits, since the oldest update in the window."""
        began, before = self._marks[0]
        self._marks = [*self._marks[1:], (_now(), self.count)]
        events, window = self.count - before, _now() - began
        # virtual time, unlike real time, may stand still between two calls
        frequency = events / window if window else math.inf if events else 0.0
        least = self.params.freq_bound["min"] * (1 - self.params.tolerance)
        bound = self.params.freq_bound.get("max")
        most = None if bound is None else bound * (1 + self.params.tolerance)
        if events == 0:
            stat.set_level(2, "No events recorded.")
        elif frequency < least:
            stat.set_level(1, "Frequency too low.")
        elif most is not None and frequency > most:
            stat.set_level(1, "Frequency too high.")
        else:
            stat.set_level(0, "Desired frequency met")
        stat.add("Events in window", f"{events:d}")
        stat.add("Events since startup", f"{self.count:d}")
        stat.add("Duration of window (s)", f"{window:f}")
        stat.add("Actual frequency (Hz)", f"{frequency:f}")
        if bound == self.params.freq_bound["min"]:
            stat.add("Target frequency (Hz)", f"{bound:f}")
        if self.params.freq_bound["min"] > 0:
            stat.add("Minimum acceptable frequency (Hz)", f"{least:f}")
        if most is not None:
            stat.add("Maximum acceptable frequency (Hz)", f"{most:f}")
        return stat


@dataclass(eq=False)
class TimeStampStatusParam:
    """Limits of a stamp's age in seconds."""

    min_acceptable: float = -1
    max_acceptable: float = 5


class TimeStampStatus(DiagnosticTask):
    """Check the ages of the stamps given to `tick`."""

    def __init__(self, params: TimeStampStatusParam | None = None, name: str = "Timestamp Status") -> None:
        super().__init__(name)
        self.params = TimeStampStatusParam() if params is None else params
        self.lock = threading.Lock()
        self.early_count = self.late_count = self.zero_count = 0
        self._ages: list[float] = []  # ages (s) of the stamps since the last update
        self._zero = False

    def tick(self, stamp: Any) -> None:
        """Record a stamp: seconds, or a time of ROS 1 or ROS 2."""
        seconds = _seconds(stamp)
        if seconds == 0:
            self._zero = True
        else:
            self._ages.append(_now() - seconds)

    def run(self, stat: Any) -> Any:
        """Compare the youngest and the oldest stamp since the last update with the limits."""
        youngest, oldest = min(self._ages, default=0.0), max(self._ages, default=0.0)
        stat.set_level(0, "Timestamps are reasonable.")
        if not self._ages:
            stat.set_level(1, "No data since last update.")
        else:
            if youngest < self.params.min_acceptable:
                stat.set_level(2, "Timestamps too far in future seen.")
                self.early_count += 1
            if oldest > self.params.max_acceptable:
                stat.set_level(2, "Timestamps too far in past seen.")
                self.late_count += 1
            if self._zero:
                stat.set_level(2, "Zero timestamp seen.")
                self.zero_count += 1
        stat.add("Earliest timestamp delay:", f"{youngest:f}")
        stat.add("Latest timestamp delay:", f"{oldest:f}")
        stat.add("Earliest acceptable timestamp delay:", f"{self.params.min_acceptable:f}")
        stat.add("Latest acceptable timestamp delay:", f"{self.params.max_acceptable:f}")
        stat.add("Late diagnostic update count:", f"{self.late_count:d}")
        stat.add("Early diagnostic update count:", f"{self.early_count:d}")
        stat.add("Zero seen diagnostic update count:", f"{self.zero_count:d}")
        self._ages, self._zero = [], False
        return stat


class HeaderlessTopicDiagnostic(CompositeDiagnosticTask):
    """Adds a check of a topic's frequency to an updater."""

    def __init__(self, name: str, diag: Any, freq: FrequencyStatusParam) -> None:
        super().__init__(f"{name} topic status")
        self.diag = diag
        self.freq = FrequencyStatus(freq)
        self.addTask(self.freq)
        self.diag.add(self)

    def tick(self) -> None:
        """Count a message."""
        self.freq.tick()

    def clear_window(self) -> None:
        """Forget all messages."""
        self.freq.clear()


class TopicDiagnostic(HeaderlessTopicDiagnostic):
    """Adds a check of a topic's frequency and time stamps to an updater."""

    def __init__(self, name: str, diag: Any, freq: FrequencyStatusParam, stamp: TimeStampStatusParam) -> None:
        super().__init__(name, diag, freq)
        self.stamp = TimeStampStatus(stamp)
        self.addTask(self.stamp)

    def tick(self, stamp: Any) -> None:  # type: ignore[override]  # as in the library
        """Count a message with its stamp."""
        self.stamp.tick(stamp)
        super().tick()


class DiagnosedPublisher(TopicDiagnostic):
    """A publisher that counts its messages, which need a header."""

    def __init__(self, pub: Any, diag: Any, freq: FrequencyStatusParam, stamp: TimeStampStatusParam) -> None:
        topic = getattr(pub, "name", None)  # publishers of rospy have `name`, those of rclpy `topic`
        super().__init__(pub.topic_name if topic is None else topic, diag, freq, stamp)
        self.publisher = pub

    def publish(self, message: Any) -> None:
        """Count a message, and publish it."""
        self.tick(message.header.stamp)
        self.publisher.publish(message)


def _now() -> float:
    return current_process("diagnostic_updater").scheduler.time / NANOSECONDS


def _seconds(stamp: Any) -> float:
    if hasattr(stamp, "to_sec"):
        return float(stamp.to_sec())
    if hasattr(stamp, "nanoseconds"):
        return float(stamp.nanoseconds) / NANOSECONDS
    if hasattr(stamp, "nanosec"):
        return float(stamp.sec + stamp.nanosec / NANOSECONDS)
    return float(stamp)
