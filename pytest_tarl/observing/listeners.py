"""Subscribe the observer to topics, separately from the node."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import partial
from importlib import import_module
from typing import Any

from pytest_tarl.errors import LogError
from pytest_tarl.observing.observer import Observer
from pytest_tarl.sensors import Sensor

Listener = Callable[[Any], None]
NUMBER = "std_msgs/msg/Float64"
WORD = "std_msgs/msg/String"
DEPTH = 1000  # queue length per topic; rclpy drops the oldest message when the queue is full


@dataclass(frozen=True)
class Topics:
    """The observed topics, with message types by topic in `types`.

    `reward` is the topic that closes steps, and `mission` the topic that delimits missions; either may be empty.
    """

    types: Mapping[str, str]
    reward: str = ""
    mission: str = ""
    own: Mapping[str, str] = field(default_factory=dict)  # types given on the command line

    def type_of(self, topic: str) -> str:
        """Return the message type of a topic. Raise LogError if the type is unknown."""
        usual = {self.reward: NUMBER, self.mission: WORD}
        found = self.own.get(topic) or self.types.get(topic) or usual.get(topic)
        if not found:
            raise LogError(
                f"The type of {topic} is unknown, because the recording does not contain it. Record again, or write "
                f"{topic}:TYPE."
            )
        return found


@contextmanager
def watched(library: str, observer: Observer, topics: Topics, *, idle: bool) -> Iterator[None]:
    """Pass messages to the observer while the block runs the node. Raise LogError."""
    # imported before any message type, because it decides between ROS 1 and ROS 2 messages
    import_module(library)
    listeners = _listeners(observer, topics)
    undo = _watch_rospy(listeners) if library == "rospy" else _watch_rclpy(listeners)
    resume = _watch_publishing(library, observer) if idle else None
    try:
        yield
    finally:
        undo()
        if resume is not None:
            resume()


def _listeners(observer: Observer, topics: Topics) -> list[tuple[str, type[Any], Listener]]:
    found: list[tuple[str, type[Any], Listener]] = [
        (sensor.topic, _class(topics.type_of(sensor.topic)), _telling(observer, sensor))
        for sensor in observer.sensors
        if sensor.topic is not None
    ]
    found += [
        (signal.topic, _class(topics.type_of(signal.topic)), partial(observer.signalled, signal))
        for signal in observer.signals
        if signal.topic is not None
    ]
    orders: dict[str, Listener] = {
        topics.reward: lambda message: observer.step(float(message.data)),
        topics.mission: lambda message: observer.order(str(message.data)),
    }
    found += [(topic, _class(topics.type_of(topic)), tell) for topic, tell in orders.items() if topic]
    return found


def _telling(observer: Observer, sensor: Sensor) -> Listener:
    return lambda message: observer.told(sensor, message)


def _class(name: str) -> type[Any]:
    package, _, short = name.replace("/msg/", "/").partition("/")
    found: type[Any] = getattr(import_module(f"{package}.msg"), short)
    return found


def _watch_rospy(listeners: list[tuple[str, type[Any], Listener]]) -> Callable[[], None]:
    """Subscribe before the node does, so that the observer receives messages first."""
    rospy = import_module("rospy")
    begin = rospy.init_node

    def init_node(*args: Any, **kwargs: Any) -> None:
        begin(*args, **kwargs)
        for topic, kind, listener in listeners:
            rospy.Subscriber(topic, kind, listener)

    rospy.init_node = init_node  # type: ignore[attr-defined]

    def undo() -> None:
        rospy.init_node = begin  # type: ignore[attr-defined]

    return undo


def _watch_rclpy(listeners: list[tuple[str, type[Any], Listener]]) -> Callable[[], None]:
    """Subscribe through the first node that the program creates."""
    node_class = import_module("rclpy.node").Node
    qos = import_module("rclpy.qos")  # best effort and volatile are compatible with every publisher
    profile = qos.QoSProfile(depth=DEPTH, reliability=qos.ReliabilityPolicy.BEST_EFFORT)
    make, pending = node_class.__init__, list(listeners)

    def init(self: Any, *args: Any, **kwargs: Any) -> None:
        make(self, *args, **kwargs)
        while pending:
            topic, kind, listener = pending.pop(0)
            self.create_subscription(kind, topic, listener, profile)

    node_class.__init__ = init

    def undo() -> None:
        node_class.__init__ = make

    return undo


def _watch_publishing(library: str, observer: Observer) -> Callable[[], None]:
    home = import_module("rospy" if library == "rospy" else "rclpy.publisher")
    publisher = home.Publisher
    publish = publisher.publish

    def tell(self: Any, *args: Any, **kwargs: Any) -> Any:
        observer.active()
        return publish(self, *args, **kwargs)

    publisher.publish = tell

    def undo() -> None:
        publisher.publish = publish

    return undo
