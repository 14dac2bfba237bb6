"""The guardian's rospy node on the simulator's master."""

from __future__ import annotations

import os
import socket
import threading
import warnings
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import suppress
from io import BytesIO
from time import monotonic, sleep, time_ns
from typing import Any
from urllib.parse import urlparse

from pytest_tarl.external.plain import filled, to_plain
from pytest_tarl.external.unread import unread
from pytest_tarl.processors import available

NAME = "/tarl_link"
OWN = ("/rosout", "/rosout_agg")
DEPTH = 1000
LOST = "transport error"  # how rospy's error message for a broken connection starts
PATIENCE = 5.0  # seconds for a service to report its type
READING = 10.0  # seconds for the simulator to read all commands
LOOK = 0.001  # seconds between two checks for unread bytes
# seconds between a command and a service call on an idle machine; the call has its own connection, so it could
# otherwise arrive first
PAUSE = 0.005

Say = Callable[[dict[str, Any]], None]


def _pause() -> float:
    """Return the pause before a service call, which is longer on a busy machine."""
    try:
        waiting = os.getloadavg()[0] / available()
    except OSError:
        waiting = 1.0
    return PAUSE * max(waiting, 1.0)


class LinkROS1:
    """The only rospy node of the process; it passes events to `say`. Use it from one thread."""

    def __init__(self, clock: str, say: Say) -> None:
        import rosgraph
        import rospy

        rospy.init_node(
            NAME.strip("/"), argv=[], disable_signals=True, disable_rosout=True, disable_rostime=True
        )
        self._master = rosgraph.Master(NAME)
        self._say, self._clock = say, clock
        self._wanted: dict[str, Any] = {clock: None}  # topic → subscription
        self._publishers: dict[str, Any] = {}
        self._proxies: dict[str, Any] = {}
        self._calls: list[dict[str, Any]] = []  # calls of services that do not exist yet
        self._known: dict[str, Any] = {}
        self._events: deque[dict[str, Any]] = deque()
        self._arrival = threading.Event()
        self._sent = False  # whether a command was sent since the last service call

    def spin(self, seconds: float) -> None:
        """Pass on messages that have arrived, or arrive within `seconds`."""
        self._arrival.wait(seconds)
        self._arrival.clear()
        while self._events:
            self._say(self._events.popleft())

    def wake(self) -> None:
        """End the wait in `spin`. Any thread may call this."""
        self._arrival.set()

    def close(self) -> None:
        """Shut the node down and leave the master."""
        import rospy

        with suppress(Exception):  # the node may have ended
            rospy.signal_shutdown("the episode is over")

    def subscribe(self, topics: list[str]) -> None:
        """Pass on messages of further topics, and report the graph again."""
        for topic in topics:
            self._wanted.setdefault(topic, None)
        self._known = {}

    def send(self, topic: str, data: dict[str, Any]) -> None:
        """Publish a message to the simulator."""
        publisher = self._publishers.get(topic)
        if publisher is not None:
            publisher.publish(filled(publisher.data_class(), data, _message_class))
            self._sent = True

    def call(self, asked: dict[str, Any]) -> None:
        """Call a service now, or as soon as it exists.

        First wait until the simulator has read all commands sent so far; then pause, so that it handles them before the
        call.
        """
        if self._sent:
            deadline = monotonic() + READING
            while unread(self._connections()) and monotonic() < deadline:
                sleep(LOOK)
            sleep(_pause())
            self._sent = False
        self._calls.append(asked)
        self._start_calls()

    def _connections(self) -> Iterator[tuple[int, int]]:
        """Yield (own port, simulator's port) for each connection that carries commands."""
        for publisher in self._publishers.values():
            for connection in list(publisher.impl.connections):
                with suppress(OSError, AttributeError):  # the connection was just closed
                    yield connection.socket.getsockname()[1], connection.socket.getpeername()[1]

    def look(self) -> None:
        """Connect to the topics and services of the simulator, and report changes."""
        try:
            publishing, subscribing, _ = self._master.getSystemState()
            kinds = dict(self._master.getTopicTypes())
        except OSError:
            return  # the simulator has ended, and the ROS master with it
        published = [topic for topic, nodes in publishing if _others(nodes) and topic not in OWN]
        for topic in published:
            self._listen(topic, kinds.get(topic, "*"))
        subscribed = []
        for topic, nodes in subscribing:
            if _others(nodes) and topic not in OWN:
                self._offer(topic, kinds.get(topic, "*"))
                if topic in self._publishers and self._publishers[topic].get_num_connections():
                    subscribed.append(topic)
        connected = [topic for topic, end in self._wanted.items() if end and end.get_num_connections()]
        now = {"published": sorted(published), "subscribed": sorted(subscribed), "connected": connected}
        if now != self._known:
            self._known = now
            self._say({"kind": "graph", **now})
        self._start_calls()

    def _listen(self, topic: str, kind: str) -> None:
        import rospy

        if kind != "*" and topic in self._wanted and self._wanted[topic] is None:
            heard = self._on_clock if topic == self._clock else self._on_message(topic, kind)
            self._wanted[topic] = rospy.Subscriber(topic, _class(kind), heard, tcp_nodelay=True)

    def _offer(self, topic: str, kind: str) -> None:
        import rospy

        if kind == "*" or topic in self._publishers:
            return
        with warnings.catch_warnings():
            # rospy warns if there is no queue, but with a queue, a service call could overtake the message
            warnings.simplefilter("ignore", SyntaxWarning)
            self._publishers[topic] = rospy.Publisher(topic, _class(kind), tcp_nodelay=True, queue_size=None)

    def _on_clock(self, message: Any) -> None:
        self._put({"kind": "clock", "time": message.clock.to_nsec()})

    def _on_message(self, topic: str, kind: str) -> Callable[[Any], None]:
        def heard(message: Any) -> None:
            data = to_plain(message)
            self._put({"kind": "message", "topic": topic, "type": kind, "data": data, "sent": time_ns()})

        return heard

    def _put(self, event: dict[str, Any]) -> None:
        self._events.append(event)
        self._arrival.set()

    def _start_calls(self) -> None:
        waiting, self._calls = self._calls, []
        for asked in waiting:
            proxy = self._proxy(asked["service"])
            if proxy is None:
                self._calls.append(asked)
            else:
                threading.Thread(target=self._answer, args=(proxy, asked, time_ns()), daemon=True).start()

    def _answer(self, proxy: Any, asked: dict[str, Any], when: int) -> None:
        try:
            request = filled(proxy.request_class(), asked["request"], _message_class)
            told: dict[str, Any] = {"response": to_plain(proxy(request))}
        except Exception as problem:
            if str(problem).startswith(LOST):
                return  # the guardian reports if the simulator ended, and the test reports if an answer is missing
            told = {"error": str(problem)}
        self._put({"kind": "answer", "id": asked["id"], "asked": when, **told})

    def _proxy(self, service: str) -> Any:
        import rospy

        if service not in self._proxies:
            try:
                kind = _service_type(service, self._master.lookupService(service))
            except Exception:  # no node offers the service yet
                return None
            self._proxies[service] = rospy.ServiceProxy(service, _service_class(kind))
        return self._proxies[service]


def _service_type(service: str, uri: str) -> str:
    """Ask the server of a service for its type."""
    from rosgraph.network import read_ros_handshake_header, write_ros_handshake_header

    place = urlparse(uri)
    with socket.create_connection((place.hostname or "", place.port or 0), PATIENCE) as connection:
        asking = {"probe": "1", "md5sum": "*", "callerid": NAME, "service": service}
        write_ros_handshake_header(connection, asking)
        return str(read_ros_handshake_header(connection, BytesIO(), 2048)["type"])


def _others(nodes: list[str]) -> list[str]:
    return [one for one in nodes if one != NAME]


def _class(kind: str) -> Any:
    import roslib.message

    found = roslib.message.get_message_class(kind)
    if found is None:
        raise LookupError(
            f"The simulator uses the type {kind}, but its package is not installed beside rospy."
        )
    return found


def _service_class(kind: str) -> Any:
    import roslib.message

    found = roslib.message.get_service_class(kind)
    if found is None:
        raise LookupError(
            f"The simulator uses the type {kind}, but its package is not installed beside rospy."
        )
    return found


def _message_class(package: str, name: str) -> Any:
    return _class(f"{package}/{name}")
