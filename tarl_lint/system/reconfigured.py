"""Add the parameters of dynamic_reconfigure to those of a program; the workspace's `.cfg` files name them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Any

from tarl_lint.system.model import Interface
from tarl_lint.workspace.cfg_files import configurations
from tarl_lint.workspace.model import Workspace


def with_configured(interface: Interface, workspace: Workspace) -> Interface:
    """Return an interface whose words include the names in its `.cfg` files.

    If a file is not in the workspace or cannot be read completely, the parameters are unknown.
    """
    if not interface.configured:
        return interface
    found = [_names(one, workspace) for one in interface.configured]
    if None in found:
        return replace(interface, parameters=False)
    names = (name for one in found for name in one or ())
    return replace(interface, words=interface.words.union(names))


def _names(config: str, workspace: Workspace) -> tuple[str, ...] | None:
    """Return the parameters of a class `PACKAGE.cfg.NAMEConfig`; None if they are unknown."""
    package, _, name = config.partition(".cfg.")
    owner = workspace.package(package)
    for path in owner.configurations if owner is not None else ():
        names = _generated(path, path.stat().st_mtime_ns if path.is_file() else 0).get(name)
        if names is not None:
            return names
    return None


@lru_cache(maxsize=256)
def _generated(path: Path, _changed: int) -> dict[str, tuple[str, ...]]:
    """Return the parameters of each class that a `.cfg` file generates; empty if a part of the file is unknown.

    `_changed` is the time of the file's last change, so that a changed file is read again.
    """
    made, problems = configurations(path)
    if problems:
        return {}
    return {f"{one.name}Config": tuple(_of_group(one.description)) for one in made}


def _of_group(group: dict[str, Any]) -> Iterator[str]:
    yield from (str(one["name"]) for one in group["parameters"])
    for inner in group["groups"]:
        yield from _of_group(inner)
