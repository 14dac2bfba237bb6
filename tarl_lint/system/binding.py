"""Give a program the parameters of one launched node."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

from tarl_lint.model import Finding
from tarl_lint.parameter_names import (
    ARGUMENTS,
    DEFAULT,
    ELSEWHERE,
    LAUNCHED,
    MARK,
    Launched,
    ParameterName,
    places,
    substituted,
)
from tarl_lint.system.model import Endpoint, Interface
from tarl_lint.workspace.bounded_files import UnreadableError
from tarl_lint.workspace.launch_model import Launch, LaunchedNode, Setting
from tarl_lint.workspace.launch_parameters import leaves, stated
from tarl_lint.workspace.parameter_yaml import NoYamlError

DEEPEST = 8  # maximum nesting of parameters whose defaults contain other parameters


def parameter_values(launch: Launch, node: LaunchedNode, full_name: str) -> Mapping[str, Any]:
    """Return a node's launched parameters by absolute name."""
    found: dict[str, Any] = {}
    for setting in (*launch.settings, *node.settings):
        for name, value in _stated(setting, full_name):
            whole = f"{full_name}/{name[1:].lstrip('/')}" if name.startswith("~") else name
            found.update(leaves({whole: value}))
    return found


def private_values(launch: Launch, node: LaunchedNode, full_name: str) -> Mapping[str, Any]:
    """Return a node's private launched parameters, by the names in its code."""
    above = f"{full_name}/"
    values = parameter_values(launch, node, full_name)
    return {name.removeprefix(above): value for name, value in values.items() if name.startswith(above)}


def fixed(names: Sequence[str], values: Mapping[str, Any], full_name: str) -> Mapping[str, object]:
    """Return the values of parameters in a launched node, by their names in the code; DEFAULT for parameters not set.

    A parameter is left out if its value is known only on the robot, or is not a scalar or a list of scalars.
    """
    found: dict[str, object] = {}
    for name in (one for one in names if one != ARGUMENTS):
        found_at = places(name, full_name)
        below = any(one.startswith(f"{place}/") for place in found_at for one in values)
        value = next((values[place] for place in found_at if place in values), None if below else DEFAULT)
        if isinstance(value, list) and all(isinstance(one, str | bool | int | float) for one in value):
            found[name] = tuple(value)
        elif isinstance(value, str | bool | int | float):
            found[name] = value
    return found


def command_line(node: LaunchedNode, launch: Launch, full_name: str) -> Mapping[str, object]:
    """Return a node's command line under ARGUMENTS; empty if partly unknown."""
    try:
        given = shlex.split(node.arguments)
    except ValueError:
        return {}
    if any("$(" in one for one in given):
        return {}
    own = (
        f"__node:={full_name.rpartition('/')[2]}"
        if launch.ros2
        else f"__name:={full_name.rpartition('/')[2]}"
    )
    remaps = [pair for old, new in node.remaps if (pair := f"{old}:={new}") not in given]
    for_ros = ["--ros-args", "-r", own] if launch.ros2 else [*remaps, own, "__log:=node.log"]
    return {ARGUMENTS: (node.executable, *given, *for_ros)}


def whole(values: Mapping[str, Any], full_name: str) -> Mapping[str, object]:
    """Return a launched node with all its parameters under LAUNCHED."""
    plain = ((name, value if _plain(value) else ELSEWHERE) for name, value in sorted(values.items()))
    return {LAUNCHED: Launched(full_name, tuple(plain))}


def _plain(value: object) -> bool:
    """Return whether the launch determines a value completely."""
    if isinstance(value, list):
        return all(map(_plain, value))
    if isinstance(value, dict):
        return all(isinstance(name, str) and _plain(one) for name, one in value.items())
    return value is None or isinstance(value, str | bool | int | float)


def undetermined(interface: Interface) -> bool:
    """Return whether parameters may determine the name of an end."""
    ends = [one.names for one in interface.endpoints]
    for one in interface.flows:
        if one.flow is not None:
            ends += [one.flow.source.topics, one.flow.sink.topics]
    return any(len(names) != 1 for names in ends)


def with_prints(decided: Interface, every: Interface) -> Interface:
    """Return the interface for known parameters, with the fingerprints of a run without launch."""
    prints = {_ends(one): one.fingerprint for one in every.flows}
    flows = (replace(one, fingerprint=prints.get(_ends(one), one.fingerprint)) for one in decided.flows)
    return replace(decided, flows=tuple(flows))


def with_names_in_code(decided: Interface, every: Interface) -> Interface:
    """Return the interface for known parameters, with the names in the code."""
    written = {(one.role, one.span): one.written for one in every.endpoints if one.written}
    ends = (replace(one, written=written.get((one.role, one.span), one.written)) for one in decided.endpoints)
    return replace(decided, endpoints=tuple(ends))


def _ends(finding: Finding) -> object:
    flow = finding.flow
    return finding.code, flow and flow.source.span, flow and flow.sink.span


def _stated(setting: Setting, full_name: str) -> Sequence[tuple[str, Any]]:
    try:
        return [(one.name, one.value) for one in stated((setting,), full_name)]
    except (NoYamlError, UnreadableError):
        return ()  # another part of the report describes the problem


def bound(
    interface: Interface, values: Mapping[str, Any], full_name: str, resolve: Callable[[str], str]
) -> Interface:
    """Return the interface of a program in a launched node, whose parameters have these values.

    `resolve` returns the launched name of a topic in the code.
    """
    if not interface.in_names:
        return interface
    namer = _Namer(interface.in_names, values, full_name, resolve)
    endpoints = tuple(namer.endpoint(one) for one in interface.endpoints)
    flows = tuple(namer.finding(one) for one in interface.flows)
    known = all(one.names for one in endpoints) and all(_has_topics(one) for one in flows)
    return replace(interface, endpoints=endpoints, flows=flows, whole=interface.whole and known)


def _has_topics(finding: Finding) -> bool:
    flow = finding.flow
    return flow is None or bool(flow.source.topics and flow.sink.topics)


class _Namer:
    """Replaces parameters in the names of one node."""

    def __init__(
        self,
        parameters: Sequence[ParameterName],
        values: Mapping[str, Any],
        full_name: str,
        resolve: Callable[[str], str],
    ) -> None:
        self._resolve = resolve
        self._parameters = parameters
        self._values = values
        self._full_name = full_name
        self._depth = 0

    def endpoint(self, one: Endpoint) -> Endpoint:
        """Return an endpoint with its launched topic names, if all are known."""
        if not any(MARK in name for name in one.names):
            return one
        return replace(one, names=self._names(one.names), written=tuple(map(self._in_code, one.names)))

    def finding(self, one: Finding) -> Finding:
        """Return a finding with its launched topic names."""
        flow = one.flow
        if flow is None or not any(MARK in name for name in (*flow.source.topics, *flow.sink.topics)):
            return one
        source, sink = flow.source, flow.sink
        source = replace(source, topics=self._names(source.topics), id=self._in_code(source.id))
        sink = replace(sink, topics=self._names(sink.topics), id=self._in_code(sink.id))
        return replace(one, flow=replace(flow, source=source, sink=sink))

    def _names(self, names: Sequence[str]) -> tuple[str, ...]:
        found = [substituted(name, self._value) for name in names]
        return () if None in found else tuple(sorted({one for one in found if one}))

    def _in_code(self, text: str) -> str:
        return substituted(text, self._written) or ""

    def _written(self, number: int) -> str:
        one = self._parameters[number]
        kind = "param" if one.kind == "parameter" else one.kind
        return f"$({kind} {self._in_code(one.name)})" if one.name else f"$({kind})"

    def _value(self, number: int) -> str | None:
        """Return the value of a part of a name; None if it is unknown."""
        one = self._parameters[number]
        if one.kind == "node":
            return self._full_name
        if one.kind == "own":
            return self._full_name.rpartition("/")[2]
        if one.kind == "namespace":
            return f"{self._full_name.rpartition('/')[0]}/"
        if one.kind == "resolved":
            name = self._deeper(one.name)
            return None if name is None else self._resolve(name)
        found_at = places(one.name, self._full_name)
        given = next((self._values[place] for place in found_at if place in self._values), None)
        if given is not None:
            return str(given) if isinstance(given, str | int | float) else None
        return None if one.default is None else self._deeper(one.default)

    def _deeper(self, text: str) -> str | None:
        """Return a string with each part replaced by its value."""
        if self._depth >= DEEPEST:
            return None
        self._depth += 1
        try:
            return substituted(text, self._value)
        finally:
            self._depth -= 1
