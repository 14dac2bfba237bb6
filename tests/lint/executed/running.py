"""Execute a generated node, compiled, without ROS, and compare what it publishes for different messages."""

from __future__ import annotations

import builtins
import copy
import random
from collections.abc import Callable, Mapping, Sequence
from types import CodeType, ModuleType
from typing import Any, Final

Event = tuple[str, int]  # topic and content of a message; topic "" stands for the timer
Published = dict[str, list[Any]]

TOPICS: Final = ("a", "b")
WRONG: Final = (AttributeError, NameError, TypeError)  # no generated program raises these on purpose


class Message:
    """A message with one field."""

    def __init__(self, data: Any = 0) -> None:
        self.data = data


class UnhandledError(Exception):
    """Raised if an execution cannot be judged."""


class Network:
    """The topics of one execution of a program with these lines."""

    def __init__(self, lines: Sequence[str]) -> None:
        self.lines = lines
        self.callbacks: dict[str, Callable[[Any], Any]] = {}
        self.published: Published = {}

    def modules(self) -> Mapping[str, ModuleType]:
        """Return the modules that a generated node imports."""
        rospy, messages, package = ModuleType("rospy"), ModuleType("std_msgs.msg"), ModuleType("std_msgs")
        rospy.__dict__.update(
            Publisher=lambda topic, *_, **__: _Publisher(self.published.setdefault(topic, [])),
            Subscriber=lambda topic, _, callback: self.callbacks.update({topic: callback}),
            Timer=lambda _, callback: self.callbacks.update({"": callback}),
            Duration=float,
            init_node=lambda _: None,
            spin=lambda: None,
        )
        messages.__dict__["Float64"] = Message
        return {"rospy": rospy, "std_msgs.msg": messages, "std_msgs": package}

    def deliver(self, event: Event) -> None:
        """Run a callback; as in ROS, an exception ends only the callback.

        Raises UnhandledError for an exception that no `raise` of the program raised, since the linter follows such
        exceptions only to handlers.
        """
        topic, content = event
        callback = self.callbacks.get(topic)
        try:
            callback(Message(content)) if callback is not None else None
        except WRONG:
            raise
        except Exception as error:
            if not self._raised(error):
                raise UnhandledError from error

    def _raised(self, error: Exception) -> bool:
        """Return whether the statement that failed is a `raise`."""
        trace = error.__traceback__
        while trace is not None and trace.tb_next is not None:
            trace = trace.tb_next
        return trace is not None and self.lines[trace.tb_lineno - 1].strip().startswith("raise")


class _Publisher:
    def __init__(self, sent: list[Any]) -> None:
        self.sent = sent

    def publish(self, value: Any) -> None:
        self.sent.append(copy.copy(value))


def published(code: CodeType, lines: Sequence[str], events: Sequence[Event]) -> Published:
    """Execute a generated node with these events; return what it publishes, by topic."""
    network = Network(lines)
    modules = network.modules()

    def load(name: str, *_: Any) -> ModuleType:
        return modules[name]

    names = {**vars(builtins), "__import__": load}
    exec(code, {"__name__": "__main__", "__builtins__": names})
    for event in events:
        network.deliver(event)
    return network.published


def dependences(text: str, seed: int, times: int) -> set[tuple[str, str]]:
    """Return the pairs (input topic, output topic) for which executions show that the output depends on the input."""
    draw = random.Random(seed)
    code, lines = compile(text, "node.py", "exec"), text.splitlines()
    found: set[tuple[str, str]] = set()
    for _ in range(times):
        events = [(draw.choice(["a", "b", ""]), draw.randint(-1, 4)) for _ in range(draw.randint(3, 7))]
        for topic in TOPICS:
            changed = [(t, draw.randint(-1, 4) if t == topic else v) for t, v in events]
            try:
                before, after = published(code, lines, events), published(code, lines, changed)
            except UnhandledError:
                continue
            found |= {(topic, out) for out in before if before[out] != after[out]}
    return found
