"""The server of interactive markers: it publishes them, and passes user feedback to callbacks."""

# ruff: noqa: ARG002, N802 (names and signatures are those of interactive_markers)

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from pytest_tarl.ros.messages import message_type
from pytest_tarl.ros.messages.snapshot import snapshot

MESSAGES = ["ImageMarker", "InteractiveMarker", "InteractiveMarkerControl", "InteractiveMarkerFeedback",
            "InteractiveMarkerInit", "InteractiveMarkerPose", "InteractiveMarkerUpdate", "Marker", "MarkerArray",
            "MenuEntry"]  # fmt: skip
__all__ = ["InteractiveMarkerServer", *MESSAGES]  # nodes get the messages by `import *` from here

Callbacks = dict[int, Callable[[Any], Any]]
DEFAULT = 255  # event type of the default callback


def __getattr__(name: str) -> Any:
    """Return a message class that the library exports; raise for a name that the stand-in lacks."""
    if name in MESSAGES:
        from pytest_tarl.ros.install import kind_of_caller
        from pytest_tarl.ros.messages import class_of

        return class_of(kind_of_caller(), f"visualization_msgs/{name}")
    raise AttributeError(name)


@dataclass
class _Shown:
    """A marker, with its feedback callbacks by event type."""

    marker: Any
    callbacks: Callbacks = field(default_factory=dict)


class InteractiveMarkerServer:
    """Publishes markers on `NAMESPACE/update` and listens to `NAMESPACE/feedback`.

    `InteractiveMarkerServer(namespace)` in ROS 1, `InteractiveMarkerServer(node, namespace)` in ROS 2. Changes are
    published by `applyChanges`.
    """

    DEFAULT_FEEDBACK_CB = DEFAULT

    def __init__(self, *args: Any, q_size: int = 100, server_id: str = "", **options: Any) -> None:
        self._node = args[0] if args and hasattr(args[0], "create_publisher") else options.pop("node", None)
        rest = args[1:] if args and args[0] is self._node else args
        self._namespace = str(rest[0] if rest else options.get("topic_ns", options.get("namespace", "")))
        self._package = "visualization_msgs/" if self._node is None else "visualization_msgs/msg/"
        self._id = server_id
        self._number = 0
        self._shown: dict[str, _Shown] = {}
        self._waiting: dict[str, _Shown | None] = {}  # None for a marker to be erased
        self._moved: dict[str, Any] = {}  # marker name → new pose, for markers that have only moved
        self._update = self._publisher("update", "InteractiveMarkerUpdate")
        self._full = self._publisher("update_full", "InteractiveMarkerInit")
        self._subscription = self._subscribe("feedback", "InteractiveMarkerFeedback", self.processFeedback)
        self._publish_full()

    def insert(
        self,
        marker: Any,
        feedback_callback: Callable[[Any], Any] | int | None = None,
        feedback_type: int = DEFAULT,
    ) -> None:
        """Add a marker, or replace the one with the same name, keeping its callbacks."""
        now = self._waiting.get(marker.name) or self._shown.get(marker.name)
        self._waiting[marker.name] = _Shown(snapshot(marker), now.callbacks if now is not None else {})
        self._moved.pop(marker.name, None)
        if callable(feedback_callback):
            self.setCallback(marker.name, feedback_callback, feedback_type)

    def setPose(self, name: str, pose: Any, header: Any = None) -> bool:
        """Move a marker; return whether it exists. The pose is in the marker's frame unless `header` names another."""
        known = self._newest(name)
        if known is None:
            return False
        if header is not None and header.frame_id:
            known.marker.header = header
        known.marker.pose = pose
        if self._waiting.get(name) is None:
            self._moved[name] = self._message("InteractiveMarkerPose")(
                header=known.marker.header, pose=pose, name=name
            )
        return True

    def erase(self, name: str) -> bool:
        """Remove a marker; return whether it existed."""
        known = self._newest(name) is not None
        self._waiting[name] = None
        self._moved.pop(name, None)
        return known

    def clear(self) -> None:
        """Remove all markers."""
        for name in (*self._shown, *self._waiting):
            self.erase(name)

    def setCallback(
        self, name: str, feedback_callback: Callable[[Any], Any] | int | None, feedback_type: int = DEFAULT
    ) -> bool:
        """Set or remove the callback for an event type; return whether the marker exists."""
        known = self._newest(name)
        if known is None:
            return False
        if callable(feedback_callback):
            known.callbacks[feedback_type] = feedback_callback
        else:
            known.callbacks.pop(feedback_type, None)
        return True

    def get(self, name: str) -> Any:
        """Return a copy of a marker with all changes, or None if it does not exist."""
        known = self._newest(name)
        return None if known is None else snapshot(known.marker)

    def applyChanges(self) -> None:
        """Publish all changes since the last call."""
        if not self._waiting and not self._moved:
            return
        changed = {name: shown for name, shown in self._waiting.items() if shown is not None}
        erased = [name for name, shown in self._waiting.items() if shown is None]
        for name in erased:
            self._shown.pop(name, None)
        self._shown.update(changed)
        self._number += 1
        message: Any = self._message("InteractiveMarkerUpdate")(
            server_id=self._id, seq_num=self._number, erases=erased, poses=list(self._moved.values())
        )
        message.type, message.markers = message.UPDATE, [shown.marker for shown in changed.values()]
        self._waiting.clear()
        self._moved.clear()
        self._update.publish(message)
        self._publish_full()

    def processFeedback(self, feedback: Any) -> None:
        """Move the marker if the user dragged it, and call the callback for the event."""
        shown = self._shown.get(feedback.marker_name)
        if shown is None:
            return
        if feedback.event_type == feedback.POSE_UPDATE:
            self.setPose(feedback.marker_name, feedback.pose, feedback.header)
        callback = shown.callbacks.get(feedback.event_type, shown.callbacks.get(DEFAULT))
        if callback is not None:
            callback(feedback)

    def shutdown(self) -> None:
        """Remove all markers."""
        self.clear()
        self.applyChanges()

    def _newest(self, name: str) -> _Shown | None:
        return self._waiting[name] if name in self._waiting else self._shown.get(name)

    def _publish_full(self) -> None:
        """Publish all markers for clients that join later."""
        markers = [shown.marker for shown in self._shown.values()]
        make: Any = self._message("InteractiveMarkerInit")
        self._full.publish(make(server_id=self._id, seq_num=self._number, markers=markers))

    def _message(self, name: str) -> Any:
        return message_type(self._package + name)

    def _publisher(self, topic: str, name: str) -> Any:
        full, path = topic == "update_full", f"{self._namespace}/{topic}"
        if self._node is None:
            from pytest_tarl.ros.rospy.topics import Publisher

            return Publisher(path, self._message(name), latch=full, queue_size=100)
        from pytest_tarl.ros.rclpy.qos import DurabilityPolicy, QoSProfile

        kept = DurabilityPolicy.TRANSIENT_LOCAL if full else DurabilityPolicy.VOLATILE
        return self._node.create_publisher(self._message(name), path, QoSProfile(depth=100, durability=kept))

    def _subscribe(self, topic: str, name: str, callback: Callable[[Any], None]) -> Any:
        path = f"{self._namespace}/{topic}"
        if self._node is None:
            from pytest_tarl.ros.rospy.topics import Subscriber

            return Subscriber(path, self._message(name), callback, queue_size=100)
        return self._node.create_subscription(self._message(name), path, callback, 100)
