"""`rostopic.ROSTopicHz`: measures a topic's rate in virtual time."""

# ruff: noqa: ARG002 (signatures are rostopic's)

from __future__ import annotations

import math
from collections import deque
from itertools import pairwise
from typing import Any

from pytest_tarl.ros.rospy.log import loginfo
from pytest_tarl.ros.rospy.timing import get_time

Rate = tuple[
    float, float, float, float, int
]  # rate (Hz); shortest and longest period and their standard deviation (s); number of messages


class ROSTopicHz:
    """Receives messages in `callback_hz` and returns rates from `get_hz`, over the last `window_size` periods."""

    def __init__(self, window_size: int, filter_expr: Any = None, use_wtime: bool = False) -> None:
        self.window_size = window_size if window_size > 0 else 50_000
        self.filter_expr = filter_expr
        self._times: dict[str | None, deque[float]] = {}

    def callback_hz(self, m: Any, topic: str | None = None) -> None:
        """Receive a message on a topic."""
        if self.filter_expr is None or self.filter_expr(m):
            kept = self._times.setdefault(topic, deque(maxlen=self.window_size + 1))
            kept.append(get_time())

    def get_hz(self, topic: str | None = None) -> Rate | None:
        """Return the rate, statistics of the periods, and the number of messages; None before the second message."""
        times = [*self._times.get(topic, ())]
        periods = [later - earlier for earlier, later in pairwise(times)]
        if not periods or not sum(periods):
            return None
        mean = sum(periods) / len(periods)
        deviation = math.sqrt(sum((period - mean) ** 2 for period in periods) / len(periods))
        return 1 / mean, min(periods), max(periods), deviation, len(times)

    def print_hz(self, topics: Any = (None,)) -> None:
        """Log the rates of topics."""
        for topic in topics:
            found = self.get_hz(topic)
            loginfo(
                f"{topic or 'topic'}: "
                + ("no new messages" if found is None else f"average rate: {found[0]:.3f}")
            )
