"""The node of a watch with a scripted rclpy: when it publishes, waits and ends."""

from __future__ import annotations

from threading import Event
from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.monitoring import node


class Rclpy:
    """Records what the node does; `spins` is the number of times that it may wait before it is shut down."""

    def __init__(self, spins: int) -> None:
        self.done: list[Any] = []
        self.spins = spins
        self.tick: Any = None

    def init(self, signal_handler_options: str) -> None:
        self.done.append(signal_handler_options)

    def create_node(self, name: str) -> Any:
        stamp = SimpleNamespace(to_msg=lambda: "now")
        return SimpleNamespace(
            create_publisher=lambda kind, topic, depth: SimpleNamespace(publish=self.done.append),
            get_clock=lambda: SimpleNamespace(now=lambda: stamp),
            create_timer=self.create_timer,
            destroy_node=lambda: self.done.append("destroyed"),
        )

    def create_timer(self, period: float, tick: Any) -> None:
        self.tick = tick

    def ok(self) -> bool:
        return self.spins > 0

    def spin_once(self, node: Any, timeout_sec: float) -> None:
        self.spins -= 1
        self.tick()

    def shutdown(self) -> None:
        self.done.append("shut down")


def run(monkeypatch: pytest.MonkeyPatch, rclpy: Rclpy, looks: list[Any], stopped: bool = False) -> list[Any]:
    module = SimpleNamespace(
        SignalHandlerOptions=SimpleNamespace(NO="no handlers"), ExternalShutdownException=KeyError
    )
    monkeypatch.setattr(node, "import_module", lambda _: module)
    monkeypatch.setattr(
        node, "array", lambda _m, stamp, watch, status, bytes_level: (stamp, status, bytes_level)
    )
    event, script = Event(), iter(looks)
    if stopped:
        event.set()

    def look() -> Any:
        found = next(script)
        if isinstance(found, Exception):
            raise found
        return found

    messages: Any = SimpleNamespace(DiagnosticArray=object)
    node._rclpy(rclpy, messages, look, 1.0, event)
    return rclpy.done


def test_the_node_publishes_until_the_watch_ends(monkeypatch: pytest.MonkeyPatch) -> None:
    done = run(monkeypatch, Rclpy(9), [(True, "w", "a"), (True, "w", "b"), (False, "w", "c")])
    assert done == ["no handlers", *(("now", one, True) for one in "abc"), "destroyed", "shut down"]


def test_stopped_node_ends(monkeypatch: pytest.MonkeyPatch) -> None:
    first = ["no handlers", ("now", "a", True)]
    assert run(monkeypatch, Rclpy(9), [(True, "w", "a")], stopped=True) == [*first, "destroyed", "shut down"]
    assert run(monkeypatch, Rclpy(0), [(True, "w", "a")]) == [*first, "destroyed"]
    looks = [(True, "w", "a"), KeyError("shut down from outside")]
    assert run(monkeypatch, Rclpy(9), looks) == [*first, "destroyed", "shut down"]


def test_watch_error_ends_the_node(monkeypatch: pytest.MonkeyPatch) -> None:
    rclpy = Rclpy(9)
    with pytest.raises(ValueError, match="unreadable"):
        run(monkeypatch, rclpy, [ValueError("unreadable")])
    assert rclpy.done == ["no handlers", "destroyed", "shut down"]
