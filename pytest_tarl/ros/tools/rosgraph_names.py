"""rosgraph.names: functions for ROS 1 names."""

# ruff: noqa: ARG001 (the signatures are rosgraph's)

from __future__ import annotations

import os
import re
from collections.abc import Mapping, Sequence

from pytest_tarl.ros_names import is_legal_ros1

__all__ = [
    "ANYTYPE", "GLOBALNS", "PRIV_NAME", "REMAP", "SEP", "anonymous_name", "canonicalize_name", "get_ros_namespace",
    "is_global", "is_legal_base_name", "is_legal_name", "is_private", "load_mappings", "make_caller_id",
    "make_global_ns", "namespace", "ns_join", "resolve_name", "script_resolve_name",
]  # fmt: skip

ANYTYPE = TOPIC_ANYTYPE = SERVICE_ANYTYPE = "*"
GLOBALNS = SEP = "/"
PRIV_NAME = "~"
REMAP = ":="


def get_ros_namespace(env: Mapping[str, str] | None = None, argv: Sequence[str] | None = None) -> str:
    """Return the namespace: `__ns:=` on the command line, or the variable `ROS_NAMESPACE`, or `/`."""
    for argument in argv or ():
        if argument.startswith("__ns:="):
            return make_global_ns(argument.removeprefix("__ns:="))
    return make_global_ns((os.environ if env is None else env).get("ROS_NAMESPACE", GLOBALNS))


def make_caller_id(name: str) -> str:
    """Return the full name of a node, without a trailing slash."""
    return make_global_ns(ns_join(get_ros_namespace(), name)).rstrip("/") or "/"


def make_global_ns(name: str) -> str:
    """Return a name with a slash at both ends. Raise ValueError for a private name."""
    if is_private(name):
        raise ValueError(f"cannot turn [{name}] into a global name")
    return ("" if is_global(name) else SEP) + name + ("" if name.endswith(SEP) else SEP)


def is_global(name: str) -> bool:
    """Return whether a name begins with a slash."""
    return name.startswith(SEP)


def is_private(name: str) -> bool:
    """Return whether a name begins with `~`."""
    return name.startswith(PRIV_NAME)


def namespace(name: str | None) -> str:
    """Return the namespace of a name, with a trailing slash. Raise ValueError for None."""
    if name is None:
        raise ValueError("name")
    return name.rstrip(SEP).rpartition(SEP)[0] + SEP


def ns_join(ns: str, name: str) -> str:
    """Join a namespace and a name; global and private names stay unchanged."""
    if is_private(name) or is_global(name):
        return name
    if ns == PRIV_NAME:
        return PRIV_NAME + name
    return f"{ns.rstrip(SEP)}{SEP}{name}" if ns else name


def load_mappings(argv: Sequence[str]) -> dict[str, str]:
    """Return the remappings `old:=new` on a command line, without special names such as `__name`."""
    pairs = [argument.split(REMAP, 1) for argument in argv if REMAP in argument]
    return {old.strip(): new.strip() for old, new in pairs if old.strip() and not old.startswith("_")}


def is_legal_name(name: str | None) -> bool:
    """Return whether a topic, service, node or parameter can have this name."""
    return name is not None and (name == "" or is_legal_ros1(name))


def is_legal_base_name(name: str | None) -> bool:
    """Return whether a string can be the last part of a name."""
    return name is not None and bool(re.fullmatch(r"[A-Za-z]\w*", name, re.ASCII))


def canonicalize_name(name: str) -> str:
    """Return a name without doubled or trailing slashes."""
    parts = SEP.join(part for part in name.split(SEP) if part)
    return SEP + parts if is_global(name) else parts


def resolve_name(name: str, namespace_: str, remappings: Mapping[str, str] | None = None) -> str:
    """Return the global form of a name used in node `namespace_`; remappings apply to the result."""
    if not name:
        return namespace(namespace_)
    name = canonicalize_name(name)
    if is_private(name):
        resolved = canonicalize_name(f"{namespace_}{SEP}{name[1:]}")
    else:
        resolved = name if is_global(name) else namespace(namespace_) + name
    return (remappings or {}).get(resolved, resolved)


def script_resolve_name(script_name: str, name: str) -> str:
    """Return the global form of a name on a script's command line. Raise ValueError for a private name."""
    if is_private(name):
        raise ValueError("~name topics cannot be created on the command-line")
    return (
        get_ros_namespace() if not name else name if is_global(name) else ns_join(get_ros_namespace(), name)
    )


def anonymous_name(id: str) -> str:  # noqa: A002 (rosgraph's name)
    """Return a name that no other node of the episode has."""
    from pytest_tarl.ros.process import current_process

    process = current_process("rosgraph.names.anonymous_name")
    return f"{id}_{len(process.ros.processes)}_{process.scheduler.time}"
