"""Topics of the programs of topic_tools, which publish what they receive: relay, throttle, drop, mux, demux, delay."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Final

from tarl_lint.files import shown
from tarl_lint.model import Span
from tarl_lint.system.model import Endpoint, Instance
from tarl_lint.workspace.ros_arguments import plain

# (topics that a program subscribes to, topics that it publishes)
_Topics = tuple[Sequence[str], Sequence[str]]


def _named(words: Sequence[str], number: int, suffix: str) -> _Topics:
    """Return the topics of a program whose argument `number` is the output; without it, the input has a suffix."""
    return words[:1], words[number : number + 1] or [f"{words[0]}{suffix}"]


_PROGRAMS: Final[Mapping[str, Callable[[Sequence[str]], _Topics]]] = {
    "relay": lambda words: _named(words, 1, "_relay"),
    "drop": lambda words: _named(words, 3, "_drop"),
    "delay": lambda words: _named(words, 2, "_delay"),
    "mux": lambda words: (words[1:], words[:1]),
    "demux": lambda words: (words[:1], words[1:]),
}
_CHOOSING: Final[Mapping[str, str]] = {
    "mux": "Mux",
    "demux": "Demux",
}  # beginnings of the types of their services


def passed_on(instance: Instance, *, ros2: bool) -> tuple[Endpoint, ...]:
    """Return the topics of a program of topic_tools, as its arguments name them; empty for other programs."""
    node = instance.node
    words = plain(node.arguments, for_ros2=ros2)
    if node.package != "topic_tools" or node.kind != "node":
        return ()
    if node.executable == "throttle" and len(words) > 2:
        number = 2 if words[0] == "messages" else 3  # `messages topic rate`, `bytes topic rate window`
        inputs, outputs = _named(words[1:], number, "_throttle")
    elif node.executable in _PROGRAMS and words:
        inputs, outputs = _PROGRAMS[node.executable](words)
    else:
        return ()
    span = Span(shown(node.file), max(node.line, 1), 1, max(node.line, 1), 2)
    return (
        *(Endpoint("subscribes", (one,), "", span) for one in inputs if "$(" not in one),
        *(Endpoint("publishes", (one,), "", span) for one in outputs if "$(" not in one),
        *_choice(node.executable, span, ros2=ros2),
    )


def _choice(program: str, span: Span, *, ros2: bool) -> Iterator[Endpoint]:
    """Yield the services that choose the topic of `mux` and `demux`."""
    kind = _CHOOSING.get(program)
    if kind is None:
        return
    private = "~/" if ros2 else "~"
    for service in ("select", "add", "delete"):
        names = (f"{private}{service}",) if ros2 else (f"{private}{service}", f"{program}/{service}")
        yield Endpoint("serves", names, f"{kind}{service.capitalize()}", span)
