"""The guardian's rclpy node in the simulator's domain."""

from __future__ import annotations

import importlib
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from time import monotonic, time_ns
from typing import Any

from pytest_tarl.external.plain import filled, to_plain

NAME = "tarl_link"
OWN = ("/rosout", "/parameter_events")
DEPTH = 1000
# the queue counts as empty after this many attempts in a row without a message; a single attempt may have handled
# another event
IDLE = 3
UNKNOWN = (
    # rclpy's name for a node of which only an endpoint is known
    "_NODE_NAME_UNKNOWN_"
)
# seconds to wait for a node's name; programs other than nodes never get one
NAMING = 10.0
# seconds for a node to answer a parameter request; a slower node is not asked again
ASKING = 10.0

Say = Callable[[dict[str, Any]], None]


@dataclass(frozen=True)
class Turn:
    """A call of a parameter service, with a time limit and what to do next."""

    service: str
    deadline: float
    then: Callable[[], None]


class Link:
    """A node in its own context that passes events to `say`; use it from one thread."""

    def __init__(self, domain: int, clock: str, say: Say) -> None:
        from rclpy.context import Context
        from rclpy.executors import SingleThreadedExecutor
        from rclpy.node import Node

        self._context = Context()
        self._context.init(args=[], domain_id=domain, initialize_logging=False)
        self._node = Node(
            NAME,
            context=self._context,
            use_global_arguments=False,
            start_parameter_services=False,
            enable_rosout=False,
        )
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)
        self._waker = self._node.create_guard_condition(lambda: None)
        self._say, self._clock = say, clock
        self._wanted: dict[str, Any] = {clock: None}  # topic → subscription
        self._publishers: dict[str, Any] = {}
        self._clients: dict[str, Any] = {}
        self._calls: list[dict[str, Any]] = []  # calls of services that do not exist yet
        self._receivers: dict[str, list[str]] = {}  # topic → parameter services of its subscribers
        self._seen: dict[str, float] = {}  # topic → when a subscription to it was first seen
        self._asking: Turn | None = None  # the call of a parameter service that is waiting for its answer
        self._silent: set[str] = set()  # parameter services that did not answer in time
        self._sent: Counter[str] = Counter()  # topic → number of commands since the last call
        self._known: dict[str, Any] = {}
        # answers of services that the test has not received yet
        self._answers: list[dict[str, Any]] = []
        self._handled = 0  # number of messages handled so far

    def spin(self, seconds: float) -> None:
        """Wait up to `seconds` for an event; handle messages that arrived before it first.

        In each cycle, rclpy's executor takes one message from each subscription, and then the answers. An answer can
        therefore overtake the second message on a topic, which may be the state after a step.
        """
        self._executor.spin_once(seconds)
        for _ in range(DEPTH if self._answers else 0):
            handled = self._handled
            for _ in range(IDLE):
                self._executor.spin_once(0)
            if self._handled == handled:
                break
        answers, self._answers = self._answers, []
        for answer in answers:
            self._say(answer)

    def wake(self) -> None:
        """End the wait in `spin`. Any thread may call this."""
        self._waker.trigger()

    def close(self) -> None:
        """Shut the node down and leave the domain."""
        self._executor.shutdown()
        self._node.destroy_node()
        self._context.try_shutdown()

    def subscribe(self, topics: list[str]) -> None:
        """Pass on messages of further topics, and report the graph again."""
        for topic in topics:
            self._wanted.setdefault(topic, None)
        self._known = {}

    def send(self, topic: str, data: dict[str, Any]) -> None:
        """Publish a message to the simulator."""
        publisher = self._publishers.get(topic)
        if publisher is not None:
            publisher.publish(filled(publisher.msg_type(), data, _message_class))
            self._sent[topic] += 1

    def call(self, asked: dict[str, Any]) -> None:
        """Call a service after the simulator has handled all commands.

        Commands arrive before the call, because both go by UDP to the same port of the simulator's participant. This is
        not enough: in each cycle, an executor looks for messages, then for requests, and takes one message from each
        subscription. It can therefore miss a command that arrives in between, or handle the request before the second
        command on a topic.

        For this reason, each node that subscribes to the commands first gets one empty parameter request per command.
        Once it has answered them all, its executor has taken the last command before it finds the call. Nodes without
        parameter services and nodes that do not answer are skipped. Waiting for acknowledgements would not be enough,
        and would take 0.8 s per call (the period of the middleware's heartbeats).
        """
        self._calls.append(asked)
        self._start_calls()

    def look(self) -> None:
        """Connect to the simulator's topics and services; report changes of the ROS graph."""
        kinds = {name: types[0] for name, types in self._node.get_topic_names_and_types() if types}
        published, subscribed = [], []
        for topic, kind in sorted(kinds.items()):
            if topic in OWN:
                continue
            if offered := _others(self._node.get_publishers_info_by_topic(topic)):
                published.append(topic)
                self._listen(topic, kind, offered[0].qos_profile)
            if wanting := _others(self._node.get_subscriptions_info_by_topic(topic)):
                self._offer(topic, kind, wanting[0].qos_profile)
                self._receivers[topic] = sorted(
                    {_parameters(end) for end in wanting if end.node_name != UNKNOWN}
                )
                known = all(end.node_name != UNKNOWN for end in wanting)
                seen = self._seen.setdefault(topic, monotonic())
                if self._publishers[topic].get_subscription_count() and (
                    known or monotonic() > seen + NAMING
                ):
                    subscribed.append(topic)
        connected = [topic for topic, end in self._wanted.items() if end and end.get_publisher_count()]
        now = {"published": published, "subscribed": subscribed, "connected": connected}
        if now != self._known:
            self._known = now
            self._say({"kind": "graph", **now})
        self._skip_silent()
        self._start_calls()

    def _listen(self, topic: str, kind: str, offered: Any) -> None:
        from rclpy.qos import QoSProfile

        if topic not in self._wanted or self._wanted[topic] is not None:
            return
        profile = QoSProfile(depth=DEPTH, reliability=offered.reliability, durability=offered.durability)
        heard = self._on_clock if topic == self._clock else self._on_message(topic, kind)
        self._wanted[topic] = self._node.create_subscription(_class(kind), topic, heard, profile)

    def _on_clock(self, message: Any) -> None:
        self._handled += 1
        self._say({"kind": "clock", "time": message.clock.sec * 10**9 + message.clock.nanosec})

    def _on_message(self, topic: str, kind: str) -> Callable[[Any, Any], None]:
        def heard(message: Any, info: Any) -> None:
            self._handled += 1
            sent = info[
                "source_timestamp"
            ]  # time of sending by this machine's clock (ns); 0 if the middleware does not provide it
            self._say(
                {"kind": "message", "topic": topic, "type": kind, "data": to_plain(message), "sent": sent}
            )

        return heard

    def _offer(self, topic: str, kind: str, wanted: Any) -> None:
        from rclpy.qos import QoSProfile, ReliabilityPolicy

        if topic not in self._publishers:
            profile = QoSProfile(
                depth=DEPTH, reliability=ReliabilityPolicy.RELIABLE, durability=wanted.durability
            )
            self._publishers[topic] = self._node.create_publisher(_class(kind), topic, profile)

    def _start_calls(self) -> None:
        waiting, self._calls = self._calls, []
        for asked in waiting:
            client, names = self._client(asked["service"]), self._asked_first()
            receivers = [self._client(name) for name in names]
            if client is None or not all(one.service_is_ready() for one in (client, *receivers)):
                self._calls.append(asked)
                continue
            self._sent.clear()
            self._ask(names, partial(self._start, client, asked))

    def _asked_first(self) -> list[str]:
        """Return the parameter services to call: one call for each command sent to their nodes."""
        times = Counter[str]()
        for topic, commands in self._sent.items():
            for name in self._receivers.get(topic, ()):
                times[name] = max(times[name], commands)
        asked = [
            name for name in sorted(times) if name not in self._silent and self._client(name) is not None
        ]
        return [name for name in asked for _ in range(times[name])]

    def _ask(self, names: list[str], then: Callable[[], None]) -> None:
        """Call the parameter services one by one, then call `then`."""
        self._asking = None
        names = [name for name in names if name not in self._silent]
        if not names:
            then()
            return
        first, others = names[0], names[1:]
        turn = self._asking = Turn(first, monotonic() + ASKING, partial(self._ask, others, then))
        client = self._client(first)
        client.call_async(client.srv_type.Request()).add_done_callback(lambda _: self._answered_first(turn))

    def _answered_first(self, turn: Turn) -> None:
        if self._asking is turn:
            turn.then()

    def _skip_silent(self) -> None:
        """Go on without a node that does not answer."""
        turn = self._asking
        if turn is not None and monotonic() > turn.deadline:
            self._silent.add(turn.service)
            turn.then()

    def _start(self, client: Any, asked: dict[str, Any]) -> None:
        request = filled(client.srv_type.Request(), asked["request"], _message_class)
        answered = self._answered(asked["id"], time_ns())
        client.call_async(request).add_done_callback(answered)

    def _answered(self, number: int, asked: int) -> Callable[[Any], None]:
        def answer(future: Any) -> None:
            problem = future.exception()
            told = {"error": str(problem)} if problem else {"response": to_plain(future.result())}
            self._answers.append({"kind": "answer", "id": number, "asked": asked, **told})

        return answer

    def _client(self, service: str) -> Any:
        if service not in self._clients:
            kinds = dict(self._node.get_service_names_and_types())
            if service not in kinds:
                return None
            self._clients[service] = self._node.create_client(_class(kinds[service][0]), service)
        return self._clients[service]


def _parameters(end: Any) -> str:
    """Return the name of the service by which a node returns its parameters."""
    return f"{end.node_namespace.rstrip('/')}/{end.node_name}/get_parameters"


def _others(ends: list[Any]) -> list[Any]:
    return [end for end in ends if end.node_name != NAME]


def _class(kind: str) -> Any:
    package, part, name = kind.split("/")
    return getattr(importlib.import_module(f"{package}.{part}"), name)


def _message_class(package: str, name: str) -> Any:
    return _class(f"{package}/msg/{name}")
