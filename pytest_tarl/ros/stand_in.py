"""Replace a node of a launch file by a function of the test, which uses the node's topic and service names."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from pytest_tarl.errors import SettingsError
from pytest_tarl.ros.clock import nanoseconds
from pytest_tarl.ros.launch_plan import Launched
from pytest_tarl.ros.process import Process
from pytest_tarl.ros.scheduler import Task

if TYPE_CHECKING:
    from pytest_tarl.ros.episode import Ros


class StandIn:
    """The interface for a function that replaces a node. Names are those in the node's code, before remapping."""

    def __init__(self, ros: Ros, launched: Launched) -> None:
        self.name = launched.name
        self._ros = ros
        self._launched = launched
        self._process = _OfTest(ros, launched.name, (launched.name,))
        ros.processes.append(self._process)

    def resolve(self, name: str) -> str:
        """Return the full name of a topic or service, after the launch file's namespace and remappings."""
        return self._launched.resolve(name)

    def parameter(self, name: str, default: Any = None) -> Any:
        """Return a parameter that the launch file gives the node, or the default."""
        given = self._launched.given
        return given.private.get(name, given.shared.get(self.resolve(name), default))

    def publish(self, topic: str, message: Any, *, latch: bool = False) -> None:
        """Publish a message, as `tarl.bus.publish` does."""
        self._ros.bus.publish(self.resolve(topic), message, latch=latch)

    def subscribe(self, topic: str, callback: Callable[[Any], None]) -> None:
        """Call the callback with every message published by a node on the topic."""
        self._ros.bus.subscribe(self.resolve(topic), callback)

    def latest(self, topic: str) -> Any | None:
        """Return the newest message published by a node on the topic, or None before the first one."""
        return self._ros.bus.latest(self.resolve(topic))

    def serve(self, service: str, service_type: Any, handler: Callable[[Any], Any]) -> None:
        """Serve a service (in-process ROS only); `handler(request)` returns the response."""
        self._ros.bus.serve(self.resolve(service), service_type, handler)

    def every(self, seconds: float, function: Callable[[], object]) -> None:
        """Call the function at the start of the next step, and then every `seconds` of virtual time.

        Raise SettingsError unless the period is positive.
        """
        if not 0 < seconds < math.inf:
            raise SettingsError(f"{self.name}: every({seconds!r}, …) needs a positive number of seconds.")
        self._ros.spawn(self._process, self._repeat, nanoseconds(seconds), function)

    def _repeat(self, period: int, function: Callable[[], object]) -> None:
        scheduler = self._ros.scheduler
        due = scheduler.time
        while not self._process.ending:
            if not scheduler.wait(due):
                function()
                due += period


class _OfTest(Process):
    """The process of a function that replaces a node; its errors are raised in the test unchanged."""

    def failed(self, task: Task, error: BaseException) -> None:  # noqa: ARG002
        """Raise the error in the test, unless the episode is over."""
        if not self.ending and self.scheduler.failure is None:
            self.scheduler.failure = error
