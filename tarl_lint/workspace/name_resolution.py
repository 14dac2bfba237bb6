"""Resolve ROS names: join a namespace and a name."""

from __future__ import annotations

import re
from typing import Final

_FOUND: Final = re.compile(
    r"\$\(find(?:-pkg-share)? ([\w-]+)\)/|\$\([\w.(\[]*get_package_share_(?:directory|path)\(['\"]([\w-]+)['\"]\)"
)


def package_in(path: str) -> str:
    """Return the package at the beginning of a missing path: `robot` for `$(find robot)/launch/arm.launch`; else "".

    In Python, the path may be an expression, such as `$(os.path.join(get_package_share_directory('robot'), 'launch'))`.
    """
    found = _FOUND.match(path)
    return (found[1] or found[2]) if found else ""


def joined(namespace: str, name: str) -> str:
    """Return an absolute name: `name` in `namespace`, or `name` itself if it is absolute."""
    whole = name if name.startswith("/") else f"{namespace}/{name}"
    return "/" + "/".join(part for part in whole.split("/") if part)


def resolved(name: str, namespace: str, node: str) -> str:
    """Return the absolute name of a topic, service or parameter that a node uses; `~name` is private to the node."""
    if name.startswith("~"):
        return joined(joined(namespace, node), name[1:].lstrip("/"))
    return joined(namespace, name)


def remapped(name: str, namespace: str, node: str, remaps: tuple[tuple[str, str], ...]) -> str:
    """Return the absolute name of a node's topic or service after remapping.

    Both sides of a remapping are resolved like the node's own names. If several remap the same name, the last one
    counts.
    """
    table = {resolved(old, namespace, node): resolved(new, namespace, node) for old, new in remaps}
    whole = resolved(name, namespace, node)
    return table.get(whole, whole)
