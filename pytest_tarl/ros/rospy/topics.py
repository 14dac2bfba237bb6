"""rospy's publishers and subscribers."""

# ruff: noqa: ARG002 (signatures are rospy's)

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from io import BytesIO
from typing import Any

from pytest_tarl.ros.clock import nanoseconds
from pytest_tarl.ros.messages.field_values import FieldError
from pytest_tarl.ros.messages.snapshot import is_message, type_name
from pytest_tarl.ros.process import Process
from pytest_tarl.ros.rospy.exceptions import ROSException, ROSInterruptException, ROSSerializationException
from pytest_tarl.ros.rospy.node import this_node, warn_if_illegal
from pytest_tarl.ros.scheduler import current_task

Callback = tuple[Callable[..., Any], Any]
DEFAULT_BUFF_SIZE = 65536


class AnyMsg:
    """Subscribes to topics of any type; messages arrive in their own class."""

    _type = "*"
    _md5sum = "*"
    _slot_types: tuple[str, ...] = ()


class Inbox:
    """A process's subscriptions to one topic; handles one message at a time, like rospy's thread."""

    def __init__(self, process: Process, topic: str, message_type: type | None) -> None:
        self.process = process
        self.topic = topic
        self.message_type = message_type
        self.callbacks: list[Callback] = []
        self.subscribers = 0  # number of Subscriber objects that are still registered
        self.capacity: int | None = None
        self._waiting: deque[Any] = deque()
        self._busy = False

    def deliver(self, message: Any, origin: Any = None) -> None:
        """Call the callbacks with a message, or queue it while they handle an earlier one."""
        if self.process.ending:
            return
        if self.message_type is None and (kind := _with_bytes(type(message))) is not type(message):
            message.__class__ = kind
        if hasattr(type(message), "_connection_header"):
            message._connection_header = _connection_header(self.topic, type(message), origin)
        if not self._busy:
            self.process.scheduler.spawn(self.process, self._work, message)
            return
        self._waiting.append(message)
        if self.capacity and len(self._waiting) > self.capacity:
            self._waiting.popleft()

    def _work(self, message: Any) -> None:
        self._busy = True
        try:
            self._call(message)
            while self._waiting and not self.process.ending:
                self._call(self._waiting.popleft())
        finally:
            self._busy = False

    def _call(self, message: Any) -> None:
        for callback, arguments in tuple(self.callbacks):
            if arguments is None:
                callback(message)
            else:
                callback(message, arguments)


_WITH_BYTES: dict[Any, Any] = {}  # class of an installed ROS → class from `_with_bytes`


def _with_bytes(message_type: Any) -> Any:
    """Return a message class with `_buff`, the serialised message, which subscribers to AnyMsg read.

    Only classes of an installed ROS 1 need this; all others are returned unchanged.
    """
    if hasattr(message_type, "_buff") or not hasattr(message_type, "serialize"):
        return message_type

    def serialised(message: Any) -> bytes:
        written = BytesIO()
        message.serialize(written)
        return written.getvalue()

    if message_type not in _WITH_BYTES:
        namespace = {"__slots__": (), "_buff": property(serialised), "__module__": message_type.__module__}
        _WITH_BYTES[message_type] = type(message_type.__name__, (message_type,), namespace)
    return _WITH_BYTES[message_type]


def _connection_header(topic: str, message_type: Any, origin: Any) -> dict[str, str]:
    """Return the connection header that a publisher sends to a subscriber; the world is the node `/world`."""
    own = getattr(origin, "connection_header", {"callerid": "/world", "latching": "0"})
    return {**own, "topic": topic, "type": message_type._type, "md5sum": message_type._md5sum}


class Inboxes:
    """The inboxes of a process, by topic."""

    def __init__(self, process: Process) -> None:
        self._process = process
        self._by_topic: dict[str, Inbox] = {}

    def open(
        self, topic: str, message_type: type | None, callback: Callback | None, capacity: int | None
    ) -> Inbox:
        """Add a callback to a topic's inbox, which is connected when first needed."""
        inbox = self._by_topic.get(topic)
        new = inbox is None
        if inbox is None:
            inbox = self._by_topic[topic] = Inbox(self._process, topic, message_type)
        inbox.subscribers += 1
        if callback is not None:
            inbox.callbacks.append(callback)
        inbox.capacity = capacity or inbox.capacity
        if new:
            self._process.bus.attach(inbox, self._process.bus.topic(topic))
        return inbox

    def close(self, inbox: Inbox, callback: Callback | None) -> None:
        """Remove a callback; disconnect the inbox after its last subscriber, so that the next one connects anew."""
        if callback in inbox.callbacks:
            inbox.callbacks.remove(callback)
        inbox.subscribers -= 1
        if not inbox.subscribers:
            del self._by_topic[inbox.topic]
            self._process.bus.detach(inbox, self._process.bus.topic(inbox.topic))


class Topic:
    """The base of publishers and subscribers."""

    def __init__(self, name: str, data_class: Any, api: str) -> None:
        if not name or not isinstance(name, str):
            raise ValueError("topic name is not a non-empty string")
        _require_message_class(data_class)
        warn_if_illegal(name, stacklevel=4)
        self._node = this_node(api)
        self._process = self._node.process
        self.name = self.resolved_name = self._node.resolve(name)
        self._node.require_registrable(self.name, "topic")
        self.type = type_name(data_class) if data_class is not AnyMsg else "*"
        self.data_class = data_class
        self._place = self._process.bus.topic(self.name)
        self._closed = False

    @property
    def closed(self) -> bool:
        """Return whether this object was unregistered or its node has ended."""
        return self._closed or (self._process.ending and not self._node.in_hooks)

    def get_num_connections(self) -> int:
        """Return the number of connections; the simulated world counts as one on every topic."""
        return 1 + len(self._peers())

    def _peers(self) -> list[Any]:
        raise NotImplementedError


def _require_message_class(data_class: Any) -> None:
    if data_class is None:
        raise ValueError("topic parameter 'data_class' is not initialized")
    if not isinstance(data_class, type):
        raise ValueError(f"data_class [{data_class}] is not a class")
    if data_class is not AnyMsg and not hasattr(data_class, "_slot_types"):
        raise ValueError(f"data_class [{data_class.__class__.__name__}] is not a message data class")


class Publisher(Topic):
    """Publishes messages of one type on a topic."""

    def __init__(
        self,
        name: str,
        data_class: Any,
        subscriber_listener: Any = None,
        tcp_nodelay: bool = False,
        latch: bool = False,
        headers: Any = None,
        queue_size: int | None = None,
    ) -> None:
        super().__init__(name, data_class, "Publisher")
        self.process = self._process
        self._latch = int(latch)
        self._listener = subscriber_listener
        self._headers = dict(headers or {})
        self._process.bus.advertise(self, self._place)

    @property
    def connection_header(self) -> dict[str, str]:
        """Return the connection header for subscribers.

        It is computed on request, because `init_node` may come after the publisher is created.
        """
        return {**self._headers, "callerid": self._node.name, "latching": str(self._latch)}

    def publish(self, *args: Any, **kwds: Any) -> None:
        """Publish a message, or create one from fields given by position or keyword.

        Raise ROSSerializationException for an invalid message, and ROSException if it cannot be published now.
        """
        if self._closed:
            raise ROSException("publish() to an unregistered() handle")
        if not self._node.initialised:
            raise ROSException("ROS node has not been initialized yet. Please call init_node() first")
        if self.closed:
            raise ROSException("publish() to a closed topic")
        message = (
            args[0] if len(args) == 1 and isinstance(args[0], self.data_class) else self._make(args, kwds)
        )
        try:
            self._process.bus.publish_from(self, self._place, message, keep=self._latch)
        except FieldError as error:
            raise ROSSerializationException(f"{error} (publishing {self.type} on {self.name})") from error

    def peers_changed(self, subscription: Any, *, joined: bool) -> None:
        """Notify the subscribe listener of new and lost peers, while its node waits."""
        listener = self._listener
        if listener is None or self.closed:
            return
        if joined:
            arguments = (self.name, self.publish, lambda message: self._publish_to(subscription, message))
            self._process.scheduler.spawn(self._process, listener.peer_subscribe, *arguments)
        else:
            self._process.scheduler.spawn(
                self._process, listener.peer_unsubscribe, self.name, len(self._peers())
            )

    def _publish_to(self, subscription: Any, message: Any) -> None:
        self._process.bus.hand(self._place, subscription, message, self)

    def unregister(self) -> None:
        """Stop publishing."""
        self._closed = True
        if self in self._place.publications:
            self._place.publications.remove(self)
            self._place.kept.pop(self, None)

    def _make(self, args: tuple[Any, ...], kwds: dict[str, Any]) -> Any:
        """Create the message from the arguments. Raise TypeError if a single message does not fit the first field."""
        if args and kwds:
            raise TypeError("publish() can be called with arguments or keywords, but not both.")
        if len(args) == 1 and is_message(args[0]):
            given, wanted = type_name(type(args[0])), next(iter(self.data_class._slot_types), "")
            if given != wanted:
                raise TypeError(f"expected [{wanted}] but got [{given}]")
        return self.data_class(*args, **kwds)

    def _peers(self) -> list[Any]:
        return list(self._place.subscriptions)


class Subscriber(Topic):
    """Calls `callback(message)` or `callback(message, callback_args)` for every message on a topic."""

    def __init__(
        self,
        name: str,
        data_class: Any,
        callback: Callable[..., Any] | None = None,
        callback_args: Any = None,
        queue_size: int | None = None,
        buff_size: int = DEFAULT_BUFF_SIZE,
        tcp_nodelay: bool = False,
    ) -> None:
        super().__init__(name, data_class, "Subscriber")
        self.callback, self.callback_args = callback, callback_args
        self._entry = (callback, callback_args) if callback is not None else None
        wanted = None if data_class is AnyMsg else data_class
        self._inbox = self._process.part(Inboxes).open(self.name, wanted, self._entry, queue_size)

    def unregister(self) -> None:
        """Stop calling the callback."""
        if not self._closed:
            self._closed = True
            self._process.part(Inboxes).close(self._inbox, self._entry)

    def _peers(self) -> list[Any]:
        return list(self._place.publications)


class SubscribeListener:
    """Base class of listeners that are told when a node (not the simulated world) subscribes."""

    def peer_subscribe(self, topic_name: str, topic_publish: Any, peer_publish: Any) -> None:
        """Do nothing by default."""

    def peer_unsubscribe(self, topic_name: str, num_peers: int) -> None:
        """Do nothing by default."""


def wait_for_message(topic: str, topic_type: Any, timeout: float | None = None) -> Any:
    """Wait for the next message. Raise ROSException after `timeout` seconds, ROSInterruptException at shutdown."""
    node = this_node("wait_for_message")
    clock = node.process.scheduler
    task = current_task()
    received: list[Any] = []

    def receive(message: Any) -> None:
        received.append(message)
        clock.wake(task)

    until = None if timeout is None else clock.time + nanoseconds(timeout)
    subscriber = Subscriber(topic, topic_type, receive)
    try:
        while not received and not node.process.ending and (until is None or clock.time < until):
            clock.wait(until)
    finally:
        subscriber.unregister()
    if received:
        return received[0]
    if node.process.ending:
        raise ROSInterruptException("rospy shutdown")
    raise ROSException(f"timeout exceeded while waiting for message on topic {subscriber.name}")


def get_published_topics(namespace: str = "/") -> list[list[str]]:
    """Return the topics on which nodes publish, with their types."""
    bus = this_node("get_published_topics").process.bus
    return [[place.name, place.publications[0].type] for place in bus.topics() if place.publications
            and place.name.startswith(namespace)]  # fmt: skip
