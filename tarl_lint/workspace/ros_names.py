"""Names of ROS: join a namespace and a name, resolve a name as a node does."""

from __future__ import annotations


def joined(namespace: str, name: str) -> str:
    """Return an absolute name: `name` within `namespace`, or `name` itself where it is absolute."""
    whole = name if name.startswith("/") else f"{namespace}/{name}"
    return "/" + "/".join(part for part in whole.split("/") if part)
