"""rostopic: types and classes of topics."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from pytest_tarl.field_paths import field_value
from pytest_tarl.ros.clock import nanoseconds
from pytest_tarl.ros.messages import find_class
from pytest_tarl.ros.process import current_process
from pytest_tarl.ros.tools import graph
from pytest_tarl.ros.tools.topic_rates import ROSTopicHz

__all__ = ["ROSTopicException", "ROSTopicHz", "ROSTopicIOException", "get_topic_class", "get_topic_type"]

Evaluate = Callable[[Any], Any] | None
_LOOK = nanoseconds(0.1)  # polling period of a blocking query (ns)


class ROSTopicException(Exception):  # noqa: N818 (these names are rostopic's)
    """A query about a topic failed."""


class ROSTopicIOException(ROSTopicException):
    """The master could not be reached."""


def get_topic_type(topic: str, blocking: bool = False) -> tuple[str | None, str | None, Evaluate]:
    """Return type, name, and a function that reads the field if `topic` includes one; None if unknown."""
    process = current_process("rostopic.get_topic_type")
    while True:
        found = _known(topic)
        if found[0] is not None or not blocking or process.ending:
            return found
        process.scheduler.wait(process.scheduler.time + _LOOK)


def get_topic_class(topic: str, blocking: bool = False) -> tuple[Any, str | None, Evaluate]:
    """Return message class, topic name, and the function from `get_topic_type`.

    Raise ROSTopicException if the type is unknown.
    """
    kind, name, evaluate = get_topic_type(topic, blocking)
    if kind is None:
        return None, None, None
    package, _, short = kind.partition("/")
    made = find_class("ros1", package, short)
    if made is None:
        raise ROSTopicException(f"Cannot load message class for [{kind}]. Are your messages built?")
    return made, name, evaluate


def _known(topic: str) -> tuple[str | None, str | None, Evaluate]:
    types, wanted = graph.topic_types(), graph.resolved(topic)
    if wanted in types:
        return types[wanted], wanted, None
    longest = max((name for name in types if wanted.startswith(name + "/")), key=len, default=None)
    if longest is None:
        return None, None, None
    field = wanted[len(longest) + 1 :].replace("/", ".")
    return types[longest], longest, lambda message: field_value(message, field)
