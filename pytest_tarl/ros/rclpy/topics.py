"""rclpy's publishers and subscriptions."""

# ruff: noqa: ARG002 (signatures are rclpy's)

from __future__ import annotations

import inspect
from collections import deque
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypedDict, TypeVar

from pytest_tarl.ros.bus import Topic
from pytest_tarl.ros.messages import ros2_wire
from pytest_tarl.ros.messages.field_values import FieldError
from pytest_tarl.ros.messages.snapshot import type_name
from pytest_tarl.ros.rclpy.exceptions import InvalidHandle
from pytest_tarl.ros.rclpy.qos import DurabilityPolicy, QoSProfile

if TYPE_CHECKING:
    from pytest_tarl.ros.rclpy.node import Node

_VARIADIC = inspect.CO_VARARGS | inspect.CO_VARKEYWORDS


MsgType = TypeVar("MsgType")  # rclpy's name, which nodes use in annotations


class MessageInfo(TypedDict):
    """Times (ns) and sequence numbers that callbacks receive with a message."""

    source_timestamp: int
    received_timestamp: int
    publication_sequence_number: int | None
    reception_sequence_number: int | None


class Publisher:
    """Publishes messages of one type on a topic."""

    def __init__(self, node: Node, msg_type: Any, place: Topic, profile: QoSProfile) -> None:
        _require_message_class(msg_type)
        self.process = node.process
        self.node = node
        self.msg_type = msg_type
        self.type = type_name(msg_type)
        self.qos_profile = profile
        self._place = place
        self._keep = int(profile.durability == DurabilityPolicy.TRANSIENT_LOCAL)
        self._destroyed = False
        self.process.bus.advertise(self, place)

    @property
    def topic_name(self) -> str:
        """Return the resolved topic name."""
        return self._place.name

    topic = topic_name

    def publish(self, msg: Any) -> None:
        """Publish a message or its serialised form. Raise TypeError for a message of another type."""
        if self._destroyed:
            raise InvalidHandle("cannot use Destroyable because destruction was requested")
        if isinstance(msg, bytes):
            msg = ros2_wire.deserialize(msg, self.msg_type)
        if not isinstance(msg, self.msg_type):
            raise TypeError(f"Expected {self.msg_type}, got {type(msg)}")
        try:
            self.process.bus.publish_from(self, self._place, msg, keep=self._keep)
        except FieldError as error:
            raise TypeError(f"{error} (publishing {self.type} on {self._place.name})") from error

    def assert_liveliness(self) -> None:
        """Do nothing: a publisher lives as long as its node."""

    def wait_for_all_acked(self, timeout: Any = None) -> bool:
        """Return True: no message is lost here."""
        return True

    def get_subscription_count(self) -> int:
        """Return the number of subscriptions, including that of the simulated world."""
        return 1 + len(self._place.subscriptions)

    def destroy(self) -> None:
        """Stop publishing."""
        self._destroyed = True
        if self in self._place.publications:
            self._place.publications.remove(self)
            self._place.kept.pop(self, None)


class Subscription:
    """Queues messages for an executor, up to the depth of the profile."""

    def __init__(
        self,
        node: Node,
        msg_type: Any,
        place: Topic,
        callback: Callable[[Any], Any],
        group: Any,
        profile: QoSProfile,
        raw: bool = False,
    ) -> None:
        _require_message_class(msg_type)
        self.process = node.process
        self.node = node
        self.raw = raw
        self.msg_type = self.message_type = msg_type
        self.callback = callback
        self.callback_group = group
        self.qos_profile = profile
        self.queue: deque[Any] = deque(maxlen=profile.capacity)
        # called when a message arrives, in addition to waking the executor
        self.arrived: Callable[[], None] | None = None
        self._place = place
        wants_kept = profile.durability == DurabilityPolicy.TRANSIENT_LOCAL
        self.process.bus.attach(self, place, wants_kept=wants_kept)

    @property
    def topic_name(self) -> str:
        """Return the resolved topic name."""
        return self._place.name

    topic = topic_name

    def deliver(self, message: Any, _origin: Any = None) -> None:
        """Queue a message (dropping the oldest if the queue is full), and wake the node's executor."""
        self.queue.append(message)
        self.node.notify()
        if self.arrived is not None:
            self.arrived()

    def is_ready(self) -> bool:
        """Return whether a message is waiting."""
        return bool(self.queue)

    def run(self) -> Any:
        """Call the callback with the oldest message (its bytes if `raw`), and its times if it takes two arguments."""
        message = self.queue.popleft()
        if self.raw:
            message = ros2_wire.serialize(message)
        return self._callback(message, self._info()) if self._wants_info else self._callback(message)

    @property
    def callback(self) -> Callable[..., Any]:
        """Return the callback for messages."""
        return self._callback

    @callback.setter
    def callback(self, callback: Callable[..., Any]) -> None:
        self._callback = callback
        self._wants_info = _wants_info(callback)

    def _info(self) -> MessageInfo:
        now = self.process.scheduler.time
        return {"source_timestamp": now, "received_timestamp": now, "publication_sequence_number": None,
                "reception_sequence_number": None}  # fmt: skip

    def get_publisher_count(self) -> int:
        """Return the number of publishers, including that of the simulated world."""
        return 1 + len(self._place.publications)

    def destroy(self) -> None:
        """Stop receiving."""
        self.queue.clear()
        if self in self._place.subscriptions:
            self._place.subscriptions.remove(self)


def _wants_info(callback: Callable[..., Any]) -> bool:
    code = getattr(callback, "__code__", None) or getattr(
        getattr(callback, "__func__", None), "__code__", None
    )
    if code is not None and not code.co_flags & _VARIADIC:  # fast path: inspect.signature is slow
        defaults = len(getattr(callback, "__defaults__", None) or ())
        needed = code.co_argcount - defaults - hasattr(callback, "__self__")
        return bool(needed == 2)
    try:
        inspect.signature(callback).bind(None)
    except ValueError:
        return False
    except TypeError:
        return True
    return False


def _require_message_class(msg_type: Any) -> None:
    if not hasattr(msg_type, "get_fields_and_field_types"):
        raise AttributeError(f"{msg_type!r} is not a ROS 2 message type: it has no attribute '_TYPE_SUPPORT'")
