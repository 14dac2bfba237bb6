"""Select the parameters for one node from the values given by a test, a launch file or a parameter file."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from tarl_lint.workspace.parameter_yaml import dotted, matches, sections


def overrides(given: Mapping[str, Any], full_name: str) -> dict[str, Any]:
    """Return the values for the node with this absolute name; nested mappings become dotted names.

    - Parameters that name no node apply to all nodes.
    - A section with `ros__parameters` applies to the nodes that match its key. A node in a namespace also gets the
      section with its own name.
    - A mapping without `ros__parameters` is a section if its key is the node's name or `**`; otherwise it has nested
      parameters.
    - Later values win.
    """
    name = full_name.rpartition("/")[2]
    chosen: dict[str, Any] = {}
    for key, value in given.items():
        owner = key.strip("/")
        if isinstance(value, dict) and (found := list(sections({key: value}))):
            for pattern, values in found:
                if matches(pattern, full_name) or pattern.strip("/") == name:
                    chosen.update(dotted(values))
        elif isinstance(value, dict) and owner in (name, full_name.strip("/"), "**"):
            chosen.update(dotted(value))
        elif ":" in key:
            node, _, own = key.partition(":")
            if node.strip("/") in (name, full_name.strip("/")):
                chosen[own] = value
        elif not key.startswith("/"):
            chosen.update(dotted({key.removeprefix("~"): value}))
    return chosen
