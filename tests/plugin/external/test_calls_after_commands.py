"""A service call reaches the simulator's code after the commands that were sent before it."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.external import link as module
from pytest_tarl.external.link import Link

Callback = Callable[[Any], None]


class Simulator:
    """The requests and commands that have arrived at a simulator, and what its executor has handled."""

    def __init__(self, parameters: Sequence[str]) -> None:
        self.services = dict.fromkeys(("/step", *parameters), True)  # service → whether it is ready
        self.commands: list[str] = []
        self.requests: list[tuple[str, Callback]] = []
        self.handled: list[str] = []

    def one_pass(self, before_requests: Callable[[], None] = lambda: None) -> None:
        """Look for commands, then for requests; handle in this order one command and all requests."""
        commands, self.commands = self.commands[:1], self.commands[1:]
        before_requests()
        requests, self.requests = self.requests, []
        self.handled += commands
        for name, answer in requests:
            self.handled.append(name)
            answer(SimpleNamespace(exception=lambda: None, result=dict))

    def client(self, name: str) -> Any:
        def call_async(_: object) -> Any:
            return SimpleNamespace(
                add_done_callback=lambda answer: self.requests.append((name, answer)),
            )

        return SimpleNamespace(
            srv_type=SimpleNamespace(Request=SimpleNamespace),
            service_is_ready=lambda: self.services[name],
            call_async=call_async,
        )

    def publisher(self, topic: str) -> Any:
        return SimpleNamespace(
            msg_type=SimpleNamespace,
            publish=lambda _: self.commands.append(topic),
            get_subscription_count=lambda: 1,
        )


def linked(
    monkeypatch: pytest.MonkeyPatch,
    simulator: Simulator,
    receivers: Sequence[tuple[str, str]],
    say: Callback = lambda _: None,
) -> Link:
    """Return a link to a simulator of which nodes (namespace, name) subscribe to /cmd."""
    ends = [
        SimpleNamespace(node_namespace=namespace, node_name=name, qos_profile=SimpleNamespace(durability=1))
        for namespace, name in receivers
    ]
    node = SimpleNamespace(
        create_guard_condition=lambda _: None,
        create_client=lambda _, name: simulator.client(name),
        create_publisher=lambda _, topic, __: simulator.publisher(topic),
        get_service_names_and_types=lambda: [(name, ["a/srv/B"]) for name in simulator.services],
        get_topic_names_and_types=lambda: [("/cmd", ["a/msg/C"])],
        get_publishers_info_by_topic=lambda _: [],
        get_subscriptions_info_by_topic=lambda _: ends,
    )
    context = SimpleNamespace(init=lambda **_: None)
    contents: dict[str, dict[str, Any]] = {
        "rclpy": {},
        "rclpy.context": {"Context": lambda: context},
        "rclpy.executors": {"SingleThreadedExecutor": lambda **_: SimpleNamespace(add_node=lambda _: None)},
        "rclpy.node": {"Node": lambda *_, **__: node},
        "rclpy.qos": {
            "QoSProfile": SimpleNamespace,
            "ReliabilityPolicy": SimpleNamespace(RELIABLE="reliable"),
        },
    }
    for name, content in contents.items():
        made = ModuleType(name)
        vars(made).update(content)
        monkeypatch.setitem(sys.modules, name, made)
    monkeypatch.setattr(module, "_class", lambda kind: kind)
    link = Link(7, "/clock", say)
    link.look()
    return link


def step(link: Link) -> None:
    link.call({"id": 1, "service": "/step", "request": {}})


def command(link: Link) -> None:
    link.send("/cmd", {})


@pytest.mark.parametrize("place", [("/", "cart"), ("/a", "cart")])
def test_command_between_two_checks_is_handled_before_the_step(
    monkeypatch: pytest.MonkeyPatch, place: tuple[str, str]
) -> None:
    simulator = Simulator([f"{place[0].rstrip('/')}/cart/get_parameters"])
    link = linked(monkeypatch, simulator, [place])

    def sent() -> None:
        command(link)
        step(link)

    simulator.one_pass(sent)  # both arrive after this pass has looked for commands
    simulator.one_pass()
    assert [name for name in simulator.handled if not name.endswith("get_parameters")] == ["/cmd", "/step"]


def test_topic_commands_are_handled_before_the_step(monkeypatch: pytest.MonkeyPatch) -> None:
    simulator = Simulator(["/cart/get_parameters"])
    link = linked(monkeypatch, simulator, [("/", "cart")])

    def sent() -> None:
        for _ in range(3):
            command(link)
        step(link)

    simulator.one_pass(sent)
    while simulator.requests:
        simulator.one_pass()
    asked = "/cart/get_parameters"
    assert simulator.handled == [asked, "/cmd", asked, "/cmd", asked, "/cmd", "/step"]


def test_no_parameter_service_is_called_without_a_command(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    simulator = Simulator(["/cart/get_parameters"])
    link = linked(monkeypatch, simulator, [("/", "cart")])
    step(link)
    simulator.one_pass()
    command(link)
    step(link)
    simulator.one_pass()
    simulator.one_pass()
    step(link)
    simulator.one_pass()
    assert simulator.handled == ["/step", "/cmd", "/cart/get_parameters", "/step", "/step"]


def test_parameter_services_of_command_receivers_are_called_first(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    simulator = Simulator(["/left/get_parameters", "/right/get_parameters", "/else/get_parameters"])
    link = linked(monkeypatch, simulator, [("/", "right"), ("/", "left"), ("/", "tarl_link")])
    command(link)
    step(link)
    for _ in range(3):
        simulator.one_pass()
    assert simulator.handled == ["/cmd", "/left/get_parameters", "/right/get_parameters", "/step"]


def test_node_without_parameter_services_is_stepped_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    simulator = Simulator([])
    link = linked(monkeypatch, simulator, [("/", "cart")])
    command(link)
    step(link)
    simulator.one_pass()
    assert simulator.handled == ["/cmd", "/step"]


def test_step_waits_for_parameter_services(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    simulator = Simulator(["/cart/get_parameters"])
    link = linked(monkeypatch, simulator, [("/", "cart")])
    simulator.services["/cart/get_parameters"] = False
    command(link)
    step(link)
    simulator.one_pass()
    assert simulator.handled == ["/cmd"]
    simulator.services["/cart/get_parameters"] = True
    link.look()
    simulator.one_pass()
    simulator.one_pass()
    assert simulator.handled == ["/cmd", "/cart/get_parameters", "/step"]


def test_topic_is_subscribed_once_its_nodes_are_known(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    said: list[Any] = []
    nodes = [
        SimpleNamespace(
            node_namespace="/", node_name=module.UNKNOWN, qos_profile=SimpleNamespace(durability=1)
        )
    ]
    now = [100.0]
    monkeypatch.setattr(module, "monotonic", lambda: now[0])
    link = linked(monkeypatch, Simulator(["/cart/get_parameters"]), [("/", module.UNKNOWN)], said.append)
    assert said[-1]["subscribed"] == []
    now[0] += module.NAMING
    link.look()
    assert len(said) == 1
    now[0] += 1.0
    link.look()
    assert said[-1]["subscribed"] == ["/cmd"]
    nodes[0].node_name = "cart"
    monkeypatch.setattr(link._node, "get_subscriptions_info_by_topic", lambda _: nodes)
    link._seen.clear()
    link.look()
    assert link._receivers == {"/cmd": ["/cart/get_parameters"]}


def test_node_that_runs_only_within_a_step_delays_one_step(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    now = [100.0]
    monkeypatch.setattr(module, "monotonic", lambda: now[0])
    simulator = Simulator(["/cart/get_parameters", "/drive/get_parameters"])
    link = linked(monkeypatch, simulator, [("/", "cart"), ("/", "drive")])
    command(link)
    step(link)
    (_, late), simulator.requests = simulator.requests[0], []
    now[0] += module.ASKING
    link.look()
    simulator.one_pass()
    assert simulator.handled == ["/cmd"]
    now[0] += 0.1
    link.look()
    simulator.one_pass()
    simulator.one_pass()
    late(None)
    simulator.one_pass()
    assert simulator.handled == ["/cmd", "/drive/get_parameters", "/step"]
    command(link)
    step(link)
    simulator.one_pass()
    simulator.one_pass()
    assert simulator.handled[3:] == ["/cmd", "/drive/get_parameters", "/step"]
