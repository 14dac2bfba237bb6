"""Topics of the programs of topic_tools, such as `relay`, `throttle` and `mux`, which publish what they receive.

The topics are arguments of the programs; in ROS 2, they may also be parameters. For components, they always are.
Source: the files of these names in `topic_tools/src` of ros_comm (ROS 1) and of topic_tools (ROS 2).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, Final

from tarl_lint.model import Span
from tarl_lint.system.model import Endpoint, Instance, Seen, place_of
from tarl_lint.workspace.ros_arguments import plain

# (topics that a program subscribes to, topics that it publishes)
_Topics = tuple[Sequence[str], Sequence[str]]


def _named(words: Sequence[str], number: int, suffix: str) -> _Topics:
    """Return the input and output topics of a program.

    The argument with index `number` names the output. If this argument is missing, the output is the input's name
    with the suffix.
    """
    return words[:1], words[number : number + 1] or [f"{words[0]}{suffix}"]


def _converted(words: Sequence[str]) -> _Topics:
    """Return the topics of `transform` and `relay_field`: `topic output type expression`."""
    return ((), ()) if len(words) < 4 else (words[:1], words[1:2])


_PROGRAMS: Final[Mapping[str, Callable[[Sequence[str]], _Topics]]] = {
    "relay": lambda words: _named(words, 1, "_relay"),
    "drop": lambda words: _named(words, 3, "_drop"),
    "delay": lambda words: _named(words, 2, "_delay"),
    "mux": lambda words: (words[1:], words[:1]),
    "demux": lambda words: (words[:1], words[1:]),
    "transform": _converted,
    "relay_field": _converted,
}
# programs whose first argument may be a topic followed by a field
_OF_FIELDS: Final = ("transform", "relay_field")
_CHOOSING: Final[Mapping[str, str]] = {
    "mux": "Mux",
    "demux": "Demux",
}  # prefixes of the types of these programs' services


def passed_on(instance: Instance, values: Mapping[str, Any], *, ros2: bool) -> Seen:
    """Return the topics of a program of topic_tools (parameters `values`); empty for others."""
    node = instance.node
    program = _program(instance, ros2=ros2)
    if not program:
        return Seen()
    words = [
        one for one in plain(node.arguments, for_ros2=ros2) if not (program in _OF_FIELDS and one[:2] == "--")
    ]
    inputs, outputs = _of_arguments(program, words) if words else ((), ())
    if ros2 and not inputs:
        inputs, outputs = _of_parameters(program, values)
    span = place_of(instance)
    named = [(one, "subscribes") for one in inputs] + [(one, "publishes") for one in outputs]
    certain = bool(named) and program not in _CHOOSING and program not in _OF_FIELDS
    ends: list[Endpoint] = []
    for name, role in named:
        if "$(" in name:
            certain = False
        else:
            ends.append(Endpoint("subscribes" if role == "subscribes" else "publishes", (name,), "", span))
    above = (
        "~" if ros2 else instance.resolve(program)
    )  # in ROS 1, a remapping may rename the namespace of the services
    return Seen((*ends, *_choice(program, outputs, above, span)) if named else (), certain)


def _program(instance: Instance, *, ros2: bool) -> str:
    """Return the program that has the code of a component, or the name itself."""
    node = instance.node
    if node.package != "topic_tools":
        return ""
    if node.kind == "component" and ros2:
        own = node.executable.removeprefix("topic_tools::").removesuffix("Node").lower()
        return own if own in (*_PROGRAMS, "throttle") else ""
    known = node.executable == "throttle" or node.executable in _PROGRAMS
    return node.executable if node.kind == "node" and known else ""


def _of_arguments(program: str, words: Sequence[str]) -> _Topics:
    if program != "throttle":
        return _PROGRAMS[program](words)
    if len(words) < 3:
        return (), ()
    # the arguments are `messages TOPIC RATE` or `bytes TOPIC RATE WINDOW`
    number = 2 if words[0] == "messages" else 3
    return _named(words[1:], number, "_throttle")


def _of_parameters(program: str, values: Mapping[str, Any]) -> _Topics:
    """Return the topics in the parameters of a program of ROS 2."""
    if program == "mux":
        return _texts(values.get("input_topics")), _texts(values.get("output_topic", "~/selected"))
    if program == "demux":
        return _texts(values.get("input_topic", "~/input")), _texts(values.get("output_topics"))
    inputs = _texts(values.get("input_topic"))
    return inputs, _texts(values.get("output_topic")) or [f"{one}_{program}" for one in inputs]


def _texts(value: Any) -> list[str]:
    return [one for one in (value if isinstance(value, list) else [value]) if isinstance(one, str) and one]


def _choice(program: str, outputs: Sequence[str], above: str, span: Span) -> Iterator[Endpoint]:
    """Yield the services of `mux` and `demux` below the namespace `above`."""
    kind = _CHOOSING.get(program)
    if kind is None:
        return
    for service in ("select", "add", "delete"):
        yield Endpoint("serves", (f"{above}/{service}",), f"{kind}{service.capitalize()}", span)
    if program == "mux" and above != "~" and outputs:
        yield Endpoint("serves", (f"{outputs[0]}_select",), "MuxSelect", span)
