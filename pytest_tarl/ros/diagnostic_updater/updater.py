"""The updater: it runs its tasks once per period and publishes their statuses on /diagnostics."""

# ruff: noqa: N802 (names are those of diagnostic_updater)

from __future__ import annotations

from typing import Any

from pytest_tarl.ros.clock import NANOSECONDS
from pytest_tarl.ros.diagnostic_updater.status import number, wrapper_of
from pytest_tarl.ros.diagnostic_updater.tasks import DiagnosticTaskVector
from pytest_tarl.ros.messages import class_of
from pytest_tarl.ros.messages.type_definitions import Kind
from pytest_tarl.ros.process import current_process

_CHECK_SECONDS = 0.25  # seconds between two reads of the period from the parameter server (rospy)
_NO_ID = (
    "diagnostic_updater: no hardware ID was set: call setHardwareID, with 'none' for a device without one."
)


class Updater(DiagnosticTaskVector):
    """`Updater()` in ROS 1, where the node calls `update`; `Updater(node, period)` in ROS 2, with a timer."""

    def __init__(self, node: Any = None, period: float = 1.0) -> None:
        super().__init__()
        self.node = node
        self.verbose, self.hwid, self.warn_nohwid_done = False, "", False
        self._kind: Kind = "ros1" if node is None else "ros2"
        self._array: Any = class_of(self._kind, "diagnostic_msgs/DiagnosticArray")
        self.last_time = self._read_at = _seconds()
        if node is None:
            from pytest_tarl.ros.rospy.topics import Publisher

            self.period: float = 1
            self.publisher: Any = Publisher("/diagnostics", self._array, queue_size=10)
            return
        self.publisher = node.create_publisher(self._array, "/diagnostics", 1)
        self.period = node.declare_parameter("diagnostic_updater.period", float(period)).value
        self._full_name = node.declare_parameter("diagnostic_updater.use_fqn", False).value
        self.timer = node.create_timer(self.period, self.update)

    def update(self) -> None:
        """Run the tasks and publish, if a period has passed since the last update."""
        if self.node is None and _seconds() >= self._read_at + _CHECK_SECONDS:
            from pytest_tarl.ros.rospy.parameters import get_param

            self.period, self._read_at = get_param("~diagnostic_period", 1), _seconds()
        if _seconds() >= self.last_time + self.period:
            self.force_update()

    def force_update(self) -> None:
        """Run the tasks and publish now."""
        self.last_time = _seconds()
        with self.lock:
            statuses = [self._run(task) for task in self.tasks]
        if not self.hwid and not self.warn_nohwid_done and not any(number(one.level) for one in statuses):
            self._warn(_NO_ID)
            self.warn_nohwid_done = True
        self.publish(statuses)

    def broadcast(self, lvl: Any, msg: str) -> None:
        """Publish the same level and message for all tasks."""
        statuses = [self._status(task.name) for task in self.tasks]
        for status in statuses:
            status.summary(lvl, msg)
        self.publish(statuses)

    def setHardwareID(self, hwid: str) -> None:
        """Set the `hardware_id` of all statuses."""
        self.hwid = hwid

    def publish(self, msg: Any) -> None:
        """Publish one or more statuses, with the node's name before each status's own."""
        statuses = msg if isinstance(msg, list) else [msg]
        for status in statuses:
            status.name = f"{self._name()}: {status.name}"
        message = self._array(status=statuses)
        message.header.stamp = self._stamp()
        self.publisher.publish(message)

    def addedTaskCallback(self, task: Any) -> None:
        """Publish that the node is starting."""
        status = self._status(task.name)
        status.set_level(0, "Node starting up")
        self.publish(status)

    def _status(self, name: str) -> Any:
        return wrapper_of(self._kind)(name=name)

    def _run(self, task: Any) -> Any:
        status = self._status(task.name)
        status.set_level(2, "No message was set")
        status.hardware_id = self.hwid
        task.run(status)
        if self.verbose and number(status.level):
            self._warn(f"Task '{status.name}' has level {number(status.level)}: '{status.message}'")
        return status

    def _name(self) -> str:
        if self.node is None:
            from pytest_tarl.ros.rospy.node import get_name

            return get_name()[1:]
        return str(self.node.get_fully_qualified_name() if self._full_name else self.node.get_name())

    def _stamp(self) -> Any:
        if self.node is None:
            from pytest_tarl.ros.rospy.timing import get_rostime

            return get_rostime()
        return self.node.get_clock().now().to_msg()

    def _warn(self, text: str) -> None:
        if self.node is None:
            from pytest_tarl.ros.rospy.log import logwarn

            logwarn(text)
        else:
            self.node.get_logger().warning(text)


def _seconds() -> float:
    return current_process("diagnostic_updater").scheduler.time / NANOSECONDS
