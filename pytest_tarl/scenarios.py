"""Read the names of drift scenarios, and of their tests, from pytest's node ids."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import pytest


def scenario(item: pytest.Item) -> str | None:
    """Return the name of the item's drift scenario."""
    callspec = getattr(item, "callspec", None)
    name: str | None = callspec.params.get("tarl_drift") if callspec is not None else None
    return name


def without_drift(item: pytest.Item) -> str:
    """Return the node id without its scenario, because all scenarios of a test share its recording."""
    callspec = getattr(item, "callspec", None)
    if callspec is None or "tarl_drift" not in callspec.params:
        return item.nodeid
    drift, ids = scenario(item) or "online", callspec.id
    base = item.nodeid.removesuffix(f"[{ids}]")
    if ids == drift:
        return base
    rest = ids.removeprefix(f"{drift}-") if ids.startswith(f"{drift}-") else ids.removesuffix(f"-{drift}")
    return f"{base}[{rest}]"
