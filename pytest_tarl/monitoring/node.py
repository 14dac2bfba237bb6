"""Run a watch as a ROS node that publishes on /diagnostics."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from importlib import import_module
from threading import Event
from typing import Any

from pytest_tarl.errors import SettingsError
from pytest_tarl.monitoring import words
from pytest_tarl.monitoring.status import Evidence, Status
from pytest_tarl.monitoring.watch import Watch

LIBRARIES = ("rclpy", "rospy")
TOPIC = "/diagnostics"
NAME = "tarl_watch"
OK, WARN, ERROR = 0, 1, 2  # levels of DiagnosticStatus

NOTICED = 0.5  # maximum time between a signal and the end of the watch (s)

Look = Callable[[], tuple[bool, Watch, Status]]  # returns whether to continue, the watch, and its status


def run(library: str, look: Look, period: float, stopped: Event) -> None:
    """Read the logs every `period` seconds of ROS time and publish the status.

    Stop when a signal handler sets `stopped` or when ROS shuts the node down. ROS's own signal handlers are not
    installed: they would shut the node down in the middle of a publish call. Raise SettingsError if the library or the
    message package is not installed.
    """
    try:
        ros, messages = import_module(library), import_module("diagnostic_msgs.msg")
    except ImportError as missing:
        raise SettingsError(
            f"--diagnostics {library} needs {missing.name}, which is not installed: source the setup.bash of your "
            "ROS, and install its package diagnostic_msgs."
        ) from None
    (_rospy if library == "rospy" else _rclpy)(ros, messages, look, period, stopped)


def array(messages: Any, stamp: Any, watch: Watch, status: Status, *, bytes_level: bool) -> Any:
    """Return the status as a message: WARN if the world changed, ERROR if a bound is violated.

    `bytes_level` says whether levels are bytes, as in ROS 2, or numbers, as in ROS 1.
    """
    level = ERROR if status.below else WARN if status.drifted else OK
    entry = messages.DiagnosticStatus()
    entry.level = bytes([level]) if bytes_level else level
    entry.name = f"tarl: {watch.fixture.test}"
    entry.message = words.headline(watch, status)
    entry.hardware_id = ", ".join(str(reader.path) for reader in watch.readers)
    entry.values = [messages.KeyValue(key=key, value=value) for key, value in values(watch, status)]
    found = messages.DiagnosticArray()
    found.header.stamp = stamp
    found.status = [entry]
    return found


def values(watch: Watch, status: Status) -> list[tuple[str, str]]:
    """Return the status as keys and values.

    Evidence is given as log10; -log10(alpha) raises an alarm.
    """
    found = [
        ("missions", str(status.missions)),
        ("passed", str(status.passed)),
        ("alpha", f"{status.alpha:g}"),
    ]
    for bound, evidence in status.bounds:
        found += [
            (f"{bound.what}.at_least", f"{bound.least:g}"),
            (f"{bound.what}.confidence", f"{bound.confidence:g}"),
        ]
        found += _values(bound.what, evidence)
    found += _values("world", status.world)
    where = words.vocabulary(watch, status).words(status.cells) if status.cells else ""
    return [*found, ("where", where), ("problems", " ".join(watch.problems))]


def _values(name: str, evidence: Evidence | None) -> list[tuple[str, str]]:
    if evidence is None:
        return []
    since = "" if evidence.since is None else str(evidence.since.mission)
    alarm = "" if evidence.alarm is None else str(evidence.alarm.mission)
    return [
        (f"{name}.log10_evidence", f"{evidence.now:.4f}"),
        (f"{name}.since", since),
        (f"{name}.alarm", alarm),
    ]


def _rospy(rospy: Any, messages: Any, look: Look, period: float, stopped: Event) -> None:
    rospy.init_node(NAME, anonymous=True, disable_signals=True)
    publisher = rospy.Publisher(TOPIC, messages.DiagnosticArray, queue_size=1, latch=True)
    with suppress(rospy.ROSInterruptException):
        while not rospy.is_shutdown():
            go_on, watch, status = look()
            publisher.publish(array(messages, rospy.Time.now(), watch, status, bytes_level=False))
            if not go_on:
                return
            due = rospy.get_time() + period
            while not stopped.is_set() and rospy.get_time() < due:
                rospy.sleep(min(NOTICED, period))


def _rclpy(rclpy: Any, messages: Any, look: Look, period: float, stopped: Event) -> None:
    rclpy.init(signal_handler_options=import_module("rclpy.signals").SignalHandlerOptions.NO)
    node = rclpy.create_node(NAME)
    publisher = node.create_publisher(messages.DiagnosticArray, TOPIC, 1)
    going = True

    def tick() -> None:
        nonlocal going
        going, watch, status = look()
        stamp = node.get_clock().now().to_msg()
        publisher.publish(array(messages, stamp, watch, status, bytes_level=True))

    node.create_timer(period, tick)
    try:
        tick()
        with suppress(import_module("rclpy.executors").ExternalShutdownException):
            while going and not stopped.is_set() and rclpy.ok():
                rclpy.spin_once(node, timeout_sec=NOTICED)
    finally:
        node.destroy_node()
        if rclpy.ok():
            rclpy.shutdown()
