"""Hand-made analyses and a tiny ROS for the tests of rewriting."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

from pytest_tarl import Sensor
from pytest_tarl.model import Conjunct, Guard
from tarl_lint.model import Flow, Operand, Sink, SiteId, Source, Span

TERRAIN = Sensor("terrain", topic="/terrain", field="data")
POSITION = Sensor("x", topic="/odom", field="pose.pose.position.x", low=0, high=10, bins=10)
TOPICS = {
    "/terrain": "std_msgs/msg/Bool",
    "/odom": "nav_msgs/msg/Odometry",
    "/scan": "sensor_msgs/msg/LaserScan",
}
MUD = Guard((Conjunct(TERRAIN, 1, 1),))
MUDDY_STRETCH = Guard((Conjunct(TERRAIN, 1, 1), Conjunct(POSITION, 4.0, 7.0)))


@dataclass
class HandMade:
    """A stand-in for `tarl_lint.api.Analysis` whose results are given by the test."""

    sources: Mapping[str, str]
    flows: tuple[Flow, ...] = ()
    held: Mapping[tuple[str, str], tuple[str, ...]] = field(default_factory=dict)

    def holders(self, topic: str, field: str, site: SiteId) -> tuple[str, ...]:
        return self.held.get((topic, field), ())

    def operand(
        self, code: str, value: Any, within: str, path: str = "", literal: bool | None = None
    ) -> Operand:
        """Return the operand whose text is `code` in the first line that contains `within`."""
        path = path or next(iter(self.sources))
        text = self.sources[path]
        span = span_of(path, text, code, text.index(within) + within.index(code))
        literal = code == repr(value) if literal is None else literal
        definition = span if literal else Span(path, 1, 1, 1, 2)
        return Operand(SiteId(Path(path).stem, "", within), span, code, value, definition)


def span_of(path: str, text: str, code: str, start: int) -> Span:
    """Return the span of `code`, which starts at an offset of the text."""
    end = start + len(code)
    before, until = text[:start].split("\n"), text[:end].split("\n")
    return Span(path, len(before), len(before[-1]) + 1, len(until), len(until[-1]) + 1)


def subscribing(
    sources: Mapping[str, str], path: str, call: str, api: str, topic: str = "/odom"
) -> tuple[Flow, ...]:
    """Return the flow whose source is the subscription call `call`."""
    text = sources[path]
    source = Source("source", span_of(path, text, call, text.index(call)), (topic,), "", "", api)
    return (Flow("explicit", source, Sink("sink", Span(path, 1, 1, 1, 1), (), "", ""), ()),)


class TinyRos:
    """Subscriptions of a node by topic, and its published messages."""

    def __init__(self) -> None:
        self.subscribed: dict[str, list[Callable[[Any], None]]] = {}
        self.published: list[Any] = []
        self.loops: Callable[[], bool] = lambda: False

    def deliver(self, topic: str, message: Any) -> None:
        for callback in self.subscribed.get(topic, []):
            callback(message)

    def subscribe(self, topic: str, callback: Callable[[Any], None]) -> None:
        self.subscribed.setdefault(topic, []).append(callback)

    def modules(self) -> dict[str, ModuleType]:
        """Return stand-ins for rospy, rclpy and the messages."""
        rospy = SimpleNamespace(
            init_node=lambda *_, **__: None,
            Subscriber=lambda topic, kind, callback=None, **_: self.subscribe(topic, callback),
            Publisher=lambda *_, **__: SimpleNamespace(publish=self.published.append),
            is_shutdown=lambda: not self.loops(),
            get_param=lambda _, default=None: default,
        )
        node = type("Node", (), {
            "__init__": lambda self, *_: None,
            "create_subscription": lambda _, kind, topic, callback, qos: self.subscribe(topic, callback),
            "create_publisher": lambda *_: SimpleNamespace(publish=self.published.append),
        })  # fmt: skip
        kinds = {"Bool", "Float64", "Odometry", "LaserScan", "Twist"}
        messages = {kind: type(kind, (SimpleNamespace,), {}) for kind in kinds}
        packages = ("std_msgs", "nav_msgs", "sensor_msgs", "geometry_msgs")
        contents: dict[str, Mapping[str, Any]] = {
            "rospy": vars(rospy), "rclpy": {"init": lambda: None, "create_node": node}, "rclpy.node": {"Node": node},
            **{package: {} for package in packages}, **{f"{package}.msg": messages for package in packages},
        }  # fmt: skip
        return {name: _module(name, values) for name, values in contents.items()}

    @contextmanager
    def installed(self) -> Iterator[None]:
        saved = dict(sys.modules)
        sys.modules.update(self.modules())
        try:
            yield
        finally:
            sys.modules.clear()
            sys.modules.update(saved)

    def run(self, texts: Mapping[str, str], main: str) -> dict[str, Any]:
        """Execute modules in order, each importable by the later ones; return the globals of `main`."""
        spaces: dict[str, dict[str, Any]] = {}
        with self.installed():
            for path, text in texts.items():
                name = Path(path).stem
                module = ModuleType(name)
                sys.modules[name] = module
                module.__dict__["__name__"] = "__main__" if path == main else name
                exec(compile(text, path, "exec"), module.__dict__)
                spaces[path] = module.__dict__
        return spaces[main]


def odometry(x: float) -> SimpleNamespace:
    return SimpleNamespace(pose=SimpleNamespace(pose=SimpleNamespace(position=SimpleNamespace(x=x))))


def terrain(value: bool) -> SimpleNamespace:
    return SimpleNamespace(data=value)


def _module(name: str, values: Mapping[str, Any]) -> ModuleType:
    module = ModuleType(name)
    module.__dict__.update(values)
    return module
