"""A scripted guardian in place of the process that runs a simulator and connects to its ROS."""

from __future__ import annotations

import queue
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from pytest_tarl.external import kept_simulator
from pytest_tarl.external import simulator as module
from pytest_tarl.external.arguments import Call, Setup
from pytest_tarl.external.simulator import Simulator
from pytest_tarl.ros import Ros

SECOND = 10**9
FLOAT = "std_msgs/msg/Float64"
SETUP = Setup(
    command=("sim", "--world", "a b"), folder=Path("/project"), environment={"LEVEL": "3"}, clock="/clock",
    ready=("/odom",), step=None, reset=None, every_step=(), timeout=60.0, patience=60.0,
)  # fmt: skip
STEPPED = replace(SETUP, step=Call("/step", {"n": 1}), every_step=("/odom",))


def clock(seconds: float) -> dict[str, Any]:
    return {"kind": "clock", "time": round(seconds * SECOND)}


def graph(published: str = "", subscribed: str = "", connected: str = "") -> dict[str, Any]:
    names = {"published": published, "subscribed": subscribed, "connected": connected}
    return {"kind": "graph", **{name: topics.split() for name, topics in names.items()}}


def message(topic: str, data: float, sent: int = 0) -> dict[str, Any]:
    return {"kind": "message", "topic": topic, "type": FLOAT, "data": {"data": data}, "sent": sent}


class Guardian:
    """Keeps the commands, and answers each one with the events that `react` returns."""

    def __init__(self) -> None:
        self.alive = True
        self.events: queue.SimpleQueue[dict[str, Any]] = queue.SimpleQueue()
        self.done: list[tuple[str, dict[str, Any]]] = []
        self.react: Callable[..., list[dict[str, Any]]] = lambda what, **arguments: []
        self.said = ""
        self.closed = False

    def do(self, what: str, **arguments: Any) -> None:
        self.done.append((what, arguments))
        for event in self.react(what, **arguments):
            self.events.put(event)

    def stop(self) -> None:
        self.do("stop")

    def close(self) -> None:
        self.closed = True

    def output(self) -> str:
        # like the client, return what the simulator printed since the last call
        said, self.said = self.said, ""
        return said

    def last_words(self) -> str:
        return self.said

    def commands(self, what: str) -> list[dict[str, Any]]:
        return [arguments for name, arguments in self.done if name == what]


@pytest.fixture
def guardian(monkeypatch: pytest.MonkeyPatch) -> Guardian:
    made = Guardian()
    kept = kept_simulator.Kept()
    kept.client = made  # type: ignore[assignment]
    monkeypatch.setattr(module, "KEPT", kept)
    monkeypatch.setattr(kept_simulator, "Client", Guardian)
    monkeypatch.setattr(module, "SETTLED", 0.01)
    return made


@pytest.fixture
def ros() -> Iterator[Ros]:
    made = Ros()
    with made.installed():
        yield made
        made.close()


STARTED = [{"kind": "stopped"}, graph("/odom /clock", "/cmd", "/odom"), message("/odom", 0.5, 1), clock(2.0)]


def begun(setup: Setup, guardian: Guardian, ros: Ros, watched: tuple[str, ...] = ()) -> Simulator:
    """Start a simulator that publishes /odom and subscribes to /cmd, at 2 s of its time."""
    guardian.react = lambda what, **_: STARTED if what == "start" else []
    made = Simulator(setup, ros, watched)
    made.begin()
    return made
